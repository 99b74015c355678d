"""Remedies for a run that could not go on, by the advice of its process and its state."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clast.block.polygon import thicknesses
from clast.errors import StepOutcome
from clast.model.model import Model
from clast.model.state import State
from clast.step.finish import LARGEST_TURN
from clast.step.method import Method

GENERAL: Mapping[StepOutcome, str] = {
    StepOutcome.TRAVELLED_TOO_FAR: "Lower time.step, or raise time.max_displacement",
    StepOutcome.ROTATED_TOO_FAR: "Lower time.step",
    StepOutcome.TUNNELLED: "Lower time.step",
    StepOutcome.NOT_FINITE: (
        "Look for a block with hardly any mass or a stiffness that is far too large"
    ),
    StepOutcome.SINGULAR: (
        "A block is free to move without mass or support: set time.dynamic_ratio > 0 or fix it"
    ),
    StepOutcome.ENERGY_CREATED: (
        'Lower time.step, or set method.integrator = "backward-euler", which damps'
    ),
    StepOutcome.NOT_CONVERGED: "Lower method.contact_law.normal_stiffness or time.step",
}
"""Remedy with any process."""


def remedy(
    outcome: StepOutcome, model: Model, method: Method, state: State, smallest: float
) -> str:
    """Return the remedy where no step from ``state`` down to ``smallest``, s, is accepted.

    Remedies of the state come first; then those of the process, ``remedies`` of its own, and those
    that help any other.
    """
    by_state = {
        StepOutcome.TRAVELLED_TOO_FAR: _too_fast,
        StepOutcome.ROTATED_TOO_FAR: _spins_too_fast,
        StepOutcome.TUNNELLED: _too_soft,
    }
    by_its_state = by_state[outcome](model, method, state, smallest) if outcome in by_state else ""
    own: Mapping[StepOutcome, str] = getattr(method.process, "remedies", {})
    return by_its_state or own.get(outcome) or GENERAL.get(outcome, "")


def _too_fast(model: Model, method: Method, state: State, smallest: float) -> str:
    """Say so where a block at the speed that it has goes too far in the smallest step."""
    speed = np.hypot(state.velocity[:, 0], state.velocity[:, 1])
    fastest = int(speed.argmax())
    if speed[fastest] * smallest < 0.5 * method.max_displacement:
        return ""
    return (
        f"Block '{model.block_name[fastest]}' moves at {speed[fastest]:.3g} m/s, "
        f"{speed[fastest] * smallest:.2g} m in the smallest step: raise time.max_displacement, or "
        "lower time.smallest_step"
    )


def _spins_too_fast(model: Model, method: Method, state: State, smallest: float) -> str:
    """Say so where a block at the spin that it has turns too far in the smallest step."""
    spin = np.abs(state.velocity[:, 2])
    fastest = int(spin.argmax())
    if spin[fastest] * smallest < 0.5 * LARGEST_TURN:
        return ""
    return (
        f"Block '{model.block_name[fastest]}' spins at {spin[fastest]:.3g} rad/s: lower "
        "time.smallest_step"
    )


def _too_soft(model: Model, method: Method, state: State, smallest: float) -> str:
    """Say so where contacts are deep already."""
    depth = float(max(0.0, -state.memory.gap.min(initial=0.0)))
    # Penetration, as a share of the thinnest block, from which contacts are called too soft
    if depth < 0.01 * float(thicknesses(model.vertices, model.block_start).min()):
        return ""
    return f"Contacts are {depth:.2g} m deep: raise {stiffnesses_named(model, method)}"


def stiffnesses_named(model: Model, method: Method) -> str:
    """Return which normal stiffnesses contacts have, by their keys."""
    law = f"method.contact_law.normal_stiffness ({method.contact_law.normal_stiffness:.3g})"
    own = [
        f"'{joint.name}' ({joint.normal_stiffness:.3g})"
        for joint in model.joint_table.joints
        if joint.normal_stiffness is not None
    ]
    return f"{law}, or normal_stiffness of joint {', '.join(own)}" if own else law
