"""All problems, in the order of the table."""

from __future__ import annotations

from clast.verification import (
    bounce,
    collision,
    column,
    decelerating_block,
    direct_shear,
    free_fall,
    friction_lag,
    incline,
    patch,
    pendulum,
    penetration,
    spin,
    stack,
    stiffness,
)
from clast.verification.problem import Problem

PROBLEMS: tuple[Problem, ...] = (
    incline.PROBLEM,
    friction_lag.PROBLEM,
    decelerating_block.PROBLEM,
    direct_shear.PROBLEM,
    penetration.PROBLEM,
    stiffness.PROBLEM,
    stack.PROBLEM,
    bounce.PROBLEM,
    collision.PROBLEM,
    column.PROBLEM,
    patch.PROBLEM,
    free_fall.PROBLEM,
    spin.PROBLEM,
    pendulum.PROBLEM,
)
"""Problems by what they test: friction, contact, elasticity, motion."""
