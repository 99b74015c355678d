"""Options of a picture: limits of its colours, size, resolution, part to show."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from clast import spelling
from clast.errors import CaseError

CM = 1.0 / 2.54
"""A centimetre in inches."""
SMALLEST, LARGEST = 6.0, 200.0
"""Sizes of a picture, cm."""
COARSEST, FINEST = 20, 2400
"""Dots per inch of a picture."""
MOST_DOTS = 25_000
"""Dots in the width or the height of a picture, at most."""

LAYERS = (
    "chains",
    "crosses",
    "vectors",
    "levels",
    "normal-forces",
    "shear-forces",
    "moments",
    "scale",
    "gravity",
)
"""Force chains, crosses of principal stress, displacements as arrows and as lines of equal ones, a
scale bar, the direction of gravity."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Limits, size, resolution and part of a picture; None: as the drawing needs."""

    limits: tuple[float, float] | None = None
    """Values at the ends of the colours, in m, m/s, degrees or Pa."""
    size: tuple[float, ...] | None = None
    """Width and height of the picture, or its width alone, cm."""
    dpi: int | None = None
    """Dots per inch."""
    zoom: tuple[float, float, float, float] | None = None
    """Part that is shown: xmin, ymin, xmax, ymax, m."""
    layers: tuple[str, ...] = ()
    """Layers drawn above the blocks as well, some of LAYERS."""
    water: bool = True
    """Whether levels and pressures of water are drawn."""
    magnify: float | Literal["auto"] = 1.0
    """Factor of displacements from the start; "auto": one with which they are seen."""

    def __post_init__(self) -> None:
        for name in ("limits", "size", "zoom"):
            given = getattr(self, name)
            if given is not None and not all(map(math.isfinite, given)):
                raise CaseError("must be finite numbers", where=name)
        if self.limits is not None and not self.limits[0] < self.limits[1]:
            raise CaseError(
                f"from {self.limits[0]:g} to {self.limits[1]:g} is not a valid range",
                where="limits",
                remedy="give the lower limit first",
            )
        if self.zoom is not None:
            left, low, right, high = self.zoom
            if not (left < right and low < high):
                raise CaseError(
                    f"({left:g}, {low:g}) to ({right:g}, {high:g}) has no area",
                    where="zoom",
                    remedy="give the lower left corner, then the upper right one: x0,y0,x1,y1",
                )
        for name in self.layers:
            if name not in LAYERS:
                remedy = spelling.advice(name, LAYERS, kind="layer")
                raise CaseError(f"there is no layer '{name}'", where="layers", remedy=remedy)
        given = math.nan if isinstance(self.magnify, str) else float(self.magnify)
        if self.magnify != "auto" and not (math.isfinite(given) and given > 0.0):
            raise CaseError(
                f"{self.magnify} is not a valid factor of displacements",
                where="magnify",
                remedy='give a number above 0, as 100, or "auto"',
            )
        self._check_size()

    def _check_size(self) -> None:
        for length in self.size or ():
            if not SMALLEST <= length <= LARGEST:
                raise CaseError(
                    f"{length:g} cm is too {'small' if length < SMALLEST else 'large'}",
                    where="size",
                    remedy=f"give width and height in cm, {SMALLEST:g} to {LARGEST:g} each",
                )
        if self.dpi is not None and not COARSEST <= self.dpi <= FINEST:
            raise CaseError(
                f"dpi must lie between {COARSEST} and {FINEST}, not {self.dpi}",
                where="dpi",
                remedy="300 is usual in print",
            )
        most = max(self.size or (0.0,)) * CM * (self.dpi or 0)
        if most > MOST_DOTS:
            raise CaseError(
                f"{most:.0f} dots are more than a picture can have in width or height",
                where="size, dpi",
                remedy=f"lower one of them: {MOST_DOTS} dots at most",
            )

    @property
    def inches(self) -> tuple[float, float | None] | None:
        """Width and height of the picture, inches; the height is None where it is not given."""
        if self.size is None:
            return None
        return self.size[0] * CM, self.size[1] * CM if len(self.size) > 1 else None


DEFAULT = Look()
"""The default options, which follow from the drawing."""
