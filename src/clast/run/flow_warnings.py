"""Warnings of a flow in joints that the end of a run gives: turbulence, and joints that opened."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clast.actions.flow import JointWater
from clast.actions.following import PASSES_MAX
from clast.model.checks import point_text
from clast.model.flow.apertures import gaps
from clast.model.flow.given import STEADY
from clast.model.model import Model
from clast.model.state import State

TURBULENT = 1000.0
"""Reynolds number rho q/mu up to which flow in joints is laminar."""
WIDENED = 0.5
"""Change of an aperture, as a share of it, that the flow should follow."""


def flow_warnings(model: Model, state: State) -> Iterator[str]:
    """Give the warnings of water that flows in joints."""
    flow = model.flow
    water = next((one for one in state.actions if isinstance(one, JointWater)), None)
    if flow is None or water is None or not len(water.conductance):
        return
    network, names = water.network, flow.names
    for number in np.unique(water.conditions.part[water.solved.missing > 0.0]).tolist():
        mine = water.conditions.part == number
        lack, asked = water.solved.missing[mine].sum(), -water.conditions.inflow[mine].sum()
        yield (
            f"flow: the pump '{names[number]}' asks for {asked:.4g} m3/s per m and gets "
            f"{asked - lack:.4g}: the joints about it are dry. Give a rate nearer to 0, or "
            "pressure = 0.0 and only_outflow = true"
        )
    reynolds = flow.reynolds(water.solved.flow)
    worst = int(reynolds.argmax())
    if reynolds[worst] > TURBULENT:
        at = point_text(network.middle[worst] + model.origin)
        yield (
            f"flow: Re = rho q/mu is {reynolds[worst]:.4g} in the joint at {at}: flow is turbulent "
            f"above {TURBULENT:g}, and the cubic law gives too much. Give a smaller aperture, or a "
            "flow_factor"
        )
    if flow.coupling == STEADY and water.passes >= PASSES_MAX:
        yield (
            f"flow: after {water.passes} equilibria the flow still changes apertures by "
            f"{water.left:.2g} of them. Give a shorter longest, or stiffer joints"
        )
    if flow.coupling != "none":
        return
    after = model.vertex_after
    opened = gaps(network, state.vertices, after) - gaps(network, model.vertices, after)
    aperture = np.array([one.aperture_without_stress for one in model.joint_table.joints])
    share = opened.max(axis=1) / aperture[network.joint]
    wide = share > WIDENED
    if wide.any():
        first = int(share.argmax())
        at = point_text(network.middle[first] + model.origin)
        pressed = (water.solved.pressure[network.node[wide]] > 0.0).any(axis=1)
        wet = f", {network.length[wide][pressed].sum():.4g} m of them under pressure"
        yield (
            f"flow: {network.length[wide].sum():.4g} m of joints have opened by more than half of "
            f"their aperture{wet if pressed.any() else ''}, most at {at}: the flow is that of the "
            'apertures of the start, and does not follow. Give [flow] coupling = "steady", these '
            "joints a wider aperture, or hold the blocks"
        )
