"""What seems unsound about a case before its first step, each with its number and its remedy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from clast.errors import ModelError, shortened
from clast.ground_motion import InertialForce, MovingBase
from clast.model import Floats, Ints, Model

if TYPE_CHECKING:
    from clast.interfaces import Method
    from clast.simulate import Schedule

SOFTEST, HARDEST = 1e8, 2e12
"""Young's moduli outside look like kPa, MPa or GPa, Pa."""
LIGHTEST, HEAVIEST = 200.0, 25e3
"""Densities outside look like t/m3 or g/cm3, kg/m3."""
WEAKEST, STRONGEST = 1e3, 1e9
"""Strengths and stresses outside look like kPa or MPa, Pa."""
STEEPEST = 75.0
"""Friction angles above are steeper than any joint's, degrees."""
LARGE_SHARE = 0.1
"""max_displacement and critdis above this share of the smallest block's size are coarse."""
SMALL_SHARE = 1e-6
"""max_displacement and critdis below this share of the smallest block's size find nothing."""
NO_DIGITS = 1e-7
"""Coordinates rounded to more than this share of the smallest block have too few digits."""
SPREAD = 1e4
"""Blocks whose sizes differ by more than this factor are not simulated well together."""
THIN = 1e-5
"""Parts of a block thinner than this share of its extent are spikes or cracks."""
SINKING = 0.01
"""Blocks that sink into others by more than this share of the smallest block sink too far."""
STIFFNESS_RATIO = 1e3
"""Normal stiffness by E, and shear by normal stiffness, are within this factor as a rule."""
LOOSE = 1e-3
"""Tolerances of a process above this are felt in the results."""
MANY_FRAMES = 10_000
"""Result files of more frames are said to be large."""
HARDEST_SHAKING = 50.0
"""No ground has been accelerated by more than this, m/s2."""
NAMED = 5
"""Most things that a warning names."""


def doubts(model: Model, method: Method, schedule: Schedule) -> list[str]:
    """Return what seems unsound about a system of blocks and how it is to be simulated."""
    return [
        *_support_doubts(model),
        *_idle_doubts(model),
        *_gravity_doubts(model),
        *_unit_doubts(model),
        *_strength_doubts(model),
        *_shape_doubts(model),
        *_length_doubts(model, method),
        *_overlap_doubts(model, method),
        *_stiffness_doubts(model, method),
        *_motion_doubts(model, schedule),
        *_frame_doubts(schedule),
    ]


def _named(model: Model, blocks: Ints) -> str:
    """Return blocks as a warning calls them, no more than a few."""
    names = [f"'{shortened(model.block_name[block])}'" for block in blocks[:NAMED].tolist()]
    return ", ".join(names) + (", ..." if len(blocks) > NAMED else "")


def _size(model: Model) -> float:
    """Return the size of the smallest block, m."""
    return float(np.sqrt(model.area.min()))


def _support_doubts(model: Model) -> Iterable[str]:
    """Say where nothing or everything holds the blocks, and where a base leaves some behind."""
    held = bool(model.fixed.any()) or len(model.fixed_points.block) > 0
    if not held and model.gravity.any():
        yield "nothing is fixed: all blocks fall. Give a [[fixed_point]] or fixed = true"
    if model.fixed.all():
        yield (
            f"all blocks are fixed ({model.block_count}): nothing can move. Remove fixed = true "
            "where blocks are to move"
        )
    elif isinstance(model.ground_motion, MovingBase) and model.fixed.any():
        yield (
            f"{int(model.fixed.sum())} fixed block(s) stay where they are while the base moves: "
            "hold what moves with the ground by fixed points"
        )


def _idle_doubts(model: Model) -> Iterable[str]:
    """Say what does nothing: loads and supports of fixed blocks, rocks of no block."""
    kinds = {
        "point load": (model.point_loads.block, model.point_loads.force),
        "line load": (model.line_loads.block, model.line_loads.traction),
        "fixed point": (model.fixed_points.block, np.ones((len(model.fixed_points.block), 1))),
    }
    for kind, (block, size) in kinds.items():
        idle = np.unique(block[model.fixed[block]])
        if len(idle) and not model.fixed.all():
            count = int(model.fixed[block].sum())
            yield (
                f"{count} {kind}(s) act on blocks that are fixed and do nothing there: "
                f"{_named(model, idle)}. Remove them, or fixed = true of the block"
            )
        zero = int((~size.any(axis=1)).sum())
        if zero:
            yield f"{zero} {kind}(s) are zero: give a force, or remove them"
    unused = np.setdiff1d(np.arange(len(model.rocks)), model.block_rock)
    for rock in unused[:NAMED].tolist():
        name = shortened(model.rocks[rock].name)
        yield f"no block is made of rock '{name}': name it in a block, or remove it"


def _gravity_doubts(model: Model) -> Iterable[str]:
    """Say where gravity points upwards, or nothing sets the blocks in motion."""
    across, up = model.gravity.tolist()
    if up > 0.0:
        yield (
            f"gravity is ({across:g}, {up:g}) m/s2 and points upwards: blocks fall up. "
            f"y is positive upwards; write gravity = [{across:g}, {-up:g}]"
        )
    driven = (
        model.gravity.any()
        or model.velocity.any()
        or model.initial_stress.any()
        or model.point_loads.force.any()
        or model.line_loads.traction.any()
        or isinstance(model.ground_motion, InertialForce | MovingBase)
    )
    if not driven:
        yield (
            "gravity, loads, velocities and stresses are all zero: nothing sets the blocks in "
            "motion. Give gravity = [0.0, -9.8] or a load"
        )


def _unit_doubts(model: Model) -> Iterable[str]:
    """Say which moduli, densities and stresses look like other units than SI."""
    for rock in model.rocks:
        where = f"rock '{shortened(rock.name)}'"
        if not SOFTEST <= rock.young <= HARDEST:
            yield (
                f"{where}: young is {rock.young:g} Pa, which no rock or brick has (1e8 to 2e12); "
                "it is meant in Pa: 50 GPa are 50e9"
            )
        if not LIGHTEST <= rock.density <= HEAVIEST:
            yield (
                f"{where}: density is {rock.density:g} kg/m3, which no rock or brick has; it is "
                "meant in kg/m3: 2.7 t/m3 are 2700"
            )
    largest = np.abs(model.initial_stress).max(axis=1)
    small = np.flatnonzero((largest > 0.0) & (largest < WEAKEST))
    if len(small) == model.block_count:
        yield (
            f"initial_stress is at most {largest.max():g} Pa, next to nothing; it is meant in Pa: "
            "10 MPa are 10e6"
        )
    young = np.array([rock.young for rock in model.rocks])[model.block_rock]
    strained = np.flatnonzero(largest > 0.01 * young)
    if len(strained):
        worst = int(strained[np.argmax((largest / young)[strained])])
        yield (
            f"initial_stress of {largest[worst]:g} Pa strains block {_named(model, strained)} by "
            f"{100.0 * largest[worst] / young[worst]:.3g} %, beyond small strains: check it and "
            "young"
        )
    pulled = np.flatnonzero((model.initial_stress[:, :2] >= WEAKEST).all(axis=1))
    if len(pulled):
        xx, yy, _ = model.initial_stress[pulled[0]].tolist()
        yield (
            f"initial_stress ({xx:g}, {yy:g}) Pa pulls block {_named(model, pulled)} both ways: "
            f"tension is positive; rock under pressure has ({-xx:g}, {-yy:g})"
        )


def _strength_doubts(model: Model) -> Iterable[str]:
    """Say which strengths of joints look like other units than SI."""
    for joint in model.joint_table.joints:
        where = f"joint '{shortened(joint.name)}'"
        strengths = {"cohesion": joint.cohesion, "tensile_strength": joint.tensile_strength}
        for key, value in strengths.items():
            if 0.0 < value < WEAKEST:
                yield (
                    f"{where}: {key} is {value:g} Pa, next to nothing; it is meant in Pa: "
                    f"{value:g} kPa are {1e3 * value:g}"
                )
            if value > STRONGEST:
                yield f"{where}: {key} is {value:g} Pa, stronger than any rock; it is meant in Pa"
        if joint.friction_angle > STEEPEST:
            yield (
                f"{where}: friction_angle is {joint.friction_angle:g} degrees, a coefficient of "
                f"{np.tan(np.radians(joint.friction_angle)):.3g}; joints have 10 to 50"
            )
    default = model.joint_table.joints[0]
    if model.block_count > 1 and default.friction_angle == 0.0 and default.cohesion == 0.0:
        yield (
            f"joint '{default.name}' is frictionless, and with it every contact that no other "
            "joint names: give friction_angle in [joint.default] if that is not meant"
        )


def _shape_doubts(model: Model) -> Iterable[str]:
    """Say where coordinates have too few digits, and which blocks are thin or hardly comparable."""
    size = _size(model)
    far = float(np.abs(model.vertices + model.origin).max())
    rounding = float(np.spacing(far))
    if rounding > NO_DIGITS * size:
        yield (
            f"coordinates of {far:.3g} m are rounded to {rounding:.2g} m, but the smallest block "
            f"is only {size:.3g} m wide: no digits are left for it. Subtract a common offset "
            "from all coordinates"
        )
    largest = float(np.sqrt(model.area.max()))
    if largest > SPREAD * size:
        smallest, broadest = int(model.area.argmin()), int(model.area.argmax())
        yield (
            f"block {_named(model, np.array([smallest]))} is {size:.3g} m wide and block "
            f"{_named(model, np.array([broadest]))} {largest:.3g} m: steps and tolerances follow "
            "the smallest. Leave it out, or check its coordinates"
        )
    thickness, block = _thickness(model)
    thin = np.flatnonzero(thickness < THIN)
    for vertex in thin[:1].tolist():
        x, y = (model.vertices[vertex] + model.origin).tolist()
        number = vertex - int(model.block_start[block[vertex]]) + 1
        more = f" (and {len(thin) - 1} more vertices)" if len(thin) > 1 else ""
        yield (
            f"block {_named(model, block[[vertex]])} has a spike, a crack or a tiny edge at vertex "
            f"{number}, ({x:.9g}, {y:.9g}){more}: {thickness[vertex]:.2g} of its extent thin, too "
            "thin for contacts. Remove the vertex"
        )


def _thickness(model: Model) -> tuple[Floats, Ints]:
    """Return how thin each block is at each vertex, as a share of its extent, and its block (nv,).

    The thickness at a corner is the distance of one end of its shorter edge from its longer edge;
    at a flat or blunt corner it is no thickness, and 1 is returned.
    """
    block, start = model.vertex_block, model.block_start
    vertex = np.arange(len(block))
    after, before = vertex + 1, vertex - 1
    after[start[1:] - 1], before[start[:-1]] = start[:-1], start[1:] - 1
    forth = model.vertices[after] - model.vertices
    back = model.vertices[before] - model.vertices
    low = np.minimum.reduceat(model.vertices, start[:-1])
    high = np.maximum.reduceat(model.vertices, start[:-1])
    extent = np.hypot(*(high - low).T)[block]
    long, short = np.hypot(*forth.T), np.hypot(*back.T)
    sine = np.abs(forth[:, 0] * back[:, 1] - forth[:, 1] * back[:, 0]) / (long * short)
    sharp = (forth * back).sum(axis=1) > 0.0
    least = np.minimum(long, short)
    corner = np.where(sharp, np.minimum(1.0, sine), 1.0) * least
    return np.where(sharp, corner, least) / extent, block


def _length_doubts(model: Model, method: Method) -> Iterable[str]:
    """Say which lengths are coarse or fine against the smallest block."""
    size = _size(model)
    lengths = {"time.max_displacement": method.max_displacement, "critdis": method.critdis}
    for key, length in lengths.items():
        if length > LARGE_SHARE * size:
            yield (
                f"{key} is {length:g} m, but the smallest block is only {size:.3g} m wide: lower "
                f"it to {0.01 * size:.2g} m"
            )
        if length < SMALL_SHARE * size:
            yield (
                f"{key} is {length:g} m, next to nothing beside the smallest block of "
                f"{size:.3g} m: raise it to {0.005 * size:.2g} m, or leave it out"
            )


def check_overlaps(model: Model, method: Method) -> None:
    """Refuse overlaps that no contact of this stiffness can have left.

    The energy p d2/2 of a contact comes from what rests on it, or from a fall of the lighter block,
    at most from the top of the scene to its bottom.
    """
    if len(model.overlaps.depth) == 0:
        return
    stiffness = method.contact_law.normal_stiffness
    weight, load = _weight(model), _load(model)
    mass = np.where(model.fixed, np.inf, model.mass)[model.overlaps.pair].min(axis=1)
    mass = np.where(np.isfinite(mass), mass, 0.0)
    fall = float(np.ptp(model.vertices @ model.gravity))
    speed = float(np.hypot(model.velocity[:, 0], model.velocity[:, 1]).max())
    held = (weight + load) ** 2 / (2.0 * stiffness)
    known = held + mass * (fall + 0.5 * speed**2)
    stored = 0.5 * stiffness * model.overlaps.depth**2
    unknown = np.flatnonzero(stored > known)
    if len(unknown):
        _refuse_overlap(model, stiffness, int(unknown[np.argmax(stored[unknown])]), len(unknown))


def _refuse_overlap(model: Model, stiffness: float, worst: int, count: int) -> NoReturn:
    """Raise ModelError for a pair that no contact can have pressed into each other."""
    one, other = model.overlaps.pair[worst].tolist()
    depth = float(model.overlaps.depth[worst])
    more = f"; so do {count - 1} more pairs" if count > 1 else ""
    raise ModelError(
        f"overlaps block {_named(model, np.array([other]))} to a depth of {depth:.3g} m{more}: "
        f"with normal_stiffness = {stiffness:.3g} a contact would press them apart with "
        f"{stiffness * depth:.3g} N/m, and all blocks weigh {_weight(model):.3g} N/m",
        where=f"block {_named(model, np.array([one]))}",
        remedy="move or cut the blocks so that they touch at most (coordinates rounded too "
        "coarsely overlap as well: give more digits)",
    )


def _weight(model: Model) -> float:
    """Return the weight of all blocks that can move, N/m."""
    return float(model.mass[~model.fixed].sum() * np.hypot(*model.gravity))


def _load(model: Model) -> float:
    """Return the sum of all loads, and of the stress on the largest block, N/m."""
    lines = model.line_loads
    length = np.hypot(*(lines.end - lines.start).T)
    stress = np.abs(model.initial_stress).max(axis=1) * np.sqrt(model.area)
    return float(
        np.hypot(*model.point_loads.force.T).sum()
        + (np.hypot(*lines.traction.T) * length).sum()
        + stress.max()
    )


def _overlap_doubts(model: Model, method: Method) -> Iterable[str]:
    """Say which blocks lie in each other like contacts of a run."""
    depth = model.overlaps.depth
    if len(depth) == 0:
        return
    worst = int(np.argmax(depth))
    one, other = (_named(model, model.overlaps.pair[worst, [k]]) for k in (0, 1))
    force = method.contact_law.normal_stiffness * depth[worst]
    more = f", and {len(depth) - 1} more pairs by less" if len(depth) > 1 else ""
    yield (
        f"blocks {one} and {other} overlap by {depth[worst]:.3g} m at the start{more}: contacts "
        f"press them apart with {force:.3g} N/m. Blocks from the end of a run may; others should "
        "touch at most: give more digits"
    )


def _stiffness_doubts(model: Model, method: Method) -> Iterable[str]:
    """Say which stiffnesses and tolerances are out of proportion."""
    law = method.contact_law
    normal, shear = law.normal_stiffness, getattr(law, "shear_stiffness", None)
    ratio = normal / model.stiffest
    if not 1.0 / STIFFNESS_RATIO**2 <= ratio <= STIFFNESS_RATIO:
        yield (
            f"normal_stiffness is {normal:.3g} N/m per m, {ratio:.2g} times young of the stiffest "
            f'rock: give {model.stiffest:.2g}, or "auto"'
        )
    if shear is not None and not 1.0 / STIFFNESS_RATIO <= shear / normal <= STIFFNESS_RATIO:
        yield (
            f"shear_stiffness is {shear:.3g} N/m per m, {shear / normal:.2g} times "
            "normal_stiffness: leave it out, and it is equal"
        )
    sinking = _weight(model) / normal / max(1, int(model.block_count**0.5))
    if sinking > SINKING * _size(model):
        yield (
            f"normal_stiffness = {normal:.3g} lets blocks sink into each other by some "
            f"{sinking:.2g} m under their weight, {100.0 * sinking / _size(model):.2g} % of the "
            f"smallest block: raise it to {normal * sinking / (1e-4 * _size(model)):.1g}, or "
            'give "auto"'
        )
    tolerance = getattr(method.process, "tolerance", 0.0)
    if tolerance > LOOSE:
        yield (
            f"tolerance of the process is {tolerance:g}, so loose that steps are hardly solved: "
            "lower it to 1e-7, or leave it out"
        )


def _motion_doubts(model: Model, schedule: Schedule) -> Iterable[str]:
    """Say what the ground does before its record begins and after it ends, and how hard."""
    motion = model.ground_motion
    if not isinstance(motion, InertialForce | MovingBase):
        return
    record = motion.accelerogram
    first, last = float(record.time[0]), float(record.time[-1])
    peak = float(np.hypot(*record.acceleration.T).max())
    if first >= schedule.end or last <= 0.0:
        yield (
            f"the ground motion goes from {first:g} to {last:g} s, but the run from 0 to "
            f"{schedule.end:g} s: it is not felt. Shift its instants"
        )
        return
    if first > 0.0:
        yield (
            f"the ground motion begins at {first:g} s: until then the ground rests. Subtract "
            f"{first:g} s from its instants if it is to begin at once"
        )
    if first < 0.0:
        yield (
            f"the ground motion begins at {first:g} s, before the run: the ground moves already "
            "at 0 s. Let its instants begin at 0"
        )
    drift = float(np.hypot(*record.velocity(last)))
    if last < schedule.end and drift * (schedule.end - last) > LARGE_SHARE * _size(model):
        yield (
            f"the ground motion ends at {last:g} s with {drift:.3g} m/s, which the ground keeps "
            f"until {schedule.end:g} s: correct the record's base line, or let it end at rest"
        )
    if peak > HARDEST_SHAKING:
        yield (
            f"the ground is accelerated by up to {peak:.3g} m/s2, more than any earthquake: give "
            "m/s2, or a scale (0.01 for a record in cm/s2)"
        )
    if peak == 0.0:
        yield "the ground motion is zero throughout: check its columns and scale"


def _frame_doubts(schedule: Schedule) -> Iterable[str]:
    """Say where frames are kept more often than steps are made, or never."""
    if schedule.every < schedule.step * (1.0 - 1e-9):
        yield (
            f"output.every is {schedule.every:g} s, less than a step of {schedule.step:g} s: a "
            f"frame is kept after every step, {schedule.end / schedule.step:.3g} in all. Raise it"
        )
    elif schedule.end / schedule.every > MANY_FRAMES:
        yield (
            f"output.every of {schedule.every:g} s gives {schedule.end / schedule.every:.3g} "
            f"frames: raise it to {schedule.end / 100.0:.2g} s if the file is not to grow large"
        )
    elif schedule.every > schedule.end * (1.0 + 1e-9):
        yield (
            f"output.every is {schedule.every:g} s, longer than the run of {schedule.end:g} s: no "
            "frame is kept on the way. Lower it"
        )
