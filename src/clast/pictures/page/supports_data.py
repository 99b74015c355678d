"""Links, reactions and linings of a page, frame by frame."""

from __future__ import annotations

from dataclasses import astuple
from typing import Any

import numpy as np

from clast.model.model import Floats, Ints
from clast.pictures.page.packing import raw
from clast.pictures.supports import draw_links
from clast.pictures.supports.draw_linings import DIAGRAMS, comes_back
from clast.pictures.supports.draw_reactions import COLOUR, forces_in
from clast.results import Recording
from clast.results.schema import LINK_STATES

BEARS = (1, 4)
"""First state of a joint of a lining in which it carries, and the first after these."""


def supports_of(results: Recording) -> dict[str, Any]:
    """Return what of links, reactions and linings stays the same: names, colours, vertices."""
    links = results.supported.links
    looks = [
        ("link" if one == "intact" else f"link, {one}", draw_links.COLOURS[one])
        for one in LINK_STATES
    ]
    return {
        "link_looks": looks,
        "link_holds": links.holds.tolist() if links.name else [],
        "reaction_colour": COLOUR,
        "linings": [_lining(results, name) for name in results.lining_name],
        "diagrams": {name: astuple(one) for name, one in DIAGRAMS.items()},
    }


def _lining(results: Recording, name: str) -> dict[str, Any]:
    """Return the vertices outside and inside at each joint of a lining, and whether it closes."""
    lining = results.lining(name)
    return {"face": lining.face.tolist(), "closed": comes_back(results, name, lining)}


def links_in(results: Recording, numbers: Ints, origin: Floats) -> dict[str, Any] | None:
    """Return both points, directions and states of the links in some frames; None without any."""
    links = results.supported.links
    if not links.name:
        return None
    places = np.stack([draw_links.places_of(results, int(k)) for k in numbers]) - origin
    ways = np.stack([draw_links.ways_of(results, int(k)) for k in numbers])
    states = np.stack([draw_links.states_of(results, int(k)) for k in numbers])
    ends = {f"{axis}{end}": places[:, :, end, k] for end in (0, 1) for k, axis in enumerate("xy")}
    ends |= {"wayX": ways[..., 0], "wayY": ways[..., 1]}
    return {
        "names": list(links.name),
        **{name: raw(values, "<f4") for name, values in ends.items()},
        "state": raw(states, "<i4"),
    }


def reactions_in(results: Recording, numbers: Ints, origin: Floats) -> dict[str, Any] | None:
    """Return where reactions act, m, and their forces, N/m, in some frames; NaN for none."""
    names = results.reaction_name
    if not names:
        return None
    found = np.full((4, len(numbers), len(names)), np.nan)
    for row, number in enumerate(numbers):
        for name, at, force in forces_in(results, int(number)):
            found[:, row, names.index(name)] = *(at - origin), *force
    columns = zip(("x", "y", "fx", "fy"), found, strict=True)
    return {"names": list(names), **{name: raw(values, "<f4") for name, values in columns}}


def linings_in(results: Recording, numbers: Ints) -> dict[str, str] | None:
    """Return N, Q and M of the joints of all linings in some frames; NaN: it does not bear."""
    if not results.lining_name:
        return None
    every: dict[str, list[Floats]] = {one.column: [] for one in DIAGRAMS.values()}
    for name in results.lining_name:
        lining = results.lining(name)
        rows = results.rows_at(lining.time, numbers)
        carries = (lining.state[rows] >= BEARS[0]) & (lining.state[rows] < BEARS[1])
        for column, values in every.items():
            values.append(np.where(carries, getattr(lining, column)[rows], np.nan))
    return {name: raw(np.concatenate(values, axis=1), "<f4") for name, values in every.items()}
