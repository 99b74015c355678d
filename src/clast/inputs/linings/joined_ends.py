"""Ends of linings that are joined: which of them lie at one place, and the mitres between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.errors import ModelError, shortened
from clast.inputs.declaring.values import number_of
from clast.model.model import Floats

ENDS_APART_MAX = 0.5
"""Distance of two ends that are at one place, in units of the smaller thickness."""
Drawn = tuple[Floats, bool]
"""The line of a lining (c, 2), m, and whether it was turned."""


@dataclass(frozen=True, kw_only=True)
class JoinedEnd:
    """An end of a lining that is joined to an end of another."""

    lining: int
    """Number of the lining that joins the other."""
    end: int
    """Its end: 0 where its line begins, 1 where it ends."""
    other: int
    """Number of the other."""
    other_end: int
    """End of that."""


def joined_ends(tables: Sequence[Any], drawn: Sequence[Drawn]) -> tuple[JoinedEnd, ...]:
    """Return the ends that linings (Lining) join, which have lines; raises ModelError."""
    number = {one.name: k for k, one in enumerate(tables)}
    found: dict[tuple[int, int], JoinedEnd] = {}
    for k, one in enumerate(tables):
        if one.joins is None:
            continue
        where = f"lining '{shortened(one.name)}', joins"
        other = number_of(one.joins, number, "lining", where)
        for joint in _between(k, other, tables, drawn, where):
            mine, theirs = (k, joint.end), (other, joint.other_end)
            if mine in found and found[mine] == found.get(theirs):
                continue  # each of the two names the other
            for of, end in (mine, theirs):
                _check_free(tables[of], drawn[of], end, where)
                if (of, end) in found:
                    what = f"an end of lining '{shortened(tables[of].name)}' is joined already"
                    raise ModelError(what, where=where, remedy="join two linings at one place")
            found[mine] = found[theirs] = joint
    return tuple(dict.fromkeys(found.values()))


def _between(
    k: int, other: int, tables: Sequence[Any], drawn: Sequence[Drawn], where: str
) -> Iterator[JoinedEnd]:
    """Yield the ends of two linings that are at one place."""
    said = f"lining '{shortened(tables[other].name)}'"
    if tables[other].is_ring:
        what = f"the line of {said} is closed: it has no ends"
        raise ModelError(what, where=where, remedy="name a lining that ends where this one does")
    own, theirs = drawn[k][0][[0, -1]], drawn[other][0][[0, -1]]
    apart = np.hypot(*(own[:, None] - theirs).T).T
    near = ENDS_APART_MAX * min(tables[k].thickness, tables[other].thickness)
    if not (apart <= near).any():
        what = f"no end of it is at an end of {said}: the nearest are {apart.min():.3g} m apart"
        raise ModelError(what, where=where, remedy="begin one where the other ends")
    for end, other_end in np.argwhere(apart <= near).tolist():
        yield JoinedEnd(lining=k, end=end, other=other, other_end=other_end)


def _check_free(one: Any, drawn: Drawn, end: int, where: str) -> None:
    """Refuse an end that the ground holds as well."""
    key = ("start", "end")[1 - end if drawn[1] else end]
    if getattr(one, key) != "free":
        what = f"the {key} of lining '{shortened(one.name)}' is held by the ground as well"
        raise ModelError(what, where=where, remedy=f"leave its {key} out")


def beyond(
    number: int, joined: Sequence[JoinedEnd], drawn: Sequence[Drawn]
) -> tuple[Floats | None, Floats | None]:
    """Return the edges (2,), m, of others before the start and behind the end of a lining."""
    edges: list[Floats | None] = [None, None]
    for one in joined:
        sides = ((one.lining, one.end), (one.other, one.other_end))
        for (of, end), (other, other_end) in (sides, sides[::-1]):
            if of == number:
                line = drawn[other][0]
                edge = line[-1] - line[-2] if other_end else line[1] - line[0]
                edges[end] = edge if end != other_end else -edge
    return edges[0], edges[1]
