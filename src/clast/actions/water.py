"""Water: pressure on outer faces and in joints, as the blocks lie halfway through a step.

    F_i = int T_i^T p n ds,    F_j = -int T_j^T p n ds

A joint's water lies halfway between its two faces, and presses on both with the same p n ds there:
the two forces and their moments cancel to the last bit, whatever the blocks do.  The contact forces
beside it are the effective stress.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import Action, Contribution, StepStart
from clast.actions.loads import pressure_forces
from clast.model.model import Floats, Ints
from clast.model.water import Water, ends_of_faces, faces_of_joints, filled, wetted


@dataclass(frozen=True)
class Pressed:
    """Pressures on parts of lines: of outer faces, or of both faces of joints."""

    edge: Ints
    """Edge of the block to the left of each part, shape (k,)."""
    block: Ints
    """Block that lies to the left of each part, shape (k,)."""
    other: Ints
    """Block to its right, -1 where there is none, shape (k,)."""
    ends: Floats
    """Ends, m, shape (k, 2, 2)."""
    pressure: Floats
    """Pressure at the ends, Pa, shape (k, 2)."""

    def forces(self, centroid: Floats) -> tuple[Floats, Floats]:
        """Return the generalised forces on the blocks to the left and to the right, (k, 6) each."""
        left = pressure_forces(self.ends - centroid[self.block][:, None], self.pressure)
        right = pressure_forces(self.ends - centroid[self.other][:, None], -self.pressure)
        right[self.other < 0] = 0.0
        return left, right


def pressed_by(water: Water, model: Any, vertices: Floats, time: float) -> Pressed:
    """Return where a water presses at a time, s, with blocks at ``vertices`` (nv, 2), m.

    ``model`` may be a frame as well.  Excavated blocks are under no pressure, and the joints that
    they had are empty.
    """
    owner, after = model.vertex_block, model.vertex_after
    weight = water.pressure_of_head(time)
    faces = wetted(water.surface, ends_of_faces(water.faces, vertices, after))
    one, other = faces_of_joints(water.joints, vertices, after)
    joint, ends, lowered = filled(water.joints, one, other)
    joints = wetted(water.surface, ends, lowered)
    sides = water.joints.edge[joint[joints.line]]
    edge = np.concatenate([water.faces.edge[faces.line], sides[:, 0]])
    pair, single = owner[sides], owner[water.faces.edge[faces.line]]
    pressed = Pressed(
        edge,
        np.concatenate([single, pair[:, 0]]),
        np.concatenate([np.full(len(single), -1), pair[:, 1]]),
        np.concatenate([faces.ends, joints.ends]),
        weight * np.concatenate([faces.head, joints.head]),
    )
    absent = model.absent
    if not absent.any():
        return pressed
    there = ~absent[pressed.block] & ((pressed.other < 0) | ~absent[pressed.other])
    return Pressed(*(getattr(pressed, one.name)[there] for one in fields(Pressed)))


@dataclass(frozen=True)
class WaterPressure(Action):
    """The water of the model."""

    entries: ClassVar[Mapping[str, float]] = {"water": 1.0}

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return the sum of the generalised forces of all water on each block."""
        model, midway, time = start.model, start.midway, start.time_of_forces
        pressed = [
            pressed_by(water, model, midway.vertices, time)
            for water in model.water
            if water.pressure_of_head(time)
        ]
        if not pressed:
            return Contribution()
        block, force = sums_on_blocks(pressed, midway.centroid)
        return Contribution(block=block, force=force)


def sums_on_blocks(pressed: Iterable[Pressed], centroid: Floats) -> tuple[Ints, Floats]:
    """Return the blocks that pressures act on, (b,), and the sum of their forces on each, (b, 6).

    One force for each block, in the order of the parts: fewer to be added up later.
    """
    block: list[Ints] = []
    force: list[Floats] = []
    for one in pressed:
        left, right = one.forces(centroid)
        paired = one.other >= 0
        block += [one.block, one.other[paired]]
        force += [left, right[paired]]
    blocks, forces = np.concatenate(block), np.concatenate(force)
    sums: Floats = np.stack(
        [np.bincount(blocks, one, len(centroid)).astype(float) for one in forces.T], axis=1
    )
    some = np.flatnonzero(sums.any(axis=1))
    return some, sums[some]
