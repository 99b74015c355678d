"""The scenes of tools/digits.py: small systems of blocks that between them reach every branch.

They are built from code alone, with a generator of their own, so that nothing that moves within
clast or within its tests changes them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

import clast

Floats = NDArray[np.float64]

CASES = Path(__file__).resolve().parents[1] / "src" / "clast" / "case" / "templates"
YOUNG = 5e9
"""Young's modulus of most scenes, Pa."""
CUT = 64.0
"""A run stops where it needs a smaller step than this part of the wanted one."""
STIFFNESS = {"modified": "auto", "open-close": 1e8, "convex": "auto"}
"""Normal contact stiffness by process, N/m per m, where a scene has no other.

With its own choice the open-close iteration stops in nearly all scenes before it has moved much.
"""


class Scene(Protocol):
    """What can be run by any process and contact law."""

    def case(self, process: str, law: str) -> clast.Case:
        """Return the case of the scene with a process and a contact law."""
        ...


@dataclass(frozen=True, kw_only=True)
class Built:
    """A scene from code."""

    build: Callable[[], clast.ModelBuilder]
    """Returns its blocks."""
    step: float
    """Length of a step, s."""
    steps: int
    """Steps of the run, where none is cut."""
    stiffness: Mapping[str, float | str] = field(default_factory=dict)
    """Normal contact stiffness by process, N/m per m, where it is not as in STIFFNESS."""
    keys: Mapping[str, Any] = field(default_factory=dict)
    """Further keys of [time] and [method]."""
    process: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Numbers of a process, by its name."""
    law: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Numbers of a contact law, by its name."""

    def case(self, process: str, law: str) -> clast.Case:
        """Return the case of the scene with a process and a contact law."""
        end = self.steps * self.step
        return self.build().case(
            step=self.step,
            end=end,
            every=end,
            smallest_step=self.step / CUT,
            process={"name": process, **self.process.get(process, {})},
            contact_law={
                "name": law,
                "normal_stiffness": {**STIFFNESS, **self.stiffness}[process],
                **self.law.get(law, {}),
            },
            **self.keys,
        )


@dataclass(frozen=True, kw_only=True)
class FromFile:
    """A scene of the folder cases."""

    file: str
    """Path within the folder."""
    end: float
    """End of the run, s."""

    def case(self, process: str, law: str) -> clast.Case:
        """Return the case of the scene with a process and a contact law."""
        settings = [f"time.end={self.end}", f"output.every={self.end}"]
        case = clast.Case.from_toml(CASES / self.file, settings)
        return case.with_method(process=process, contact_law=law)


# --- outlines ------------------------------------------------------------------------------


def uniform(seed: int) -> Iterator[float]:
    """Yield numbers in [0, 1): x <- 1103515245 x + 12345 modulo 2^31."""
    value = seed
    while True:
        value = (1103515245 * value + 12345) % 2**31
        yield value / 2**31


def box(x: float, y: float, width: float = 1.0, height: float = 1.0) -> Floats:
    """Return a rectangle by its lower left corner, m, shape (4, 2)."""
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]], float)


def turned(points: Floats, angle: float, shift: Sequence[float] = (0.0, 0.0)) -> Floats:
    """Return points turned about (0, 0) by an angle, rad, then shifted, m."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.asarray(shift, float)


def regular(count: int, radius: float) -> Floats:
    """Return a regular polygon about (0, 0) that stands on a side, m."""
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count - 0.5 * np.pi
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def star(count: int, radius: float, numbers: Iterator[float]) -> Floats:
    """Return a star-shaped polygon about (0, 0), mostly not convex, m."""
    angle = np.cumsum([0.5 + next(numbers) for _ in range(count)])
    angle *= 2.0 * np.pi / (angle[-1] + 0.75)
    distance = radius * np.array([0.45 + 0.55 * next(numbers) for _ in range(count)])
    return distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def begun(
    friction_angle: float = 30.0,
    *,
    young: float = YOUNG,
    poisson: float = 0.2,
    gravity: Sequence[float] = (0.0, -9.8),
) -> clast.ModelBuilder:
    """Return a builder with one rock and a default joint."""
    builder = clast.ModelBuilder(gravity=[*gravity])
    builder.add_rock("rock", young=young, poisson=poisson, density=2500.0)
    builder.add_joint(friction_angle=friction_angle)
    return builder


# --- few blocks ----------------------------------------------------------------------------


def incline(friction_angle: float = 20.0) -> clast.ModelBuilder:
    """Return a block on an incline of 45 degrees that fixed points hold."""
    builder = begun(friction_angle, young=50e9)
    builder.block(name="incline", vertices=[(0, 0), (10, 0), (0, 10)])
    builder.block(name="slider", vertices=[(1, 9), (4, 6), (4, 9)])
    builder.fixed_point((0, 0))
    builder.fixed_point((10, 0))
    builder.measured_point("A", (1, 9), block="slider")
    return builder


def seams(friction_angle: float, *, loose: bool = False) -> clast.ModelBuilder:
    """Return a brick that slides over a floor of tiles, fixed or loose on a bed."""
    builder = begun(friction_angle)
    builder.block(name="bed", vertices=box(-1.0, -1.0, 6.0, 0.5), fixed=True)
    for k in range(4):
        builder.block(vertices=box(float(k), -0.5, 1.0, 0.5), fixed=not loose)
    brick = box(0.3, 0.0, 0.8, 0.4)
    builder.block(name="brick", vertices=brick, velocity=(4.0, 0.0, 0.0))
    builder.measured_point("middle", (0.7, 0.2), block="brick")
    return builder


def arch(count: int = 15, inner: float = 2.0, outer: float = 2.5) -> clast.ModelBuilder:
    """Return a semicircular arch of voussoirs without mortar on fixed abutments."""
    angle = np.linspace(0.0, np.pi, count + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    builder = begun(35.0)
    builder.block(vertices=box(1.5, -0.5, 1.5, 0.5), fixed=True)
    builder.block(vertices=box(-3.0, -0.5, 1.5, 0.5), fixed=True)
    for a, b in itertools.pairwise(ring):
        builder.block(vertices=[inner * a, outer * a, outer * b, inner * b])
    return builder


def bounce() -> clast.ModelBuilder:
    """Return blocks that fall on a floor, each with a restitution of its own, and on each other."""
    builder = begun(20.0)
    builder.block(name="floor", vertices=box(-1.0, -1.0, 12.0), fixed=True)
    for k, restitution in enumerate((0.0, 0.5, 1.0)):
        name = f"box {k}"
        builder.block(name=name, vertices=box(2.0 * k, 0.05), velocity=(0.5, -2.0, 0.2 * k))
        builder.add_joint(
            name, friction_angle=20.0, restitution=restitution, between=[("floor", name)]
        )
    wheel = regular(7, 0.5) + np.array([7.0, 0.6])
    builder.block(vertices=wheel, velocity=(1.0, -2.0, -3.0))
    builder.block(vertices=box(8.5, 0.05), velocity=(-1.0, -1.0, 0.0))
    builder.block(vertices=box(8.6, 1.1), velocity=(0.0, -2.0, 0.0))
    return builder


def loaded() -> clast.ModelBuilder:
    """Return blocks of two rocks under all loads, held by fixed points, in plane strain."""
    builder = clast.ModelBuilder(plane=clast.PlaneStrain())
    builder.add_rock("granite", young=20e9, poisson=0.25, density=2700.0)
    builder.add_rock(
        "marl", young=1e9, poisson=0.3, density=2200.0, initial_stress=(-2e4, -5e4, 1e3)
    )
    builder.add_joint(friction_angle=25.0)
    builder.add_joint("rough", friction_angle=40.0, between_rocks=[("granite", "marl")])
    builder.block(name="base", rock="granite", vertices=box(0.0, 0.0, 4.0))
    builder.block(name="left", rock="marl", vertices=box(0.0, 1.0, 2.0))
    builder.block(name="right", rock="marl", vertices=box(2.0, 1.0, 2.0))
    builder.block(
        name="top",
        rock="granite",
        vertices=box(0.5, 2.0, 3.0, 0.5),
        initial_stress=(-1e4, 0.0, 0.0),
    )
    builder.block(name="wall", rock="granite", vertices=box(4.0, 0.0, 0.5, 2.0), fixed=True)
    builder.fixed_point((0.0, 0.0), block="base")
    builder.fixed_point((4.0, 0.0), block="base")
    builder.line_load((0.5, 2.5), (3.5, 2.5), (0.0, -2e4), block="top")
    builder.line_load((0.0, 1.0), (0.0, 2.0), (3e4, 0.0), block="left")
    builder.point_load((3.0, 2.25), (3e4, -1e4), block="top")
    builder.measured_point("top", (2.0, 2.5), block="top")
    builder.measured_point("joint", (2.0, 1.5), block="right")
    return builder


def shaken(by: type[clast.InertialForce] | type[clast.MovingBase]) -> clast.ModelBuilder:
    """Return a tower on a ground that shakes, as a body force or by its fixed points."""
    time: Floats = np.linspace(0.0, 0.4, 41)
    wave: Floats = np.sin(2.0 * np.pi * 5.0 * time)
    record = clast.Accelerogram(time, np.stack([4.0 * wave, 1.5 * wave[::-1]], axis=1))
    builder = begun(25.0)
    builder.ground_motion = by(record)
    builder.block(name="ground", vertices=box(-1.0, -0.5, 4.0, 0.5))
    builder.fixed_point((-1.0, -0.5), block="ground")
    builder.fixed_point((3.0, -0.5), block="ground")
    for k in range(4):
        builder.block(vertices=box(0.5, 0.6 * k, 0.5, 0.6))
    builder.block(vertices=box(1.5, 0.0, 1.0, 0.5))
    builder.measured_point("top", (0.5, 2.4))
    return builder


def bonded() -> clast.ModelBuilder:
    """Return two cantilevers of bonded blocks: one holds, one breaks at its weak joint."""
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=YOUNG, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0, cohesion=2e6, tensile_strength=1e6)
    builder.add_joint(
        "weak",
        friction_angle=30.0,
        cohesion=2e4,
        tensile_strength=1e4,
        between=[("low 1", "low 2"), ("low 3", "low 4")],
    )
    builder.block(name="rock face", vertices=box(-1.0, 0.0, 1.0, 4.0), fixed=True)
    for y, name in ((0.5, "low"), (2.5, "high")):
        for k in range(5):
            builder.block(name=f"{name} {k}", vertices=box(0.6 * k, y, 0.6, 0.5))
    return builder


def rolling() -> clast.ModelBuilder:
    """Return a polygon that rolls on a floor, and one that spins in the air."""
    builder = begun(40.0)
    builder.block(vertices=box(-2.0, -1.0, 10.0), fixed=True)
    standing = regular(8, 0.5)
    standing[:, 1] -= standing[:, 1].min()
    builder.block(vertices=standing, velocity=(2.0, 0.0, -4.0))
    builder.block(vertices=regular(5, 0.4) + np.array([4.0, 2.0]), velocity=(0.0, 1.0, 8.0))
    return builder


def wedge() -> clast.ModelBuilder:
    """Return a thin wedge that cuts through an obtuse corner: edges cross, no vertex is inside."""
    builder = begun(20.0)
    slab = [(-1.0, -1.5), (4.0, -1.5), (4.0, 0.0), (1.0, 0.0), (-1.0, -0.8)]
    builder.block(vertices=slab, fixed=True)
    thin = np.array([[0.7, -0.1], [2.7, 0.2], [2.7, 0.4]]) + np.array([0.6, 0.25])
    builder.block(vertices=thin, velocity=(-2.0, -0.7, 0.0))
    return builder


def sheets(dip: float, friction_angle: float) -> clast.ModelBuilder:
    """Return a pile of blocks on an incline by its dip, degrees: most of their joints slide."""
    angle = math.radians(dip)
    builder = begun(friction_angle)
    builder.block(vertices=turned(box(-6.0, -1.0, 12.0), angle), fixed=True)
    for row in range(4):
        for column in range(3):
            place = box(1.2 * column - 1.0 + 0.3 * row, 0.5 * row, 1.2, 0.5)
            builder.block(vertices=turned(place, angle))
    return builder


# --- many blocks ---------------------------------------------------------------------------


def wall(
    courses: int, columns: int, *, bond: bool = True, gravity: Sequence[float] = (0.0, -9.8)
) -> clast.ModelBuilder:
    """Return a wall of 1 m x 0.5 m bricks on a fixed base; without bond all joints are aligned."""
    builder = begun(math.degrees(math.atan(0.5)), poisson=0.0, gravity=gravity)
    builder.block(vertices=box(-1.0, -1.0, columns + 2.0), fixed=True)
    for course in range(courses):
        joints = np.arange(columns + 1.0)
        if bond and course % 2:
            joints = np.array([0.0, *(joints[:-1] + 0.5), columns])
        for left, right in itertools.pairwise(joints):
            builder.block(vertices=box(left, 0.5 * course, right - left, 0.5))
    return builder


def jolted() -> clast.ModelBuilder:
    """Return two walls apart from each other: one stands, the bricks of the other are jolted."""
    numbers = uniform(7)
    builder = begun(30.0)
    for left, courses in ((0.0, 18), (30.0, 14)):
        builder.block(vertices=box(left - 1.0, -1.0, 18.0), fixed=True)
        for course in range(courses):
            for column in range(15):
                place = box(left + column + 0.5 * (course % 2), 0.5 * course, 1.0, 0.5)
                speed = 0.4 * next(numbers) if left else 0.0
                builder.block(vertices=place, velocity=(speed, -speed, 0.5 * speed))
    return builder


def heap(count: int, columns: int, *, stars: bool = False) -> clast.ModelBuilder:
    """Return squares, or polygons that are not convex, thrown into a fixed trough."""
    numbers = uniform(count)
    spacing, rows = 1.15, math.ceil(count / columns)
    width, height = spacing * columns, spacing * rows
    builder = begun(26.0)
    builder.block(vertices=box(-1.0, -1.0, width + 2.0), fixed=True)
    builder.block(vertices=box(-1.0, 0.0, 1.0, height), fixed=True)
    builder.block(vertices=box(width, 0.0, 1.0, height), fixed=True)
    for k in range(count):
        corners = 5 + int(4.0 * next(numbers))
        shape = star(corners, 0.55, numbers) if stars else box(-0.5, -0.5)
        at = (spacing * (k % columns + 0.5), spacing * (k // columns + 0.5))
        builder.block(
            vertices=turned(shape, 0.2 * next(numbers) - 0.1, at),
            velocity=(2.0 * next(numbers) - 1.0, -2.0 - 2.0 * next(numbers), next(numbers)),
        )
    return builder


def slope(size: int, *, shuffled: bool = False) -> clast.ModelBuilder:
    """Return a benched slope of two joint sets, its bottom and back fixed.

    ``shuffled``: its blocks are numbered in no order.
    """
    dip, steep = math.radians(10.0), math.radians(80.0)
    rows = max(6, round(math.sqrt(size / 2.0)))
    first = [4 * (max(0, row - 1) // 5) for row in range(rows)]
    columns = max(first[-1] + 2, round((size + sum(first)) / rows))
    along = np.array([math.cos(dip), math.sin(dip)])
    up = 0.8 * np.array([math.cos(steep), math.sin(steep)])
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    builder = begun(math.degrees(math.atan(0.5)), poisson=0.0)
    cells = [(row, column) for row in range(rows) for column in range(first[row], columns)]
    if shuffled:
        cells = [cell for _, cell in sorted(zip(uniform(size), cells, strict=False))]
    for row, column in cells:
        place = corners + np.array([column, row])
        builder.block(
            vertices=place[:, :1] * along + place[:, 1:] * up,
            fixed=row == 0 or column == columns - 1,
        )
    return builder


CARRIED = {"augmented-lagrangian": {"multipliers": "carried", "penetration_tolerance": 1e-7}}

AS_ROCK = {"convex": YOUNG}
"""The convex process with contacts as stiff as a metre of rock."""
SAME_FOR_ALL = dict.fromkeys(STIFFNESS, YOUNG)
"""All processes with such contacts: the modified one and the open-close iteration then fail."""

SCENES: dict[str, Scene] = {
    "case-incline": FromFile(file="incline.toml", end=0.2),
    "case-wall": FromFile(file="wall.toml", end=0.02),
    "case-heap": FromFile(file="heap.toml", end=0.1),
    "incline": Built(build=incline, step=2e-3, steps=200),
    "seams": Built(build=lambda: seams(0.0), step=1e-3, steps=200),
    "seams-loose": Built(
        build=lambda: seams(20.0, loose=True),
        step=1e-3,
        steps=200,
        keys={"corner_rule": "shi"},
    ),
    "arch": Built(build=arch, step=1e-3, steps=150),
    "bounce": Built(
        build=bounce,
        step=1e-3,
        steps=250,
        stiffness=AS_ROCK,
        process={"convex": {"restitution": 0.3}},
    ),
    "loaded": Built(build=loaded, step=1e-3, steps=150),
    "shaken-force": Built(build=lambda: shaken(clast.InertialForce), step=2e-3, steps=200),
    "shaken-base": Built(build=lambda: shaken(clast.MovingBase), step=2e-3, steps=200),
    "bonded": Built(build=bonded, step=1e-3, steps=200),
    "rolling-exact": Built(build=rolling, step=2e-3, steps=200, keys={"rotation": "exact"}),
    "rolling-linear": Built(build=rolling, step=2e-3, steps=200, keys={"rotation": "linear"}),
    "wedge": Built(
        build=wedge,
        step=5e-3,
        steps=120,
        stiffness=dict.fromkeys(STIFFNESS, 1e5),
        keys={"max_displacement": 0.02},
    ),
    "friction": Built(
        build=lambda: sheets(28.0, 25.0),
        step=1e-3,
        steps=100,
        process={
            "convex": {"friction_updates": 4, "tolerance": 1e-9},
            "modified": {"passes": 3},
            "open-close": {"iterations": 12},
        },
    ),
    "columns": Built(
        build=lambda: wall(8, 5, bond=False), step=1e-3, steps=80, stiffness={"open-close": "auto"}
    ),
    "static": Built(
        build=lambda: wall(5, 4, gravity=(2.0, -9.6)),
        step=1e-2,
        steps=60,
        stiffness={"open-close": 2e7},
        keys={"dynamic_ratio": 0.0, "integrator": "backward-euler", "corner_rule": "shi"},
    ),
    "wall-30-1ms": Built(build=lambda: wall(6, 5), step=1e-3, steps=100),
    "wall-30-5ms": Built(build=lambda: wall(6, 5), step=5e-3, steps=100, stiffness=SAME_FOR_ALL),
    "wall-30-carried": Built(build=lambda: wall(6, 5), step=1e-3, steps=100, law=CARRIED),
    "heap-60": Built(
        build=lambda: heap(60, 8), step=2e-3, steps=120, keys={"integrator": "backward-euler"}
    ),
    "heap-stars": Built(build=lambda: heap(40, 7, stars=True), step=2e-3, steps=120),
    "slope-pcg": Built(build=lambda: slope(120), step=1e-3, steps=20, keys={"solver": "pcg"}),
    "slope-cholesky": Built(
        build=lambda: slope(120), step=1e-3, steps=20, keys={"solver": "cholesky"}
    ),
    "wall-400-1ms": Built(build=lambda: wall(20, 20), step=1e-3, steps=20, stiffness=AS_ROCK),
    "wall-400-5ms": Built(build=lambda: wall(20, 20), step=5e-3, steps=20, stiffness=AS_ROCK),
    "heap-300": Built(build=lambda: heap(300, 18), step=5e-3, steps=40),
    "slope-300": Built(build=lambda: slope(300), step=1e-3, steps=20, stiffness=AS_ROCK),
    "slope-300-stiff": Built(
        build=lambda: slope(300), step=1e-3, steps=15, stiffness={"convex": 50.0 * YOUNG}
    ),
    "slope-600-shuffled": Built(
        build=lambda: slope(600, shuffled=True), step=1e-3, steps=5, stiffness=AS_ROCK
    ),
    "jolted": Built(build=jolted, step=1e-3, steps=8, stiffness=AS_ROCK),
    "wall-1600": Built(build=lambda: wall(40, 40), step=5e-3, steps=4, stiffness=AS_ROCK),
    "heap-1600": Built(build=lambda: heap(1600, 40), step=5e-3, steps=12, stiffness=AS_ROCK),
}
"""Scenes by name.

Those of 1,600 blocks are for what only many blocks have: work shared by threads, and the worst
blocks that go first.
"""
