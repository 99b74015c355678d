"""Limit analysis of rigid blocks on joints that carry no tension, by linear programming.

A joint carries N1, N2 >= 0 at its two ends and a shear force |V| <= (N1 + N2) tan phi; every block
is in equilibrium, three equations each (Livesley 1978).  By the theorem of limit analysis the
largest load in equilibrium is the collapse load where no joint slips; where joints slip it is an
upper bound (Drucker 1954), for such friction opens a joint as it slips.  With friction that does
not, blocks fail under less, by how much depends on the history of loading (Gilbert, Casapulla and
Ahmed 2006).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats

Bounds = tuple[float | None, None]
"""Least and largest value of an unknown; None: unbounded."""
GROUND = -1
"""Block number of the ground."""


class NoEquilibriumError(ValueError):
    """No forces of the joints are in equilibrium with the loads."""


@dataclass(frozen=True, kw_only=True)
class RigidJoint:
    """A straight joint between two blocks."""

    blocks: tuple[int, int]
    """Block that the normal points into, and the one behind it; GROUND for fixed ground."""
    ends: tuple[Floats, Floats]
    """Its two ends, m, (2,) each."""
    normal: Floats
    """Unit normal into the first block, (2,)."""
    friction_angle: float
    """Friction angle, degrees."""

    @property
    def along(self) -> Floats:
        """Unit vector along the joint, the normal turned clockwise, (2,)."""
        return np.array([self.normal[1], -self.normal[0]])


@dataclass(frozen=True, kw_only=True)
class RigidBlocks:
    """Rigid blocks and the joints between them; unknowns are N1, N2 and V of each of k joints."""

    corners: Sequence[Floats]
    """Corners of each of n blocks, counter-clockwise, m, (c, 2)."""
    joints: Sequence[RigidJoint]
    """The joints."""

    def equilibrium(self) -> Floats:
        """Return force across and up, N/m, and moment, N m/m, on each block by unit unknowns.

        Shape (3 n, 3 k); moments are about the centroids, counter-clockwise.
        """
        matrix = np.zeros((3 * len(self.corners), 3 * len(self.joints)))
        for k, joint in enumerate(self.joints):
            for block, sign in zip(joint.blocks, (1.0, -1.0), strict=True):
                if block == GROUND:
                    continue
                for column, at, force in (
                    (0, joint.ends[0], sign * joint.normal),
                    (1, joint.ends[1], sign * joint.normal),
                    (2, joint.ends[0], sign * joint.along),
                ):
                    load = self.force_at(block, at, force)
                    matrix[:, 3 * k + column] += load
        return matrix

    def friction(self) -> Floats:
        """Return the rows of +-V - (N1 + N2) tan phi, which are <= 0, (2 k, 3 k)."""
        rows = np.zeros((2 * len(self.joints), 3 * len(self.joints)))
        for k, joint in enumerate(self.joints):
            for row, sign in ((2 * k, 1.0), (2 * k + 1, -1.0)):
                rows[row, 3 * k : 3 * k + 2] = -np.tan(np.radians(joint.friction_angle))
                rows[row, 3 * k + 2] = sign
        return rows

    def body_force(self, force: Sequence[float]) -> Floats:
        """Return the loads (3 n,) of a force per area (2,), N/m3."""
        loads = np.zeros(3 * len(self.corners))
        for block, corners in enumerate(self.corners):
            area, _ = centroid(corners)
            loads[3 * block : 3 * block + 2] = area * np.asarray(force)
        return loads

    def force_at(self, block: int, at: Floats, force: Floats) -> Floats:
        """Return the loads (3 n,) of a force (2,), N/m, at a point (2,), m, of a block."""
        loads = np.zeros(3 * len(self.corners))
        x, y = at - centroid(self.corners[block])[1]
        loads[3 * block : 3 * block + 3] = *force, x * force[1] - y * force[0]
        return loads


def largest_factor(blocks: RigidBlocks, dead: Floats, live: Floats) -> float:
    """Return the largest factor of ``live`` that is in equilibrium with ``dead``, loads (3 n,)."""
    friction = np.hstack([blocks.friction(), np.zeros((2 * len(blocks.joints), 1))])
    bounds = [*_signs(blocks), (0.0, None)]
    return -_least(_last_unknown(blocks), friction, blocks, dead, bounds, live)


def least(blocks: RigidBlocks, dead: Floats, cost: Floats) -> float:
    """Return the least sum of ``cost`` times the unknowns (3 k,) in equilibrium with ``dead``."""
    return _least(cost, blocks.friction(), blocks, dead, _signs(blocks))


def reserve(blocks: RigidBlocks, dead: Floats) -> float:
    """Return the largest s, N/m, with N1, N2 >= s in all joints, which do not slip.

    It is not negative where a line of thrust lies inside the joints.
    """
    count = 3 * len(blocks.joints)
    ends = np.flatnonzero(np.arange(count) % 3 != 2)
    above = np.zeros((len(ends), count + 1))
    above[np.arange(len(ends)), ends] = -1.0
    above[:, -1] = 1.0
    free: list[Bounds] = [(None, None)] * (count + 1)
    return -_least(_last_unknown(blocks), above, blocks, dead, free, np.zeros(len(dead)))


def _last_unknown(blocks: RigidBlocks) -> Floats:
    """Return the cost (3 k + 1,) of the largest last unknown, after the forces of k joints."""
    cost = np.zeros(3 * len(blocks.joints) + 1)
    cost[-1] = -1.0
    return cost


def _least(
    cost: Floats,
    above: Floats,
    blocks: RigidBlocks,
    dead: Floats,
    bounds: list[Bounds],
    live: Floats | None = None,
) -> float:
    """Return the least cost.x with above.x <= 0 and the blocks in equilibrium.

    The unknowns are the joint forces (3 k,) and, with ``live``, the factor of these loads (3 n,).
    """
    equilibrium = blocks.equilibrium()
    if live is not None:
        equilibrium = np.hstack([equilibrium, live[:, None]])
    none = np.zeros(len(above))
    optimum = linprog(cost, A_ub=above, b_ub=none, A_eq=equilibrium, b_eq=-dead, bounds=bounds)
    if optimum.x is None:
        raise NoEquilibriumError(optimum.message)
    return float(optimum.fun)


def _signs(blocks: RigidBlocks) -> list[Bounds]:
    """Return the bounds of N1, N2 and V of each joint."""
    return [(0.0, None), (0.0, None), (None, None)] * len(blocks.joints)


def centroid(corners: Floats) -> tuple[float, Floats]:
    """Return area, m2, and centroid, m (2,), of a polygon (k, 2)."""
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - following[:, 0] * corners[:, 1]
    area = 0.5 * cross.sum()
    return float(area), np.sum((corners + following) * cross[:, None], axis=0) / (6.0 * area)


# --- arches ----------------------------------------------------------------------------------


def joint_ends(
    radius: float, share: float, embrace: float, voussoirs: int
) -> tuple[Floats, Floats]:
    """Return the inner and outer ends of the joints of a circular arch, m, (voussoirs + 1, 2) each.

    They go from right to left; ``radius`` is the mean radius, m, ``share`` the thickness over it,
    ``embrace`` the angle between the springings, degrees.
    """
    half = 0.5 * np.radians(embrace)
    angle = 0.5 * np.pi + np.linspace(-half, half, voussoirs + 1)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = 0.5 * share * radius
    return (radius - reach) * direction, (radius + reach) * direction


def corners_between(inner: Floats, outer: Floats) -> list[Floats]:
    """Return the corners (4, 2), m, of each voussoir between joints, by their ends (k + 1, 2)."""
    return [
        np.array([inner[k], outer[k], outer[k + 1], inner[k + 1]]) for k in range(len(inner) - 1)
    ]


def add_voussoirs(builder: InputBuilder, inner: Floats, outer: Floats) -> dict[str, Floats]:
    """Add the voussoirs between joints, by their ends (k + 1, 2), m; return their middles (2,), m.

    Their names are "1" to "k", from right to left.
    """
    middles = {}
    for k, corners in enumerate(corners_between(inner, outer), 1):
        builder.block(name=str(k), vertices=corners)
        middles[str(k)] = corners.mean(axis=0)
    return middles


def voussoirs_between(inner: Floats, outer: Floats, friction_angle: float) -> RigidBlocks:
    """Return the voussoirs between joints, by their ends (k + 1, 2), m, on fixed abutments.

    The normal of each joint points along the arch into the voussoir to its left.
    """
    count = len(inner) - 1
    joints = []
    for k in range(count + 1):
        radial = (outer[k] - inner[k]) / np.hypot(*(outer[k] - inner[k]))
        joints.append(
            RigidJoint(
                blocks=(k if k < count else GROUND, k - 1 if k else GROUND),
                ends=(inner[k], outer[k]),
                normal=np.array([-radial[1], radial[0]]),
                friction_angle=friction_angle,
            )
        )
    return RigidBlocks(corners=corners_between(inner, outer), joints=joints)
