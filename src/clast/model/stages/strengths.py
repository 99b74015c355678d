"""Strengths of joints that a stage changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from clast.model.model import Joint, JointTable


def with_strengths(table: JointTable, changes: Mapping[str, Mapping[str, float]]) -> JointTable:
    """Return the joints with other strengths: ``{"bedding": {"friction_angle": 25.0}}``.

    Cohesion and tensile strength are those of bonds: a contact that has lost its bond gets none.
    """
    joints = tuple(_changed(joint, changes.get(joint.name, {})) for joint in table.joints)
    return replace(table, joints=joints)


def _changed(joint: Joint, changes: Mapping[str, float]) -> Joint:
    """Return a joint with other strengths."""
    numbers: dict[str, Any] = {key: float(value) for key, value in changes.items()}
    return replace(joint, **numbers)
