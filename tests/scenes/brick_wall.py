"""The text of a case with a wall of bricks that are listed one by one, with names."""

from __future__ import annotations

from itertools import pairwise

HEAD = """schema = 1
gravity = [0.0, -9.8]
time = {step = 1e-3, end = 0.5, max_displacement = 0.005}
output = {every = 0.01}
[rock.brick]
young = 5e9
poisson = 0.2
density = 2000.0
[joint.default]
friction_angle = 30.0
[method]
contact_law = {name = "penalty", normal_stiffness = "auto"}
critdis = 0.002
"""


def block_text(name: str, corners: list[tuple[float, float]], more: str = "") -> str:
    """Return [[block]] with its corners, m, and ``more`` lines."""
    vertices = ", ".join(f"[{x:.9g}, {y:.9g}]" for x, y in corners)
    return f'[[block]]\nname = "{name}"\nvertices = [{vertices}]\n{more}'


def listed_wall(rows: int, columns: int) -> str:
    """Return bricks of 1 m x 0.5 m in running bond, with straight ends, on a fixed base."""
    base = [(-1.0, -1.0), (columns + 1.0, -1.0), (columns + 1.0, 0.0), (-1.0, 0.0)]
    lines = [HEAD, block_text("base", base, "fixed = true\n")]
    for row in range(rows):
        low, high = 0.5 * row, 0.5 * (row + 1)
        # every other row begins and ends with half a brick
        inner = [column + 0.5 * (row % 2) for column in range(columns + 1)]
        joints = sorted({0.0, float(columns), *(x for x in inner if x <= columns)})
        for number, (left, right) in enumerate(pairwise(joints), start=1):
            corners = [(left, low), (right, low), (right, high), (left, high)]
            lines.append(block_text(f"row {row + 1} brick {number}", corners))
    return "\n".join(lines)
