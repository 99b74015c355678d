"""Joints on springs with water in them: a block on a base, and columns side by side on one."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

import clast
from clast.actions.coupled_flow import CoupledWater

WEIGHT = 2600.0 * 9.81
"""Weight of the rock, N/m3."""
SETTLED = 1e6
"""Time at which blocks have settled and their water has drained, s."""
COMMON = """
title = "A joint and its water"
gravity = [0.0, -9.81]
[time]
end = {end}
step = {step}
[rock.base]
young = 50e9
poisson = 0.2
density = 2600.0
[rock.upper]
young = 50e9
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 0.0
normal_stiffness = {stiffness}
shear_stiffness = {stiffness}
[joint.bed]
between_rocks = [["base", "upper"]]
friction_angle = 30.0
normal_stiffness = {stiffness}
shear_stiffness = {stiffness}
aperture = {aperture}
residual_aperture = 1e-6
maximum_aperture = 1e-2
[flow]
state = "transient"
coupling = "full"
initial = "hydrostatic"
level = 0.0
bulk_modulus = {bulk}
{flow}
[[block]]
name = "base"
rock = "base"
vertices = [[0, -2], [{length}, -2], [{length}, 0], [0, 0]]
fixed = true
[[flow_boundary]]
name = "left"
where = {{side = "left"}}
{left}
[[flow_boundary]]
name = "right"
where = {{side = "right"}}
{right}
[[stage]]
name = "settle"
dynamic_ratio = 0.0
until = "time"
time = {settled}
step = {settling}
"""
STAGE = """
[[stage]]
name = "{name}"
dynamic_ratio = {ratio}
until = "time"
time = {time}
step = {step}
{more}
"""


def text_of(places: Any, height: float, *stages: dict[str, Any], **given: Any) -> str:
    """Return a case of columns between ``places`` (n + 1,), m, on a base, and its stages."""
    end = given.get("settled", SETTLED)
    values = {
        "stiffness": 1e10,
        "aperture": 2e-4,
        "bulk": 2e9,
        "flow": "",
        "left": "impermeable = true",
        "right": "impermeable = true",
        "settled": end,
        "settling": end / 10.0,
        "length": float(places[-1]),
        "end": end + sum(one["time"] for one in stages),
        "step": end,
        **{key: value for key, value in given.items() if key not in ("settled", "more")},
    }
    text = COMMON.format(**values)
    for number, one in enumerate(stages):
        text += STAGE.format(**{"name": f"stage {number}", "ratio": 0.0, "more": "", **one})
    for number, (first, last) in enumerate(pairwise(places)):
        outline = [[first, 0.0], [last, 0.0], [last, height], [first, height]]
        outline = [[float(x), float(y)] for x, y in outline]
        text += f'[[block]]\nname = "column {number}"\nrock = "upper"\nvertices = {outline}\n'
    return text + str(given.get("more", ""))


def run_of(text: str) -> clast.Run:
    """Return the run of a case."""
    return clast.Case.from_text(text, "case").run()


def water_of(run: clast.Run) -> CoupledWater:
    """Return the water at the end of a run."""
    (water,) = [one for one in run.state.actions if isinstance(one, CoupledWater)]
    return water


def along_joint(water: CoupledWater) -> tuple[Any, Any]:
    """Return places, m, from the left, and pressures of the nodes, Pa, (m,) each."""
    order = np.argsort(water.network.at[:, 0])
    x = water.network.at[order, 0]
    return x - x[0], water.solved.pressure[order]
