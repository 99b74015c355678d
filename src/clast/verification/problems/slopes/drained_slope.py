"""Pressures of a phreatic line and of drains on the plane of a slope, and the factor of safety.

A slab of weight W lies on a plane of dip a and length A below a vertical crack with zw of water.
The joint carries the effective force,

    N' = W cos a - U - V sin a,    T = W sin a + V cos a,    V = 1/2 w zw^2,

U being the pressures on the plane, w (y_line - y) below a phreatic line, and

    F = (c A + N' tan phi)/T.

Drains take the head that they lie at: from the foot of the crack to the first drain the pressure
falls evenly to none, and between two drains there is none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.problem import Bracket, Trial, problem
from clast.verification.problems import Floats, InputBuilder, Model, StaticRun
from clast.verification.problems.slopes.wet_slope import (
    GRAVITY,
    STEP,
    WATER,
    WEIGHT,
    Slope,
    dry_slope,
    steep_slope,
)
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE, Variant

STIFFNESS, STEPS, FIRM = 2e9, 300, 0.5
"""Contact stiffness, N/m per m; steps; divisor of the strength of a firm slope."""
SPAN, BISECTIONS, FEW = 0.04, 5, 3
RESOLUTION = f"bisected to {100 * 2 * SPAN / 2**BISECTIONS:.2g} %"
SETTLES = "blocks give by microns, and the water with them"
FULL = 4.0
"""Height of the water in the crack zw, m."""


@dataclass(frozen=True, kw_only=True)
class WaterHead:
    """Heads of water over a plane, and how they are entered."""

    name: str
    """Its name in the table."""
    share: tuple[float, ...]
    """Places on the plane, shares of its length from the toe, from 0 to 1."""
    head: tuple[float, ...]
    """Height of the water above the plane there, m; linear between."""
    drains: tuple[float, ...] = ()
    """Places of drains; none: a phreatic line through the heads."""

    def at(self, slope: Slope, share: Floats) -> Floats:
        """Return the pressure on the plane at places, Pa."""
        return WATER * GRAVITY * np.interp(share, self.share, self.head)

    def forces(self, slope: Slope) -> tuple[float, float]:
        """Return N' and T, N/m."""
        dip, length = np.radians(slope.plane), float(np.hypot(*slope.foot))
        crest = slope.height / np.tan(np.radians(slope.face))
        area = 0.5 * (slope.height * (slope.crack - crest) + slope.crack * slope.depth)
        lifts = WATER * GRAVITY * length * float(np.trapezoid(self.head, self.share))
        pushes = 0.5 * WATER * GRAVITY * self.head[-1] ** 2
        presses = WEIGHT * area * np.cos(dip) - lifts - pushes * np.sin(dip)
        drives = WEIGHT * area * np.sin(dip) + pushes * np.cos(dip)
        return float(presses), float(drives)

    def factor(self, slope: Slope) -> float:
        """Return F."""
        presses, drives = self.forces(slope)
        friction = np.tan(np.radians(slope.friction_angle))
        return float((slope.cohesion * np.hypot(*slope.foot) + presses * friction) / drives)

    def keys(self, slope: Slope) -> Mapping[str, Any]:
        """Return the keys of the water: a level and drains, or a phreatic line."""
        along = np.array(self.share)[:, None] * slope.foot
        if self.drains:
            drained = [tuple(share * slope.foot) for share in self.drains]
            level = float(slope.foot[1]) + self.head[-1]
            return MappingProxyType({"level": level, "drained_at": drained})
        line = along + np.stack([np.zeros(len(along)), self.head], axis=1)
        beyond = line[-1] + (10.0, 0.0)
        return MappingProxyType({"line": np.vstack([line, beyond])})


WATERS = (
    WaterHead(name="line to the toe", share=(0.0, 1.0), head=(0.0, FULL)),
    WaterHead(name="line with a corner", share=(0.0, 0.4, 1.0), head=(1.0, 3.0, FULL)),
    WaterHead(name="drain at the toe", share=(0.0, 1.0), head=(0.0, FULL), drains=(0.0,)),
    WaterHead(
        name="drains at the toe and at 0.4 A",
        share=(0.0, 0.4, 1.0),
        head=(0.0, 0.0, FULL),
        drains=(0.0, 0.4),
    ),
)


def wet(water: WaterHead, divided_by: float = FIRM) -> Model:
    """Return the slope of 15 m with water, its strength divided."""
    builder: InputBuilder = dry_slope(steep_slope(), divided_by)
    builder.water(acts_on="joints", **water.keys(steep_slope()))
    return builder.build()


def borne(water: WaterHead, variant: Variant) -> tuple[float, float]:
    """Return N' and T that the plane carries, N/m."""
    model, slope = wet(water), steep_slope()
    step = STEP * slope.height
    run = variant.run(
        model,
        step=step,
        end=STEPS * step,
        normal_stiffness=STIFFNESS,
        max_displacement=0.02,
        dynamic_ratio=0.0,
    )
    contacts, slab = run.contacts(), model.block_name.index("slab")
    sense = np.where(contacts.vertex_block == slab, 1.0, -1.0)
    force = (sense[:, None] * contacts.force).sum(axis=0)
    dip = np.radians(slope.plane)
    along, across = np.array([np.cos(dip), np.sin(dip)]), np.array([-np.sin(dip), np.cos(dip)])
    return float(force @ across), float(force @ along)


def safety(water: WaterHead, bisections: int, variant: Variant) -> Bracket:
    """Return the divisor of the strength at which the slab begins to slide."""
    slope = steep_slope()
    exact = water.factor(slope)
    static = StaticRun(normal_stiffness=STIFFNESS, step=STEP * slope.height, steps=STEPS)
    ends = 1.0 - SPAN, 1.0 + SPAN
    found = static.limit(lambda share: wet(water, exact / share), variant, *ends, bisections)
    return Bracket(exact / found.low, exact / found.high)


@problem(
    set_up=lambda: wet(WATERS[3]),
    variants=(CONVEX, OPEN_CLOSE, LAGGED),
    quick=(CONVEX,),
    few=(WATERS[1:4:2], FEW),
)
def drained_slope(
    trial: Trial, waters: tuple[WaterHead, ...] = WATERS, bisections: int = BISECTIONS
) -> None:
    """Phreatic lines and drains on the plane of a slope.

    The slope of 15 m of wet-slope with 4 m of water in its crack, entered as a phreatic line
    (straight to the toe, or with a corner), or as a level with drains at the toe and in the plane.
    Forces on the plane with twice the strength, and the factor of safety, bisected. p = 2 GPa, h =
    4 ms, static (dynamic_ratio = 0).

    Exact: N' = W cos a - U - V sin a, T = W sin a + V cos a, F = (c A + N' tan phi)/T.
    Source: limit equilibrium of Hoek & Bray (1974).
    """
    slope = steep_slope()
    for water in waters:
        carries, exact = borne(water, trial.variant), water.forces(slope)
        for name, one, other in zip(("N'", "T"), carries, exact, strict=True):
            trial.relative(f"{name}, {water.name}", "N/m", one, other, 2e-3, SETTLES)
        found = safety(water, bisections, trial.variant)
        quantity = f"factor of safety, {water.name}"
        trial.relative(quantity, "-", found, water.factor(slope), 0.01, RESOLUTION)
    fine = np.linspace(0.0, 1.0, 51)
    trial.chart(
        "pressure on the plane",
        "distance from the toe / A",
        "pressure, kPa",
        *(exact_curve(water.name, fine, 1e-3 * water.at(slope, fine)) for water in waters),
        curve("foot of the crack", (1.0,), (1e-3 * WATER * GRAVITY * FULL,)),
    )
