"""[rock.NAME] and [joint.NAME]: materials of blocks, and strength of their contacts."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Positive, Strength, Stresses, Table
from clast.inputs.declaring.validation_messages import Fault, refusal
from clast.model import joints, model, ranges
from clast.model.stages.strengths import contradiction


class Rock(Table):
    """A linear elastic rock."""

    NAMED: ClassVar[bool] = True

    young: Annotated[Positive, within(ranges.MODULUS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(gt=-1.0, le=0.5)]
    """Poisson's ratio, -; below 0.5 in plane strain."""
    density: Annotated[Positive, within(ranges.DENSITY)]
    """Density, kg/m3."""
    initial_stress: Stresses = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""

    def rock(self, name: str) -> model.Rock:
        """Return it as a rock of the model."""
        return model.Rock(name=name, **dict(self))


class Joint(Table):
    """Strength and stiffness of contacts along a joint; the joint called default serves others."""

    NAMED: ClassVar[bool] = True

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: Strength = 0.0
    """Cohesion, Pa; it stays while the joint slips, and ends where it opens."""
    tensile_strength: Strength = 0.0
    """Tension cut-off, Pa; tension beyond it ends it and the cohesion."""
    residual_cohesion: Strength | None = None
    """Cohesion left after slip, Pa; 0: brittle, as mortar; else all of it: ideally plastic."""
    residual_friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Residual friction angle, degrees; if absent, friction does not weaken."""
    slip_weakening: Annotated[Number, Field(ge=0.0), within(ranges.LENGTH)] = 0.0
    """Way of sliding over which strengths fall from peak to residual, m; 0: at once."""
    restitution: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None
    """Share of the closing velocity with which impacts rebound, 0 to 1; else the process' own."""
    normal_stiffness: Annotated[Positive, within(ranges.JOINT_STIFFNESS)] | None = None
    """Normal stress by closure, Pa/m; else contacts have the spring of method.contact_law."""
    shear_stiffness: Annotated[Positive, within(ranges.JOINT_STIFFNESS)] | None = None
    """Shear stress by slip, Pa/m; else contacts have the spring of method.contact_law."""
    between: list[tuple[StrictStr, StrictStr]] = Field([])
    """Pairs of blocks with this joint between them: [["a", "b"], ...]."""
    between_rocks: list[tuple[StrictStr, StrictStr]] = Field([])
    """Pairs of rocks with this joint between their blocks: [["granite", "granite"], ...]."""
    allow_small_friction_angle: StrictBool = False
    """True where a friction angle below 1.6 is meant in degrees, not in radians."""

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        found = contradiction(self, is_small_meant=self.allow_small_friction_angle)
        if found is not None:
            raise refusal(Fault(place=(found.key,), what=found.what, remedy=found.remedy))
        return self

    def joint(self, name: str) -> joints.Joint:
        """Return it as a joint of the model."""
        return joints.Joint(name=name, **self.model_dump(exclude=PLACES))


PLACES = {"between", "between_rocks", "allow_small_friction_angle"}
"""Keys of a joint for its place, not for its strength."""


def check_rock(rock: model.Rock, plane: model.Plane) -> None:
    """Refuse a Poisson's ratio that is impossible in a plane."""
    if isinstance(plane, model.PlaneStrain) and rock.poisson == 0.5:
        raise ModelError(
            f"{rock.poisson:g} is impossible in plane {plane.name}",
            where=f"rock '{shortened(rock.name)}', poisson",
            remedy="Poisson's ratio is above -1 and below 0.5; rocks have 0.1 to 0.4",
        )
