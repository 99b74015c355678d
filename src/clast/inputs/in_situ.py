"""[in_situ]: the stress in the rock before anything is dug."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from clast.errors import CaseError
from clast.inputs.declaring.choices import Number, within
from clast.inputs.declaring.faults import Fault, refusal
from clast.inputs.declaring.table import Coordinate, Stresses, Table
from clast.model import ranges
from clast.model.in_situ import InSituStress, Overburden

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
    datum: Coordinate | None = None
    """Height y at which the stress holds, m: 0 if absent; the top of the rock for "overburden"."""
    vertical: Literal["overburden"] | None = None
    """In place of a stress: the weight of the rock above, by its mean density."""
    k0: Annotated[Number, Field(ge=0.0), within(ranges.FACTOR)] | None = None
    """Horizontal by vertical stress, with vertical = "overburden"."""
    contacts: Literal["in-equilibrium", "none"] = "in-equilibrium"
    """Whether contacts begin with the forces of the stress, or have to find them by moving."""
    boundary: Literal["roller", "fixed", "traction"] = "roller"
    """What holds the outline beside the stress that loads it: springs along its normal, in both
    directions, or none."""
    sides: list[Side] = Field([])
    """Sides of the box around all blocks that are loaded; all edges on the convex hull if empty."""

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        if (self.stress is None) == (self.vertical is None):
            found = "neither stress nor" if self.stress is None else "both stress and"
            what = f"has {found} vertical"
            remedy = 'give stress, or vertical = "overburden" with k0'
            raise refusal(Fault(what=what, remedy=remedy))
        if (self.vertical is None) != (self.k0 is None):
            what = 'vertical = "overburden" and k0 belong together'
            raise refusal(Fault(what=what, remedy="give both, or a stress"))
        if self.vertical is not None and any(self.gradient):
            what = "the gradient of the overburden is that of the weight"
            raise refusal(Fault(place=("gradient",), what=what, remedy="remove gradient"))
        return self

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


def in_situ_keys(given: InSituStress | Overburden | None) -> dict[str, object]:
    """Return the keys of the table that makes this stress; none where there is none."""
    if given is None:
        return {}
    names = {value: name for name, value in HELD.items()}
    shares = {value: name for name, value in IN_CONTACTS.items()}
    if given.held not in names or given.in_contacts not in shares:
        raise CaseError(
            f"springs {given.held} and a share of {given.in_contacts:g} have no name in a file",
            where="in_situ",
            remedy="run the model itself: clast.simulate(builder.build())",
        )
    keys: dict[str, object] = {
        "contacts": shares[given.in_contacts],
        "boundary": names[given.held],
        "sides": list(given.sides),
    }
    if isinstance(given, Overburden):
        keys |= {"vertical": "overburden", "k0": given.k0}
        return keys if given.datum is None else keys | {"datum": given.datum}
    return keys | {"stress": given.stress, "gradient": given.gradient, "datum": given.datum}
