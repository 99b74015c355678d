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


def contradiction(joint: Joint, *, is_small_meant: bool) -> Contradiction | None:
    """Return the fault in the strengths of a joint; None: all is well.

    ``is_small_meant`` says that a friction angle of less than SMALL_ANGLE is one in degrees.
    """
    for key in ("friction_angle", "residual_friction_angle", "kinetic_friction_angle"):
        angle = getattr(joint, key)
        if angle is not None and 0.0 < angle < SMALL_ANGLE and not is_small_meant:
            return Contradiction(
                key=key,
                what=f"{angle:g} looks like radians, but friction angles are in degrees",
                remedy=f"write {math.degrees(angle):.6g}, or 0 for no friction; if {angle:g} "
                "degrees is meant, add allow_small_friction_angle = true to the joint",
            )
    if joint.roughness is not None:
        return _of_roughness(joint)
    return _of_residual(joint) or _of_sliding(joint) or _of_dilation(joint)


def _of_roughness(joint: Joint) -> Contradiction | None:
    """Return the fault in a rough joint that a stage has changed."""
    for key in ("friction_angle", "cohesion", "tensile_strength", "dilation_angle"):
        if getattr(joint, key) != 0.0:
            return Contradiction(
                key=key,
                what='does not belong to law = "barton-bandis"',
                remedy="change residual_friction_angle or strength_reduction",
            )
    for key in ("residual_cohesion", "kinetic_friction_angle"):
        if getattr(joint, key) is not None:
            return Contradiction(
                key=key,
                what='does not belong to law = "barton-bandis"',
                remedy="change residual_friction_angle or strength_reduction",
            )
    return None


def _of_sliding(joint: Joint) -> Contradiction | None:
    """Return the fault in kinetic friction, and in keys of rough joints alone."""
    kinetic = joint.kinetic_friction_angle
    if kinetic is not None and kinetic > joint.friction_angle:
        return Contradiction(
            key="kinetic_friction_angle",
            what=f"{kinetic:g} degrees are more than the friction angle, {joint.friction_angle:g}",
            remedy="give an angle up to that, or leave it out: then they are equal",
        )
    if joint.critical_speed > 0.0 and kinetic is None:
        return Contradiction(
            key="critical_speed",
            what="the joint has no kinetic friction angle",
            remedy="give kinetic_friction_angle, or leave this out",
        )
    if joint.strength_reduction != 1.0:
        return Contradiction(
            key="strength_reduction",
            what='belongs to a joint with law = "barton-bandis"',
            remedy="change friction_angle, cohesion and tensile_strength themselves",
        )
    return None


SMALL_DILATION = 0.35
"""Dilation angles up to this many degrees look like radians (20 degrees are 0.35)."""


def _of_dilation(joint: Joint) -> Contradiction | None:
    """Return the fault in dilation: more than friction can lift."""
    angle = joint.dilation_angle
    if 0.0 < angle < SMALL_DILATION:
        return Contradiction(
            key="dilation_angle",
            what=f"{angle:g} looks like radians, but angles are in degrees",
            remedy=f"write {math.degrees(angle):.6g}, or leave it out",
        )
    if joint.dilation_until is not None and angle == 0.0:
        return Contradiction(
            key="dilation_until",
            what="the joint does not dilate",
            remedy="give dilation_angle, or leave this out",
        )
    angles = joint.friction_angle, joint.residual_friction_angle, joint.kinetic_friction_angle
    least = min(one for one in angles if one is not None)
    if angle > least:
        return Contradiction(
            key="dilation_angle",
            what=f"{angle:g} degrees are more than the least friction angle, {least:g}: sliding "
            "would create energy",
            remedy="give an angle up to that; the friction angle is that of a test, roughness "
            "included",
        )
    return None


def _of_residual(joint: Joint) -> Contradiction | None:
    """Return the fault in residual strengths: above the peak, or not there to fall to."""
    cohesion, angle = joint.residual_cohesion, joint.residual_friction_angle
    if cohesion is not None and cohesion > joint.cohesion:
        return Contradiction(
            key="residual_cohesion",
            what=f"{cohesion:g} Pa are more than the cohesion, {joint.cohesion:g} Pa",
            remedy="give a residual cohesion up to that, or leave it out: then all of it remains",
        )
    if angle is not None and angle > joint.friction_angle:
        return Contradiction(
            key="residual_friction_angle",
            what=f"{angle:g} degrees are more than the friction angle, {joint.friction_angle:g}",
            remedy="give a residual value up to that, or leave it out: then all of it remains",
        )
    if joint.slip_weakening > 0.0 and cohesion is None and angle is None:
        return Contradiction(
            key="slip_weakening",
            what="the joint has no residual strength",
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
