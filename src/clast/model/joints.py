"""Joints, and which one a contact lies along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from clast.read_only import kept_property

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

WELD_STRENGTH = 1e18
"""Strength of welded edges, Pa: above every load of a body that strains by less than its size.

A finite number, for a contact may stand for no length of joint, and infinity times 0 is none.
"""


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Strength and stiffness of the contacts along a joint."""

    name: str = "default"
    """Name by which contacts refer to it."""
    friction_angle: float = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: float = 0.0
    """Cohesion of bonds, Pa; it stays while the joint slips, and ends where it opens."""
    tensile_strength: float = 0.0
    """Tension cut-off of bonds, Pa; tension beyond it ends it and the cohesion."""
    residual_cohesion: float | None = None
    """Cohesion left where a bond has slipped, Pa; None: all of it, the joint is ideally plastic.

    A joint that has one is brittle: with its first slip a bond loses its tensile strength, too.
    """
    residual_friction_angle: float | None = None
    """Residual friction angle, degrees; None: friction does not weaken."""
    slip_weakening: float = 0.0
    """Way of sliding over which peak strengths fall to the residual ones, m; 0: at once."""
    restitution: float | None = None
    """Share of the closing velocity with which impacts rebound, 0 to 1; None: the process' own."""
    normal_stiffness: float | None = None
    """k_n, normal stress by closure, Pa/m; None: contacts have the springs of the contact law."""
    shear_stiffness: float | None = None
    """k_s, shear stress by slip, Pa/m; None: that of the contact law."""


@dataclass(frozen=True, kw_only=True)
class JointTable:
    """The joint of a contact: by pair of blocks, edge, pair of rocks, else the first."""

    joints: tuple[Joint, ...]
    """All joints; the first is the default."""
    rock_pair: Ints
    """Joint index for each pair of rocks, symmetric, shape (rocks, rocks)."""
    block_pair: Ints
    """Pairs of blocks (lower, higher) with a joint of their own, sorted, shape (k, 2)."""
    block_pair_joint: Ints
    """Joint index of each such pair, shape (k,)."""

    @kept_property
    def strengths(self) -> tuple[Floats, Floats, Floats]:
        """tan(phi), cohesion, Pa, and tensile strength, Pa, of all joints, shape (joints,) each."""
        return (
            np.tan(np.radians([one.friction_angle for one in self.joints])),
            np.array([one.cohesion for one in self.joints], float),
            np.array([one.tensile_strength for one in self.joints], float),
        )

    @kept_property
    def binds(self) -> bool:
        """Whether any joint has cohesion, after a slip either, or tensile strength."""
        return bool(np.nan_to_num([*self.strengths[1:], self.residual_cohesion]).any())

    @kept_property
    def integrated(self) -> Bools:
        """True for joints whose faces are integrated (contact/joints/faces.py), shape (joints,).

        Those with a stiffness or a strength per area, but no weld, which gives way to nothing.
        """
        own = self.strengths[1:]
        bonded = (np.max(own, axis=0) > 0.0) & (np.min(own, axis=0) < WELD_STRENGTH)
        return bonded | ~np.isnan(self.stiffnesses).all(axis=0)

    @kept_property
    def integrates(self) -> bool:
        """Whether the faces of any joint are integrated."""
        return bool(self.integrated.any())

    @kept_property
    def restitutions(self) -> Floats:
        """Restitution of each joint, nan where the process has it, shape (joints,)."""
        return np.array([one.restitution for one in self.joints], float)

    @kept_property
    def residual_cohesion(self) -> Floats:
        """Cohesion left after slip, Pa, nan where slip leaves bonds whole, shape (joints,)."""
        return np.array([one.residual_cohesion for one in self.joints], float)

    @kept_property
    def residual_friction(self) -> Floats:
        """tan(phi) left after slip, nan where slip leaves friction as it is, shape (joints,)."""
        angles = np.array([one.residual_friction_angle for one in self.joints], float)
        return np.tan(np.radians(angles))

    @kept_property
    def slip_weakening(self) -> Floats:
        """Way of sliding over which peak strengths fall to the residual ones, m, (joints,)."""
        return np.array([one.slip_weakening for one in self.joints], float)

    @kept_property
    def weakens(self) -> bool:
        """Whether any joint loses friction, or little by little cohesion, as it slides."""
        return bool((~np.isnan(self.residual_friction) | (self.slip_weakening > 0.0)).any())

    @kept_property
    def stiffnesses(self) -> tuple[Floats, Floats]:
        """k_n and k_s of all joints, Pa/m, nan where the contact law has it, (joints,) each."""
        return (
            np.array([one.normal_stiffness for one in self.joints], float),
            np.array([one.shear_stiffness for one in self.joints], float),
        )

    def of_pairs(self, block_rock: Ints, pairs: Ints) -> tuple[Ints, Bools]:
        """Return the joint of each pair of blocks (q, 2), and whether it names the blocks, (q,).

        ``block_rock`` (n,) is the rock of each block.
        """
        joint = self.rock_pair[block_rock[pairs[:, 0]], block_rock[pairs[:, 1]]]
        if len(self.block_pair) == 0:
            return joint, np.zeros(len(pairs), np.bool_)
        width = len(block_rock)
        own = self.block_pair[:, 0] * width + self.block_pair[:, 1]
        wanted = pairs[:, 0] * width + pairs[:, 1]
        at = np.minimum(np.searchsorted(own, wanted), len(own) - 1)
        named = own[at] == wanted
        return np.where(named, self.block_pair_joint[at], joint), named
