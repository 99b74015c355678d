"""The events of bolts in words: yielding, rupture, loss of their block."""

from __future__ import annotations

import numpy as np

from clast.actions.bolts.bolt_states import BoltStates, untouched
from clast.model.model import Floats, Model

MOST = 20
"""Events that are said one by one, at most."""


def happened(
    model: Model, before: BoltStates, after: BoltStates
) -> list[tuple[float, str, str, str]]:
    """Return the events of bolts between two states of a run, in the order of time.

    Time, s, kind, name of the bolt, and a sentence.  ``before`` and ``after`` are the own states of
    the action on bolts (``State.actions``); a block is lost between steps, and has no time.
    """
    names = model.bolts.name
    found = []
    for kind, was, now in (
        ("yielded", before.yielded_at, after.yielded_at),
        ("broke", before.broken_at, after.broken_at),
    ):
        first = _first(model, np.where(np.isnan(was), now, np.nan))
        known = ~np.isnan(_first(model, was))
        found += [
            (float(first[k]), kind, names[k], f"bolt '{names[k]}' {kind} at t = {first[k]:.6g} s")
            for k in np.flatnonzero(~np.isnan(first) & ~known)
        ]
    lost = np.unique(model.bolts.of_spring[after.lost & ~before.lost])
    said = "lost its anchor with its block"
    found += [(np.inf, "lost", names[k], f"bolt '{names[k]}' {said}") for k in lost]
    return sorted(found)


def story_of(state: BoltStates, model: Model) -> tuple[str, ...]:
    """Return all that has happened to bolts since the start of a run; of many, how many more."""
    events = [text for *_, text in happened(model, untouched(len(state.rest)), state)]
    if len(events) <= MOST:
        return tuple(events)
    return *events[:MOST], f"bolts: {len(events) - MOST} more events after these"


def _first(model: Model, times: Floats) -> Floats:
    """Return the earliest of the times (m,) of the springs of each bolt, nan for none, (k,)."""
    earliest = np.full(len(model.bolts), np.inf)
    np.fmin.at(earliest, model.bolts.of_spring, times)
    return np.where(np.isfinite(earliest), earliest, np.nan)
