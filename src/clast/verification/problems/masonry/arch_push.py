"""The lateral push that an arch resists: its weight times a factor, across.

Voussoirs between radial joints carry no tension; a joint gives way to N1, N2 >= 0 at its ends and
to a shear force |V| <= (N1 + N2) tan phi.  The largest factor whose push is in equilibrium is found
by linear programming, three equations for every voussoir.  By the theorem of limit analysis it is
exact where the arch folds on four hinges, as that of Oppenheim (1992) does at 0.37; where joints
slide, it is an upper bound for friction that does not open joints (Drucker 1954), which the arch
here reaches.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.limit_analysis import (
    RigidBlocks,
    add_voussoirs,
    joint_ends,
    largest_factor,
    voussoirs_between,
)
from clast.verification.problems import Floats, InputBuilder, Model, StaticRun, Trial, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

GRAVITY, DENSITY = 9.8, 2400.0
STEP, STEPS, BISECTIONS, FEW = 2e-2, 200, 4, 3
SPAN = 0.06
"""Half of the range searched about the exact factor, as a share of it."""
TOLERANCE = 0.015
RESOLUTION = f"bisected to {200 * SPAN / 2**BISECTIONS:.2g} %; joints and blocks give a little"


@dataclass(frozen=True, kw_only=True)
class Arch:
    """A circular arch of equal voussoirs."""

    name: str
    """Its name in the table."""
    radius: float = 5.0
    """Mean radius R, m."""
    share: float = 0.15
    """Thickness over R."""
    embrace: float = 180.0
    """Angle between its springings, degrees."""
    voussoirs: int = 21
    """Their number."""
    friction_angle: float = 60.0
    """Friction angle of the joints, degrees."""

    def joints(self) -> tuple[Floats, Floats]:
        """Return the inner and outer ends of all joints from right to left, m (k, 2)."""
        return joint_ends(self.radius, self.share, self.embrace, self.voussoirs)

    def blocks(self) -> RigidBlocks:
        """Return its voussoirs as rigid blocks."""
        return voussoirs_between(*self.joints(), self.friction_angle)


OPPENHEIM = Arch(name="Oppenheim's arch", radius=10.0, embrace=157.5, voussoirs=7)
ARCHES = (
    OPPENHEIM,
    replace(OPPENHEIM, name="of 15 voussoirs", voussoirs=15),
    *(
        replace(OPPENHEIM, name=f"at phi = {angle:g} degrees", friction_angle=angle)
        for angle in (26.6, 21.8, 16.7)
    ),
    *(
        Arch(name=f"semicircle of t/R = {share:g}", share=share)
        for share in (0.12, 0.15, 0.2, 0.25)
    ),
)


def exact_factor(arch: Arch) -> float:
    """Return the largest push over the weight."""
    blocks = arch.blocks()
    return largest_factor(blocks, blocks.body_force((0.0, -1.0)), blocks.body_force((1.0, 0.0)))


def add_arch(builder: InputBuilder, arch: Arch, carried: str = "") -> None:
    """Add an arch between abutments, fixed but the ``carried`` one, which two fixed points hold."""
    inner, outer = arch.joints()
    for name, end, side in (("right", 0, -1.0), ("left", arch.voussoirs, 1.0)):
        radial = (outer[end] - inner[end]) / np.hypot(*(outer[end] - inner[end]))
        reach = 0.2 * arch.radius
        low, high = inner[end] - 0.05 * reach * radial, outer[end] + 0.05 * reach * radial
        back = side * reach * np.array([-radial[1], radial[0]])
        corners = [low, high, high + back, low + back]
        name = f"{name} abutment"
        builder.block(
            name=name, vertices=corners if side > 0.0 else corners[::-1], fixed=name != carried
        )
        for at in (high + back, low + back) if name == carried else ():
            builder.fixed_point(at, block=name)
    for name, middle in add_voussoirs(builder, inner, outer).items():
        builder.measured_point(name, middle, block=name)


def pushed(arch: Arch = OPPENHEIM, factor: float = 0.3) -> Model:
    """Return two fixed abutments and the voussoirs, with ``factor`` of their weight across."""
    builder = InputBuilder(title="Arch under push", gravity=(factor * GRAVITY, -GRAVITY))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=arch.friction_angle)
    add_arch(builder, arch)
    return builder.build()


STATIC = StaticRun(normal_stiffness=1e10, step=STEP, steps=STEPS)


@problem(set_up=pushed, variants=(OPEN_CLOSE, CONVEX), quick=(CONVEX,), few=(ARCHES[:1], FEW))
def arch_push(
    trial: Trial, arches: tuple[Arch, ...] = ARCHES, bisections: int = BISECTIONS
) -> None:
    """Arch under lateral push.

    A share of the weight of an arch acts across, as in an earthquake that lasts; the share is
    bisected. Seven voussoirs over 157.5 degrees of a mean radius of 10 m, t/R = 0.15, as
    Oppenheim's, also with more voussoirs and less friction, and semicircles of 21 voussoirs; phi =
    60 degrees, E = 50 GPa, p = 10 GPa, h = 20 ms, static (dynamic_ratio = 0).

    Exact: the largest factor with N1, N2 >= 0 and |V| <= (N1 + N2) tan phi in all joints: 0.3736
    for Oppenheim's arch.
    Source: limit analysis by linear programming (scipy); Oppenheim (1992) has 0.37.
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6.
    """
    for arch in arches:
        exact = exact_factor(arch)
        found = STATIC.limit(
            partial(pushed, arch),
            trial.variant,
            (1.0 + SPAN) * exact,
            (1.0 - SPAN) * exact,
            bisections,
        )
        quantity = f"push over weight, {arch.name}"
        trial.relative(quantity, "", found, exact, TOLERANCE, RESOLUTION)
    # with less friction arches slide: their points belong to neither line
    drawn = [k for k, arch in enumerate(arches) if arch.friction_angle == OPPENHEIM.friction_angle]
    shares = np.linspace(0.11, 0.26, 16)
    semicircle = Arch(name="")
    trial.chart(
        "largest push",
        "t/R",
        "push over weight",
        exact_curve(
            "semicircle of 21, linear programming",
            shares,
            [exact_factor(replace(semicircle, share=share)) for share in shares],
        ),
        exact_curve(
            "157.5 degrees, 7 voussoirs",
            shares,
            [exact_factor(replace(OPPENHEIM, share=share)) for share in shares],
        ),
        curve(
            trial.variant.name,
            [arches[k].share for k in drawn],
            [trial.rows[k].computed for k in drawn],
        ),
    )
