"""The lateral push that a dry wall in running bond resists in its plane.

Under a push of a share of its weight a wall does not turn over as one piece: a part of it stays
behind a stepped crack.  The largest share is found by linear programming, which is exact where no
joint slips, else an upper bound (Drucker 1954).

Head joints are smooth here.  Were they rough, the bound would count on friction there that needs
them pressed together, which nothing does: with phi = 35
degrees everywhere walls carry 5 to 8 % less than the bound.
"""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from clast.verification.limit_analysis import GROUND, RigidBlocks, RigidJoint, largest_factor
from clast.verification.problems import Floats, InputBuilder, Model, StaticRun, Trial, box, problem
from clast.verification.variants import CONVEX

GRAVITY, DENSITY, FRICTION_ANGLE = 9.8, 2000.0, 40.0
BRICK, COURSE = 1.0, 0.5
"""Length and height of a brick, m."""
RESOLUTION = "bisected to 0.81 %; joints give a little"
STATIC = StaticRun(p=1e10, step=2e-2, steps=300)


@dataclass(frozen=True)
class Wall:
    """A wall so many bricks long and courses high, on the ground."""

    bricks: int
    courses: int

    def outlines(self) -> list[tuple[float, float, float]]:
        """Return left and right end and foot of all bricks, m; every other course has halves."""
        bricks = []
        for course in range(self.courses):
            ends = BRICK * np.arange(self.bricks + 1)
            if course % 2:
                ends = np.array([0.0, *(ends[:-1] + 0.5 * BRICK), BRICK * self.bricks])
            bricks += [
                (float(left), float(right), course * COURSE) for left, right in pairwise(ends)
            ]
        return bricks

    def blocks(self) -> RigidBlocks:
        """Return the bricks and their joints; head joints have no friction."""
        bricks = self.outlines()
        up, right = np.array([0.0, 1.0]), np.array([1.0, 0.0])
        joints = []

        def joint(first: int, second: int, ends: tuple[Floats, Floats], normal: Floats) -> None:
            angle = FRICTION_ANGLE if normal is up else 0.0
            joints.append(
                RigidJoint(blocks=(first, second), ends=ends, normal=normal, friction_angle=angle)
            )

        for i, (a, b, foot) in enumerate(bricks):
            if foot == 0.0:
                joint(i, GROUND, (np.array([a, 0.0]), np.array([b, 0.0])), up)
            for j, (c, d, other) in enumerate(bricks):
                low, high = max(a, c), min(b, d)
                if np.isclose(other + COURSE, foot) and low < high:
                    joint(i, j, (np.array([low, foot]), np.array([high, foot])), up)
                if other == foot and d == a:
                    joint(i, j, (np.array([a, foot]), np.array([a, foot + COURSE])), right)
        return RigidBlocks(
            corners=[np.array(box(a, foot, b, foot + COURSE)) for a, b, foot in bricks],
            joints=joints,
        )


WALLS = (Wall(2, 6), Wall(2, 8), Wall(3, 8), Wall(3, 10))


def exact_push(wall: Wall) -> float:
    """Return the largest push over the weight."""
    blocks = wall.blocks()
    return largest_factor(blocks, blocks.body_force((0.0, -1.0)), blocks.body_force((1.0, 0.0)))


def pushed(wall: Wall = WALLS[2], share: float = 0.3) -> Model:
    """Return the fixed ground and the bricks, with a share of their weight to the right."""
    builder = InputBuilder(title="Wall under push", gravity=(share * GRAVITY, -GRAVITY))
    add_wall(builder, wall)
    return builder.build()


def add_wall(builder: InputBuilder, wall: Wall) -> None:
    """Add the fixed ground and the bricks of a wall, their rock and their joints."""
    builder.add_rock("brick", young=20e9, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=FRICTION_ANGLE)
    builder.add_joint("head", friction_angle=0.0)
    out = BRICK * wall.bricks + 1.0
    builder.block(name="ground", vertices=box(-1.0, -0.5, out, 0.0), fixed=True)
    for k, (left, right, foot) in enumerate(wall.outlines()):
        top = foot + COURSE
        corners = box(left, foot, right, top)
        builder.block(name=str(k + 1), vertices=corners, edge_joint=["", "head", "", "head"])
        builder.measured_point(
            str(k + 1), (0.5 * (left + right), foot + 0.5 * COURSE), block=str(k + 1)
        )


@problem(set_up=pushed, variants=(CONVEX,), quick=())
def wall_push(trial: Trial, walls: tuple[Wall, ...] = WALLS) -> None:
    """Dry wall under lateral push.

    Walls of bricks of 1 m x 0.5 m in running bond with a share of their weight across, which is
    bisected; phi = 40 degrees in bed joints, none in head joints, E = 20 GPa, p = 10 GPa, h = 20
    ms, static (dynamic_ratio = 0).

    Exact: the largest share with N1, N2 >= 0 and |V| <= (N1 + N2) tan phi in all joints.
    Source: limit analysis by linear programming (scipy), after Livesley (1978).
    Not run with: modified: in steps this long one pass and four throw the bricks, p h2/m being far
    above 6; open-close: for its time.
    """
    for wall in walls:
        exact = exact_push(wall)
        push = STATIC.limit(trial.variant, partial(pushed, wall), 1.05 * exact, 0.92 * exact)
        quantity = f"push over weight, {wall.bricks} bricks x {wall.courses} courses"
        trial.relative(quantity, "", push, exact, 0.015, RESOLUTION)
    courses = range(4, 13)
    chart = trial.chart("largest push", "courses", "push over weight")
    for bricks in (2, 3):
        values = [exact_push(Wall(bricks, count)) for count in courses]
        chart.exact(f"linear programming, {bricks} bricks", courses, values)
    chart.computed([wall.courses for wall in walls], trial.computed)
