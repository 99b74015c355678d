"""Warnings about slides over bent ground: slices that lock at a bend, or wear at their cuts.

Rock that slides over a bend has to shear inside.  Blocks are stiff: one whose base runs over the
bend is locked, and of two that meet at it, each sliding along its own plane at a speed s,

    s1 t1.n = s2 t2.n                                      n: normal of the cut between them,

so that both go at one speed, as a slide does, only where the cut follows the bisector of the bend;
along any other cut they grind past each other.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clast.block.polygon import edges
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.water.faces import edges_of, facing_edges

BENDS = np.radians(3.0), np.radians(60.0)
"""Bends of the ground below are none, and above are two faces, rad."""
FLAT = np.radians(5.0)
"""Bases that dip less do not slide, rad."""
ASKEW = np.radians(5.0)
"""Cuts that leave the bisector by more do not follow the bend, rad."""
MOST = 20_000
"""Blocks up to which slides are looked for: more are no row of slices."""
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
    yield from _askew(model, facing, on_ground)


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
        "factors of safety come out too high. Cut the slide at its bends, along their bisectors, "
        "and give the cuts the strength of the rock inside"
    )


def _askew(model: Model, facing: Ints, on_ground: Bools) -> Iterator[str]:
    """Warn of cuts between slices that begin at a bend and leave it in another direction."""
    owner, after, along = model.vertex_block, _after(model), _along(model)
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    # a cut stands where the base of one block ends (up) and that of the other begins (down)
    up, down = np.concatenate([facing, facing[:, ::-1]]).T
    one, other = before[up], after[down]
    near = 1e-6 * np.sqrt(model.area)[owner[up]]
    apart = np.hypot(*(model.vertices[up] - model.vertices[other]).T)
    standing = on_ground[one] & on_ground[other] & (apart <= near)
    up, one, other = up[standing], one[standing], other[standing]
    bend = _bends(model, along[one], along[other])
    middle = along[one] + along[other]
    bisector = np.stack([-middle[:, 1], middle[:, 0]], axis=1)
    cut = along[up]
    off = np.arctan2(
        bisector[:, 0] * cut[:, 1] - bisector[:, 1] * cut[:, 0], (bisector * cut).sum(axis=1)
    )
    found = np.flatnonzero(np.isfinite(bend) & (np.abs(off) > ASKEW))
    if not len(found):
        return
    worst = found[np.argmax(np.abs(bend[found]))]
    upwards = bisector[worst] * -np.sign(bisector[worst] @ model.gravity)
    wanted = np.degrees(np.arctan2(upwards[1], upwards[0]))
    yield (
        f"{len(found)} cut(s) between slices do not follow the bend of the ground below: at "
        f"{_place(model, int(up[worst]))} it bends by {np.degrees(abs(bend[worst])):.2g} degrees, "
        f"and the cut is {np.degrees(abs(off[worst])):.2g} degrees off its bisector. Slices grind "
        "past each other there, and factors of safety come out too high: cut along the bisector "
        f"({wanted:.3g} degrees from +x), or give the cut no more strength than the rock inside"
    )


def _bends(model: Model, first: Floats, second: Floats) -> Floats:
    """Return the turn from one direction of a base (k, 2) to the next, rad; NaN where none counts.

    Both planes dip to the same side: a block between two that face each other is no slide.
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
