"""All problems, in the order of the table."""

from __future__ import annotations

from clast.verification import (
    bounce,
    collision,
    column,
    decelerating_block,
    direct_shear,
    energy,
    free_fall,
    friction_lag,
    incline,
    invariance,
    order,
    patch,
    pendulum,
    penetration,
    spin,
    stack,
    stiffness,
    toppling,
    wave,
)
from clast.verification.problem import Problem

PROBLEMS: tuple[Problem, ...] = (
    incline.PROBLEM,
    friction_lag.PROBLEM,
    decelerating_block.PROBLEM,
    direct_shear.PROBLEM,
    toppling.PROBLEM,
    penetration.PROBLEM,
    stiffness.PROBLEM,
    stack.PROBLEM,
    bounce.PROBLEM,
    collision.PROBLEM,
    column.PROBLEM,
    patch.PROBLEM,
    wave.PROBLEM,
    free_fall.PROBLEM,
    spin.PROBLEM,
    pendulum.PROBLEM,
    energy.PROBLEM,
    order.PROBLEM,
    invariance.PROBLEM,
)
"""Problems by what they test: friction, contact, elasticity, motion, the method as a whole."""
