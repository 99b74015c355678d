"""Cut rock with water in its joints: its blocks as polygons, models of them, confined flow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import clast
from clast.model.flow.apertures import at_start, conductance, hydraulic
from clast.model.flow.balance import GIVEN, INNER, Balance, Solved
from clast.model.flow.network import Network
from clast.model.flow.solving import steady
from clast.model.model import Floats, Model

WEIGHT = 9810.0
CUT = """
title = "Cut rock"
gravity = [0.0, -9.81]
[time]
end = 1.0
step = 1e-2
[rock.stone]
young = 50e9
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 30.0
aperture = 2e-4
[domain]
boundary = {boundary}
smallest_block = 0.0
smallest_edge = 0.0
"""
SET = """
[[joint_set]]
name = "set {0}"
angle = {0}
spacing = {1}
origin = [0.3, 0.4]
"""


def case_of(size: float, *sets: tuple[float, float], more: str = "") -> clast.Case:
    """Return the case of a square of rock, m, cut by sets of (angle, spacing)."""
    boundary = [[0, 0], [size, 0], [size, size], [0, size]]
    text = CUT.format(boundary=boundary) + "".join(SET.format(*one) for one in sets) + more
    return clast.Case.from_text(text, "case")


def cut(size: float, *sets: tuple[float, float], more: str = "") -> Model:
    """Return the model of such a case."""
    return case_of(size, *sets, more=more).model()


def rock_of(polygons: list[Floats], **joint: float) -> Model:
    """Return blocks with these outlines, m, about joints of one aperture."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, **{"aperture": 2e-4, **joint})
    for one in polygons:
        builder.block(vertices=one.tolist())
    return builder.build()


def polygons_of(model: Model) -> list[Floats]:
    """Return the outlines of the blocks, m, (s, 2) each."""
    return [model.polygon(block) for block in range(model.block_count)]


def confined(model: Model, network: Network, head: Floats) -> tuple[Balance, Solved]:
    """Return the flow in full joints with heads (m,), m, at outer nodes."""
    aperture = hydraulic(model, network, at_start(model, network))
    height = network.at[:, 1] + model.origin[1]
    count, node = network.count, network.node
    balance = Balance(
        node=node,
        conductance=conductance(aperture, network.length, 1e-3),
        weight=WEIGHT * (height[node[:, 0]] - height[node[:, 1]]),
        kind=np.where(network.outer, GIVEN, INNER),
        pressure=WEIGHT * (head - height),
        inflow=np.zeros(count),
        volume=np.zeros(count),
        opened=np.zeros(count),
        confined=True,
    )
    return balance, steady(balance)


def through(solved: Solved) -> float:
    """Return what flows in, m2/s."""
    return float(solved.given[solved.given > 0.0].sum())


def without_block(model: Model, block: int) -> Model:
    """Return a model in which a block is excavated."""
    absent = model.absent.copy()
    absent[block] = True
    return replace(model, absent=absent)
