"""A look at a case before its first step: how much of everything, and what seems unsound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.contact.detection import detect
from clast.equations.frames import block_frames
from clast.ground_motion import MovingBase
from clast.model import Bools, Model
from clast.state import State, initial_state
from clast.stepping.modified import STABILITY_LIMIT, reach_of, stability_number

if TYPE_CHECKING:
    from clast.contact.arrays import Contacts
    from clast.interfaces import Method
    from clast.simulate import Schedule

SOFTEST = 1e5
"""Young's moduli below this look like kPa, MPa or GPa, Pa."""
LIGHTEST = 50.0
"""Densities below this look like t/m3 or g/cm3, kg/m3."""
LARGE_SHARE = 0.1
"""max_displacement and critdis above this share of the smallest block's size are coarse."""


@dataclass(frozen=True, kw_only=True)
class Sanity:
    """What a case consists of, and warnings."""

    title: str
    """Title of the case."""
    blocks: int
    """Number of blocks."""
    vertices: int
    """Number of vertices."""
    rocks: tuple[str, ...]
    """Names of the rocks."""
    joints: tuple[str, ...]
    """Names of the joints, the default first."""
    fixed_blocks: int
    """Number of blocks that cannot move."""
    fixed_points: int
    """Number of fixed points."""
    loads: int
    """Number of point and line loads."""
    measured_points: int
    """Number of measured points."""
    mass: float
    """Mass of all blocks, kg per metre of thickness."""
    box: tuple[float, float, float, float]
    """Bounding box xmin, ymin, xmax, ymax, m."""
    smallest: tuple[str, float]
    """Name and area, m2, of the smallest block."""
    largest: tuple[str, float]
    """Name and area, m2, of the largest block."""
    contacts: int
    """Contacts at the start."""
    touching_pairs: int
    """Pairs of blocks that touch at the start."""
    unsupported: tuple[str, ...]
    """Blocks that are not fixed anywhere and touch nothing."""
    steps: int
    """Steps that the run takes if none is cut."""
    max_displacement: float
    """Largest vertex movement in a step, m."""
    critdis: float
    """Critical distance of contact detection, m."""
    stability_number: float
    """Largest p h2/m, m being a block's mass per contact."""
    stability_limit: float
    """Largest p h2/m with which contacts settle without passes."""
    warnings: tuple[str, ...]
    """What seems unsound, each with its remedy."""


def examine(model: Model, method: Method, schedule: Schedule) -> Sanity:
    """Return what a case consists of and what seems unsound about it."""
    start = initial_state(model)
    contacts = _contacts(model, method, start)
    unsupported = _unsupported(model, contacts)
    number = stability_number(model, method, start, schedule.step)
    low = model.vertices.min(axis=0) + model.origin
    high = model.vertices.max(axis=0) + model.origin
    smallest, largest = int(model.area.argmin()), int(model.area.argmax())
    return Sanity(
        title=model.title,
        blocks=model.block_count,
        vertices=len(model.vertices),
        rocks=tuple(rock.name for rock in model.rocks),
        joints=tuple(joint.name for joint in model.joint_table.joints),
        fixed_blocks=int(model.fixed.sum()),
        fixed_points=len(model.fixed_points.block),
        loads=len(model.point_loads.block) + len(model.line_loads.block),
        measured_points=len(model.measured_points.name),
        mass=float(model.mass.sum()),
        box=(float(low[0]), float(low[1]), float(high[0]), float(high[1])),
        smallest=(model.block_name[smallest], float(model.area[smallest])),
        largest=(model.block_name[largest], float(model.area[largest])),
        contacts=len(contacts),
        touching_pairs=len(contacts.pairs),
        unsupported=tuple(model.block_name[block] for block in np.flatnonzero(unsupported)),
        steps=int(np.ceil(schedule.end / schedule.step - 1e-9)),
        max_displacement=method.max_displacement,
        critdis=method.critdis,
        stability_number=number,
        stability_limit=STABILITY_LIMIT,
        warnings=(
            *method.process.advice(model, method, start, schedule.step),
            *_support_warnings(model),
            *_base_warnings(model),
            *_unit_warnings(model),
            *_length_warnings(model, method),
        ),
    )


def _contacts(model: Model, method: Method, state: State) -> Contacts:
    frames = block_frames(model, method.displacement, state)
    return detect(
        model,
        method.corner_rule,
        method.displacement,
        state,
        frames.centroid,
        reach_of(method),
    )


def _unsupported(model: Model, contacts: Contacts) -> Bools:
    """Return True for blocks that are not fixed anywhere and touch nothing, shape (n,)."""
    held = model.fixed.copy()
    held[model.fixed_points.block] = True
    held[contacts.pairs.ravel()] = True
    return ~held


def _support_warnings(model: Model) -> list[str]:
    """Warn where nothing holds the blocks."""
    held = bool(model.fixed.any()) or len(model.fixed_points.block) > 0
    if held or not model.gravity.any():
        return []
    return ["nothing is fixed: all blocks fall. Give a [[fixed_point]] or fixed = true"]


def _base_warnings(model: Model) -> list[str]:
    """Warn where a base moves and fixed blocks stay behind."""
    if not isinstance(model.ground_motion, MovingBase) or not model.fixed.any():
        return []
    return [
        f"{int(model.fixed.sum())} fixed block(s) stay where they are while the base moves: hold "
        "what moves with the ground by fixed points"
    ]


def _unit_warnings(model: Model) -> list[str]:
    """Warn of numbers that look like other units than SI."""
    found = []
    for rock in model.rocks:
        if rock.young < SOFTEST:
            found.append(f"rock '{rock.name}': young is {rock.young:g}; it is meant in Pa")
        if rock.density < LIGHTEST:
            found.append(f"rock '{rock.name}': density is {rock.density:g}; it is meant in kg/m3")
    default = model.joint_table.joints[0]
    several = model.block_count > 1
    if several and default.friction_angle == 0.0 and default.cohesion == 0.0:
        found.append(
            f"joint '{default.name}' is frictionless, and with it every contact that no other "
            "joint names: give friction_angle in [joint.default] if that is not meant"
        )
    return found


def _length_warnings(model: Model, method: Method) -> list[str]:
    """Warn of steps and reaches that are coarse against the smallest block."""
    size = float(np.sqrt(model.area.min()))
    lengths = {"time.max_displacement": method.max_displacement, "critdis": method.critdis}
    return [
        f"{key} is {length:g} m, but the smallest block is only {size:.3g} m wide: lower it to "
        f"{0.01 * size:.2g} m"
        for key, length in lengths.items()
        if length > LARGE_SHARE * size
    ]
