"""Scenes of any size as arrays without a loop, for benchmarks and tests.

Wall, stack, heap and jointed slope, of which the first steps are timed, and scenes from beginning
to end: a heap that comes to rest, a wall of which half has no ground, dominoes, blocks that slide
down a hillside.  All are of one rock (E 5 GPa, nu 0, so that nothing widens under its weight,
2600 kg/m3) with tan phi = 0.5.  Beyond 50 courses, storeys or rows (100 in the heap) they grow in
width only, so that cost per block can be compared between sizes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.inputs.method import TRAVEL_SHARE, MethodTable
from clast.model.model import Floats, Model
from clast.run.schedule import Schedule
from clast.step.method import Method

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
WHOLE_STEP, WHOLE_SHARE = 2.5e-3, 0.1
"""Length of a step, s, and p/E of scenes from beginning to end."""


@dataclass(frozen=True, kw_only=True)
class BenchSettings:
    """How scenes are simulated."""

    step: float = 1e-3
    """Length of a step, s."""
    steps: int = 50
    """Steps."""
    share: float = 1.0
    """Normal stiffness as a share of Young's modulus."""
    results: Path | None = None
    """Folder that gets a result file of every run, with its first and its last frame."""

    @property
    def schedule(self) -> Schedule:
        """Schedule of a run; only the first and the last state are frames."""
        end = self.step * self.steps
        return Schedule(step=self.step, end=end, every=end)


def method_for(model: Model, settings: BenchSettings) -> Method:
    """Return the convex process with the stiffness of the settings."""
    law = {"name": "penalty", "normal_stiffness": settings.share * model.stiffest}
    table = MethodTable(process="convex", contact_law=law)
    smallest = float(np.sqrt(model.area.min()))
    return table.method(model, step=settings.step, max_displacement=TRAVEL_SHARE * smallest)


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


@dataclass(frozen=True, kw_only=True)
class WholeScene:
    """A scene with a beginning and an end, given by outlines: other programs simulate it too."""

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
        return model_of(f"{self.title}, {len(free)} blocks", free, fixed)


def builder_of(title: str) -> InputBuilder:
    """Return a builder with the rock and the joints of all scenes."""
    builder = InputBuilder(title=title, gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=YOUNG, poisson=0.0, density=DENSITY)
    builder.add_joint(friction_angle=FRICTION_ANGLE)
    return builder


def model_of(title: str, free: Floats, fixed: Floats) -> Model:
    """Return the model of outlines (k, 4, 2), m, those of fixed blocks first."""
    builder = builder_of(title)
    builder.blocks(vertices=fixed, fixed=True)
    builder.blocks(vertices=free)
    return builder.build()


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
    title = f"Wall of {courses} courses, {columns} bricks wide"
    ground = box(-1.0, -1.0, columns + 1.0, 0.0)
    return model_of(title, outlines_of_wall(courses, columns), ground)


def wall_of(size: int) -> Model:
    """Return a wall of about ``size`` bricks: as high as wide, then 50 courses high."""
    courses = min(HIGHEST, max(2, round(math.sqrt(2.0 * size))))
    return wall(courses, max(1, round((size - courses // 2) / courses)))


def stack(storeys: int, towers: int) -> Model:
    """Return towers of 1 m squares, half a metre apart, on a fixed ground, the first block."""
    left = np.repeat(1.5 * np.arange(towers), storeys)
    low = np.tile(np.arange(float(storeys)), towers)
    title = f"{towers} towers of {storeys} storeys"
    ground = box(-1.0, -1.0, 1.5 * towers + 0.5, 0.0)
    return model_of(title, rectangles(left, low, 1.0, 1.0), ground)


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
    return model_of(f"{count} squares falling into a trough", *outlines_of_heap(count, columns))


def heap_of(size: int) -> Model:
    """Return ``size`` falling squares, as high as wide, then 100 rows high."""
    return heap(size, math.ceil(size / rows_of_heap(size)))


def rows_of_heap(size: int) -> int:
    """Return how many rows of squares fall: as many as columns, 100 at most."""
    return min(HIGHEST_HEAP, max(2, round(math.sqrt(size))))


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
    builder = builder_of(f"Jointed slope of {rows} rows, {columns} blocks long at its foot")
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
"""Scenes of which the first steps are timed, by name."""


# --- scenes from beginning to end ------------------------------------------------------------


def heap_outlines(size: int) -> tuple[Floats, Floats]:
    """Return loose squares, and the trough into which they fall."""
    return outlines_of_heap(size, math.ceil(size / rows_of_heap(size)))


def end_of_heap(size: int) -> float:
    """Return twice the time of fall of the highest square, and a second."""
    return 2.0 * math.sqrt(2.0 * (SPACING - 1.0) * rows_of_heap(size) / GRAVITY) + 1.0


def shape_of_wall(size: int) -> tuple[int, int]:
    """Return courses and columns of a wall as high as wide, 50 courses high at most."""
    courses = min(HIGHEST, max(2, round(math.sqrt(2.0 * size))))
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
"""Scenes from beginning to end, by name."""
