"""Cases to begin with, as texts: ``clast new NAME --template wall``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from clast.case.rock_templates import KEY_BLOCK, SLOPE, TUNNEL

INCLINE = """\
schema = 1
title = "Block on an incline (the paper, Fig. 1)"
plane = "stress"                       # or "strain"
gravity = [0.0, -9.8]

[time]
step = 1e-3
end = 1.0
max_displacement = 0.01                # largest vertex movement in a step, m; steps are cut to it
dynamic_ratio = 1.0

[rock.granite]
young = 50e9
poisson = 0.2
density = 2700.0
# initial_stress = [0.0, 0.0, 0.0]

[joint.default]                        # strength of every contact that no other joint names
friction_angle = 20.0
cohesion = 0.0
tensile_strength = 0.0

[geometry]                             # numbered vertices (from 1), counter-clockwise loops
vertices = [[0,0],[10,0],[0,10],[1,9],[4,6],[4,9]]
blocks = [
    {loop=[1,2,3], name="incline", rock="granite"},
    {loop=[4,5,6], name="slider", rock="granite", velocity=[0,0,0]},
]

[[fixed_point]]
at = [0,0]
[[fixed_point]]
at = [10,0]

[[measured_point]]
name = "A"
at = [1,9]
block = "slider"                       # needed only where blocks touch

[[reference]]                          # known from elsewhere: the error is printed
point = "A"
time = 1.0
displacement = [1.558273, -1.558273]
source = "closed form: (g/2)(sin 45 - cos 45 tan phi) cos 45 t2, phi = 20 degrees"

[method]
process = "convex"                     # the default; "modified" (the paper's), "open-close"
contact_law = {name="penalty", normal_stiffness=1e9, shear_stiffness=1e9}
corner_rule = "bisector"
rotation = "sine"
integrator = "constant-acceleration"
solver = "auto"
critdis = 0.005

[output]
every = 0.01                           # s between frames; measured points are kept every step
contacts = true
"""

WALL_HEAD = """\
schema = 1
title = "Brick wall in running bond on a fixed base"
plane = "stress"
gravity = [0.0, -9.8]

[time]
step = 1e-3
end = 0.5
max_displacement = 0.005
dynamic_ratio = 1.0

[rock.brick]
young = 5e9
poisson = 0.2
density = 2000.0

[joint.default]
friction_angle = 30.0

[method]
process = "convex"                     # the default; "modified" and "open-close" are the others
contact_law = {name="penalty", normal_stiffness="auto"}
critdis = 0.002

[output]
every = 0.01
"""

HEAP_HEAD = """\
schema = 1
title = "Squares falling into a trough"
plane = "stress"
gravity = [0.0, -9.8]

[time]
step = 1e-3
end = 3.0
max_displacement = 0.02
dynamic_ratio = 1.0

[rock.stone]
young = 5e9
poisson = 0.2
density = 2500.0

[joint.default]
friction_angle = 30.0

[method]
process = "convex"                     # the default; "modified" and "open-close" are the others
contact_law = {name="penalty", normal_stiffness="auto"}
critdis = 0.005

[output]
every = 0.02
"""


def incline() -> str:
    """Return the paper's block on an incline."""
    return INCLINE


def wall(rows: int = 10, columns: int = 10) -> str:
    """Return a wall of bricks of 1 m x 0.5 m in running bond, with straight ends, on a base."""
    lines = [WALL_HEAD]
    lines.append(_block("base", _rectangle(-1.0, -1.0, columns + 1.0, 0.0), fixed=True))
    for row in range(rows):
        low = 0.5 * row
        # every other row begins and ends with half a brick
        inner = [column + 0.5 * (row % 2) for column in range(columns + 1)]
        joints = sorted({0.0, float(columns), *(x for x in inner if x <= columns)})
        for number, (left, right) in enumerate(pairwise(joints), start=1):
            name = f"row {row + 1} brick {number}"
            lines.append(_block(name, _rectangle(left, low, right, low + 0.5)))
    # a point in the middle of a brick of the uppermost row
    number = columns // 2
    at = number - (0.5 if rows % 2 else 1.0)
    lines.append(_measured("top", (at, 0.5 * rows), f"row {rows} brick {number}"))
    return "\n".join(lines)


def heap(rows: int = 8, columns: int = 8) -> str:
    """Return squares of 1 m, turned by many angles, above a fixed trough."""
    lines = [HEAP_HEAD]
    spacing = 1.5
    width = spacing * columns
    height = 0.6 * spacing * rows
    lines.append(_block("floor", _rectangle(-1.0, -1.0, width + 1.0, 0.0), fixed=True))
    lines.append(_block("left wall", _rectangle(-1.0, 0.0, 0.0, height), fixed=True))
    lines.append(_block("right wall", _rectangle(width, 0.0, width + 1.0, height), fixed=True))
    for row in range(rows):
        for column in range(columns):
            centre = (spacing * (column + 0.5), spacing * (row + 0.5))
            # angles of 37 degrees apart repeat only after 90 squares
            angle = math.radians(37.0 * (row * columns + column) % 90.0)
            name = f"row {row + 1} square {column + 1}"
            lines.append(_block(name, _square(centre, angle)))
    top = f"row {rows} square {columns // 2}"
    lines.append(_measured("top", (spacing * (columns // 2 - 0.5), spacing * (rows - 0.5)), top))
    return "\n".join(lines)


def _rectangle(left: float, low: float, right: float, high: float) -> list[tuple[float, float]]:
    return [(left, low), (right, low), (right, high), (left, high)]


def _square(centre: tuple[float, float], angle: float) -> list[tuple[float, float]]:
    """Return the corners of a square of 1 m, turned by an angle, to 0.1 mm."""
    radius = math.sqrt(0.5)
    corners = [angle + math.radians(45.0 + 90.0 * k) for k in range(4)]
    return [
        (round(centre[0] + radius * math.cos(a), 4), round(centre[1] + radius * math.sin(a), 4))
        for a in corners
    ]


def _block(name: str, corners: Sequence[tuple[float, float]], *, fixed: bool = False) -> str:
    vertices = ", ".join(f"[{x:g}, {y:g}]" for x, y in corners)
    held = "fixed = true\n" if fixed else ""
    return f'[[block]]\nname = "{name}"\nvertices = [{vertices}]\n{held}'


def _measured(name: str, at: tuple[float, float], block: str) -> str:
    return f'[[measured_point]]\nname = "{name}"\nat = [{at[0]:g}, {at[1]:g}]\nblock = "{block}"\n'


TEMPLATES: dict[str, Callable[[], str]] = {
    "incline": incline,
    "wall": wall,
    "heap": heap,
    "slope": lambda: SLOPE,
    "tunnel": lambda: TUNNEL,
    "key-block": lambda: KEY_BLOCK,
}
"""What ``clast new --template`` offers."""
