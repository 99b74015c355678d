"""[in_situ]: the stress in the rock before anything is dug."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from clast.errors import CaseError, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, Extends
from clast.inputs.declaring.builder_methods import record_of
from clast.inputs.declaring.table import Coordinate, Stresses, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.model import ranges
from clast.model.model import Floats
from clast.model.surroundings import InSituStress

HELD = {"roller": (1.0, 0.0), "fixed": (1.0, 1.0), "traction": (0.0, 0.0)}
"""Springs of the outline along its normal and along itself, by the name of the boundary."""
IN_CONTACTS = {"in-equilibrium": 1.0, "none": 0.0}
"""Share of the stress that contacts begin with."""

Side = Literal["left", "right", "bottom", "top"]


class InSituTable(Table):
    """Stress that blocks and contacts begin with, and that loads the outline."""

    stress: Stresses | None = None
    """Stress [xx, yy, xy] at the datum, Pa, tension positive."""
    gradient: Stresses = (0.0, 0.0, 0.0)
    """Its change by metre of depth below the datum, Pa/m."""
    datum: Annotated[Coordinate, Extends("level")] | None = None
    """Height y at which the stress holds, m: 0 if absent; the top of the rock for "overburden"."""
    vertical: Literal["overburden"] | None = None
    """In place of a stress: the weight of the rock above, by its mean density."""
    k0: Annotated[Number, Field(ge=0.0), within(ranges.FACTOR)] | None = None
    """Horizontal by vertical stress, -, with vertical = "overburden"."""
    contacts: Literal["in-equilibrium", "none"] = "in-equilibrium"
    """Whether contacts begin with the forces of the stress, or have to find them by moving."""
    boundary: Literal["roller", "fixed", "traction"] = "roller"
    """Support of the outline beside the stress that loads it: springs along its normal, in both
    directions, or none."""
    sides: list[Side] = Field([])
    """Sides of the box around all blocks that are loaded; all edges on the convex hull if empty."""

    ONE_OF: ClassVar = {'give stress, or vertical = "overburden" with k0': ("stress", "vertical")}
    WHEN: ClassVar = {"stress": {ANY: ("gradient",)}, "vertical": {"overburden": ("k0",)}}
    BASIC: ClassVar = ("gradient", "k0", "datum")
    TYPICAL: ClassVar = {"k0": (0.3, 3.0)}

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        if (self.vertical is None) != (self.k0 is None):
            what = 'vertical = "overburden" and k0 belong together'
            raise refusal(what, "give both, or a stress")
        if self.vertical is not None and any(self.gradient):
            what = "the gradient of the overburden is that of the weight"
            raise refusal(what, "remove gradient", "gradient")
        return self

    @classmethod
    def keys_of(cls, value: Any) -> dict[str, Any] | None:
        """Return the keys that make the stress of a script; springs may have no name in a file."""
        names = {springs: name for name, springs in HELD.items()}
        shares = {share: name for name, share in IN_CONTACTS.items()}
        if tuple(value.held) not in names or value.in_contacts not in shares:
            raise CaseError(
                f"springs {value.held} and a share of {value.in_contacts:g} have no name in a file",
                where="in_situ",
                remedy="run the model itself: clast.simulate(builder.build())",
            )
        keys = {"contacts": shares[value.in_contacts], "boundary": names[tuple(value.held)]}
        return {**keys, **_numbers(value)}

    @classmethod
    def judge(cls, value: Any, key: str) -> None:
        """Refuse an object that is not a stress, and one that only differs by its springs."""
        if not isinstance(value, InSituStress | Overburden):
            what = f"{shortened(repr(value))} is not a valid in-situ stress"
            remedy = "give the keys of [in_situ], clast.InSituStress or clast.Overburden"
            raise ModelError(what, where=key, remedy=remedy)
        record_of(cls, _numbers(value), (key,))
        if not (_is_within(value.held, 2, np.inf) and _is_within([value.in_contacts], 1, 1.0)):
            raise ModelError(
                f"springs {shortened(repr(value.held))} and a share of "
                f"{shortened(repr(value.in_contacts))} cannot be",
                where=f"[{key}] held, in_contacts",
                remedy="give held = (along the normal, along itself), 0 or more, and in_contacts "
                "from 0 to 1",
            )

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Give the builder the stress."""
        in_contacts, held = IN_CONTACTS[self.contacts], HELD[self.boundary]
        if self.k0 is not None:
            builder.in_situ = Overburden(
                k0=self.k0,
                datum=self.datum,
                in_contacts=in_contacts,
                held=held,
                sides=tuple(self.sides),
            )
        elif self.stress is not None:
            builder.in_situ = InSituStress(
                stress=self.stress,
                gradient=self.gradient,
                datum=self.datum or 0.0,
                in_contacts=in_contacts,
                held=held,
                sides=tuple(self.sides),
            )


def _is_within(values: Any, count: int, most: float) -> bool:
    """Return whether these are so many finite numbers from 0 to ``most``."""
    try:
        numbers = np.array(values, np.float64)
    except (TypeError, ValueError, OverflowError):
        return False
    within = np.isfinite(numbers) & (numbers >= 0.0) & (numbers <= most)
    return numbers.shape == (count,) and bool(within.all())


def _numbers(value: InSituStress | Overburden) -> dict[str, Any]:
    """Return the keys of the table that are numbers and sides of a stress of a script."""
    keys: dict[str, Any] = {"sides": value.sides}
    if isinstance(value, Overburden):
        keys = {**keys, "vertical": "overburden", "k0": value.k0}
        return keys if value.datum is None else {**keys, "datum": value.datum}
    return {**keys, "stress": value.stress, "gradient": value.gradient, "datum": value.datum}


@dataclass(frozen=True, kw_only=True)
class Overburden:
    """The stress of the rock's own weight: rho g z down and k0 rho g z across, compression."""

    k0: float
    """Horizontal by vertical stress."""
    datum: float | None = None
    """Height y of the ground surface, m; None: the highest point of all blocks."""
    in_contacts: float = 1.0
    """As InSituStress has it."""
    held: tuple[float, float] = (1.0, 0.0)
    """As InSituStress has it."""
    sides: tuple[str, ...] = ()
    """As InSituStress has it."""

    def stress(self, density: float, gravity: Floats, top: float) -> InSituStress:
        """Return the stress for a mean density, kg/m3, gravity (x, y), m/s2, and a top, m."""
        if gravity[0] != 0.0 or gravity[1] >= 0.0:
            what = f"gravity is [{gravity[0]:g}, {gravity[1]:g}], not downwards"
            remedy = "give stress and gradient instead of the overburden"
            raise ModelError(what, where="in_situ, vertical", remedy=remedy)
        if self.datum is not None and self.datum < top:
            raise ModelError(
                f"{self.datum:g} m is below the highest block, {top:g} m: the rock above it would "
                "be in tension",
                where="in_situ, datum",
                remedy="give the height y of the ground surface, or leave it out",
            )
        vertical = density * float(gravity[1])
        return InSituStress(
            stress=(0.0, 0.0, 0.0),
            gradient=(self.k0 * vertical, vertical, 0.0),
            datum=top if self.datum is None else self.datum,
            in_contacts=self.in_contacts,
            held=self.held,
            sides=self.sides,
        )
