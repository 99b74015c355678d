"""What rocks, joints, names and lists of numbers cannot be."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.model import Floats, Joint, Plane, PlaneStrain, Rock

SMALL_ANGLE = 1.6
"""Friction angles up to this many degrees look like radians (pi/2 is 1.57)."""
CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that names do not have: they break files, terminals and pictures."""
LONGEST_NAME = 200
"""Most characters of a name."""
LONGEST_TITLE = 1000
"""Most characters of a title."""


def check_rock(rock: Rock, plane: Plane) -> None:
    """Refuse a Poisson's ratio that is impossible in a plane."""
    if isinstance(plane, PlaneStrain) and rock.poisson == 0.5:
        raise ModelError(
            f"{rock.poisson:g} is impossible in plane {plane.name}",
            where=f"rock '{shortened(rock.name)}', poisson",
            remedy="Poisson's ratio is above -1 and below 0.5; rocks have 0.1 to 0.4",
        )


def check_joint(joint: Joint, *, allow_small_friction_angle: bool) -> None:
    """Refuse numbers that no joint has, and friction angles that look like radians."""
    where = f"joint '{shortened(joint.name)}'"
    angle = joint.friction_angle
    if not 0.0 <= angle < 90.0:
        raise ModelError(
            f"{angle:g} is no friction angle",
            where=f"{where}, friction_angle",
            remedy="give it in degrees, from 0 to below 90",
        )
    if 0.0 < angle < SMALL_ANGLE and not allow_small_friction_angle:
        raise ModelError(
            f"{angle:g} looks like radians, but friction angles are in degrees",
            where=f"{where}, friction_angle",
            remedy=f"write {math.degrees(angle):.6g}, or 0 for no friction; if {angle:g} degrees "
            "is meant, add allow_small_friction_angle = true to the joint",
        )
    strengths = {"cohesion": joint.cohesion, "tensile_strength": joint.tensile_strength}
    if joint.residual_cohesion is not None:
        strengths["residual_cohesion"] = joint.residual_cohesion
    for key, value in strengths.items():
        if not 0.0 <= value < math.inf:
            raise ModelError(
                f"{value:g} is no strength",
                where=f"{where}, {key}",
                remedy="give it in Pa, 0 or more",
            )
        ranges.check_size(value, ranges.STRESS, f"{where}, {key}", "give it in Pa")
    if strengths.get("residual_cohesion", 0.0) > joint.cohesion:
        raise ModelError(
            f"{joint.residual_cohesion:g} Pa are more than the cohesion, {joint.cohesion:g} Pa",
            where=f"{where}, residual_cohesion",
            remedy="give what slip leaves of the cohesion, or leave it out: then all of it stays",
        )
    if joint.restitution is not None and not 0.0 <= joint.restitution <= 1.0:
        raise ModelError(
            f"{joint.restitution:g} is no restitution",
            where=f"{where}, restitution",
            remedy="give the share of the closing velocity that rebounds, from 0 to 1",
        )
    for key in ("normal_stiffness", "shear_stiffness"):
        stiffness = getattr(joint, key)
        if stiffness is not None:
            remedy = "give it in Pa/m, or leave it out: the contact law has its own"
            _positive(stiffness, ranges.JOINT_STIFFNESS, f"{where}, {key}", remedy)


def _positive(value: float, limits: ranges.Range, where: str, remedy: str) -> None:
    if not 0.0 < value < math.inf:
        raise ModelError(f"{value:g} must be above 0 and finite", where=where, remedy=remedy)
    ranges.check_size(value, limits, where, remedy)


ACTION = ("begin", "share", "finish")
"""Methods of an action."""


def check_actions(actions: Sequence[object]) -> None:
    """Refuse what lacks a method of an action."""
    for k, action in enumerate(actions, 1):
        lacking = [name for name in ACTION if not callable(getattr(action, name, None))]
        if isinstance(action, type) or lacking:
            raise ModelError(
                f"{action if isinstance(action, type) else type(action).__name__} is no action"
                + (f": it has no {', '.join(lacking)}" if lacking else ", but a class"),
                where=f"actions, number {k}",
                remedy="give an object with the methods of clast.actions.action.Action",
            )


def check_numbers(
    values: Any, count: int, where: str, limits: ranges.Range = ranges.COORDINATE
) -> Floats:
    """Return ``count`` finite numbers as an array, shape (count,), or say which is none."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.zeros(0)
    if array.shape != (count,) or not np.isfinite(array).all():
        raise ModelError(
            f"{shortened(repr(values))} is no list of {count} finite numbers",
            where=where,
            remedy=f"give {count} numbers in SI units",
        )
    for value in array:
        ranges.check_size(float(value), limits, where, "give SI units")
    return array


def check_number(value: Any, where: str) -> float:
    """Return a number as a float, or say that it is none."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ModelError(
            f"{shortened(repr(value))} is no number", where=where, remedy="give it in SI units"
        ) from None


def check_name(name: Any, kind: str, where: str) -> str:
    """Return the name of something, or say that it is none."""
    if isinstance(name, str):
        return name
    raise ModelError(
        f"{shortened(repr(name))} is no name of a {kind}",
        where=where,
        remedy=f'name the {kind} by its text, e.g. "1"',
    )


def check_names(kind: str, names: Sequence[str]) -> None:
    """Refuse names that are no text, blank, too long, not printable, or there twice."""
    if not all(isinstance(name, str) for name in names):
        wrong = next(name for name in names if not isinstance(name, str))
        raise ModelError(
            f"{shortened(repr(wrong))} is no name",
            where=kind,
            remedy='names are texts, e.g. "1"',
        )
    for number, name in enumerate(names, start=1):
        check_text(name, f"{kind} {number}")
    if len(set(names)) < len(names):
        ordered = sorted(names)
        twice = next(name for name, after in pairwise(ordered) if name == after)
        raise ModelError(
            f"there are two {kind}s of that name",
            where=f"{kind} '{shortened(twice)}'",
            remedy="rename one of them",
        )


def check_text(name: str, label: str) -> None:
    """Refuse a name that is blank, too long or not printable; ``label`` is what has it."""
    for what, bad in (
        ("has no name", lambda name: not name.strip()),
        (f"has a name of more than {LONGEST_NAME} characters", lambda n: len(n) > LONGEST_NAME),
        ("has a name with a character that cannot be printed", CONTROL.search),
    ):
        if bad(name):
            raise ModelError(
                what,
                where=f"{label} {shortened(repr(name))}",
                remedy="give it a short name of letters, digits and blanks",
            )


def check_point_names(names: Sequence[str]) -> None:
    """Refuse names of measured points that cannot be those of tables in the result file."""
    check_names("measured point", names)
    for name in names:
        if name in (".", ".."):
            raise ModelError(
                "its history is kept in the result file under its name, where . and .. are none",
                where=f"measured point '{name}'",
                remedy="give it another name",
            )


def check_title(title: str) -> None:
    """Refuse titles that a result file cannot hold."""
    if not isinstance(title, str):
        raise ModelError(
            f"{shortened(repr(title))} is no text", where="title", remedy="give it in quotes"
        )
    if "\0" in title or len(title) > LONGEST_TITLE:
        what = "holds a NUL character" if "\0" in title else f"has {len(title)} characters"
        raise ModelError(
            what, where="title", remedy=f"give a text of at most {LONGEST_TITLE} characters"
        )


def number_of(name: str, number: dict[str, int], kind: str, where: str) -> int:
    """Return the index of a named thing, or suggest the nearest name."""
    name = check_name(name, kind, where)
    if name not in number:
        raise ModelError(
            f"there is no {kind} '{shortened(name)}'",
            where=where,
            remedy=spelling.advice(name, number, kind=kind),
        )
    return number[name]
