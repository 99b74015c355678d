"""Warnings about slides over bent ground, on which stiff blocks lock.

Rock that slides over a bend has to shear inside.  A block whose base runs over the bend is locked.
Of two slices that meet at a bend where the ground flattens, the toe of the upper one would go into
the next plane: it carries there from the first movement on, whatever the direction of the cut.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clast.block.polygon import edges
from clast.model.edges import edges_of, facing_edges
from clast.model.model import Bools, Floats, Ints, Model

BENDS = np.radians(3.0), np.radians(60.0)
"""Bends of the ground below are none, and above are two faces, rad."""
FLAT = np.radians(5.0)
"""Bases that dip less do not slide, rad."""
MOST = 20_000
"""Blocks up to which slides are looked for: more are not a row of slices."""
NAMED = 3
"""Blocks that are named, at most."""


def slide_warnings(model: Model) -> Iterator[str]:
    """Warn of slices over bent ground, where all that can move lies on ground that cannot."""
    ground = model.fixed.copy()
    ground[model.fixed_points.block] = True
    if not ground.any() or ground.all() or model.block_count > MOST:
        return
    owner = model.vertex_block
    _, length = edges(model.vertices, model.block_start)
    facing = facing_edges(edges_of(model.vertices, _after(model), owner, model.area)).edge
    on_ground = np.zeros(len(length), np.bool_)
    for own, other in (facing.T, facing.T[::-1]):
        on_ground[own[ground[owner[other]] & ~ground[owner[own]]]] = True
    if len(np.setdiff1d(np.flatnonzero(~ground), owner[on_ground])):
        return
    yield from _locked(model, on_ground)
    yield from _toes(model, facing, on_ground)


def _locked(model: Model, on_ground: Bools) -> Iterator[str]:
    """Warn of blocks whose base runs over a bend."""
    after = _after(model)
    corner = after[np.flatnonzero(on_ground & on_ground[after])]
    before = np.flatnonzero(on_ground & on_ground[after])
    along = _along(model)
    bend = _bends(model, along[before], along[corner])
    found = np.flatnonzero(np.isfinite(bend))
    if not len(found):
        return
    worst = found[np.argmax(np.abs(bend[found]))]
    yield (
        f"the base of block {_names(model, model.vertex_block[corner[found]])} runs over a bend of "
        f"the ground, of {np.degrees(abs(bend[worst])):.2g} degrees at "
        f"{_place(model, int(corner[worst]))}: it is locked there until it leaves the ground, and "
        "factors of safety come out too high. Cut the slide at its bends, and give the cuts the "
        "strength of the rock inside"
    )


def _toes(model: Model, facing: Ints, on_ground: Bools) -> Iterator[str]:
    """Warn of slices whose toe is at a bend where the ground flattens."""
    owner, after, along = model.vertex_block, _after(model), _along(model)
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    # a cut stands where the base of one block ends (up) and that of the other begins (down)
    up, down = np.concatenate([facing, facing[:, ::-1]]).T
    one, other = before[up], after[down]
    near = 1e-6 * np.sqrt(model.area)[owner[up]]
    apart = np.hypot(*(model.vertices[up] - model.vertices[other]).T)
    standing = on_ground[one] & on_ground[other] & (apart <= near)
    up, bend = up[standing], _bends(model, along[one[standing]], along[other[standing]])
    found = np.flatnonzero(bend > 0.0)
    if not len(found):
        return
    worst = found[np.argmax(bend[found])]
    yield (
        f"the ground flattens under {len(found)} cut(s) between slices, by "
        f"{np.degrees(bend[worst]):.2g} degrees at {_place(model, int(up[worst]))}: the toe of "
        "the slice above rests on the next plane as soon as it moves, and factors of safety come "
        "out too high. Cut off the toe at the bend so that it can move, and compare "
        "with limit equilibrium"
    )


def _bends(model: Model, first: Floats, second: Floats) -> Floats:
    """Return the turn from one direction of a base (k, 2) to the next, rad; NaN where none counts.

    Both planes dip to the same side: a block between two that face each other is not a slide.
    """
    turn = np.arctan2(
        first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0], (first * second).sum(axis=1)
    )
    gravity = model.gravity / max(float(np.hypot(*model.gravity)), 1e-300)
    drop = np.stack([first @ gravity, second @ gravity])
    level = np.sin(FLAT)
    same = (drop.prod(axis=0) >= 0.0) | (np.abs(drop).min(axis=0) < level)
    steep = np.abs(drop).max(axis=0) > level
    bent = (np.abs(turn) >= BENDS[0]) & (np.abs(turn) <= BENDS[1])
    return np.where(same & steep & bent, turn, np.nan)


def _after(model: Model) -> Ints:
    """Return the vertex after each one in its block, shape (nv,)."""
    after = np.arange(1, len(model.vertices) + 1)
    after[model.block_start[1:] - 1] = model.block_start[:-1]
    return after


def _along(model: Model) -> Floats:
    """Return the direction of the edge that begins at each vertex, shape (nv, 2)."""
    return edges(model.vertices, model.block_start)[0]


def _place(model: Model, vertex: int) -> str:
    """Return where a vertex is, as the user gave it."""
    x, y = model.vertices[vertex] + model.origin
    return f"({x:.6g}, {y:.6g})"


def _names(model: Model, blocks: Ints) -> str:
    """Return the names of the first few blocks."""
    names = [f"'{model.block_name[block]}'" for block in np.unique(blocks)[:NAMED]]
    return ", ".join(names) + (", ..." if len(np.unique(blocks)) > NAMED else "")
