"""Scenes that are simulated from beginning to end: the waiting time of a user, with impacts.

A heap that falls and comes to rest, a wall of which half has no ground, dominoes, blocks that
slide down a hillside.  They are given by outlines alone, so that other programs can simulate the
same (benchmarks/peers.py), and have the rock and the joints of studies/bench/scenes.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats, Model
from clast.studies.bench.scenes import (
    GRAVITY,
    HIGHEST_HEAP,
    SPACING,
    begun,
    box,
    outlines_of_heap,
    outlines_of_wall,
    rectangles,
)

WHOLE_SIZE = 100
"""Blocks by default."""
STEP = 2.5e-3
"""Length of a step, s."""
SHARE = 0.1
"""p/E."""
TRAVEL = 2.0
"""max_displacement in units of the default: a tenth of a block's size."""


@dataclass(frozen=True, kw_only=True)
class WholeScene:
    """A scene with a beginning and an end that can be made with any number of blocks."""

    name: str
    """Name on the command line."""
    title: str
    """The title."""
    outlines: Callable[[int], tuple[Floats, Floats]]
    """Returns the outlines of about so many blocks that move, and of those that do not, m.

    Quadrilaterals, counter-clockwise, shape (k, 4, 2) each.
    """
    end: Callable[[int], float]
    """Returns the simulated time after which so many blocks are at rest, or nearly, s."""

    def build(self, size: int) -> Model:
        """Return the model with about so many blocks, those that do not move first."""
        free, fixed = self.outlines(size)
        builder = begun(f"{self.title}, {len(free)} blocks")
        builder.blocks(vertices=fixed, fixed=True)
        builder.blocks(vertices=free)
        return builder.build()


# --- a heap ----------------------------------------------------------------------------------


def rows_of_heap(size: int) -> int:
    """Return how many rows of squares fall: as many as columns, 100 at most."""
    return min(HIGHEST_HEAP, max(2, round(math.sqrt(size))))


def heap_outlines(size: int) -> tuple[Floats, Floats]:
    """Return loose squares, and the trough into which they fall."""
    return outlines_of_heap(size, math.ceil(size / rows_of_heap(size)))


def end_of_heap(size: int) -> float:
    """Return twice the time of fall of the highest square, and a second."""
    return 2.0 * math.sqrt(2.0 * (SPACING - 1.0) * rows_of_heap(size) / GRAVITY) + 1.0


# --- a wall ----------------------------------------------------------------------------------


def shape_of_wall(size: int) -> tuple[int, int]:
    """Return courses and columns of a wall as high as wide, 50 courses high at most."""
    courses = min(50, max(2, round(math.sqrt(2.0 * size))))
    return courses, max(2, round((size - courses // 2) / courses))


def drop_of_wall(size: int) -> float:
    """Return how far the floor is below the wall, m: a quarter of its height, a metre at least."""
    return max(1.0, 0.125 * shape_of_wall(size)[0])


def wall_outlines(size: int) -> tuple[Floats, Floats]:
    """Return a running bond, and ground under its left half only, with a floor further down."""
    courses, columns = shape_of_wall(size)
    drop, width = drop_of_wall(size), float(columns)
    beyond = 4.0 * (0.5 * courses + drop)  # no brick rolls as far
    fixed = [
        box(-beyond, -drop - 1.0, 0.5 * width, 0.0),
        box(0.5 * width, -drop - 1.0, width + beyond, -drop),
    ]
    return outlines_of_wall(courses, columns), np.concatenate(fixed)


def end_of_wall(size: int) -> float:
    """Return twice the time of fall from its top to the floor, and a second."""
    height = 0.5 * shape_of_wall(size)[0] + drop_of_wall(size)
    return 2.0 * math.sqrt(2.0 * height / GRAVITY) + 1.0


# --- dominoes --------------------------------------------------------------------------------

DOMINO = (0.2, 1.0)
"""Width and height of a domino, m."""
APART = 0.8
"""Distance of dominoes, m: one that falls as far by itself throws the next."""
ROW = 25
"""Dominoes in a row at most; further ones stand on a shelf above."""
SHELF = 3.0
"""Distance of shelves, m."""
LEAN = math.radians(13.0)
"""Angle at which the first domino of a row leans; it falls by itself from 11.3 degrees on."""
SLOWEST = 1.5
"""Speed at which rows fall at least, m/s."""


def domino_outlines(size: int) -> tuple[Floats, Floats]:
    """Return rows of dominoes of which the first leans, and the ground under them."""
    shelves = math.ceil(size / ROW)
    number = np.arange(size)
    shelf, place = number % shelves, number // shelves
    low, left = np.asarray(SHELF * shelf, np.float64), np.asarray(APART * place, np.float64)
    free = rectangles(left, low, *DOMINO)
    cosine, sine = math.cos(LEAN), math.sin(LEAN)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    first = place == 0
    corner = free[first, 1:2]
    free[first] = corner + (free[first] - corner) @ turn.T
    length = APART * int(place.max()) + 3.0
    floors = [box(-2.0, SHELF * k - 0.5, length, SHELF * k) for k in range(shelves)]
    return free, np.concatenate(floors)


def end_of_dominoes(size: int) -> float:
    """Return the time in which the longest row has fallen, and a second, s."""
    return APART * min(ROW, size) / SLOWEST + 1.0


# --- a slide ---------------------------------------------------------------------------------

STEEP = math.radians(40.0)
"""Dip of the hillside on which blocks begin to slide."""
SQUARE, LOOSE = 1.0, 1.02
"""Side of a block, m, and distance of blocks along the slope."""
LAYERS = 10
"""Layers of blocks at most."""
BENDS = 12
"""Straight pieces in which the hillside flattens."""
ROUGH = math.radians(3.0)
"""By how much their dips differ at most from those of an even bend."""


def shape_of_slide(size: int) -> tuple[int, int]:
    """Return layers and blocks in each layer."""
    layers = min(LAYERS, max(1, round(math.sqrt(size / 4.0))))
    return layers, math.ceil(size / layers)


def terrain(length: float, seed: int = 1) -> Floats:
    """Return the surface from the top down, m, (k, 2): ``length`` m steep, a rough bend, level."""
    even = STEEP * (1.0 - (np.arange(BENDS) + 1.0) / (BENDS + 1.0))
    rough = even + np.random.default_rng(seed).uniform(-ROUGH, ROUGH, BENDS)
    piece = max(1.5, 0.5 * length / BENDS)
    ways = [length * _down(STEEP), *(piece * _down(dip) for dip in rough), 2.0 * length * _down(0)]
    return np.concatenate([np.zeros((1, 2)), np.cumsum(ways, axis=0)])


def _down(dip: float) -> Floats:
    """Return the direction down a slope, to the right."""
    return np.array([math.cos(dip), -math.sin(dip)])


def slide_outlines(size: int) -> tuple[Floats, Floats]:
    """Return layers of squares on a hillside, and the ground below its surface."""
    layers, columns = shape_of_slide(size)
    surface = terrain(LOOSE * columns + 2.0)
    along, up = _down(STEEP), np.array([math.sin(STEEP), math.cos(STEEP)])
    number = np.arange(size)
    place = LOOSE * (number // layers) + 1.0
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) * SQUARE
    across = place[:, None] + corners[:, 0]
    high = SQUARE * (number % layers)[:, None] + corners[:, 1]
    free = across[..., None] * along + high[..., None] * up
    depth = float(surface[:, 1].min()) - 5.0
    left, right = surface[:-1], surface[1:]
    below = np.full(len(left), depth)
    ground = [
        np.stack([left[:, 0], below], axis=1),
        np.stack([right[:, 0], below], axis=1),
        right,
        left,
    ]
    return free, np.stack(ground, axis=1)


def end_of_slide(size: int) -> float:
    """Return the time in which the uppermost block slides to the bend, and two seconds, s."""
    pull = GRAVITY * (math.sin(STEEP) - 0.5 * math.cos(STEEP))
    return math.sqrt(2.0 * LOOSE * shape_of_slide(size)[1] / pull) + 2.0


WHOLE_SCENES = {
    scene.name: scene
    for scene in (
        WholeScene(
            name="rest",
            title="squares that fall into a trough and come to rest",
            outlines=heap_outlines,
            end=end_of_heap,
        ),
        WholeScene(
            name="collapse",
            title="wall that loses the ground under its right half",
            outlines=wall_outlines,
            end=end_of_wall,
        ),
        WholeScene(
            name="dominoes",
            title="rows of dominoes of which the first leans",
            outlines=domino_outlines,
            end=end_of_dominoes,
        ),
        WholeScene(
            name="slide",
            title="blocks that slide down a hillside",
            outlines=slide_outlines,
            end=end_of_slide,
        ),
    )
}
"""All whole scenes by name."""
