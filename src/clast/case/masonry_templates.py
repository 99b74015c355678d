"""Masonry to begin with, as texts: ``clast new NAME --template arch``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

Corner = tuple[float, float]

WALL = """\
# A brick wall with a window under a lintel, at rest under its weight.  What to change:
#   region.one_block = false  the lintel is cut into bricks: they fall, and what lies on them
#                             (seen with dynamic_ratio = 1.0 and end = 1.0)
#   opening, region           where the window is, and how far the lintel reaches into the wall
#   block_pattern.brick       another format, for example [0.3, 0.15]: four times as many bricks
#   block_pattern.pattern     "stack-bond": all head joints in line
#   joint.mortar              friction; cohesion and tensile_strength where the mortar bonds
#   gravity = [5.0, -9.8]     leans along the wall: joints open in steps beside the window

schema = 1
title = "Brick wall with a window under a lintel"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 5e-3
end = 0.5
dynamic_ratio = 0.0                    # static: no velocity is carried from step to step

[rock.brick]
young = 5e9                            # Pa
poisson = 0.2
density = 1800.0                       # kg/m3

[rock.concrete]
young = 3e10
poisson = 0.2
density = 2400.0

[joint.mortar]
friction_angle = 35.0                  # degrees
cohesion = 0.0                         # Pa

[joint.default]                        # where no joint is named
friction_angle = 35.0

[domain]                               # the wall and a strip of ground under it
boundary = [[-0.6,-0.3],[6.6,-0.3],[6.6,0],[6,0],[6,3.6],[0,3.6],[0,0],[-0.6,0]]
rock = "brick"
fixed_sides = ["bottom"]               # holds the ground

[[block_pattern]]                      # look at it: clast cut wall.toml -o wall.png
pattern = "running-bond"
corner = [0, 0]                        # lower left
size = [6.0, 3.6]
brick = [0.6, 0.3]                     # width and height, m
joint = "mortar"

[[opening]]
name = "window"
shape = "box"
corner = [2.1, 0.9]
size = [1.8, 1.2]
excavated = true                       # void from the start

[[region]]
name = "lintel"
polygon = [[1.8,2.1],[4.2,2.1],[4.2,2.4],[1.8,2.4]]
rock = "concrete"
joint = "mortar"
one_block = true                       # no joint of the bricks crosses it

[[measured_point]]
name = "lintel"
at = [3.0, 2.25]

[output]
every = 0.05
"""

COLUMN = """\
# A column of drums; gravity leans to one side, as on a slope or in a steady push.  It stands as
# long as the share to the side is below breadth over height, here 1/6: up to 1.63 m/s2.
# Try:
#   gravity = [1.6, -9.8]     it stands
#   joint.default             friction_angle = 8, below atan(1/6) = 9.5 degrees: it slides
#   block_pattern.brick       [1.0, 1.5]: four drums in place of eight; [0.5, 0.5]: two beside each
#                             other in every layer, and each half topples by itself

schema = 1
title = "Column of drums under a sideways push"
gravity = [1.9, -9.8]                  # m/s2: 1.9 is more than 9.8/6

[time]
step = 2e-3
end = 2.0

[rock.marble]
young = 2e10                           # Pa
poisson = 0.2
density = 2700.0                       # kg/m3

[joint.default]
friction_angle = 35.0                  # degrees

[domain]                               # the column, and the ground under it
boundary = [[-2,-0.5],[8,-0.5],[8,0],[1,0],[1,6],[0,6],[0,0],[-2,0]]
rock = "marble"
fixed_sides = ["bottom"]

[[block_pattern]]                      # one drum lies on the other: the head joints are the sides
pattern = "stack-bond"
corner = [0, 0]
size = [1.0, 6.0]
brick = [1.0, 0.75]                    # breadth and height of a drum, m

[[measured_point]]
name = "top"
at = [1.0, 6.0]

[output]
every = 0.02
"""

SHAKEN_WALL = """\
# A brick wall with a window on ground that moves to and fro: a single Ricker wavelet.
#   peak      = {peak:<6g} m/s2 the largest acceleration, at {middle:g} s
#   frequency = {frequency:<6g} Hz
#   a = peak (1 - 2 q) exp(-q), q = (pi frequency (t - {middle:g} s))^2
# It is not a record of an earthquake; the ground ends where it began, and at rest.
# Try:
#   ground_motion.scale       2.0: the pier to the left of the window is shaken apart
#   ground_motion             file = "record.at2" in place of the two lists: a record of your own
#   joint.mortar              cohesion and tensile_strength, Pa, where the mortar bonds
#   stage shaken: time        longer than the record: to see whether bricks still come down

schema = 1
title = "Brick wall on ground that shakes"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 2e-3
end = 1.0

[rock.brick]
young = 5e9                            # Pa
poisson = 0.2
density = 1800.0                       # kg/m3

[rock.concrete]
young = 3e10
poisson = 0.2
density = 2400.0

[joint.mortar]
friction_angle = 35.0                  # degrees
cohesion = 0.0                         # Pa

[joint.default]                        # where no joint is named
friction_angle = 35.0

[domain]                               # the wall and a strip of ground under it
boundary = [[-0.6,-0.3],[4.8,-0.3],[4.8,0],[4.2,0],[4.2,3],[0,3],[0,0],[-0.6,0]]
rock = "brick"

[[fixed_point]]                        # these two move the ground: fixed_sides would hold it
at = [-0.6, -0.3]
[[fixed_point]]
at = [4.8, -0.3]

[[block_pattern]]                      # look at it: clast cut shaken-wall.toml -o wall.png
pattern = "running-bond"
corner = [0, 0]                        # lower left
size = [4.2, 3.0]
brick = [0.6, 0.3]                     # width and height, m
joint = "mortar"

[[opening]]
name = "window"
shape = "box"
corner = [1.5, 0.9]
size = [1.2, 1.2]
excavated = true                       # void from the start

[[region]]
name = "lintel"
polygon = [[1.2,2.1],[3.0,2.1],[3.0,2.4],[1.2,2.4]]
rock = "concrete"
joint = "mortar"
one_block = true                       # no joint of the bricks crosses it

[[measured_point]]
name = "ground"
at = [-0.3, -0.15]

[[measured_point]]
name = "top"
at = [2.0, 2.9]

[ground_motion]
acts = "base"                          # the fixed points move
time = [
{time}
]                                      # s
acceleration = [
{acceleration}
]                                      # m/s2, to the right

[[stage]]
name = "rest"
dynamic_ratio = 0.0                    # static: the weight comes on without a blow
reset_displacement = true              # displacements count from here

[[stage]]
name = "shaken"
ground_motion = true                   # the record begins with the stage
until = "time"
time = {end:g}

[output]
every = 0.02
"""

ARCH = """\
# A semicircular arch of equal voussoirs on fixed ground, standing under its weight.
#   radius    = {radius:<6g} m  of the middle line
#   thickness = {thickness:<6g} m  {share:.3g} of the radius: from about 0.107 on it stands
#                           (Milankovitch 1907)
#   voussoirs = {voussoirs:<6}    an odd number has a keystone
# The voussoirs are listed one by one; a script writes the file for other numbers.  This one falls:
#   from clast.case.templates import arch
#   open("thin.toml", "w").write(arch(radius=4.0, thickness=0.4, voussoirs=15))
# What else to change:
#   joint.default             friction_angle = 10: voussoirs slide out
#   [[point_load]]            beside the crown, at a place of the back: four hinges open, and it
#                             comes down

schema = 1
title = "Semicircular arch of {voussoirs} voussoirs"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 2e-3
end = 0.6

[rock.stone]
young = 2e10                           # Pa
poisson = 0.2
density = 2400.0                       # kg/m3

[joint.default]
friction_angle = 40.0                  # degrees

[output]
every = 0.02

[[block]]
name = "ground"
vertices = {ground}
fixed = true

"""

DOMINOES = """\
# Bricks on end in a row: the first is pushed over, and each topples the next.
#   count   = {count}
#   height  = {height:<6g} m
#   breadth = {breadth:<6g} m
#   gap     = {gap:<6g} m  between two; from about the height on a brick misses the next
# The bricks are listed one by one; a script writes the file for other numbers:
#   from clast.case.templates import dominoes
#   open("row.toml", "w").write(dominoes(count=20, height=0.24, breadth=0.06, gap=0.08))
# What else to change:
#   velocity of brick 1       (u, v, omega), m/s and rad/s: it turns about its lower right corner;
#                             slower than {least:.2g} rad/s it falls back

schema = 1
title = "Row of {count} dominoes"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 1e-3
end = {end:g}

[rock.brick]
young = 5e9                            # Pa
poisson = 0.2
density = 1800.0                       # kg/m3

[joint.default]
friction_angle = 30.0                  # degrees
restitution = 0.0                      # share of the closing speed with which impacts rebound

[output]
every = 0.02

[[block]]
name = "ground"
vertices = {ground}
fixed = true

"""


def arch(radius: float = 4.0, thickness: float = 0.6, voussoirs: int = 15) -> str:
    """Return a semicircular arch of a mean radius (m), on a fixed block of ground."""
    reach = round(1.25 * (radius + thickness), 3)
    head = ARCH.format(
        radius=radius,
        thickness=thickness,
        share=thickness / radius,
        voussoirs=voussoirs,
        ground=corners_text([(-reach, -0.5), (reach, -0.5), (reach, 0.0), (-reach, 0.0)]),
    )
    inner, outer = (
        [_on_circle(radius + side * thickness, k / voussoirs) for k in range(voussoirs + 1)]
        for side in (-0.5, 0.5)
    )
    blocks = [
        block_text(f"voussoir {k}", [inside[0], outside[0], outside[1], inside[1]])
        for k, (inside, outside) in enumerate(
            zip(pairwise(inner), pairwise(outer), strict=True), start=1
        )
    ]
    crown = outer[voussoirs // 2] if voussoirs % 2 == 0 else (0.0, radius)
    return "\n".join([head, *blocks, point_text("crown", crown, f"voussoir {voussoirs // 2 + 1}")])


def _on_circle(radius: float, share: float) -> Corner:
    """Return the point at a share of the half circle from its right end, to 1e-6 m."""
    angle = math.pi * share
    return round(radius * math.cos(angle), 6) + 0.0, round(radius * math.sin(angle), 6)


def dominoes(count: int = 12, height: float = 0.24, breadth: float = 0.06, gap: float = 0.1) -> str:
    """Return bricks on end (m) in a row, the first of which is pushed over."""
    pace = breadth + gap
    reach = round(0.5 * height + gap, 3)
    last = round(count * pace + 1.5 * height, 3)
    # Turning about a lower corner from rest on end, it must rise by this until it is over it.
    half_diagonal = 0.5 * math.hypot(height, breadth)
    rise = half_diagonal - 0.5 * height
    least = math.sqrt(1.5 * 9.8 * rise) / half_diagonal
    spin = round(1.5 * least, 2)
    head = DOMINOES.format(
        count=count,
        height=height,
        breadth=breadth,
        gap=gap,
        least=least,
        end=round(0.6 + 0.17 * count, 2),
        ground=corners_text([(-reach, -0.06), (last, -0.06), (last, 0.0), (-reach, 0.0)]),
    )
    pushed = f"velocity = [{0.5 * height * spin:g}, {0.5 * breadth * spin:g}, {-spin:g}]\n"
    blocks = []
    for k in range(count):
        left, right = round(k * pace, 6), round(k * pace + breadth, 6)
        corners = [(left, 0.0), (right, 0.0), (right, height), (left, height)]
        blocks.append(block_text(f"brick {k + 1}", corners, pushed if k == 0 else ""))
    at = (round((count - 1) * pace + 0.5 * breadth, 6), height)
    return "\n".join([head, *blocks, point_text("last", at, f"brick {count}")])


def shaken_wall(peak: float = 8.0, frequency: float = 1.5) -> str:
    """Return a brick wall on ground that moves by a Ricker wavelet (m/s2, Hz)."""
    interval = round(0.04 / frequency, 3)
    steps = 32  # at 1.28 periods from its middle the wavelet is a millionth of its peak
    middle = round(steps * interval, 6)
    instants = [k * interval for k in range(2 * steps + 1)]
    parts = [(math.pi * frequency * (t - middle)) ** 2 for t in instants]
    values = [round(peak * (1.0 - 2.0 * q) * math.exp(-q), 4) + 0.0 for q in parts]
    # what rounding left goes into the middle: the ground ends at rest, and where it began
    values[steps] -= sum(values) - 0.5 * (values[0] + values[-1])
    end = round(2.0 * middle + 0.3, 2)
    return SHAKEN_WALL.format(
        peak=peak,
        frequency=frequency,
        middle=middle,
        time=_rows(f"{t:.6g}" for t in [*instants, end]),
        acceleration=_rows(f"{value:.4f}" for value in [*values, 0.0]),
        end=end,
    )


def _rows(values: Iterable[str]) -> str:
    """Return values as lines of ten in a list of a case file."""
    listed = list(values)
    rows = [listed[k : k + 10] for k in range(0, len(listed), 10)]
    return "\n".join(f"    {', '.join(row)}," for row in rows)


def block_text(name: str, corners: Sequence[Corner], more: str = "") -> str:
    """Return [[block]] with the corners, m, and ``more`` lines."""
    return f'[[block]]\nname = "{name}"\nvertices = {corners_text(corners)}\n{more}'


def corners_text(corners: Sequence[Corner]) -> str:
    """Return corners as a list in a case file, each digit kept down to 1e-6 m."""
    return "[" + ", ".join(f"[{_short(x)}, {_short(y)}]" for x, y in corners) + "]"


def point_text(name: str, at: Corner, block: str) -> str:
    """Return [[measured_point]] at a point of a block."""
    place = f"[{_short(at[0])}, {_short(at[1])}]"
    return f'[[measured_point]]\nname = "{name}"\nat = {place}\nblock = "{block}"\n'


def _short(value: float) -> str:
    return f"{value:.9g}"
