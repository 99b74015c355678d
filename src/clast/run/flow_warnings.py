"""Warnings of a flow in joints that the end of a run gives, each with a place and a remedy.

Turbulence, pumps that lack water, joints that are coarse for their apertures, and those that water
lifts or that have opened while the flow does not follow.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clast.actions.flow import JointWater
from clast.actions.following import PASSES_MAX
from clast.contact.memory import pair_keys
from clast.model.checks import point_text
from clast.model.flow.apertures import gaps
from clast.model.flow.given import FULL, STEADY
from clast.model.model import Floats, Model
from clast.model.state import State

TURBULENT = 1000.0
"""Reynolds number rho q/mu up to which flow in joints is laminar."""
WIDENED = 0.5
"""Change of an aperture, as a share of it, that the flow should follow."""
COARSE = 2.0
"""Ratio of apertures of a channel and the next one above which joints are coarse."""
CARRIES = 1e-3
"""Flow of a channel that matters, as a share of the largest."""
SLOW = 100
"""Linear systems of a step that are many."""


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
    if water.hardest > SLOW:
        yield (
            f"flow: a step took {water.hardest} linear systems to find the water in joints. Give "
            "shorter steps, or an amplitude in the place of a head that changes at once"
        )
    if flow.coupling == "none":
        yield from _opened(model, state, water)
    else:
        yield from _coarse(model, water)
    if flow.coupling != FULL:
        yield from _lifted(model, state, water)


def _coarse(model: Model, water: JointWater) -> Iterator[str]:
    """Warn of joints whose apertures follow pressures and differ from one channel to the next."""
    network, aperture = water.network, water.aperture.T.ravel()
    line = network.at[network.node[:, 1]] - network.at[network.node[:, 0]]
    along = line / np.hypot(*line.T)[:, None]
    node, channel = network.node.T.ravel(), np.tile(np.arange(len(line)), 2)
    away = np.concatenate([along, -along])
    flow = np.abs(water.solved.flow)
    carries = flow > CARRIES * flow.max()
    order = np.argsort(node, kind="stable")
    worst, place = COARSE, -1
    for shift in range(1, ENDS):
        first, second = order[:-shift], order[shift:]
        one, other = channel[first], channel[second]
        straight = (away[first] * away[second]).sum(axis=1) < STRAIGHT
        next_to = (node[first] == node[second]) & straight & carries[one] & carries[other]
        next_to &= network.joint[one] == network.joint[other]
        ratio = np.where(next_to, np.exp(np.abs(np.log(aperture[first] / aperture[second]))), 1.0)
        if len(ratio) and ratio.max() > worst:
            worst, place = float(ratio.max()), int(node[first][ratio.argmax()])
    if place >= 0:
        at = point_text(network.at[place] + model.origin)
        yield (
            f"flow: at {at} a joint is {worst:.3g} times as wide on one side as on the other, "
            "and follows the pressure: blocks are long for that. Give shorter blocks along it"
        )


ENDS = 5
"""Channels that meet at a node, at most, that are compared."""
STRAIGHT = -0.9
"""Cosine of the angle of two channels below which one goes on in the other."""


def _lifted(model: Model, state: State, water: JointWater) -> Iterator[str]:
    """Warn of joints under pressure that have opened and whose contacts carry nothing."""
    network, memory, count = water.network, state.memory, model.block_count
    carried = memory.normal_force > 0.0
    pair = np.stack([model.vertex_block[memory.vertex], memory.block])[:, carried]
    held = np.isin(
        pair_keys(network.block[:, 0], network.block[:, 1], count),
        pair_keys(pair[0], pair[1], count),
    )
    pressure = water.solved.pressure[network.node].mean(axis=1)
    opened, aperture = _openings(model, state, water)
    jacked = ~held & (pressure > 0.0) & (opened.max(axis=1) > WIDENED * aperture)
    if jacked.any():
        most = int(np.where(jacked, pressure, 0.0).argmax())
        at = point_text(network.middle[most] + model.origin)
        yield (
            f"flow: water lifts the faces of {network.length[jacked].sum():.4g} m of joints apart: "
            f"its pressure is above the normal stress, most at {at} with {pressure[most]:.4g} Pa. "
            'Joints that open do not relieve it: give [flow] coupling = "full", or hold the blocks'
        )


def _openings(model: Model, state: State, water: JointWater) -> tuple[Floats, Floats]:
    """Return the opening at both ends of channels since the start, (k, 2), and apertures, (k,)."""
    network, after = water.network, model.vertex_after
    opened = gaps(network, state.vertices, after) - gaps(network, model.vertices, after)
    aperture = np.array([one.aperture_without_stress for one in model.joint_table.joints])
    return opened, aperture[network.joint]


def _opened(model: Model, state: State, water: JointWater) -> Iterator[str]:
    """Warn of joints that have opened while their flow does not follow."""
    network = water.network
    opened, aperture = _openings(model, state, water)
    share = opened.max(axis=1) / aperture
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
