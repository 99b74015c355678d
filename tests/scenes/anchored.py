"""A block on a plane that an anchor holds, and its factor of safety by limit equilibrium."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import clast

WEIGHT, LENGTH, APART = 600e3, 8.0, 3.0
HEIGHT = WEIGHT / (2600.0 * 9.81 * LENGTH)
ONE_BOLT = {"young": 2e11, "area": 1.5e-3, "out_of_plane_spacing": APART}
"""2e11 x 1.5e-3/(10 x 3) = 10 MN/m per m."""
JACKED = {"pretension_is": "jacked"}


def exact(dip: float, friction: float, angle: float, force: float) -> float:
    """Return F; ``force`` is T, N/m."""
    a, b = math.radians(dip), math.radians(angle)
    resists = (WEIGHT * math.cos(a) + force * math.sin(b)) * math.tan(math.radians(friction))
    return resists / (WEIGHT * math.sin(a) - force * math.cos(b))


def anchored(
    path: Path, kind: dict, *, dip=35.0, friction=40.0, angle=20.0, side=1.0, stages=(), **bolt
) -> Path:
    """Write the case; ``side`` -1 is its mirror image."""
    a, b = math.radians(dip), math.radians(angle)
    along = np.array([math.cos(a), math.sin(a)])
    up = np.array([-along[1], along[0]])
    toe, head = 2.0 * along, (2.0 + LENGTH) * along
    end = head + 14.0 * along
    corners = {
        "slope": [0.0 * toe, np.array([end[0], 0.0]), end],
        "block": [toe, head, head + HEIGHT * up, toe + HEIGHT * up],
    }
    mirror = np.array([side, 1.0])
    builder = clast.ModelBuilder(title="Anchored block", gravity=(0.0, -9.81))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=friction)
    for name, listed in corners.items():
        ring = [tuple(one * mirror) for one in (listed if side > 0.0 else listed[::-1])]
        builder.block(name=name, vertices=ring, fixed=name == "slope")
    builder.add_bolt_kind("anchor", **kind)
    middle = toe + 0.5 * LENGTH * along + 0.5 * HEIGHT * up
    toe_of_it = middle + 10.0 * (math.cos(b) * along - math.sin(b) * up)
    builder.bolt(middle * mirror, toe_of_it * mirror, name="A", kind="anchor", **bolt)
    path.write_text(builder.to_toml(step=5e-3, end=2.0, stages=list(stages)))
    return path
