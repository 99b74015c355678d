"""Blocks as loops of common places, one after another: removing and inserting places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Bools, Ints
from clast.rockmass.block_loops import following


@dataclass(frozen=True, kw_only=True, eq=False)
class Cycles:
    """Loops of places; entry k stands for a vertex and for the edge from it to the next."""

    start: Ints
    """First entry of each block, and the number of entries, shape (nb + 1,)."""
    node: Ints
    """Place of each entry, shape (nv,)."""
    edge: Ints
    """Edge as drawn that the edge of each entry is, or is a part of, shape (nv,)."""

    @property
    def owner(self) -> Ints:
        """Block of each entry, shape (nv,)."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))

    @property
    def after(self) -> Ints:
        """Place of the entry after each in its block, shape (nv,)."""
        return np.asarray(self.node[_next(self.start)])

    def only(self, keep: Bools) -> Cycles:
        """Return the loops with some of their entries (nv,)."""
        count = np.bincount(self.owner[keep], minlength=len(self.start) - 1)
        return Cycles(
            start=np.concatenate([[0], np.cumsum(count)]),
            node=self.node[keep],
            edge=self.edge[keep],
        )


def _next(start: Ints) -> Ints:
    """Return the entry after each; blocks may have become empty."""
    filled = np.unique(start)
    return following(filled) if len(filled) > 1 else np.zeros(0, np.int64)


def without_folds(loops: Cycles) -> tuple[Cycles, Ints]:
    """Return loops without edges of no length and without spikes, and the places of those, (k,).

    A spike goes out along an edge and comes back along it: it encloses nothing.
    """
    closed = [np.zeros(0, np.int64)]
    while len(loops.node):
        # Of an edge from a place to itself the second entry stays, with the joint of its own edge.
        same = loops.node == loops.after
        if same.any():
            closed.append(loops.node[same])
            loops = loops.only(~same)
            continue
        spike = _spikes(loops)
        if len(spike) == 0:
            break
        removed = np.zeros(len(loops.node), np.bool_)
        removed[spike] = True
        removed[_before(loops.start)[spike]] = True
        closed.append(loops.node[spike])
        loops = loops.only(~removed)
    return loops, np.concatenate(closed)


def _before(start: Ints) -> Ints:
    """Return the entry before each in its block."""
    after = _next(start)
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    return before


def _spikes(loops: Cycles) -> Ints:
    """Return entries at tips of spikes, one a block at most, (k,)."""
    tips = np.flatnonzero(loops.node[_before(loops.start)] == loops.after)
    return tips[np.unique(loops.owner[tips], return_index=True)[1]]


def with_places(loops: Cycles, entry: Ints, node: Ints) -> Cycles:
    """Return loops with places (k,) put in after entries (k,), in the order given."""
    count = np.bincount(loops.owner[entry], minlength=len(loops.start) - 1)
    every = np.concatenate([np.arange(len(loops.node)), entry])
    # Stable: an entry goes before what is put in after it.
    order = np.argsort(every, kind="stable")
    return Cycles(
        start=loops.start + np.concatenate([[0], np.cumsum(count)]),
        node=np.concatenate([loops.node, node])[order],
        edge=np.concatenate([loops.edge, loops.edge[entry]])[order],
    )
