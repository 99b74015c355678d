"""Scenes of any size: wall, stack, heap and jointed slope, made as arrays without a loop.

All are of one rock (E 5 GPa, nu 0, so that nothing widens under its weight, 2600 kg/m3) with
tan phi = 0.5.  Beyond 50 courses, storeys or rows (100 in the heap) they grow in width only, so
that cost per block can be compared between sizes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model

YOUNG = 5e9
"""Young's modulus of every scene, Pa."""
DENSITY = 2600.0
"""Density, kg/m3."""
FRICTION_ANGLE = math.degrees(math.atan(0.5))
"""Friction angle of every joint, degrees."""
GRAVITY = 9.8
"""m/s2, downwards."""
HIGHEST = 50
"""Courses, storeys or rows at most."""
HIGHEST_HEAP = 100
"""Rows of falling squares at most."""
SMALLEST, LARGEST = 10, 10_000_000
"""Blocks that a scene can have."""


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A scene that can be made with any number of blocks."""

    name: str
    """Name on the command line."""
    title: str
    """The title."""
    build: Callable[[int], Model]
    """Returns the model with about so many blocks."""
    rests: bool
    """True where nothing should move, so that any movement is drift."""


def box(left: float, low: float, right: float, high: float) -> Floats:
    """Return a rectangle as one outline, m, shape (1, 4, 2)."""
    return np.array([[(left, low), (right, low), (right, high), (left, high)]], float)


def rectangles(left: Floats, low: Floats, width: Floats | float, height: float) -> Floats:
    """Return rectangles from their lower left corners (k,), m, shape (k, 4, 2)."""
    right, high = left + width, low + height
    corners = [(left, low), (right, low), (right, high), (left, high)]
    return np.stack([np.stack(corner, axis=1) for corner in corners], axis=1)


def outlines_of_wall(courses: int, columns: int) -> Floats:
    """Return a running bond of 1 m x 0.5 m bricks above y = 0, half bricks at ends, (k, 4, 2)."""
    whole = np.arange(columns + 1.0)
    shifted = np.concatenate([[0.0], whole[:-1] + 0.5, [float(columns)]])
    left, width, low = [], [], []
    for course in range(courses):
        joints = shifted if course % 2 else whole
        left.append(joints[:-1])
        width.append(np.diff(joints))
        low.append(np.full(len(joints) - 1, 0.5 * course))
    return rectangles(np.concatenate(left), np.concatenate(low), np.concatenate(width), 0.5)


def wall(courses: int, columns: int) -> Model:
    """Return a running-bond wall on a fixed ground, which is the first block."""
    builder = begun(f"Wall of {courses} courses, {columns} bricks wide")
    builder.blocks(vertices=box(-1.0, -1.0, columns + 1.0, 0.0), fixed=True)
    builder.blocks(vertices=outlines_of_wall(courses, columns))
    return builder.build()


def wall_of(size: int) -> Model:
    """Return a wall of about ``size`` bricks: as high as wide, then 50 courses high."""
    courses = min(HIGHEST, max(2, round(math.sqrt(2.0 * size))))
    return wall(courses, max(1, round((size - courses // 2) / courses)))


def stack(storeys: int, towers: int) -> Model:
    """Return towers of 1 m squares, half a metre apart, on a fixed ground, the first block."""
    left = np.repeat(1.5 * np.arange(towers), storeys)
    low = np.tile(np.arange(float(storeys)), towers)
    builder = begun(f"{towers} towers of {storeys} storeys")
    builder.blocks(vertices=box(-1.0, -1.0, 1.5 * towers + 0.5, 0.0), fixed=True)
    builder.blocks(vertices=rectangles(left, low, 1.0, 1.0))
    return builder.build()


def stack_of(size: int) -> Model:
    """Return towers of about ``size`` squares: as high as wide, then 50 storeys high."""
    storeys = min(HIGHEST, max(2, round(math.sqrt(size))))
    return stack(storeys, max(1, round(size / storeys)))


SPACING = 1.15
"""Distance of the centres of falling squares at the start, m."""
LARGEST_TURN = 0.1
"""Turn of falling squares at the start, rad, at most; they do not touch each other."""


def outlines_of_heap(count: int, columns: int, seed: int = 1) -> tuple[Floats, Floats]:
    """Return ``count`` loose 1 m squares above (0, 0), (k, 4, 2), and the trough's (3, 4, 2)."""
    turn = np.random.default_rng(seed).uniform(-LARGEST_TURN, LARGEST_TURN, count)
    number = np.arange(count)
    place = np.stack([number % columns, number // columns], axis=1).astype(np.float64)
    centre = SPACING * (place + 0.5)
    cosine, sine = 0.5 * np.cos(turn), 0.5 * np.sin(turn)
    arm = np.stack([cosine - sine, cosine + sine], axis=1)
    across = np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    squares = centre[:, None, :] + np.stack([-arm, -across, arm, across], axis=1)
    width, height = SPACING * columns, SPACING * math.ceil(count / columns)
    sides = [
        box(-1.0, -1.0, width + 1.0, 0.0),
        box(-1.0, 0.0, 0.0, height),
        box(width, 0.0, width + 1.0, height),
    ]
    return squares, np.concatenate(sides)


def heap(count: int, columns: int) -> Model:
    """Return squares that fall into a fixed trough, which is the first three blocks."""
    squares, trough = outlines_of_heap(count, columns)
    builder = begun(f"{count} squares falling into a trough")
    builder.blocks(vertices=trough, fixed=True)
    builder.blocks(vertices=squares)
    return builder.build()


def heap_of(size: int) -> Model:
    """Return ``size`` falling squares, as high as wide, then 100 rows high."""
    rows = min(HIGHEST_HEAP, max(2, round(math.sqrt(size))))
    return heap(size, math.ceil(size / rows))


DIP = math.radians(10.0)
"""Dip of the first joint set, towards the face: less than the friction angle."""
STEEP_DIP = math.radians(80.0)
"""Dip of the second joint set, into the rock."""
SPACINGS = (1.0, 0.8)
"""Sides of the parallelograms along the two sets, m."""
BENCH = (5, 4)
"""Each bench is so many rows high and steps back by so many blocks."""


def slope_of(size: int) -> Model:
    """Return a benched slope of about ``size`` parallelograms; the bottom and the back are fixed.

    The bedding dips out of the face at 10 degrees, less than the friction angle, and the steep set
    leans into the rock, so that the slope stands by friction.  It settles along the steep set under
    its weight, by a tenth of a millimetre with 15 rows and some millimetres with 50: that much of
    its drift is real.
    """
    rows = min(HIGHEST, max(6, round(math.sqrt(size / 2.0))))
    first = BENCH[1] * (np.maximum(0, np.arange(rows) - 1) // BENCH[0])
    columns = max(int(first[-1]) + 2, round((size + int(first.sum())) / rows))
    row = np.repeat(np.arange(rows), columns - first)
    column = np.concatenate([np.arange(start, columns) for start in first])
    along = SPACINGS[0] * np.array([math.cos(DIP), math.sin(DIP)])
    up = SPACINGS[1] * np.array([math.cos(STEEP_DIP), math.sin(STEEP_DIP)])
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    place = np.stack([column, row], axis=1)[:, None, :] + corners
    builder = begun(f"Jointed slope of {rows} rows, {columns} blocks long at its foot")
    builder.blocks(
        vertices=place[..., :1] * along + place[..., 1:] * up,
        fixed=(row == 0) | (column == columns - 1),
    )
    return builder.build()


SCENES = {
    scene.name: scene
    for scene in (
        Scene(name="wall", title="running-bond wall", build=wall_of, rests=True),
        Scene(name="stack", title="towers of squares", build=stack_of, rests=True),
        Scene(name="heap", title="squares falling into a trough", build=heap_of, rests=False),
        Scene(name="slope", title="jointed rock slope", build=slope_of, rests=True),
    )
}
"""All scenes by name."""


def begun(title: str) -> InputBuilder:
    """Return a builder with the rock and the joints of all scenes."""
    builder = InputBuilder(title=title, gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=YOUNG, poisson=0.0, density=DENSITY)
    builder.add_joint(friction_angle=FRICTION_ANGLE)
    return builder
