"""Joints, and which one a contact lies along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.arrays import Bools, Floats, Ints
from clast.read_only import kept_property

WELD_STRENGTH = 1e18
"""Strength of welded edges, Pa: above every load of a body that strains by less than its size.

A finite number, for a contact may stand for no length of joint, and infinity times 0 is none.
"""


WEAKENING_SLIP_MIN = 1e-12
"""Way of sliding, m, after which a joint that weakens at once has its residual strength."""
SMOOTH_SLIP = 100.0
"""Slip after which nothing of a roughness is left, in units of that at peak strength."""
MOBILISED: Floats = np.array(
    [[0.3, 0.6, 1.0, 2.0, 4.0, 10.0, 25.0, SMOOTH_SLIP], [0.0, 0.75, 1.0, 0.85, 0.7, 0.5, 0.4, 0.0]]
)
"""Slip over that at peak strength, and JRC mobilised over JRC (Barton, Bandis & Bakhtar 1985).

Before the first of them friction rises from none to the residual one.
"""


@dataclass(frozen=True, kw_only=True)
class BartonBandis:
    """Roughness of a joint and strength of its walls (Barton & Choubey 1977)."""

    jrc: float
    """Joint roughness coefficient of a sample, 0 to 20."""
    jcs: float
    """Compressive strength of the joint's walls, of a sample, Pa."""
    sample_length: float = 0.1
    """Length L_0 of the sample that they belong to, m."""
    field_length: float | None = None
    """Length L_n between cross joints for which they are scaled, m; None: that of the sample."""
    initial_aperture: float | None = None
    """Opening of the joint under no stress, m; None: JRC/50 mm, of walls that are not weathered."""
    initial_stiffness: float | None = None
    """Normal stiffness under no stress k_ni, Pa/m; None: from JRC, JCS and aperture."""

    @property
    def length(self) -> float:
        """L_n, m."""
        return self.sample_length if self.field_length is None else self.field_length

    @property
    def scaled_jrc(self) -> float:
        """JRC_n = JRC_0 (L_n/L_0)^(-0.02 JRC_0) (Bandis et al. 1981)."""
        return self.jrc * (self.length / self.sample_length) ** (-0.02 * self.jrc)

    @property
    def scaled_jcs(self) -> float:
        """JCS_n = JCS_0 (L_n/L_0)^(-0.03 JRC_0), Pa (Bandis et al. 1981)."""
        return self.jcs * (self.length / self.sample_length) ** (-0.03 * self.jrc)

    @property
    def peak_slip(self) -> float:
        """Slip at peak strength (L_n/500) (JRC_n/L_n)^0.33, m (Barton & Bandis 1982)."""
        return self.length / 500.0 * (self.scaled_jrc / self.length) ** 0.33

    @property
    def _walls(self) -> float:
        """JCS_n over the initial aperture, MPa/mm."""
        aperture = self.initial_aperture
        millimetres = self.jrc / 50.0 if aperture is None else 1e3 * aperture
        return 1e-6 * self.scaled_jcs / millimetres

    @property
    def stiffness(self) -> float:
        """k_ni = -7.15 + 1.75 JRC + 0.02 JCS/a_j, MPa/mm (Bandis et al. 1983), or given; Pa/m."""
        if self.initial_stiffness is not None:
            return self.initial_stiffness
        return 1e9 * (-7.15 + 1.75 * self.scaled_jrc + 0.02 * self._walls)

    @property
    def closure(self) -> float:
        """V_m, m: -0.296 - 0.0056 JRC + 2.241 (JCS/a_j)^-0.245, mm, or as given.

        Of the first cycle of loading (Bandis et al. 1983).
        """
        return 1e-3 * (-0.296 - 0.0056 * self.scaled_jrc + 2.241 * self._walls**-0.245)


SMOOTHEST = 0.033
"""Relative roughness up to which a joint is hydraulically smooth (Louis 1969)."""


def _cubic(aperture: Floats, hydraulics: Hydraulics) -> Floats:
    """Return E/f^(1/3) (Witherspoon et al. 1980)."""
    return np.asarray(aperture / hydraulics.flow_factor ** (1.0 / 3.0))


def _barton(aperture: Floats, hydraulics: Hydraulics) -> Floats:
    """Return min(E, E^2/JRC^2.5), in micrometres (Barton, Bandis & Bakhtar 1985)."""
    rough: Floats = 1e6 * aperture**2 / hydraulics.jrc**2.5
    return np.minimum(aperture, rough)


def _louis(aperture: Floats, hydraulics: Hydraulics) -> Floats:
    """Return E (1 + 8.8 r^1.5)^(-1/3) (Louis 1969)."""
    factor = 1.0 + 8.8 * hydraulics.relative_roughness**1.5
    return np.asarray(aperture / factor ** (1.0 / 3.0))


HYDRAULIC_LAWS = {"cubic": _cubic, "barton": _barton, "louis": _louis}
"""Hydraulic aperture of a mechanical one, m, by the name of the law; the first is the usual one."""


@dataclass(frozen=True, kw_only=True)
class Hydraulics:
    """How water flows along a joint."""

    aperture: float
    """Mechanical aperture under no stress, m."""
    residual: float
    """Least hydraulic aperture, m."""
    maximum: float
    """Largest hydraulic aperture, m."""
    law: str = "cubic"
    """Law of the hydraulic aperture."""
    flow_factor: float = 1.0
    """f of the law "cubic"."""
    jrc: float = 0.0
    """Roughness of the law "barton"."""
    relative_roughness: float = 0.0
    """Height of asperities over twice the aperture, of the law "louis"."""

    def of(self, aperture: Floats) -> Floats:
        """Return the hydraulic apertures of mechanical ones, m, of the same shape."""
        opened = HYDRAULIC_LAWS[self.law](np.maximum(aperture, 0.0), self)
        return np.clip(opened, self.residual, self.maximum)


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
    kinetic_friction_angle: float | None = None
    """Friction angle of a contact that slides, degrees; None: the same as of one that stands."""
    critical_speed: float = 0.0
    """Sliding speed from which friction is kinetic, m/s; 0: at once."""
    dilation_angle: float = 0.0
    """Angle at which a joint opens as it slides, degrees."""
    dilation_until: float | None = None
    """Slide to either side at which it no longer opens, m; None: it goes on."""
    roughness: BartonBandis | None = None
    """Roughness of a joint after Barton and Bandis, whose friction angle is then the residual one;
    None: the joint has Coulomb's strength."""
    strength_reduction: float = 1.0
    """Divisor of the tangent of the mobilised friction angle of a rough joint."""
    restitution: float | None = None
    """Share of the closing velocity with which impacts rebound, 0 to 1; None: the process' own."""
    normal_stiffness: float | None = None
    """k_n, normal stress by closure, Pa/m; None: contacts have the springs of the contact law."""
    shear_stiffness: float | None = None
    """k_s, shear stress by slip, Pa/m; None: that of the contact law."""
    hydraulics: Hydraulics | None = None
    """How water flows along it; None: no water enters it."""

    @property
    def aperture_without_stress(self) -> float:
        """Mechanical aperture under no stress, m, 0 where no water enters it."""
        return self.hydraulics.aperture if self.hydraulics else 0.0


@dataclass(frozen=True)
class RoughnessTable:
    """Roughness and walls of joints, shape (joints,) each."""

    jrc: Floats
    """JRC_n."""
    jcs: Floats
    """JCS_n, Pa."""
    residual: Floats
    """Residual friction angle, rad."""
    peak_slip: Floats
    """Slip at peak strength, m."""
    stiffness: Floats
    """k_ni, Pa/m."""
    closure: Floats
    """V_m, m."""
    reduction: Floats
    """Divisor of tan(phi)."""


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

    def _all(self, key: str) -> Floats:
        """Return a number of all joints, nan where one has none, shape (joints,)."""
        return np.array([getattr(one, key) for one in self.joints], float)

    @kept_property
    def strengths(self) -> tuple[Floats, Floats, Floats]:
        """tan(phi), cohesion, Pa, and tensile strength, Pa, of all joints, shape (joints,) each."""
        tangent = np.tan(np.radians(self._all("friction_angle")))
        return tangent, self._all("cohesion"), self._all("tensile_strength")

    @kept_property
    def binds(self) -> bool:
        """Whether any joint has cohesion, after a slip either, or tensile strength."""
        return bool(np.nan_to_num([*self.strengths[1:], self.residual_cohesion]).any())

    @kept_property
    def integrated(self) -> Bools:
        """True for joints whose faces are integrated (contact/joints/faces.py), shape (joints,).

        Those with a stiffness or a strength per area, but no weld, which gives way to nothing.
        """
        bonded = (np.max(self.strengths[1:], axis=0) > 0.0) & ~self.welds
        return bonded | ~np.isnan(self.stiffnesses).all(axis=0)

    @kept_property
    def welds(self) -> Bools:
        """True for joints that stand for none: their bonds never break, shape (joints,)."""
        return np.asarray(np.min(self.strengths[1:], axis=0) >= WELD_STRENGTH)

    @kept_property
    def conducts(self) -> Bools:
        """True for joints that water can flow along, shape (joints,)."""
        wet = [one.hydraulics is not None for one in self.joints]
        return np.asarray(np.array(wet, np.bool_) & ~self.welds)

    @kept_property
    def integrates(self) -> bool:
        """Whether the faces of any joint are integrated."""
        return bool(self.integrated.any())

    @kept_property
    def restitutions(self) -> Floats:
        """Restitution of each joint, nan where the process has it, shape (joints,)."""
        return self._all("restitution")

    @kept_property
    def residual_cohesion(self) -> Floats:
        """Cohesion left after slip, Pa, nan where slip leaves bonds whole, shape (joints,)."""
        return self._all("residual_cohesion")

    @kept_property
    def residual_friction(self) -> Floats:
        """tan(phi) left after slip, nan where slip leaves friction as it is, shape (joints,)."""
        angles = [None if one.roughness else one.residual_friction_angle for one in self.joints]
        return np.tan(np.radians(np.array(angles, float)))

    @kept_property
    def slip_weakening(self) -> Floats:
        """Way of sliding over which peak strengths fall to the residual ones, m, (joints,)."""
        return self._all("slip_weakening")

    @kept_property
    def worn_after(self) -> Floats:
        """Way of sliding after which nothing but residual strength is left, m, shape (joints,)."""
        smooth = [
            one.roughness.peak_slip * SMOOTH_SLIP if one.roughness else one.slip_weakening
            for one in self.joints
        ]
        return np.maximum(smooth, WEAKENING_SLIP_MIN)

    @kept_property
    def weakens(self) -> bool:
        """Whether any joint loses friction, or little by little cohesion, as it slides."""
        weak = ~np.isnan(self.residual_friction) | (self.slip_weakening > 0.0)
        return bool((weak | self.rough).any())

    @kept_property
    def kinetic_friction(self) -> Floats:
        """tan(phi) in sliding, nan where it is that at rest, shape (joints,)."""
        return np.tan(np.radians(self._all("kinetic_friction_angle")))

    @kept_property
    def critical_speed(self) -> Floats:
        """Speed of sliding from which friction is the kinetic one, m/s, shape (joints,)."""
        return self._all("critical_speed")

    @kept_property
    def has_kinetic_friction(self) -> bool:
        """Whether the friction of any joint depends on the speed of sliding."""
        return not bool(np.isnan(self.kinetic_friction).all())

    @kept_property
    def dilation(self) -> tuple[Floats, Floats]:
        """tan(psi), and the slide until which joints open, m, inf for no limit, (joints,) each."""
        until = np.nan_to_num(self._all("dilation_until"), nan=np.inf, posinf=np.inf)
        return np.tan(np.radians(self._all("dilation_angle"))), until

    @kept_property
    def rough(self) -> Bools:
        """True for joints with a roughness, shape (joints,)."""
        return np.array([one.roughness is not None for one in self.joints], np.bool_)

    @kept_property
    def roughness(self) -> RoughnessTable:
        """Roughness and walls of all joints, nan for those that have none."""
        nothing = (np.nan,) * 7
        rows = [
            (
                one.roughness.scaled_jrc,
                one.roughness.scaled_jcs,
                np.radians(one.residual_friction_angle or 0.0),
                one.roughness.peak_slip,
                one.roughness.stiffness,
                one.roughness.closure,
                one.strength_reduction,
            )
            if one.roughness
            else nothing
            for one in self.joints
        ]
        return RoughnessTable(*np.array(rows, float).T.copy())

    @kept_property
    def opens(self) -> bool:
        """Whether any joint is rough, or opens as it slides."""
        return bool(self.rough.any() or self.dilation[0].any())

    @kept_property
    def dilates(self) -> Bools:
        """True for joints that open as they slide, shape (joints,)."""
        return np.asarray(self.rough | (self.dilation[0] > 0.0))

    @kept_property
    def stiffnesses(self) -> tuple[Floats, Floats]:
        """k_n and k_s of all joints, Pa/m, nan where the contact law has it, (joints,) each.

        k_n of a rough joint is that under no stress.
        """
        normal = [
            one.roughness.stiffness if one.roughness else one.normal_stiffness
            for one in self.joints
        ]
        return np.array(normal, float), self._all("shear_stiffness")

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
