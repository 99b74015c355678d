"""Forces of anchors, linings and links at the end of a trial, beside their strengths."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast.actions.linings import interaction_curve
from clast.actions.links import COMPONENTS, Links
from clast.results import Run
from clast.results.frame_samples import bolt_states
from clast.results.schema import BOLT_STATES, LINING_STATES, LINK_STATES
from clast.rockmass.drawings.drawing_files import write_rows

HEADS = ("support", "name", "part", "force or moment, kN, kN m", "strength", "used, %", "state")
"""Columns of a table of forces, per metre of thickness."""


@dataclass(frozen=True, kw_only=True)
class SupportForce:
    """A force or moment of an anchor, a lining or a link, where it uses most of its strength."""

    support: str
    """"bolt", "lining" or "link"."""
    name: str
    what: str
    """"axial" of a bolt; "N", "M" of a lining; "along", "across", "rotation" of a link."""
    force: float
    """N/m, or moment, N m/m; tension positive."""
    strength: float | None
    """Force or moment of the same kind at which it yields; None: it does not."""
    used: float | None
    """Share of its strength; of a lining by N and M together.  None: it has no strength."""
    state: str

    @property
    def row(self) -> tuple[Any, ...]:
        """Its row in a table with ``HEADS``, forces in kN."""
        strength = "none" if self.strength is None else f"{1e-3 * self.strength:.4g}"
        used = "" if self.used is None else f"{100.0 * self.used:.3g}"
        force = f"{1e-3 * self.force:.4g}"
        return (self.support, self.name, self.what, force, strength, used, self.state)


def support_forces(run: Run) -> tuple[SupportForce, ...]:
    """Return the forces of all supports that are installed at the end of a run."""
    return (*_bolts(run), *_linings(run), *_links(run))


def support_force_of(content: Any) -> SupportForce:
    """Return the force that ``vars`` gave; raises TypeError for values of another kind."""
    one = SupportForce(**content)
    texts = (one.support, one.name, one.what, one.state)
    numbers = (one.force, one.strength or 0.0, one.used or 0.0)
    if not all(isinstance(t, str) for t in texts) or not all(
        isinstance(n, int | float) for n in numbers
    ):
        raise TypeError("a force of a support has values of another kind")
    return one


def supports_of(content: Any) -> tuple[SupportForce, ...]:
    """Return the forces in the result of a run; raises TypeError for values of another kind."""
    return tuple(map(support_force_of, content.get("supports", ())))


def write_supports(folder: Path, supports: Sequence[SupportForce]) -> None:
    """Write forces into supports.csv in the folder of a study, N and N m."""
    rows = ([*vars(one).values()] for one in supports)
    write_rows(folder / "supports.csv", [list(vars(supports[0])), *rows])


def _bolts(run: Run) -> Iterator[SupportForce]:
    """Yield the axial force of each bolt, in the spring that uses most of its strength."""
    bolts = run.model.bolts
    if not len(bolts):
        return
    springs = bolt_states(run.model, run.state)
    used = np.abs(springs.force) / bolts.yield_force
    for number, name in enumerate(bolts.name):
        own = np.flatnonzero(bolts.of_spring == number)
        worst = own[np.lexsort((np.abs(springs.force[own]), used[own]))[-1]]
        state = int(springs.state[own].max())
        if state:
            yield _force(
                ("bolt", name, "axial", BOLT_STATES[state]),
                float(springs.force[worst]),
                float(bolts.yield_force[worst]),
            )


def _linings(run: Run) -> Iterator[SupportForce]:
    """Yield N and M of each lining at its joint that uses most of its strength."""
    for name in run.lining_name:
        lining = run.lining(name)
        states = lining.state[-1].astype(int)
        if not states.any():
            continue
        normal, moment, used = (
            np.nan_to_num(getattr(lining, column)[-1])
            for column in ("normal_force", "moment", "utilisation")
        )
        worst = int(np.lexsort((np.abs(normal), np.abs(moment), used))[-1])
        thickness, tension, compression = map(float, lining.section[worst])
        n, m = float(normal[worst]), float(moment[worst])
        limits = (thickness * (tension if n > 0.0 else compression), math.inf)
        if math.isfinite(tension) and math.isfinite(compression):
            curve = interaction_curve(thickness, tension, compression)
            limits = (limits[0], float(curve.moment_at(np.array([n]))[0]))
        share = None if np.isnan(lining.utilisation[-1]).all() else float(used[worst])
        word = LINING_STATES[int(states.max())]
        for what, force, limit in zip("NM", (n, m), limits, strict=True):
            one = _force(("lining", name, what, word), force, limit)
            yield SupportForce(**{**vars(one), "used": share})


def _links(run: Run) -> Iterator[SupportForce]:
    """Yield the force of each component of links that carry."""
    actions = run.model.actions
    states: Any = run.state.actions[len(run.state.actions) - len(actions) :]
    for links, held in zip(actions, states, strict=True):
        if not isinstance(links, Links):
            continue
        rows, (low, high) = links.rows, links.limits.bounds(links.rows, held)
        condition = links.condition(held)
        for k in np.flatnonzero(held.carries | held.broken).tolist():
            force, link = float(held.force[k]), int(rows.link[k])
            word = LINK_STATES[int(condition[link])]
            words = ("link", rows.name[link], COMPONENTS[int(rows.component[k])], word)
            yield _force(words, force, float(high[k] if force > 0.0 else -low[k]))


def _force(words: tuple[str, str, str, str], force: float, limit: float) -> SupportForce:
    """Return a force with a strength that may be infinite; its words are those of its fields."""
    support, name, what, state = words
    is_limited = math.isfinite(limit)
    return SupportForce(
        support=support,
        name=name,
        what=what,
        force=force,
        strength=limit if is_limited else None,
        used=abs(force) / limit if is_limited and limit > 0.0 else None,
        state=state,
    )
