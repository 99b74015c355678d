"""Cases to begin with, as texts: ``clast new NAME --template wall``."""

from __future__ import annotations

import math
from collections.abc import Callable

from clast.case.masonry_templates import (
    COLUMN,
    WALL,
    arch,
    block_text,
    dominoes,
    point_text,
    shaken_wall,
)
from clast.case.rock_templates import KEY_BLOCK, SLOPE, TUNNEL
from clast.case.support_templates import (
    LINED_TUNNEL,
    SETTLING_WALL,
    SHEAR_BOX,
    spreading_arch,
)

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


HELD = "fixed = true\n"


def incline() -> str:
    """Return the paper's block on an incline."""
    return INCLINE


def heap(rows: int = 8, columns: int = 8) -> str:
    """Return squares of 1 m, turned by many angles, above a fixed trough."""
    lines = [HEAP_HEAD]
    spacing = 1.5
    width = spacing * columns
    height = 0.6 * spacing * rows
    lines.append(block_text("floor", _rectangle(-1.0, -1.0, width + 1.0, 0.0), HELD))
    lines.append(block_text("left wall", _rectangle(-1.0, 0.0, 0.0, height), HELD))
    lines.append(block_text("right wall", _rectangle(width, 0.0, width + 1.0, height), HELD))
    for row in range(rows):
        for column in range(columns):
            centre = (spacing * (column + 0.5), spacing * (row + 0.5))
            # angles of 37 degrees apart repeat only after 90 squares
            angle = math.radians(37.0 * (row * columns + column) % 90.0)
            name = f"row {row + 1} square {column + 1}"
            lines.append(block_text(name, _square(centre, angle)))
    top = f"row {rows} square {columns // 2}"
    lines.append(point_text("top", (spacing * (columns // 2 - 0.5), spacing * (rows - 0.5)), top))
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


TEMPLATES: dict[str, Callable[[], str]] = {
    "incline": incline,
    "slope": lambda: SLOPE,
    "tunnel": lambda: TUNNEL,
    "lined-tunnel": lambda: LINED_TUNNEL,
    "key-block": lambda: KEY_BLOCK,
    "wall": lambda: WALL,
    "shaken-wall": shaken_wall,
    "settling-wall": lambda: SETTLING_WALL,
    "arch": arch,
    "spreading-arch": spreading_arch,
    "column": lambda: COLUMN,
    "dominoes": dominoes,
    "shear-box": lambda: SHEAR_BOX,
    "heap": heap,
}
"""The templates of ``clast new --template``."""
