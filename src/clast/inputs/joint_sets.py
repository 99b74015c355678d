"""[[joint_set]]: joints of one kind, by the model that places them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, StrictStr, model_validator

from clast.inputs.declaring.alternatives import Alternatives, Choice, Number
from clast.inputs.declaring.annotations import ANY, Extends, RefersTo
from clast.inputs.declaring.table import OR_TABLE, OR_TEXT, Loop, Point, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.rock_mass import Seed, check_keys

if TYPE_CHECKING:
    from clast.rockmass.joints.joint_set import JointSet

MODELS = {
    "parallel": "clast.rockmass.joints.joint_models:Parallel",
    "cross-jointed": "clast.rockmass.joints.joint_models:CrossJointed",
    "baecher": "clast.rockmass.joints.joint_models:Baecher",
    "veneziano": "clast.rockmass.joints.joint_models:Veneziano",
    "poisson-lines": "clast.rockmass.joints.joint_models:PoissonLines",
    "voronoi": "clast.rockmass.joints.joint_models:Voronoi",
}
ALTERNATIVES = Alternatives(
    classes={"model": MODELS},
    limits={"count": (Field(ge=1, le=10_000_000),), "rounds": (Field(ge=0, le=1000),)},
    needs={"model": ("lines", "takes", "needs", "cells", "blocks")},
)
DISTRIBUTIONS: dict[str, tuple[str, ...]] = {
    "uniform": ("low", "high"),
    "normal": ("mean", "sd"),
    "lognormal": ("mean", "sd"),
    "exponential": ("mean",),
    "values": ("values",),
}
"""Distribution -> its numbers; its class has its name."""


ORIENTED = ("angle", "dip", "angle_spread")
"""Keys of the sets that have a direction."""


class SpreadTable(Table):
    """A distribution of spacings or lengths: all values are above 0."""

    distribution: Literal["uniform", "normal", "lognormal", "exponential", "values"]
    """uniform (low, high), normal (mean, sd), lognormal (mean, sd), exponential (mean) or values
    (a list, repeated).
    """
    mean: Number | None = None
    """Mean of the values, m."""
    sd: Number | None = None
    """Standard deviation of the values, m."""
    low: Number | None = None
    """Smallest value, m."""
    high: Number | None = None
    """Largest value, m."""
    values: list[Number] | None = None
    """Values in their order, m."""

    WHEN: ClassVar = {"distribution": DISTRIBUTIONS}
    BASIC: ClassVar = ("mean", "sd", "low", "high", "values")

    @model_validator(mode="after")
    def _has_its_numbers(self) -> Self:
        given = [k for k in ("mean", "sd", "low", "high", "values") if getattr(self, k) is not None]
        check_keys(given, DISTRIBUTIONS[self.distribution], (), f"{self.distribution} distribution")
        return self

    def build(self) -> Any:
        """Return the distribution."""
        from clast.model import distributions

        kind = getattr(distributions, self.distribution.capitalize())
        return kind(**{key: getattr(self, key) for key in DISTRIBUTIONS[self.distribution]})


class ScatterTable(Table):
    """Scatter of directions in the section about that of the set."""

    distribution: Literal["von-mises"]
    """von-mises (kappa)."""
    kappa: Number
    """Concentration, -: the standard deviation is about 1/sqrt(kappa) radians, 7.4 degrees for
    60."""


Spread = Annotated[Number | SpreadTable, OR_TABLE]


class JointSetTable(Table):
    """Joints of one kind: direction, spacing, lengths, and the model that places them."""

    name: StrictStr
    """Name, to which terminates_at of other sets refers."""
    model: Annotated[Any, Choice("model", ALTERNATIVES)] = "parallel"
    """How lines are placed."""
    joint: StrictStr | None = None
    """Joint of its edges: [joint.NAME]; that of the pair of rocks, or the default, if absent."""
    angle: Annotated[Number, Extends("angle", "origin")] | None = None
    """Angle of the lines counter-clockwise from +x, degrees."""
    dip: Number | None = None
    """Dip of the planes, degrees; with dip_direction and the domain's section_azimuth in place of
    angle."""
    dip_direction: Number | None = None
    """Direction of dip clockwise from north, degrees."""
    spacing: Annotated[Spread, Extends("spacing", "origin")] | None = None
    """Distance between lines, m; a number or a distribution."""
    spacing_is: Literal["true", "apparent"] | None = None
    """"true": spacing in space; "apparent": as seen in the section. Required with dip."""
    trace_length: Spread | None = None
    """Length of traces, m; a number or a distribution; persistent if absent."""
    bridge_length: Spread | None = None
    """Rock bridge between traces on one line, m; a number or a distribution."""
    origin: Point | None = None
    """Point [x, y] on a line of the set, m; the lower left of the domain if absent."""
    stagger: Number = 0.0
    """Shift of every second line, as a share of trace and bridge: 0.5 for a running bond."""
    within: Annotated[Loop | Annotated[StrictStr, RefersTo("region")], OR_TEXT] | None = None
    """Name of a region, or corners [x, y], m, that bound the set; everywhere if absent."""
    terminates_at: list[Annotated[StrictStr, RefersTo("joint_set", "trace")]] | None = None
    """Sets, also of traces, at which the lines of a cross-jointed set terminate."""
    intensity: Number | None = None
    """Length of joints per area P21, m/m2, in place of a spacing."""
    angle_spread: ScatterTable | None = None
    """Scatter of directions in the section: {distribution = "von-mises", kappa = 60}."""
    fisher_kappa: Number | None = None
    """Concentration of directions in space (Fisher), -; in place of angle_spread, with dip."""
    seed: Seed | None = None
    """Its own seed; from the domain's seed and the number of the set if absent."""

    INSTEAD: ClassVar = (
        ("angle", "dip"),
        ("spacing", "intensity"),
        ("angle_spread", "fisher_kappa"),
    )
    WHEN: ClassVar = {
        "model": {
            "parallel": (*ORIENTED, "trace_length", "bridge_length", "origin", "stagger"),
            "cross-jointed": (
                *(*ORIENTED, "trace_length", "bridge_length", "origin", "stagger"),
                "terminates_at",
            ),
            "baecher": (*ORIENTED, "intensity", "trace_length"),
            "veneziano": (*ORIENTED, "intensity", "trace_length", "bridge_length"),
            "poisson-lines": (*ORIENTED, "intensity"),
            "voronoi": (),
        },
        "dip": {ANY: ("dip_direction", "spacing_is", "fisher_kappa")},
    }
    BASIC: ClassVar = ("model", "joint", "dip_direction", "spacing_is", "trace_length")
    RARE: ClassVar = ("stagger",)
    TYPICAL: ClassVar = {
        "angle": (-90.0, 90.0),
        "dip": (0.0, 90.0),
        "dip_direction": (0.0, 360.0),
        "spacing": (0.2, 5.0),
        "intensity": (0.1, 5.0),
        "trace_length": (0.5, 20.0),
        "bridge_length": (0.0, 5.0),
        "fisher_kappa": (20.0, 1000.0),
    }

    @model_validator(mode="after")
    def _has_one_scatter(self) -> Self:
        if self.angle_spread is not None and self.fisher_kappa is not None:
            what = "angle_spread and fisher_kappa are both given"
            raise refusal(what, "give one of them", "fisher_kappa")
        return self

    def build(self) -> JointSet:
        """Return the joint set as it is cut."""
        from clast.rockmass import Fisher, JointSet, VonMises

        values = {key: value for key, value in self if key not in ("model", "fisher_kappa")}
        for key in ("spacing", "trace_length", "bridge_length"):
            if isinstance(values[key], SpreadTable):
                values[key] = values[key].build()
        if self.angle_spread is not None:
            values["angle_spread"] = VonMises(kappa=self.angle_spread.kappa)
        if self.fisher_kappa is not None:
            values["angle_spread"] = Fisher(kappa=self.fisher_kappa)
        model = Choice("model", ALTERNATIVES).validate(self.model)
        return JointSet(model=model.build(), **values)
