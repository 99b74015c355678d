"""A joint set: a table of the case file, checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from clast.errors import ModelError
from clast.model import ranges
from clast.model.model import Floats
from clast.rockmass.joints.joint_models import Parallel
from clast.rockmass.joints.plan import (
    SPACING_FACTOR_MAX,
    JointModel,
    MeanDirection,
    Plan,
    Scatter,
    Window,
    apparent,
    normal_of,
)
from clast.rockmass.joints.spacing_distributions import Scaled, Spacing, check_spacing, number_or

COMMON = ("name", "model", "joint", "within", "seed")
"""Keys that every model takes."""
PERSISTENCE_MIN = 1e-3
"""Least share of their lines that traces may be: others would be drawn for hours."""
TRACE_RADII_MAX = 200.0
"""Longest traces over the radius of the window: nearly all would lie outside of it."""


@dataclass(frozen=True, kw_only=True)
class JointSet:
    """Joints of one kind: directions, spacings, lengths and the model that places them."""

    name: str
    """Name, to which ``terminates_at`` of other sets refers."""
    model: JointModel = field(default_factory=Parallel)
    """Parallel, CrossJointed, Baecher, Veneziano, PoissonLines or Voronoi."""
    joint: str | None = None
    """Joint of its edges; None: that of the pair of blocks, the rocks, or the default."""
    angle: float | None = None
    """Angle of the traces, degrees counter-clockwise from +x."""
    dip: float | None = None
    """Dip of the planes, degrees; with ``dip_direction``, in place of ``angle``."""
    dip_direction: float | None = None
    """Direction of dip, degrees clockwise from north."""
    spacing: float | Spacing | None = None
    """Distance between lines, m."""
    spacing_is: str | None = None
    """"true" (in space) or "apparent" (in the section); must be said where dip is used."""
    trace_length: float | Spacing | None = None
    """Length of the traces, m; None: persistent."""
    bridge_length: float | Spacing | None = None
    """Rock bridge between traces on one line, m; None: traces follow each other."""
    origin: Any = None
    """A line of the set passes here, m, shape (2,); None: the lower left of its window."""
    stagger: float = 0.0
    """Share of trace + bridge (between layers: of the spacing) by which every second is moved."""
    within: Any = None
    """Polygon (k, 2), m, or the name of a region; None: everywhere."""
    terminates_at: Sequence[str] | None = None
    """Sets at whose lines the traces of a cross-jointed set end."""
    intensity: float | None = None
    """Length of joints per area P21, m/m2, in place of a spacing."""
    angle_spread: Scatter | None = None
    """Scatter of directions: VonMises in the section, or Fisher in space."""
    seed: int | None = None
    """Seed of its own; None: the case's seed and the number of the set."""

    @property
    def where(self) -> str:
        """How messages call it."""
        return f"joint_set '{self.name}'"

    def random(self, seed: int, number: int) -> np.random.Generator:
        """Return the source of its random numbers: other sets do not change it."""
        seed = seed if self.seed is None else self.seed
        sequence = np.random.SeedSequence(seed, spawn_key=(number,))
        return np.random.Generator(np.random.PCG64(sequence))

    def check(self) -> None:
        """Refuse keys that do not go together, and numbers that they cannot have."""
        model = self.model
        for key in (one.name for one in fields(self) if one.name not in COMMON):
            value = getattr(self, key)
            is_absent = value == 0.0 if key == "stagger" else value is None
            if not is_absent and key not in model.takes:
                remedy = f"leave it out; the model takes {', '.join(sorted(model.takes))}"
                self._refuse(key, f"is not used by the model {model.name}", remedy)
        for group in model.needs:
            if all(getattr(self, key) is None for key in group):
                what = f"the model {model.name} needs {' or '.join(group)}"
                self._refuse(group[0], what, "give it")
        if self.bridge_length is not None and self.trace_length is None:
            self._refuse("bridge_length", "without trace_length", "give both, or neither")
        if self.intensity is not None and self.spacing is not None:
            self._refuse("intensity", "intensity and spacing are both given", "give one of them")
        self._check_numbers()
        self._check_direction()

    def _check_numbers(self) -> None:
        for key in ("spacing", "trace_length", "bridge_length"):
            spread = number_or(getattr(self, key))
            if spread is not None:
                check_spacing(spread, f"{self.where}, {key}")
        trace, bridge = number_or(self.trace_length), number_or(self.bridge_length)
        if trace is not None and bridge is not None:
            share = trace.mean / (trace.mean + bridge.mean)
            if share < PERSISTENCE_MIN:
                what = f"traces are only {share:.2g} of their lines"
                remedy = f"give bridges up to {1.0 / PERSISTENCE_MIN:g} times as long as traces"
                self._refuse("bridge_length", what, remedy)
        for key in ("angle", "dip", "dip_direction", "stagger", "intensity"):
            value = getattr(self, key)
            number = value if isinstance(value, int | float | np.number) else math.nan
            if value is not None and not math.isfinite(number):
                self._refuse(key, f"{value!r} is not a finite number", "give SI units and degrees")
        if self.intensity is not None:
            if self.intensity <= 0.0:
                self._refuse("intensity", f"{self.intensity:g} must be above 0", "give m per m2")
            where = f"{self.where}, intensity"
            ranges.check_size(self.intensity, ranges.FACTOR, where, "give m/m2")

    def _check_direction(self) -> None:
        if self.angle is not None and (self.dip is not None or self.dip_direction is not None):
            self._refuse("angle", "angle and dip are both given", "give one of them")
        if (self.dip is None) != (self.dip_direction is None):
            self._refuse("dip", "dip and dip_direction belong together", "give both")
        if self.dip is not None and not 0.0 <= self.dip <= 90.0:
            self._refuse("dip", f"{self.dip:g} is not a valid dip", "give degrees from 0 to 90")
        if self.spacing_is is not None and self.spacing_is not in ("true", "apparent"):
            self._refuse("spacing_is", f"{self.spacing_is!r} is unknown", '"true" or "apparent"')
        if self.dip is not None and self.spacing is not None and self.spacing_is is None:
            self._refuse(
                "spacing_is",
                "the spacing may be true (in space) or apparent (in the section)",
                'give spacing_is = "true" (in space) or "apparent" (in the section)',
            )
        if self.angle is not None and self.spacing_is == "true":
            self._refuse(
                "spacing_is",
                "a true spacing needs dip and dip_direction",
                'give them in place of angle, or spacing_is = "apparent"',
            )
        if self.angle_spread is not None:
            self.angle_spread.check(f"{self.where}, angle_spread")
            if self.dip is None and self.angle_spread.in_space:
                self._refuse(
                    "angle_spread",
                    "scatter in space needs dip and dip_direction",
                    "give them in place of angle, or VonMises (scatter in the section)",
                )
            if self.dip is None and self.angle is None:
                self._refuse("angle_spread", "there is no angle to scatter about", "give angle")

    def direction(self, section_azimuth: float | None) -> MeanDirection:
        """Return its direction in the section; ModelError where the section does not show it."""
        if self.dip is None or self.dip_direction is None:
            angle = None if self.angle is None else math.radians(self.angle)
            return MeanDirection(angle=angle, scatter=self.angle_spread)
        if section_azimuth is None:
            remedy = (
                "give domain.section_azimuth: the direction of +x, degrees clockwise from north"
            )
            self._refuse("dip", "the azimuth of the section is not given", remedy)
        azimuth = float(section_azimuth or 0.0)
        angle, factor = apparent(self.dip, self.dip_direction, azimuth)
        if factor > SPACING_FACTOR_MAX:
            self._refuse(
                "dip",
                f"the section is nearly parallel to the set: its spacing there is {factor:.3g} "
                "times the true one",
                "give the set by angle and apparent spacing, or cut along another section_azimuth",
            )
        return MeanDirection(
            angle=math.radians(angle),
            factor=factor,
            normal=normal_of(self.dip, self.dip_direction),
            section_azimuth=azimuth,
            scatter=self.angle_spread,
        )

    def plan(
        self, window: Window, section_azimuth: float | None, origin: Floats, bounds: Floats
    ) -> Plan:
        """Return its numbers in a window of the section about ``origin`` (2,), m."""
        direction = self.direction(section_azimuth)
        spacing = number_or(self.spacing)
        if spacing is not None and self.spacing_is == "true":
            spacing = Scaled(spread=spacing, factor=direction.factor)
        trace, bridge = number_or(self.trace_length), number_or(self.bridge_length)
        if trace is not None and trace.large > TRACE_RADII_MAX * window.radius:
            self._refuse(
                "trace_length",
                f"traces of up to {trace.large:.3g} m are more than {TRACE_RADII_MAX:g} times as "
                f"long as the domain is wide, {window.radius:.3g} m about its middle",
                "for lines without end choose the model parallel without trace_length, or "
                "poisson-lines",
            )
        given = None
        if self.origin is not None:
            try:
                given = np.array(self.origin, dtype=float)
            except (TypeError, ValueError, OverflowError):
                given = np.zeros(0)
            if given.shape != (2,) or not np.isfinite(given).all():
                self._refuse("origin", f"{self.origin!r} is not a point", "give [x, y] in m")
        return Plan(
            direction=direction,
            spacing=spacing,
            intensity=self.intensity,
            trace=trace,
            bridge=bridge,
            origin=window.box[0] if given is None else given - origin,
            stagger=self.stagger,
            bounds=bounds,
            window=window,
        )

    def _refuse(self, key: str, what: str, remedy: str) -> None:
        raise ModelError(what, where=f"{self.where}, {key}", remedy=remedy)
