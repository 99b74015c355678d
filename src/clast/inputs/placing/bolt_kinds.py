"""Kinds of bolts as they are given to a builder, checked one against the other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypedDict

from clast import spelling
from clast.errors import ModelError
from clast.model import ranges
from clast.model.bolts import BoltKind
from clast.model.value_checks import check_number


class BoltNumbers(TypedDict, total=False):
    """Numbers of a kind of bolt; see BoltKind."""

    stiffness: float | None
    young: float | None
    area: float | None
    out_of_plane_spacing: float | None
    yield_force: float | None
    rupture_elongation: float | None
    rupture_strain: float | None
    pretension: float
    compression: bool


SIZES: Mapping[str, ranges.Range | None] = {
    "stiffness": ranges.STIFFNESS,
    "young": ranges.MODULUS,
    "area": None,
    "out_of_plane_spacing": ranges.LENGTH,
    "yield_force": ranges.FORCE,
    "rupture_elongation": ranges.LENGTH,
    "rupture_strain": ranges.FACTOR,
    "pretension": ranges.FORCE,
}
"""Numbers of a kind -> the sizes that they can have."""
AXIAL = ("young", "area", "out_of_plane_spacing")
"""What a stiffness is made of."""


def checked_kind(name: str, numbers: Mapping[str, Any]) -> BoltKind:
    """Return a kind of bolt; ModelError names the number that cannot be, and what to do."""
    where = f"bolt kind '{name}'"
    unknown = [key for key in numbers if key not in BoltNumbers.__annotations__]
    for key in unknown[:1]:
        raise ModelError(
            f"a bolt has no {key}",
            where=where,
            remedy=spelling.advice(key, BoltNumbers.__annotations__, kind="key"),
        )
    values = {
        key: _number(numbers[key], limits, f"{where}, {key}", least_is_zero=key == "pretension")
        for key, limits in SIZES.items()
        if numbers.get(key) is not None
    }
    kind = BoltKind(name=name, compression=bool(numbers.get("compression", False)), **values)
    _check_stiffness(kind, where)
    _check_strength(kind, where)
    return kind


def _number(value: Any, limits: ranges.Range | None, where: str, *, least_is_zero: bool) -> float:
    """Return a number above 0, or one that may be 0."""
    number = check_number(value, where)
    if not math.isfinite(number) or number < 0.0 or (number == 0.0 and not least_is_zero):
        bound = "0 or more" if least_is_zero else "above 0"
        raise ModelError(
            f"must be {bound}, not {number:g}",
            where=where,
            remedy="give it in SI units, or leave it out",
        )
    if limits is not None:
        ranges.check_size(number, limits, where, "give it in SI units, per m of thickness")
    return number


def _check_stiffness(kind: BoltKind, where: str) -> None:
    """Refuse a stiffness that is said twice, or not wholly."""
    given = [key for key in AXIAL if getattr(kind, key) is not None]
    lacking = [key for key in AXIAL if key not in given]
    if kind.stiffness is not None and given:
        raise ModelError(
            f"stiffness and {', '.join(given)} are both given",
            where=where,
            remedy="give stiffness, N/m per m of thickness, or young, area and "
            "out_of_plane_spacing",
        )
    if kind.stiffness is None and lacking:
        what = (
            f"{' and '.join(given)} without {' and '.join(lacking)}"
            if given
            else ("has no stiffness")
        )
        raise ModelError(
            what,
            where=where,
            remedy="give stiffness, N/m per m of thickness, or all of young (Pa), area (m2 of one "
            "bolt) and out_of_plane_spacing (m between bolts along the thickness)",
        )


def _check_strength(kind: BoltKind, where: str) -> None:
    """Refuse strengths that contradict each other."""
    if kind.yield_force is not None and kind.pretension > kind.yield_force:
        raise ModelError(
            f"a pretension of {kind.pretension:g} N/m is above yield_force, "
            f"{kind.yield_force:g} N/m",
            where=f"{where}, pretension",
            remedy="lower it: a bolt that yields holds no pretension",
        )
    if kind.rupture_elongation is not None and kind.rupture_strain is not None:
        raise ModelError(
            "rupture_elongation and rupture_strain are both given",
            where=where,
            remedy="give one of them: m, or a share of the length",
        )


def check_rupture(kind: BoltKind, stiffness: float, rupture: float, where: str) -> None:
    """Refuse a spring that breaks before it yields, or before it has its pretension."""
    for force, what in ((kind.yield_force, "it yields"), (kind.pretension, "it is tensioned")):
        if force is not None and rupture < force / stiffness:
            raise ModelError(
                f"it breaks at an elongation of {rupture:.6g} m, but {what} at "
                f"{force / stiffness:.6g} m ({force:g} N/m by {stiffness:g} N/m per m)",
                where=where,
                remedy="raise rupture_elongation or rupture_strain, or the stiffness",
            )
