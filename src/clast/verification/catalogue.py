"""All problems, in the order of the table."""

from __future__ import annotations

from clast.verification.problem import Problem
from clast.verification.problems.blocks import (
    energy,
    free_fall,
    invariance,
    order,
    patch,
    pendulum,
    spin,
    stiffness,
)
from clast.verification.problems.contact import (
    bounce,
    collision,
    column,
    penetration,
    restitution,
    stack,
)
from clast.verification.problems.friction import (
    decelerating_block,
    direct_shear,
    friction_lag,
    incline,
    seams,
)
from clast.verification.problems.masonry import arch, overhang, rocking, three_hinges
from clast.verification.problems.slopes import (
    jointed_rock,
    ladder,
    plane_failure,
    slide_topple,
    toppling,
    two_planes,
)
from clast.verification.problems.underground import active_passive, key_block
from clast.verification.problems.waves import moving_base, newmark, wave

PROBLEMS: tuple[Problem, ...] = (
    incline.PROBLEM,
    friction_lag.PROBLEM,
    decelerating_block.PROBLEM,
    seams.PROBLEM,
    slide_topple.PROBLEM,
    newmark.PROBLEM,
    moving_base.PROBLEM,
    direct_shear.PROBLEM,
    ladder.PROBLEM,
    overhang.PROBLEM,
    key_block.PROBLEM,
    active_passive.PROBLEM,
    plane_failure.PROBLEM,
    toppling.PROBLEM,
    arch.PROBLEM,
    three_hinges.PROBLEM,
    two_planes.PROBLEM,
    penetration.PROBLEM,
    stiffness.PROBLEM,
    stack.PROBLEM,
    bounce.PROBLEM,
    restitution.PROBLEM,
    collision.PROBLEM,
    rocking.PROBLEM,
    column.PROBLEM,
    patch.PROBLEM,
    jointed_rock.PROBLEM,
    wave.PROBLEM,
    free_fall.PROBLEM,
    spin.PROBLEM,
    pendulum.PROBLEM,
    energy.PROBLEM,
    order.PROBLEM,
    invariance.PROBLEM,
)
"""Problems by what they test: friction, contact, elasticity, motion, the method as a whole."""
