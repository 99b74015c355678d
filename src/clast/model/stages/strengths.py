"""Strengths of joints that a stage changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from clast.model.model import Joint, JointTable, Model

HELD = 1e9
"""Strength of bonds that nothing breaks, in units of what it is."""


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
