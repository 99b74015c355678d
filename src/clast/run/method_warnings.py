"""Warnings about how a system is to be simulated, each with its number and its remedy."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from clast.actions.damping import Adaptive, Kinetic, Rayleigh
from clast.block.polygon import edges
from clast.contact.joints.along_joint import range_of_springs
from clast.contact.joints.bonds import ROUNDED_GAP
from clast.errors import ModelError, shortened
from clast.model.flow.given import FULL
from clast.model.ground_motion import MovingBase, Recorded, highest_frequency
from clast.model.model import Floats, Model
from clast.model.stages import EQUILIBRIUM, TIME
from clast.run.model_warnings import load_on, named, size_of_smallest, weight_of
from clast.step.integration import forces_at
from clast.step.method import is_stable_for_any_step

if TYPE_CHECKING:
    from clast.contact.contacts import Contacts
    from clast.run.schedule import Schedule
    from clast.step.method import Method

LENGTHS = 1e-6, 0.1
"""Usual max_displacement and critdis, in sizes of the smallest block."""
JOINT_STIFFNESS_RATIO = 1e4
"""Stiffnesses of joints, and of blocks by their size, are within this factor as a rule."""
STIFFNESS_RATIO = 1e3
"""Normal stiffness by E, and shear by normal stiffness, are within this factor as a rule."""
WAVE_LOSS_MAX = 0.05
"""Fraction of their height that waves may lose to the time steps."""
STEPS_OF_PERIOD = 20.0
"""Steps a period with which a wave is followed."""
REVERSING = 2.0
"""Mass damping c with c h above this leaves a velocity of the other sign."""


def method_warnings(model: Model, method: Method, schedule: Schedule) -> list[str]:
    """Return the warnings about method and schedule of a run."""
    return [
        *_length_warnings(model, method),
        *_overlap_warnings(model, method),
        *_stiffness_warnings(model, method),
        *_joint_stiffness_warnings(model, method),
        *_static_warnings(model, method),
        *_support_warnings(model, method),
        *_slipping_warnings(model, method, schedule),
        *_damping_warnings(model, method, schedule),
        *_wave_warnings(model, method, schedule),
        *_schedule_warnings(model, schedule),
        *_stage_warnings(schedule),
    ]


def _length_warnings(model: Model, method: Method) -> Iterator[str]:
    size = size_of_smallest(model)
    lengths = {"time.max_displacement": method.max_displacement, "critdis": method.critdis}
    for key, length in lengths.items():
        if length > LENGTHS[1] * size:
            yield (
                f"{key} is {length:g} m, but the smallest block is only {size:.3g} m wide: lower "
                f"it to {0.01 * size:.2g} m"
            )
        if length < LENGTHS[0] * size:
            yield (
                f"{key} is {length:g} m, very small beside the smallest block of "
                f"{size:.3g} m: raise it to {0.005 * size:.2g} m, or leave it out"
            )
    # twice the area by the outline: of slabs their thickness, of squares half of their side
    _, sides = edges(model.vertices, model.block_start)
    thickness = 2.0 * model.area / np.add.reduceat(sides, model.block_start[:-1])
    thinnest = int(np.argmin(thickness))
    if 0.5 * thickness[thinnest] < method.critdis <= LENGTHS[1] * size:
        yield (
            f"critdis is {method.critdis:g} m, but block {named(model, np.array([thinnest]))} is "
            f"only {thickness[thinnest]:.3g} m thick: contacts would reach through it; lower "
            f"critdis to {0.25 * thickness[thinnest]:.2g} m"
        )


def check_coupling(model: Model, method: Method) -> None:
    """Refuse water that moves blocks in the same equations where the process cannot solve them."""
    full = model.flow is not None and model.flow.coupling == FULL
    if full and not getattr(method.process, "couples_water", False):
        raise ModelError(
            'coupling = "full" is solved by the process "convex" alone',
            where="flow, coupling",
            remedy='set method.process = "convex", or leave coupling = "none"',
        )


def check_overlaps(model: Model, method: Method) -> None:
    """Refuse overlaps that no contact of this stiffness can have left.

    The energy p d2/2 of a contact comes from the load on it, or from a fall of the lighter block,
    at most from the top of the scene to its bottom.
    """
    if len(model.overlaps.depth) == 0:
        return
    stiffness = range_of_springs(model, method.contact_law.normal_stiffness)[0]
    weight = weight_of(model)
    stress_force = np.abs(model.initial_stress).max(axis=1) * np.sqrt(model.area)
    load = load_on(model) + float(stress_force.max())
    mass = np.where(model.fixed, np.inf, model.mass)[model.overlaps.pair].min(axis=1)
    mass = np.where(np.isfinite(mass), mass, 0.0)
    fall = float(np.ptp(model.vertices @ model.gravity))
    speed = float(np.hypot(model.velocity[:, 0], model.velocity[:, 1]).max())
    held = (weight + load) ** 2 / (2.0 * stiffness)
    known = held + mass * (fall + 0.5 * speed**2)
    stored = 0.5 * stiffness * model.overlaps.depth**2
    unknown = np.flatnonzero(stored > known)
    if not len(unknown):
        return
    worst = int(unknown[np.argmax(stored[unknown])])
    one, other = (named(model, model.overlaps.pair[worst, [k]]) for k in (0, 1))
    depth = float(model.overlaps.depth[worst])
    more = f"; so do {len(unknown) - 1} more pairs" if len(unknown) > 1 else ""
    raise ModelError(
        f"overlaps block {other} to a depth of {depth:.3g} m{more}: with normal_stiffness = "
        f"{stiffness:.3g} a contact would push them apart with {stiffness * depth:.3g} N/m, and "
        f"all blocks weigh {weight:.3g} N/m",
        where=f"block {one}",
        remedy="move or cut the blocks so that they do not overlap; where coordinates are rounded, "
        f"{_repair_of(depth)} joins neighbours",
    )


def open_joint_warnings(model: Model, contacts: Contacts) -> Iterator[str]:
    """Warn of joints with strength that are a little open at the start, by their ``contacts``."""
    strong = np.max(model.joint_table.strengths[1:], axis=0) > 0.0
    ends = contacts.vertex_block, contacts.edge_block
    size = np.sqrt(np.minimum(*(model.area[blocks] for blocks in ends)))
    little = (contacts.gap > ROUNDED_GAP * size) & (contacts.gap <= 1e-3 * size)
    rows = np.flatnonzero(little & strong[contacts.joint] & (contacts.length > 0.0))
    if not len(rows):
        return
    widest, others = rows[np.argmax(contacts.gap[rows])], len(np.unique(contacts.pair[rows])) - 1
    gap, more = float(contacts.gap[widest]), f", and {others} more pairs by less" if others else ""
    one, other = (named(model, blocks[[widest]]) for blocks in ends)
    yield (
        f"blocks {one} and {other} are {gap:.2g} m apart at the start{more}: across an open joint "
        "cohesion and tensile strength hold nothing. If they are meant to touch, "
        f"{_repair_of(gap)} puts them together"
    )


def _repair_of(depth: float) -> str:
    """Return the table of a case that puts blocks together over ``depth``, m, at most."""
    digit = 10.0 ** math.floor(math.log10(depth))
    return f"[repair] tolerance = {math.ceil(1.5 * depth / digit - 1e-6) * digit:.2g}"


def _overlap_warnings(model: Model, method: Method) -> Iterator[str]:
    depth = model.overlaps.depth
    if len(depth) == 0:
        return
    worst = int(np.argmax(depth))
    one, other = (named(model, model.overlaps.pair[worst, [k]]) for k in (0, 1))
    force = method.contact_law.normal_stiffness * depth[worst]
    more = f", and {len(depth) - 1} more pairs by less" if len(depth) > 1 else ""
    yield (
        f"blocks {one} and {other} overlap by {depth[worst]:.3g} m at the start{more}: contacts "
        f"press them apart with {force:.3g} N/m. Blocks from the end of a run may; other blocks "
        f"should not overlap: {_repair_of(float(depth[worst]))} puts them together"
    )


def _stiffness_warnings(model: Model, method: Method) -> Iterator[str]:
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
            "normal_stiffness: leave it out for the same value"
        )
    sinking = weight_of(model) / normal / max(1, int(model.block_count**0.5))
    share = sinking / size_of_smallest(model)
    if share > 0.01:
        yield (
            f"normal_stiffness = {normal:.3g} lets blocks sink into each other by some "
            f"{sinking:.2g} m under their weight, {100.0 * share:.2g} % of the smallest block: "
            f'raise it to {normal * share / 1e-4:.1g}, or give "auto"'
        )
    for kind, part in (("process", method.process), ("solver", method.solver)):
        tolerance = getattr(part, "tolerance", 0.0)
        if tolerance > 1e-3:
            yield (
                f"tolerance of the {kind} is {tolerance:g}, too loose to solve the steps: leave "
                "it out"
            )


def _joint_stiffness_warnings(model: Model, method: Method) -> Iterator[str]:
    size = float(np.sqrt(np.median(model.area)))
    usual = model.stiffest / size
    for joint in model.joint_table.joints:
        normal, shear = joint.normal_stiffness, joint.shear_stiffness
        for key, value in (("normal_stiffness", normal), ("shear_stiffness", shear)):
            ratio = 1.0 if value is None else value / usual
            if not 1.0 / JOINT_STIFFNESS_RATIO <= ratio <= JOINT_STIFFNESS_RATIO:
                yield (
                    f"{key} of joint '{joint.name}' is {value:.3g} Pa/m, {ratio:.2g} times that of "
                    f"a block of {size:.3g} m, young by its size: check that it is in Pa/m (1 "
                    "MPa/mm is 1e9)"
                )
        if (normal is None) != (shear is None):
            key, other = ("normal", "shear") if shear is None else ("shear", "normal")
            yield (
                f"joint '{joint.name}' has a {key}_stiffness only: its {other} springs are those "
                f"of method.contact_law. Give {other}_stiffness, too, in Pa/m"
            )


def _static_warnings(model: Model, method: Method) -> Iterator[str]:
    if method.dynamic_ratio == 0.0 and model.velocity.any():
        yield (
            "blocks have a velocity at the start, but dynamic_ratio = 0 forgets velocities at "
            "every step: raise it to 1 for a dynamic run"
        )
    hardest = range_of_springs(model, method.contact_law.normal_stiffness)[1]
    stiffest = max(hardest, model.stiffest)
    if len(model.fixed_points.block) and method.fixed_point_stiffness < 10.0 * stiffest:
        yield (
            f"fixed_point_stiffness is {method.fixed_point_stiffness:.3g} N/m per m, "
            f"{method.fixed_point_stiffness / stiffest:.2g} times contacts or rock: fixed points "
            f"give way. Raise it to {100.0 * stiffest:.1g}, or leave it out"
        )


def _support_warnings(model: Model, method: Method) -> Iterator[str]:
    static = method.dynamic_ratio == 0.0 and not is_stable_for_any_step(method.process)
    if static and model.is_driven:
        yield (
            "motions are prescribed in a static run, and the process is not convex: its steps keep "
            "their inertia, so moved blocks lag behind and forces depend on the step. Use "
            'process = "convex", or check that results do not change with half of time.step'
        )


def _slipping_warnings(model: Model, method: Method, schedule: Schedule) -> Iterator[str]:
    """Warn of supports that move under forces that the mass term of static steps holds back.

    Friction carries a block by theta mu g h2 a step at most.
    """
    motion, gravity = model.ground_motion, float(np.hypot(*model.gravity))
    if is_stable_for_any_step(method.process) or not isinstance(motion, MovingBase):
        return
    shaken = [stage.dynamic_ratio for stage in schedule.stages if stage.ground_motion] or [None]
    if min(method.dynamic_ratio if ratio is None else ratio for ratio in shaken) > 0.0:
        return
    fastest = motion.accelerogram.fastest
    table = model.joint_table
    of_rough = np.tan(table.roughness.residual) / table.roughness.reduction
    friction = float(np.where(table.rough, of_rough, table.strengths[0]).min())
    bound = method.integrator.theta * friction * gravity * schedule.step
    if fastest > bound:
        yield (
            f"supports move by up to {fastest:.3g} m/s, and static steps of this process, which "
            f"keep their mass term, carry a block on friction alone by {bound:.3g} m/s at most: it "
            'slips. Set method.process = "convex", whose static steps have next to no mass term'
        )


def _damping_warnings(model: Model, method: Method, schedule: Schedule) -> Iterator[str]:
    damping = method.damping
    if isinstance(damping, Adaptive | Kinetic) and isinstance(model.ground_motion, Recorded):
        yield (
            f'damping "{type(damping).__name__.lower()}" is for static stages: it takes energy '
            "of the ground motion. Use [damping] with mass and stiffness, or none"
        )
    if not isinstance(damping, Rayleigh):
        return
    gravity = float(np.hypot(*model.gravity))
    if damping.mass > 0.0 and gravity > 0.0 and damping.mass * schedule.end > 0.05:
        yield (
            f"damping.mass = {damping.mass:g} 1/s also slows blocks that fall or slide: none "
            f"exceeds {gravity / damping.mass:.3g} m/s. Use damping.stiffness where blocks are to "
            "fall"
        )
    if damping.mass * schedule.step > REVERSING:
        yield (
            f"damping.mass = {damping.mass:g} 1/s reverses velocities in steps of "
            f"{schedule.step:g} s: lower time.step to {REVERSING / damping.mass:.2g}, or mass to "
            f"{REVERSING / schedule.step:.2g}"
        )


def _wave_warnings(model: Model, method: Method, schedule: Schedule) -> Iterator[str]:
    """Warn where the time steps take from waves of a record, or are too long to follow them.

    A motion of frequency w loses exp(-(theta + alpha - 1) w2 h t/2) of its height, with alpha the
    place in the step at which forces are taken: exp(-w2 h t/4) by constant acceleration.
    """
    # Whether blocks swing in any stage: they keep their velocity, undamped or by Rayleigh.
    parts = [(stage.dynamic_ratio, stage.damping) for stage in schedule.stages] or [(None, None)]
    if not any(
        (method.dynamic_ratio if ratio is None else ratio) >= 1.0
        and not isinstance(damping or method.damping, Adaptive | Kinetic)
        for ratio, damping in parts
    ):
        return
    integrator = method.integrator
    loss = 0.5 * (integrator.theta + forces_at(integrator) - 1.0)
    for what, time, values in _records(model):
        frequency = highest_frequency(time, values)
        circular, step = 2.0 * np.pi * frequency, schedule.step
        last = float(time[-1]) if schedule.stages else min(schedule.end, float(time[-1]))
        length = max(0.0, last - float(time[0]))
        taken = -math.expm1(-loss * circular**2 * step * length)
        if frequency < 0.1 * own_frequency(model):
            continue
        if frequency * step * STEPS_OF_PERIOD > 1.0 + WAVE_LOSS_MAX:
            yield (
                f"{what} has frequencies up to {frequency:.3g} Hz, which a step of {step:g} s "
                f"makes {1.0 / (frequency * step):.2g} a period: lower time.step to "
                f"{1.0 / (STEPS_OF_PERIOD * frequency):.2g}, {STEPS_OF_PERIOD:g} a period"
            )
        elif taken > WAVE_LOSS_MAX:
            shorter = -math.log1p(-WAVE_LOSS_MAX) / (loss * circular**2 * length)
            yield (
                f"{what} has frequencies up to {frequency:.3g} Hz, and the time steps damp "
                f"vibrations of that frequency by {100.0 * taken:.2g} % in its {length:.3g} s "
                f"({100.0 * loss * circular * step:.2g} % of critical): set "
                f'method.integrator = "midpoint", which damps none, or lower time.step to '
                f"{shorter:.2g}"
            )


def own_frequency(model: Model) -> float:
    """Return about the lowest frequency of the blocks together, Hz: c_s/(4 L), joints included.

    L is their largest extent, c_s the slowest speed of shear waves in any rock.
    """
    size = float(np.sqrt(np.median(model.area)))
    joints = [one.shear_stiffness for one in model.joint_table.joints if one.shear_stiffness]
    soft = 1.0 / (min(joints) * size) if joints else 0.0
    speeds = [
        1.0 / np.sqrt((2.0 * (1.0 + rock.poisson) / rock.young + soft) * rock.density)
        for rock in model.rocks
    ]
    return float(min(speeds)) / (4.0 * float(np.ptp(model.vertices, axis=0).max()))


def _records(model: Model) -> Iterator[tuple[str, Floats, Floats]]:
    """Give name, instants (k,), s, and values (k, c) of all that acts on the blocks over time."""
    if isinstance(model.ground_motion, Recorded):
        record = model.ground_motion.accelerogram
        yield "the ground motion", record.time, record.acceleration
    for factor in model.factors:
        yield f"amplitude '{shortened(factor.name)}'", factor.time, factor.value[:, None]


def _schedule_warnings(model: Model, schedule: Schedule) -> Iterator[str]:
    fall = 0.5 * float(np.hypot(*model.gravity)) * schedule.step**2
    if fall > size_of_smallest(model):
        yield (
            f"a block falls by {fall:.3g} m in a step of {schedule.step:g} s, more than the width "
            f"of the smallest block, {size_of_smallest(model):.3g} m: steps will be cut. Lower "
            "time.step"
        )
    frames = schedule.end / schedule.every
    vertex, block = 72, 560  # bytes in a frame, with some contacts
    size = min(frames, schedule.end / schedule.step) * (
        vertex * len(model.vertices) + block * model.block_count
    )
    if schedule.every < schedule.step * (1.0 - 1e-9):
        yield (
            f"output.every is {schedule.every:g} s, less than a step of {schedule.step:g} s: a "
            f"frame is written after every step, {schedule.end / schedule.step:.3g} in all. Raise "
            "it"
        )
    if size > 2e9:
        yield (
            f"output.every of {schedule.every:g} s makes a result file of some {size / 1e9:.2g} "
            f"GB: raise it to {schedule.end / 100.0:.2g} s"
        )


def _stage_warnings(schedule: Schedule) -> Iterator[str]:
    for stage in schedule.stages:
        called = f"stage '{shortened(stage.name)}'"
        length, step = stage.time or schedule.end, stage.step or schedule.step
        if stage.every is not None and stage.every < step * (1.0 - 1e-9):
            yield (
                f"{called}: every is {stage.every:g} s, less than a step of {step:g} s: a frame "
                f"is written after every step, {length / step:.3g} in all. Raise it"
            )
        if stage.until == EQUILIBRIUM and stage.hold > length / step * (1.0 + 1e-9):
            yield (
                f"{called} has {length / step:.3g} steps, and equilibrium has to hold for "
                f"{stage.hold}: it ends at its limit of {length:g} s. Raise its time, lower hold, "
                f'or write until = "{TIME}"'
            )
