"""[damping]: energy taken from all blocks."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from clast.inputs.declaring.alternatives import Alternatives, Choice, Chosen, GivenObject, within
from clast.model import ranges

DAMPINGS = {
    "none": "clast.actions.damping:Undamped",
    "rayleigh": "clast.actions.damping:Rayleigh",
    "adaptive": "clast.actions.damping:Adaptive",
    "kinetic": "clast.actions.damping:Kinetic",
}
MOST = 10.0
"""Largest damping ratio that is meant."""

ALTERNATIVES = Alternatives(
    classes={"damping": DAMPINGS},
    limits={
        "mass": (Field(ge=0.0), within(ranges.RATE)),
        "stiffness": (Field(ge=0.0), within(ranges.INTERVAL)),
        "ratio": (Field(gt=0.0, le=MOST),),
    },
    needs={"damping": ("begin", "share", "finish")},
)
"""Kinds of damping; their numbers are read from their dataclasses."""
DAMPING = Choice("damping", ALTERNATIVES, usual="rayleigh")
"""A name, a table with its numbers, or an object of a script; Rayleigh damping without a name."""
Damping = Annotated[Any, DAMPING]


def chosen_damping(value: Any) -> Chosen | GivenObject:
    """Return the damping that a name, a table or an object makes."""
    return DAMPING.validate(value)
