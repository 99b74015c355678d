"""Strengths of joints that a stage changes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from clast.model.joints import Joint, JointTable
from clast.model.model import Model

HELD = 1e9
"""Strength of bonds that nothing breaks, in units of their own strength."""


SMALL_ANGLE = 1.6
"""Friction angles up to this many degrees look like radians (pi/2 is 1.57)."""


@dataclass(frozen=True, kw_only=True)
class Contradiction:
    """Numbers of a joint that are each possible, and not together or not meant."""

    key: str
    """Which number."""
    what: str
    """The fault."""
    remedy: str
    """The remedy."""


def contradiction(joint: Any, *, is_small_meant: bool) -> Contradiction | None:
    """Return the contradiction in the strengths of a joint, given or of a model, or None.

    ``is_small_meant`` says that a friction angle of less than SMALL_ANGLE is one in degrees.
    """
    for key in ("friction_angle", "residual_friction_angle"):
        angle = getattr(joint, key)
        if angle is not None and 0.0 < angle < SMALL_ANGLE and not is_small_meant:
            return Contradiction(
                key=key,
                what=f"{angle:g} looks like radians, but friction angles are in degrees",
                remedy=f"write {math.degrees(angle):.6g}, or 0 for no friction; if {angle:g} "
                "degrees is meant, add allow_small_friction_angle = true to the joint",
            )
    return _of_residual(joint)


def _of_residual(joint: Any) -> Contradiction | None:
    """Return the fault in residual strengths: above the peak, or without a peak to fall from."""
    cohesion, angle = joint.residual_cohesion, joint.residual_friction_angle
    if cohesion is not None and cohesion > joint.cohesion:
        return Contradiction(
            key="residual_cohesion",
            what=f"{cohesion:g} Pa are more than the cohesion, {joint.cohesion:g} Pa",
            remedy="give the cohesion after slip, or leave it out: then all of it stays",
        )
    if angle is not None and angle > joint.friction_angle:
        return Contradiction(
            key="residual_friction_angle",
            what=f"{angle:g} degrees are more than the friction angle, {joint.friction_angle:g}",
            remedy="give its value after sliding, or leave it out: then all of it stays",
        )
    if joint.slip_weakening > 0.0 and cohesion is None and angle is None:
        return Contradiction(
            key="slip_weakening",
            what="there is no residual strength for the peak strength to fall to",
            remedy="give residual_friction_angle or residual_cohesion, or leave this out",
        )
    return None


def with_strengths(table: JointTable, changes: Mapping[str, Mapping[str, float]]) -> JointTable:
    """Return the joints with other strengths: ``{"bedding": {"friction_angle": 25.0}}``.

    Cohesion and tensile strength are those of bonds: a contact that has lost its bond gets none.
    """
    joints = tuple(_changed(joint, changes.get(joint.name, {})) for joint in table.joints)
    return replace(table, joints=joints)


def has_bonds(model: Model) -> bool:
    """Return whether any joint has a cohesion or a tensile strength."""
    return any(one.cohesion > 0.0 or one.tensile_strength > 0.0 for one in model.joint_table.joints)


def with_bonds_held(model: Model) -> Model:
    """Return the model with bonds that nothing breaks."""
    joints = tuple(
        replace(one, cohesion=HELD * one.cohesion, tensile_strength=HELD * one.tensile_strength)
        for one in model.joint_table.joints
    )
    return replace(model, joint_table=replace(model.joint_table, joints=joints))


def _changed(joint: Joint, changes: Mapping[str, float]) -> Joint:
    """Return a joint with other strengths."""
    numbers: dict[str, Any] = {key: float(value) for key, value in changes.items()}
    return replace(joint, **numbers)
