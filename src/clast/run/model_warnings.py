"""Warnings about a system of blocks before a run, each with its number and its remedy."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clast.actions.linings import linings_of
from clast.actions.motions import Motions
from clast.block.polygon import edges
from clast.errors import shortened
from clast.model.ground_motion import IncomingWave, MovingBase, Recorded
from clast.model.joints import WELD_STRENGTH
from clast.model.model import Floats, Ints, Model
from clast.model.water import Water
from clast.run.slide_warnings import slide_warnings

SOFTEST, HARDEST = 1e8, 2e12
"""Young's moduli outside look like kPa, MPa or GPa, Pa."""
LIGHTEST, HEAVIEST = 200.0, 25e3
"""Densities outside look like t/m3 or g/cm3, kg/m3."""
WEAKEST, STRONGEST = 1e3, 1e9
"""Strengths and stresses outside look like kPa or MPa, Pa."""
WEAKEST_GRAVITY, STRONGEST_GRAVITY = 0.1, 5e3
"""Gravity outside is that of no planet and no centrifuge, m/s2."""
LIGHTEST_LOAD, HEAVIEST_LOAD = 1e-4, 1e4
"""Loads outside these shares of the weight of the blocks look like kN or MN."""
STEEPEST = 75.0
"""Friction angles above are steeper than any joint's, degrees."""
COARSEST_ROUNDING = 1e-7
"""Coordinates rounded by more than this share of the smallest block have too few digits."""
SPREAD = 1e4
"""Ratio of block sizes above which a system is not simulated well."""
THIN = 1e-5
"""Thickness at a vertex, as a share of the block's extent, below which it is a spike or crack."""
DRIFTING = 0.1
"""Drift of the ground after its record, as a share of the smallest block, that is warned of."""
SOFTEST_SHAKING, HARDEST_SHAKING = 1e-4 * 9.80665, 5.0 * 9.80665
"""Peak accelerations outside are imperceptible, or beyond any recorded earthquake, m/s2."""
LIGHTEST_WATER, HEAVIEST_WATER = 950.0, 1300.0
"""Densities outside are not those of water, nor of a slurry, kg/m3."""
STEPS_OF_INTERVAL = 2
"""Fewer steps in an interval of a ground motion miss part of it."""
WEAKEST_BOLT = 1e3
"""Yield forces of bolts below look like kN, N/m."""
NAMED = 5
"""Blocks or rocks that a warning names, at most."""


def model_warnings(model: Model, step: float, end: float) -> list[str]:
    """Return the warnings about a system of blocks that is simulated in steps until ``end``, s."""
    return [
        *_support_warnings(model),
        *_idle_warnings(model),
        *_gravity_warnings(model),
        *_unit_warnings(model),
        *_strength_warnings(model),
        *_shape_warnings(model),
        *_motion_warnings(model, end),
        *_viscous_warnings(model, end),
        *_coarse_steps(model, step),
        *_water_warnings(model),
        *_bolt_warnings(model),
        *_lining_warnings(model),
        *_servo_warnings(model),
        *slide_warnings(model),
    ]


def named(model: Model, blocks: Ints) -> str:
    """Return the names of blocks as a warning lists them, the first few."""
    names = [f"'{shortened(model.block_name[block])}'" for block in blocks[:NAMED].tolist()]
    return ", ".join(names) + (", ..." if len(blocks) > NAMED else "")


def size_of_smallest(model: Model) -> float:
    """Return the size of the smallest block, m."""
    return float(np.sqrt(model.area.min()))


def weight_of(model: Model) -> float:
    """Return the weight of all blocks that can move, N/m."""
    return float(model.mass[~model.fixed].sum() * np.hypot(*model.gravity))


def load_on(model: Model) -> float:
    """Return the sum of the sizes of all loads, N/m."""
    points, lines = model.point_loads, model.line_loads
    length = np.hypot(*(lines.end - lines.start).T)
    alone = np.hypot(*points.force.T).sum() + (np.hypot(*lines.traction.T) * length).sum()
    return float(alone + _pressed(model).sum())


def _pressed(model: Model) -> Floats:
    """Return the mean size of each pressure times the length it acts on, N/m, shape (k,)."""
    loads, (_, length) = model.pressures, edges(model.vertices, model.block_start)
    share = loads.share[:, 1] - loads.share[:, 0]
    return np.asarray(np.abs(loads.pressure).mean(axis=1) * share * length[loads.edge])


def _support_warnings(model: Model) -> Iterator[str]:
    """Warn where no block or every block is held, and where a moving base leaves some behind."""
    held = bool(model.fixed.any()) or len(model.fixed_points.block) > 0
    # the outline of a rock mass under in-situ stress is held by springs beside its load
    held = held or (model.in_situ is not None and any(model.in_situ.held))
    held = held or len(model.viscous_edges) > 0 or bool(model.moved.any())
    if not held and model.gravity.any():
        yield "nothing is fixed: all blocks fall. Give a [[fixed_point]] or fixed = true"
    if model.fixed.all() and not model.moved.any():
        yield (
            f"all blocks are fixed ({model.block_count}): nothing can move. Remove fixed = true "
            "where blocks are to move"
        )
    elif isinstance(model.ground_motion, MovingBase) and model.fixed.any():
        yield (
            f"{int(model.fixed.sum())} fixed block(s) stay where they are while the base "
            "moves: hold blocks that move with the ground by fixed points"
        )


def _idle_warnings(model: Model) -> Iterator[str]:
    """Warn of input without effect: loads and supports of fixed blocks, rocks of no block."""
    points, lines = model.point_loads, model.line_loads
    fixed, measured = model.fixed_points, model.measured_points
    kinds = {
        "point load": points.block,
        "line load": lines.block,
        "pressure": model.pressures.block,
        "fixed point": fixed.block,
        "measured point": measured.block,
    }
    for kind, block in kinds.items():
        idle = block[model.fixed[block]]
        if len(idle) and not model.fixed.all():
            yield (
                f"{len(idle)} {kind}(s) on fixed blocks have no effect: "
                f"{named(model, np.unique(idle))}. Remove them, or fixed = true of the block"
            )
    sizes = {
        "point load": points.force,
        "line load": lines.traction,
        "pressure": model.pressures.pressure,
    }
    for kind, load in sizes.items():
        zero = int((~load.any(axis=1)).sum())
        if zero:
            yield f"{zero} {kind}(s) are zero: give a force, or remove them"
    total, weight = load_on(model), weight_of(model)
    if total and weight and not LIGHTEST_LOAD <= total / weight <= HEAVIEST_LOAD:
        size = "next to nothing beside" if total < weight else "out of proportion to"
        yield (
            f"all loads together are {total:.3g} N/m, {size} the weight of the blocks, "
            f"{weight:.3g} N/m; the unit is N/m: 5 kN/m are 5000"
        )
    numbers = [points.factor, lines.factor, model.pressures.factor]
    idle = np.setdiff1d(np.arange(len(model.factors)), np.concatenate(numbers))
    used = {water.factor.name for water in model.water if water.factor}
    used |= {name for action in model.actions for name in getattr(action, "tables", ())}
    idle = np.array([k for k in idle if model.factors[k].name not in used], np.int64)
    for number in idle[:NAMED].tolist():
        name = shortened(model.factors[number].name)
        yield f"no load has the amplitude '{name}': name it in a load, or remove it"
    unused = np.setdiff1d(np.arange(len(model.rocks)), model.block_rock)
    for rock in unused[:NAMED].tolist():
        name = shortened(model.rocks[rock].name)
        yield f"no block is made of rock '{name}': name it in a block, or remove it"


def _gravity_warnings(model: Model) -> Iterator[str]:
    """Warn where gravity points upwards, or nothing moves the blocks."""
    across, up = model.gravity.tolist()
    if up > 0.0:
        yield (
            f"gravity is ({across:g}, {up:g}) m/s2 and points upwards: blocks fall up. "
            f"y is positive upwards; write gravity = [{across:g}, {-up:g}]"
        )
    size = float(np.hypot(across, up))
    if size and not WEAKEST_GRAVITY <= size <= STRONGEST_GRAVITY:
        yield f"gravity is {size:g} m/s2; the unit is m/s2: on earth gravity = [0.0, -9.8]"
    driven = (
        model.gravity.any()
        or model.velocity.any()
        or model.initial_stress.any()
        or model.point_loads.force.any()
        or model.line_loads.traction.any()
        or model.pressures.pressure.any()
        or isinstance(model.ground_motion, Recorded)
        or model.moved.any()
    )
    if not driven:
        yield (
            "gravity, loads, velocities and stresses are all zero: nothing sets the blocks in "
            "motion. Give gravity = [0.0, -9.8] or a load"
        )


def _unit_warnings(model: Model) -> Iterator[str]:
    """Warn of moduli, densities and stresses that look like other units than SI."""
    for rock in model.rocks:
        where = f"rock '{shortened(rock.name)}'"
        # linings are compared with the rock when they are placed
        if rock.is_ground and not SOFTEST <= rock.young <= HARDEST:
            yield (
                f"{where}: young is {rock.young:g} Pa, outside the range of rock and brick (1e8 "
                "to 2e12); the unit is Pa: 50 GPa are 50e9"
            )
        if rock.poisson < 0.0:
            yield (
                f"{where}: poisson is {rock.poisson:g}: under pressure it would become narrower; "
                "rocks have 0.1 to 0.4"
            )
        if not LIGHTEST <= rock.density <= HEAVIEST:
            yield (
                f"{where}: density is {rock.density:g} kg/m3, outside the range of rock and "
                "brick; it is "
                "meant in kg/m3: 2.7 t/m3 are 2700"
            )
    largest = np.abs(model.initial_stress).max(axis=1)
    small = np.flatnonzero((largest > 0.0) & (largest < WEAKEST))
    if len(small) == model.block_count:
        yield (
            f"initial_stress is at most {largest.max():g} Pa, very small; the unit is Pa: "
            "10 MPa are 10e6"
        )
    young = np.array([rock.young for rock in model.rocks])[model.block_rock]
    strained = np.flatnonzero(largest > 0.01 * young)
    if len(strained):
        worst = int(strained[np.argmax((largest / young)[strained])])
        yield (
            f"initial_stress of {largest[worst]:g} Pa strains block {named(model, strained)} by "
            f"{100.0 * largest[worst] / young[worst]:.3g} %, beyond small strains: check it and "
            "young"
        )
    pulled = np.flatnonzero((model.initial_stress[:, :2] >= WEAKEST).all(axis=1))
    if len(pulled):
        xx, yy, _ = model.initial_stress[pulled[0]].tolist()
        yield (
            f"initial_stress ({xx:g}, {yy:g}) Pa pulls block {named(model, pulled)} both ways: "
            f"tension is positive; rock under pressure has ({-xx:g}, {-yy:g})"
        )


def _strength_warnings(model: Model) -> Iterator[str]:
    """Warn of joint strengths that look like other units than SI."""
    for joint in model.joint_table.joints:
        where = f"joint '{shortened(joint.name)}'"
        strengths = {"cohesion": joint.cohesion, "tensile_strength": joint.tensile_strength}
        for key, value in strengths.items():
            if 0.0 < value < WEAKEST:
                yield (
                    f"{where}: {key} is {value:g} Pa, very small; the unit is Pa: "
                    f"{value:g} kPa are {1e3 * value:g}"
                )
            if STRONGEST < value != WELD_STRENGTH:
                yield f"{where}: {key} is {value:g} Pa, stronger than any rock; the unit is Pa"
        if joint.friction_angle > STEEPEST:
            yield (
                f"{where}: friction_angle is {joint.friction_angle:g} degrees, a coefficient of "
                f"{np.tan(np.radians(joint.friction_angle)):.3g}; joints have 10 to 50"
            )
    default = model.joint_table.joints[0]
    smooth = default.friction_angle == 0.0 and default.roughness is None
    if model.block_count > 1 and smooth and default.cohesion == 0.0:
        yield (
            f"joint '{default.name}' is frictionless, and with it every contact that no other "
            "joint names: give friction_angle in [joint.default] if that is not intended"
        )


def _shape_warnings(model: Model) -> Iterator[str]:
    """Warn of coordinates with too few digits, of thin blocks and of very unequal ones."""
    size = size_of_smallest(model)
    far = float(np.abs(model.vertices + model.origin).max())
    rounding = float(np.spacing(far))
    if rounding > COARSEST_ROUNDING * size:
        yield (
            f"coordinates of {far:.3g} m are rounded to {rounding:.2g} m, but the smallest block "
            f"is only {size:.3g} m wide: too few digits are left for it. Subtract a common offset "
            "from all coordinates"
        )
    largest = float(np.sqrt(model.area.max()))
    if largest > SPREAD * size:
        smallest, broadest = int(model.area.argmin()), int(model.area.argmax())
        yield (
            f"block {named(model, np.array([smallest]))} is {size:.3g} m wide and block "
            f"{named(model, np.array([broadest]))} {largest:.3g} m: steps and tolerances follow "
            "the smallest. Leave it out, or check its coordinates"
        )
    thickness, block = _thickness(model)
    thin = np.flatnonzero(thickness < THIN)
    for vertex in thin[:1].tolist():
        x, y = (model.vertices[vertex] + model.origin).tolist()
        number = vertex - int(model.block_start[block[vertex]]) + 1
        more = f" (and {len(thin) - 1} more vertices)" if len(thin) > 1 else ""
        yield (
            f"block {named(model, block[[vertex]])} has a spike, a crack or a tiny edge at vertex "
            f"{number}, ({x:.9g}, {y:.9g}){more}: {thickness[vertex]:.2g} of its extent thin, too "
            "thin for contacts. Remove the vertex"
        )


def _thickness(model: Model) -> tuple[Floats, Ints]:
    """Return the thickness at each vertex, as a share of its block's extent, and the block (nv,).

    The thickness at a corner is the distance of one end of its shorter edge from its longer edge;
    at a flat or blunt corner it is not a thickness, and 1 is returned.
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


def _motion_warnings(model: Model, end: float) -> Iterator[str]:
    """Warn of ground motions outside of the run, with a drift, or of an unlikely strength."""
    motion = model.ground_motion
    if not isinstance(motion, Recorded):
        return
    record = motion.accelerogram
    first, last = float(record.time[0]), float(record.time[-1])
    peak = float(np.hypot(*record.acceleration.T).max())
    if first >= end or last <= 0.0:
        yield (
            f"the ground motion goes from {first:g} to {last:g} s, but the run from 0 to "
            f"{end:g} s: it has no effect. Shift its instants"
        )
        return
    if first > 0.0:
        yield (
            f"the ground motion begins at {first:g} s: until then the ground rests. Subtract "
            f"{first:g} s from its instants if it is to begin at once"
        )
    if first < 0.0:
        yield (
            f"the ground motion begins at {first:g} s, before the run: the ground is already "
            "moving at 0 s. Let its instants begin at 0"
        )
    drift = float(np.round(np.hypot(*record.velocity(last)), 12))
    if last < end and drift * (end - last) > DRIFTING * size_of_smallest(model):
        yield (
            f"the ground motion ends at {last:g} s with {drift:.3g} m/s, which the ground keeps "
            f"until {end:g} s: correct the record's base line, or let it end at rest"
        )
    elif last < end:
        kept = f"goes on at {drift:.3g} m/s" if drift else "rests"
        yield (
            f"the ground motion ends at {last:g} s, before the run at {end:g} s: after it the "
            f"ground {kept}. Lower time.end if that is not intended"
        )
    if peak > HARDEST_SHAKING:
        yield (
            f"the ground is accelerated by up to {peak:.3g} m/s2, more than any earthquake: give "
            "m/s2, or a scale (0.01 for a record in cm/s2)"
        )
    if peak < SOFTEST_SHAKING:
        yield (
            f"the ground is accelerated by no more than {peak:.3g} m/s2, which nobody would feel: "
            "check the columns and the scale of the record"
        )


def _viscous_warnings(model: Model, end: float) -> Iterator[str]:
    """Warn of viscous edges that carry no weight, begin after the end, or miss the wave."""
    edges = model.viscous_edges
    if not len(edges):
        return
    at_once = edges.begins == 0.0
    loose = at_once & (edges.kept > 0.0) & (model.in_situ is None)
    supported = bool(model.fixed.any()) or len(model.fixed_points.block) > 0
    supported = supported or bool(model.moved.any())
    if loose.any() and model.gravity.any() and not supported:
        yield (
            f"{int(loose.sum())} viscous edge(s) begin at once and carry no weight: the blocks "
            "sink into them. Give [in_situ], whose traction stays on them, or begins in "
            "[[viscous_boundary]], so that springs hold them until then"
        )
    last = float(edges.begins[np.isfinite(edges.begins)].max(initial=0.0))
    if last >= end:
        yield (
            f"a viscous boundary begins at {last:g} s, but the run ends at {end:g} s: springs hold "
            "it all the time. Lower begins, or raise time.end"
        )
    motion = model.ground_motion
    if not isinstance(motion, IncomingWave):
        return
    record = motion.accelerogram
    if last > float(record.time[0]) and np.abs(record.velocity(last)).max() > 0.0:
        yield (
            f"a viscous boundary begins at {last:g} s, when the ground motion has begun: earlier "
            "motion does not enter there. Shift the instants of the record"
        )


def _coarse_steps(model: Model, step: float) -> Iterator[str]:
    """Warn of steps that are too long for the intervals of a ground motion."""
    motion = model.ground_motion
    if not isinstance(motion, Recorded):
        return
    intervals = np.diff(motion.accelerogram.time)
    usual = float(np.median(intervals[intervals > 0.0]))
    if step * STEPS_OF_INTERVAL > usual * (1.0 + 1e-9):
        yield (
            f"a step of {step:g} s is longer than half the interval of the ground motion, "
            f"{usual:g} s: faster motion is averaged over a step. Lower time.step to "
            f"{usual / STEPS_OF_INTERVAL:g}"
        )


def _water_warnings(model: Model) -> Iterator[str]:
    """Warn of water without effect, over everything, of odd density, or twice in one joint."""
    top = float(model.vertices[:, 1].max())
    gravity = float(np.hypot(*model.gravity))
    for number, water in enumerate(model.water, 1):
        called = f"water {number}" + (f" '{shortened(water.name)}'" if water.name else "")
        owner = model.vertex_block
        wetted = [owner[water.faces.edge], owner[water.joints.edge.ravel()]]
        never = water.share == 0.0 or (water.factor and not water.factor.value.any())
        if never or model.fixed[np.concatenate(wetted)].all():
            why = "its amplitude is zero" if never else "all blocks that it touches are fixed"
            yield f"{called} has no effect: {why}. Remove it, or give it blocks that it can move"
        if float(water.surface[:, 1].min()) > top:
            over = float(water.surface[:, 1].min()) - top
            yield (
                f"{called} stands {over:.3g} m above the highest block: everything is under water. "
                "Lower it if that is not intended"
            )
        density = water.weight / gravity
        if not LIGHTEST_WATER <= density <= HEAVIEST_WATER:
            yield f"{called} has a density of {density:g} kg/m3; water has 1000, sea water 1025"
    for one, first in enumerate(model.water):
        for other, second in enumerate(model.water[one + 1 :], one + 1):
            both = np.intersect1d(_joints_of(first, model), _joints_of(second, model))
            if len(both):
                yield (
                    f"waters {one + 1} and {other + 1} are both in {len(both)} joints, where their "
                    "pressures add up: assign different joints to each, unless stages change "
                    "from one to the other"
                )


def _joints_of(water: Water, model: Model) -> Ints:
    """Return a number for each pair of edges between which a water is, shape (k,)."""
    first, second = water.joints.edge.T
    return np.asarray(first * len(model.vertices) + second)


def _bolt_warnings(model: Model) -> Iterator[str]:
    """Warn of bolts that can do nothing, and of forces that look like kN."""
    bolts = model.bolts
    idle = model.fixed[bolts.blocks].all(axis=1)
    acting = np.unique(bolts.of_spring[~idle])
    for k in np.setdiff1d(np.arange(len(bolts)), acting)[:NAMED]:
        yield (
            f"bolt '{shortened(bolts.name[k])}' is anchored in blocks that are all fixed: it has "
            "no effect. Move an end into a block that can move, or leave it out"
        )
    forces = bolts.yield_force[np.isfinite(bolts.yield_force)]
    if len(forces) and forces.max() < WEAKEST_BOLT:
        yield (
            f"bolts yield at {forces.max():g} N/m at most: that looks like kN. Give yield_force in "
            "N per metre of thickness"
        )


def _lining_warnings(model: Model) -> Iterator[str]:
    """Warn of linings that are to be bonded where there is no rock."""
    linings, _ = linings_of(model)
    for one in linings.each if linings else ():
        if len(one.loose):
            yield (
                f"Lining '{shortened(one.name)}' has no rock beside {len(one.loose)} of its "
                f"{len(one.segments)} segments ({named(model, one.loose)}): those segments carry "
                "no load. Draw it along the faces of blocks, or without joint."
            )


def _servo_warnings(model: Model) -> Iterator[str]:
    """Warn of servos that press with a stress in another unit than Pa, or a force in another."""
    motions = [
        one for action in model.actions if isinstance(action, Motions) for one in action.each
    ]
    for one in motions:
        if one.servo is None:
            continue
        first, past = model.block_start[one.block[0] :][:2]
        width, height = np.ptp(model.vertices[first:past], axis=0).tolist()
        stress = float((one.servo.largest / (height, width)).max())
        if not WEAKEST <= stress <= STRONGEST:
            size = "very small" if stress < WEAKEST else "stronger than any rock"
            yield (
                f"{one.label} presses with {stress:g} Pa, {size}; the unit of stress is Pa: 1 MPa "
                "is 1e6; that of force is N per metre of thickness"
            )
