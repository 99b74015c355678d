"""[flow], [[flow_boundary]], [[well]], [[measured_flow]]: water that flows in joints."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import RefersTo
from clast.inputs.declaring.builder_methods import ByKeys
from clast.inputs.declaring.table import Coordinate, Ends, Length, Point, Positive, Table
from clast.inputs.declaring.validation_messages import check_one, refusal
from clast.inputs.viscous_boundaries import Where
from clast.inputs.water import check_density
from clast.model import ranges

KINDS = ("head", "pressure", "flux", "rain", "seepage", "impermeable")
"""Keys of which a boundary has one."""
WELLS = ("pressure", "head", "rate")
"""Keys of which a well has one."""
CENTIPOISE = 1.0
"""Viscosity, Pa s, from which on it is in another unit."""
KINEMATIC = 1e-5
"""Viscosity, Pa s, below which it is one in m2/s: gases have more."""
SOFT = 1e3
"""Bulk modulus, Pa, below which it is in another unit: water with much air has more."""

CLOUDBURST = 1e-3
"""Rain, m/s, above which it is in another unit."""


class FlowTable(ByKeys):
    """Water that flows in joints with an aperture; blocks are impermeable."""

    state: Literal["steady", "transient", "hydrostatic"] = "steady"
    """Steady flow between boundaries; flow that takes time; or water at rest under a level."""
    coupling: Literal["none", "steady", "full"] = "none"
    """"none": pressures act, and apertures are those of the start; "steady": at the end of a stage
    until equilibrium, or of a static run, apertures and pressures of state "steady" agree; "full":
    blocks open and close joints, and are moved by what flows, of state "transient"."""
    passes: Annotated[int, Field(ge=1, le=100)] = 10
    """Times that a step of "full" is solved again at most, for conductances to agree with it."""
    level: Coordinate | None = None
    """Height y of water at rest, m, of state or initial "hydrostatic"."""
    initial: Literal["steady", "dry", "hydrostatic"] | None = None
    """Water at the start of state "transient": steady flow, if absent, none, or at rest under a
    level."""
    bulk_modulus: Annotated[Positive, within(ranges.MODULUS)] = 2e9
    """Bulk modulus of water, Pa, for flow that takes time."""
    viscosity: Positive = 1e-3
    """Viscosity, Pa s."""
    density: Annotated[Number, within(ranges.DENSITY)] = 1000.0
    """Density, kg/m3."""
    longest: Length | None = None
    """Longest piece of a channel, m; channels are not divided if absent."""
    confined: StrictBool = False
    """True: all joints are full, and pressures may be negative; so it is without gravity."""

    WHEN: ClassVar = {
        "state": {"transient": ("initial", "bulk_modulus"), "hydrostatic": ("level",)},
        "initial": {"hydrostatic": ("level",)},
        "coupling": {"full": ("passes",)},
    }
    BASIC: ClassVar = ("state", "coupling", "level")

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        check_density(self.density)
        if self.viscosity >= CENTIPOISE:
            what = f"{self.viscosity:g} looks like cP, but viscosities are in Pa s"
            remedy = f"write {1e-3 * self.viscosity:g}; water has 1e-3"
            raise refusal(what, remedy, "viscosity")
        if self.viscosity < KINEMATIC:
            what = f"{self.viscosity:g} looks like m2/s, but viscosities are in Pa s"
            remedy = f"write {self.viscosity * self.density:g}; water has 1e-3"
            raise refusal(what, remedy, "viscosity")
        if self.bulk_modulus < SOFT:
            what = f"{self.bulk_modulus:g} looks like GPa, but moduli are in Pa"
            remedy = f"write {1e9 * self.bulk_modulus:g}; water has 2e9"
            raise refusal(what, remedy, "bulk_modulus")
        if self.initial is not None and self.state != "transient":
            remedy = 'leave it out, or give state = "transient"'
            raise refusal('belongs to state = "transient"', remedy, "initial")
        if self.coupling == "full" and self.state != "transient":
            what = f'"full" does not go with state = "{self.state}"'
            remedy = 'give state = "transient": blocks move while water flows'
            raise refusal(what, remedy, "coupling")
        if self.coupling == "steady" and self.state != "steady":
            what = f'"steady" does not go with state = "{self.state}"'
            remedy = 'give state = "steady"; flow that takes time follows blocks by "full"'
            raise refusal(what, remedy, "coupling")
        if "passes" in self.model_fields_set and self.coupling != "full":
            raise refusal('belongs to coupling = "full"', "leave it out", "passes")
        rests = "hydrostatic" in (self.state, self.initial)
        if rests and self.level is None:
            raise refusal("is missing: water at rest has one", "give its height y, m", "level")
        if not rests and self.level is not None:
            remedy = 'give the head of a [[flow_boundary]], or state = "hydrostatic"'
            raise refusal("belongs to water at rest", remedy, "level")
        return self


class FlowWhere(Where):
    """Where a boundary of the flow is: one of these."""

    opening: StrictStr | None = None
    """Opening by its name: its walls, once it is excavated."""

    ONE_OF: ClassVar = {
        'give one of side = "left", edges = [[p, q], ...], polygon and opening': (
            "side",
            "edges",
            "polygon",
            "opening",
        )
    }


class FlowValue(Table):
    """Water at a boundary of the flow: one of these."""

    head: Coordinate | None = None
    """Height y up to which water stands in the joints, m."""
    pressure: Annotated[Number, within(ranges.STRESS)] | None = None
    """Pressure, Pa."""
    flux: Annotated[Number, within(ranges.SPEED)] | None = None
    """Flow into the rock by length of the boundary, m/s."""
    rain: Annotated[Number, Field(ge=0.0), within(ranges.SPEED)] | None = None
    """Rain on the horizontal, m/s; what cannot enter runs off."""
    seepage: Literal[True] | None = None
    """True: faces in air, which give water off and take none."""
    impermeable: Literal[True] | None = None
    """True: no water passes."""

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        # a head may be that of an amplitude
        others = any(getattr(self, key) is not None for key in KINDS[1:])
        if getattr(self, "amplitude", None) is None or others:
            check_one(self, KINDS, f"give one of {', '.join(KINDS)}")
        if self.rain is not None and self.rain > CLOUDBURST:
            what = f"{self.rain:g} m/s is more than any rain: {3.6e6 * self.rain:.3g} mm/h"
            raise refusal(what, "give m/s: 1 mm/h is 2.8e-7", "rain")
        return self

    @property
    def kind(self) -> str:
        """Which of the keys it has."""
        return next((key for key in KINDS if getattr(self, key) is not None), "head")


class FlowBoundary(FlowValue):
    """Head, pressure, flow or faces in air at outer nodes of the joints."""

    name: StrictStr | None = None
    """Name by which stages and results refer to it."""
    where: FlowWhere
    """Which nodes: {side = "left"}, {edges = [[p, q], ...]}, {polygon = [...]} or
    {opening = "tunnel"}."""
    amplitude: StrictStr | None = None
    """The [amplitude.NAME] of heads over time, m, in the place of head."""
    seepage_above: StrictBool = True
    """Whether faces above the head give water off; false: they are tight."""
    presses: StrictBool = True
    """Whether the water presses on outer faces below the head."""

    @model_validator(mode="after")
    def _has_heads_that_change(self) -> Self:
        if self.amplitude is not None and self.kind != "head":
            remedy = "leave it out, or give a head"
            raise refusal("only a head changes with time", remedy, "amplitude")
        return self


class Well(Table):
    """Points of joints from which water is taken, or into which it is put."""

    name: StrictStr
    """Name by which stages and results refer to it."""
    at: Point | None = None
    """Point of a joint [x, y], m."""
    line: Ends | None = None
    """Borehole from a point to another, m: every joint that it crosses."""
    pressure: Annotated[Number, within(ranges.STRESS)] | None = None
    """Pressure, Pa; 0 for a drain."""
    head: Coordinate | None = None
    """Height y to which water stands in it, m."""
    rate: Annotated[Number, within(ranges.SPEED)] | None = None
    """Flow into the rock, m2/s; below 0 out of it."""
    only_outflow: StrictBool = False
    """True for drains: it takes water and gives none."""
    stage: StrictStr | None = None
    """Stage with which it begins; from the start if absent."""

    ONE_OF: ClassVar = {
        "give a point of a joint, or a line that crosses joints": ("at", "line"),
        "give the pressure in it, its head, or a rate": WELLS,
    }

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        if self.only_outflow and self.rate is not None:
            remedy = "leave it out: the sign of the rate says which way"
            raise refusal("does not go with a rate", remedy, "only_outflow")
        return self


class MeasuredFlow(Table):
    """A flow that is recorded every step."""

    name: StrictStr
    """Name."""
    of: Annotated[StrictStr, RefersTo("flow_boundary", "well", "opening")]
    """Boundary, well or opening by its name."""
