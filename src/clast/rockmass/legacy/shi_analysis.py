"""Shi's analysis file in: materials, number of steps and their length.

Numbers in this order, separated by spaces, and the meaning of each in a case of clast:

| numbers | in a case of clast |
| --- | --- |
| analysis type, 0 static to 1 dynamic | [time] dynamic_ratio |
| number of steps | [time] end = steps x step |
| number of block materials, number of joint materials | - |
| largest displacement ratio g2 | [time] max_displacement = g2 w0, w0 half the domain's height |
| time step | [time] step |
| for each block material: mass, weight, E, nu | [rock.rock-N] density, young, poisson; gravity |
| s11 s22 s12 | [rock.rock-N] initial_stress |
| t11 t22 t12 (columns 8 to 10) | not taken over; said where one is not 0 |
| vx vy vr | a comment where one is not 0: velocities belong to blocks |
| for each joint material: phi, cohesion, tension | [joint.type-N] |

``legacy`` explains the meaning of each, and the purpose of ``mass_unit``.
"""

from __future__ import annotations

from pathlib import Path

from clast.errors import CaseError
from clast.rockmass.drawings.drawing import Analysis, LeftOut
from clast.rockmass.legacy.number_text import NumberText
from clast.rockmass.legacy.shi_geometry import rest_of
from clast.rockmass.legacy.words import (
    NumberRow,
    check_mass_unit,
    legacy_joint,
    legacy_rock,
    unit_notes,
)


def read_shi_analysis(path: str | Path, mass_unit: float = 1.0) -> Analysis:
    """Return the content of an analysis file of Shi's programs, in SI units.

    ``mass_unit`` is the kilograms in its unit of mass: 1000 for a file in t, kN and kPa.  Raises
    CaseError with the line where it is no such file.
    """
    scale, text = check_mass_unit(mass_unit), NumberText(Path(path))
    kind = text.number("the analysis type")
    if not 0.0 <= kind <= 1.0:
        raise CaseError(
            f"{kind:g} is not an analysis type",
            where=f"{text.file}: line 1",
            remedy="an analysis file begins with 0, static, or 1, dynamic",
        )
    steps = text.count("steps")
    blocks, joints = text.count("block materials", 13), text.count("joint materials", 3)
    ratio = text.number("the largest displacement ratio g2")
    step = text.number("the time step")
    check_step(steps, step, ratio, text.file)
    materials = text.rows(blocks, 13, "block material")
    strengths = text.rows(joints, 3, "joint material")
    rocks = tuple(
        legacy_rock(k, _without_columns_8_to_10(one), scale) for k, one in enumerate(materials, 1)
    )
    left = [
        LeftOut(
            what=f"columns 8 to 10 of block material {k}: {' '.join(f'{v:g}' for v in tectonic)}",
            place=one.place,
            reason="clast starts from stresses alone, and these are not added to them",
        )
        for k, one in enumerate(materials, 1)
        if any(tectonic := one.values[7:10])
    ]
    return Analysis(
        rocks=rocks,
        joints=tuple(legacy_joint(k, one, scale) for k, one in enumerate(strengths, 1)),
        dynamic_ratio=kind,
        steps=steps,
        step=step,
        displacement_ratio=ratio,
        notes=tuple(unit_notes(rocks, scale)),
        left_out=(*left, *rest_of(text)),
    )


def check_step(steps: int, step: float, ratio: float, file: str) -> None:
    """Refuse a run without steps, and steps or displacements of no length."""
    for what, value in (("steps", steps), ("time step", step), ("displacement ratio", ratio)):
        if not value > 0:
            raise CaseError(f"the {what} is {value:g}", where=file, remedy="give a number above 0")


def _without_columns_8_to_10(given: NumberRow) -> NumberRow:
    return NumberRow(values=(*given.values[:7], *given.values[10:]), place=given.place)
