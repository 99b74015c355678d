"""Quantities that colour a picture: labels, units, colours, and where their scale ends.

A scale ends at the largest value, unless a few blocks would spoil it: where some that make up less
than a hundredth of the area have values more than three times those of all others, it ends before
them, and the colour bar shows by its pointed end that values go on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Floats
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.colors import Colormap


@dataclass(frozen=True)
class Field:
    """A quantity that colours blocks or joints."""

    label: str
    """Its name on the picture."""
    unit: str
    """Unit of the values; the picture may put a prefix before it."""
    values: Callable[[Recording, int], Any]
    """Gives the values (n,) of the blocks in a frame, or the faces of joints with theirs."""
    from_zero: bool = True
    """Whether its scale holds zero: heads are compared with each other."""


def _column(name: str) -> Callable[[Recording, int], Floats]:
    return lambda results, frame: results.field(name, frame)


def _magnitude(name: str) -> Callable[[Recording, int], Floats]:
    return lambda results, frame: np.hypot(*results.field(name, frame).T)


SCALARS = {
    "displacement": Field("Displacement", "m", _magnitude("displacement")),
    "displacement_x": Field("Displacement in x", "m", _column("displacement_x")),
    "displacement_y": Field("Displacement in y", "m", _column("displacement_y")),
    "velocity": Field("Velocity", "m/s", _magnitude("velocity")),
    "velocity_x": Field("Velocity in x", "m/s", _column("velocity_x")),
    "velocity_y": Field("Velocity in y", "m/s", _column("velocity_y")),
    "rotation": Field(
        "Rotation", "°", lambda results, frame: np.degrees(results.field("rotation", frame))
    ),
    "sigma_xx": Field(r"Stress $\sigma_{xx}$", "Pa", _column("sigma_xx")),
    "sigma_yy": Field(r"Stress $\sigma_{yy}$", "Pa", _column("sigma_yy")),
    "sigma_xy": Field(r"Shear stress $\sigma_{xy}$", "Pa", _column("sigma_xy")),
    "sigma_1": Field(r"Largest principal stress $\sigma_1$", "Pa", _column("sigma_1")),
    "sigma_3": Field(r"Smallest principal stress $\sigma_3$", "Pa", _column("sigma_3")),
    "max_shear": Field("Largest shear stress", "Pa", _column("max_shear")),
}
"""Fields with a scale."""

KINDS = {"rock": "Rock", "block": "Blocks", "joint": "Edges by joint", "none": "Blocks"}
"""Fields that tell kinds apart, and that which colours nothing."""


def check_field(name: str, more: Iterable[str] = ()) -> None:
    """Raise CaseError for a field that no picture knows; ``more`` are those of joints."""
    known = (*SCALARS, *KINDS, *more)
    if name not in known:
        close = spelling.nearest(name, known)
        every = f"the fields are: {', '.join(known)}"  # they are listed nowhere else in a terminal
        raise CaseError(
            f"there is no field '{name}'", remedy=f"did you mean '{close}'?" if close else every
        )


PREFIXES = {-3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}


KILO = {"N m/m": "kN m/m"}
"""Units that are shown with one prefix always, for small moments to be seen beside large ones."""


def prefixed(largest: float, unit: str) -> tuple[float, str]:
    """Return a factor and a unit with a prefix that make ``largest`` a number from 1 to 1000.

    Moments are in kN m/m whatever their size; µm2 are not a millionth of m2.
    """
    if unit in KILO:
        return 1e-3, KILO[unit]
    if unit in ("°", "%") or unit.startswith("m2") or not math.isfinite(largest) or largest == 0.0:
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


ONE_SIDED = 0.02
"""Values on one side of zero but for this share get a scale of one colour."""

RISING = ("YlOrRd", 0.0, 0.66, 0.66, 0.85)
FALLING = ("YlGnBu_r", 0.32, 1.0, 0.12, 1.0)
BOTH = ("RdBu_r", 0.14, 0.86, 0.02, 0.98)
"""Colours for values above zero, below, and on both sides: red is up or tension, blue the other.

The shares leave out the dark ends, on which no outline and no arrow could be seen; the last two are
those of values beyond the scale.
"""


@dataclass(frozen=True)
class ColourScale:
    """Colours and the values at their ends."""

    colours: Colormap
    """Colours from one end to the other, and beyond."""
    low: float
    """Value at the lower end."""
    high: float
    """Value at the upper end."""
    extend: str
    """Which ends values go beyond, as matplotlib calls it: neither, min, max, both."""
    beyond: int
    """Blocks whose values lie beyond the scale."""
    ends: tuple[float, float]
    """Least and largest value."""

    def beyond_text(self, unit: str) -> str:
        """Return how many values lie beyond the scale and how far they go, in words."""
        texts = []
        for name, end in zip(("min", "max"), self.ends, strict=True):
            if self.extend in (name, "both"):
                factor, prefix = prefixed(end, unit)
                texts.append(f"{factor * end:.3g} {prefix}".replace("-", "−"))
        return f"{self.beyond} beyond, to {' and '.join(texts)}"


def scale_of(
    values: Floats, area: Floats, limits: tuple[float, float] | None = None
) -> ColourScale:
    """Return the colours of values (n,) of blocks of an area (n,), m2, and where they end."""
    low, high = limits or _ends(values, area)
    slack = (1e-9 if limits else ONE_SIDED) * (high - low)
    below, above = values < low - slack, values > high + slack
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}
    return ColourScale(
        colours=colours_between(low, high),
        low=low,
        high=high,
        extend=extend[int(below.any()), int(above.any())],
        beyond=int(np.sum(below | above)),
        ends=(float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))),
    )


def colours_between(low: float, high: float) -> Colormap:
    """Return the colours of values from ``low`` to ``high``; that of zero is always the same."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    kind = RISING if low >= 0.0 else FALLING if high <= 0.0 else BOTH
    name, first, last, under, over = kind
    if kind is BOTH:
        middle, half = 0.5 * (first + last), 0.5 * (last - first) / max(-low, high)
        first, last = middle + half * low, middle + half * high
    colours = ListedColormap(colormaps[name](np.linspace(first, last, 256)))
    return colours.with_extremes(under=colormaps[name](under), over=colormaps[name](over))


def _ends(values: Floats, area: Floats) -> tuple[float, float]:
    """Return where the scale of values (n,) ends."""
    size = largest_but_few(np.abs(values), area)
    if size == 0.0:
        return 0.0, 1.0
    low, high = max(-size, float(values.min())), min(size, float(values.max()))
    if low >= -ONE_SIDED * size:
        return 0.0, size
    if high <= ONE_SIDED * size:
        return -size, 0.0
    return -size, size


def largest_but_few(sizes: Floats, weight: Floats, few: float = 0.01) -> float:
    """Return the largest of ``sizes`` (n,) >= 0, but for a few that would spoil a scale.

    They make up less than the share ``few`` of the total ``weight`` (n,), and are more than three
    times the largest of all others.
    """
    largest = float(sizes.max(initial=0.0))
    order = np.argsort(-sizes, kind="stable")
    within = np.cumsum(weight[order]) > few * weight.sum()
    usual = float(sizes[order][within].max(initial=0.0))
    if usual <= 1e-6 * largest:
        return largest
    return float(sizes[sizes <= 3.0 * usual].max(initial=0.0))
