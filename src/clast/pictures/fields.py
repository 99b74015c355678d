"""Quantities that can colour the blocks of a picture, with labels, units and colours."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Floats
from clast.results import Recording

Values: TypeAlias = Callable[[Recording, int], Floats]


@dataclass(frozen=True)
class PictureField:
    """A scalar field of the blocks."""

    label: str
    """Its name on the picture."""
    unit: str
    """Unit of the values; the picture may put a prefix before it."""
    values: Values
    """Gives the values (n,) of a frame."""


def _plain(name: str) -> Values:
    return lambda results, frame: results.field(name, frame)


def _magnitude(name: str) -> Values:
    return lambda results, frame: np.hypot(*results.field(name, frame).T)


def _degrees(results: Recording, frame: int) -> Floats:
    return np.degrees(results.field("rotation", frame))


SCALARS = {
    "displacement": PictureField("Displacement", "m", _magnitude("displacement")),
    "displacement_x": PictureField("Displacement in x", "m", _plain("displacement_x")),
    "displacement_y": PictureField("Displacement in y", "m", _plain("displacement_y")),
    "velocity": PictureField("Velocity", "m/s", _magnitude("velocity")),
    "velocity_x": PictureField("Velocity in x", "m/s", _plain("velocity_x")),
    "velocity_y": PictureField("Velocity in y", "m/s", _plain("velocity_y")),
    "rotation": PictureField("Rotation", "°", _degrees),
    "sigma_xx": PictureField(r"Stress $\sigma_{xx}$", "Pa", _plain("sigma_xx")),
    "sigma_yy": PictureField(r"Stress $\sigma_{yy}$", "Pa", _plain("sigma_yy")),
    "sigma_xy": PictureField(r"Shear stress $\sigma_{xy}$", "Pa", _plain("sigma_xy")),
    "sigma_1": PictureField(r"Largest principal stress $\sigma_1$", "Pa", _plain("sigma_1")),
    "sigma_3": PictureField(r"Smallest principal stress $\sigma_3$", "Pa", _plain("sigma_3")),
    "max_shear": PictureField("Largest shear stress", "Pa", _plain("max_shear")),
}
"""Fields with a scale."""

KINDS = {
    "rock": "Rock",
    "block": "Blocks",
    "joint": "Edges by joint",
    "none": "Blocks",
}
"""Fields that tell kinds apart, and that which colours nothing."""


def check_field(name: str, more: Iterable[str] = ()) -> None:
    """Raise CaseError for a field that no picture knows; ``more`` are those of joints."""
    known = (*SCALARS, *KINDS, *more)
    if name not in known:
        close = spelling.nearest(name, known)
        every = f"the fields are: {', '.join(known)}"  # they are listed nowhere else in a terminal
        raise CaseError(
            f"there is no field '{name}'",
            remedy=f"did you mean '{close}'?" if close else every,
        )


PREFIXES = {-3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """Return a factor and a unit with a prefix that make ``largest`` a number from 1 to 1000."""
    if unit in ("°", "%") or not math.isfinite(largest) or largest == 0.0:
        return 1.0, unit
    thousands = math.floor(math.log10(abs(largest) * (1 + 1e-12)) / 3.0)
    # Nobody says kilometres of displacement, nor kilometres per second.
    highest = 0 if unit.startswith("m") else max(PREFIXES)
    thousands = max(min(PREFIXES), min(highest, thousands))
    return 10.0 ** (-3 * thousands), f"{PREFIXES[thousands]}{unit}"


def round_below(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above ``value`` > 0."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-12))
