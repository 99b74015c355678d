"""[rock.NAME] and [joint.NAME]: what blocks are made of, and what their contacts bear."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field, StrictBool, StrictStr

from clast.inputs.builder import ModelBuilder
from clast.inputs.declaring.choices import Number, within
from clast.inputs.declaring.table import Positive, Strength, Stresses, Table
from clast.model import ranges


class RockTable(Table):
    """A linear elastic rock."""

    young: Annotated[Positive, within(ranges.MODULUS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(gt=-1.0, le=0.5)]
    """Poisson's ratio, -; below 0.5 in plane strain."""
    density: Annotated[Positive, within(ranges.DENSITY)]
    """Density, kg/m3."""
    initial_stress: Stresses = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the rock, called ``key``."""
        builder.add_rock(key, **dict(self))


class JointTable(Table):
    """Strength and stiffness of contacts along a joint; the joint called default serves others."""

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: Strength = 0.0
    """Cohesion, Pa; it stays while the joint slips, and ends where it opens."""
    tensile_strength: Strength = 0.0
    """Tension cut-off, Pa; tension beyond it ends it and the cohesion."""
    residual_cohesion: Strength | None = None
    """Cohesion left after slip, Pa; 0: brittle, as mortar; else all of it: ideally plastic."""
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

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Add the joint, called ``key``."""
        builder.add_joint(key, **dict(self))
