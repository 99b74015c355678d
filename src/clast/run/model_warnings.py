"""Warnings about a system of blocks before a run, each with its number and its remedy."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np

from clast.actions.linings import linings_of
from clast.actions.motions import Motions
from clast.block.polygon import edges
from clast.errors import shortened
from clast.model.edges import edges_of, facing_edges
from clast.model.ground_motion import IncomingWave, MovingBase, Recorded
from clast.model.joints import WELD_STRENGTH
from clast.model.model import Bools, Floats, Ints, Model

USUAL = {
    "young": (1e8, 2e12),
    "density": (200.0, 25e3),
    "stress": (1e3, 1e9),
    "gravity": (0.1, 5e3),
    "loads": (1e-4, 1e4),
    "shaking": (1e-4 * 9.80665, 5.0 * 9.80665),
    "density of water": (950.0, 1300.0),
}
"""Quantity -> least and largest usual value, SI (loads: in weights of the blocks), outside of which
it looks like another unit."""
STEPS_OF_INTERVAL = 2
"""Fewer steps in an interval of a ground motion miss part of it."""
BENDS = np.radians(3.0), np.radians(60.0)
"""Bends of the ground below are none, and above are two faces, rad."""
NAMED = 5
"""Blocks or rocks that a warning names, at most."""


def is_usual(quantity: str, value: float) -> bool:
    """Return whether a value is within the usual range of its quantity."""
    least, most = USUAL[quantity]
    return bool(least <= value <= most)


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


def named(model: Model, blocks: Ints, most: int = NAMED) -> str:
    """Return the names of blocks as a warning lists them, the first few."""
    names = [f"'{shortened(model.block_name[block])}'" for block in blocks[:most].tolist()]
    return ", ".join(names) + (", ..." if len(blocks) > most else "")


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


def _is_supported(model: Model) -> bool:
    return bool(model.fixed.any() or len(model.fixed_points.block) or model.moved.any())


def _support_warnings(model: Model) -> Iterator[str]:
    # the outline of a rock mass under in-situ stress is held by springs beside its load
    held = model.in_situ is not None and any(model.in_situ.held)
    if not (held or _is_supported(model) or len(model.viscous_edges)) and model.gravity.any():
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
    loads: dict[str, tuple[Any, Floats]] = {
        "point load": (model.point_loads, model.point_loads.force),
        "line load": (model.line_loads, model.line_loads.traction),
        "pressure": (model.pressures, model.pressures.pressure),
    }
    blocks = {kind: one.block for kind, (one, _) in loads.items()}
    blocks |= {
        "fixed point": model.fixed_points.block,
        "measured point": model.measured_points.block,
    }
    for kind, block in blocks.items():
        idle = block[model.fixed[block]]
        if len(idle) and not model.fixed.all():
            yield (
                f"{len(idle)} {kind}(s) on fixed blocks have no effect: "
                f"{named(model, np.unique(idle))}. Remove them, or fixed = true of the block"
            )
    for kind, (_, size) in loads.items():
        zero = int((~size.any(axis=1)).sum())
        if zero:
            yield f"{zero} {kind}(s) are zero: give a force, or remove them"
    total, weight = load_on(model), weight_of(model)
    if total and weight and not is_usual("loads", total / weight):
        compared = "next to nothing beside" if total < weight else "out of proportion to"
        yield (
            f"all loads together are {total:.3g} N/m, {compared} the weight of the blocks, "
            f"{weight:.3g} N/m; the unit is N/m: 5 kN/m are 5000"
        )
    numbers = {int(k) for one, _ in loads.values() for k in one.factor}
    used = {water.factor.name for water in model.water if water.factor}
    heads = model.flow.boundaries if model.flow else ()
    used |= {one.factor.name for one in heads if one.factor}
    used |= {name for action in model.actions for name in getattr(action, "tables", ())}
    used |= {factor.name for k, factor in enumerate(model.factors) if k in numbers}
    for name in [one.name for one in model.factors if one.name not in used][:NAMED]:
        yield f"no load has the amplitude '{shortened(name)}': name it in a load, or remove it"
    unused = np.setdiff1d(np.arange(len(model.rocks)), model.block_rock)
    for rock in unused[:NAMED].tolist():
        name = shortened(model.rocks[rock].name)
        yield f"no block is made of rock '{name}': name it in a block, or remove it"


def _gravity_warnings(model: Model) -> Iterator[str]:
    across, up = model.gravity.tolist()
    if up > 0.0:
        yield (
            f"gravity is ({across:g}, {up:g}) m/s2 and points upwards: blocks fall up. "
            f"y is positive upwards; write gravity = [{across:g}, {-up:g}]"
        )
    size = float(np.hypot(across, up))
    if size and not is_usual("gravity", size):
        yield f"gravity is {size:g} m/s2; the unit is m/s2: on earth gravity = [0.0, -9.8]"
    loads = model.point_loads.force, model.line_loads.traction, model.pressures.pressure
    drives = (model.gravity, model.velocity, model.initial_stress, model.moved, *loads)
    if not any(one.any() for one in drives) and not isinstance(model.ground_motion, Recorded):
        yield (
            "gravity, loads, velocities and stresses are all zero: nothing sets the blocks in "
            "motion. Give gravity = [0.0, -9.8] or a load"
        )


def _unit_warnings(model: Model) -> Iterator[str]:
    for rock in model.rocks:
        where = f"rock '{shortened(rock.name)}'"
        # linings are compared with the rock when they are placed
        if rock.is_ground and not is_usual("young", rock.young):
            yield (
                f"{where}: young is {rock.young:g} Pa, outside the range of rock and brick (1e8 "
                "to 2e12); the unit is Pa: 50 GPa are 50e9"
            )
        if rock.poisson < 0.0:
            yield (
                f"{where}: poisson is {rock.poisson:g}: under pressure it would become narrower; "
                "rocks have 0.1 to 0.4"
            )
        if not is_usual("density", rock.density):
            yield (
                f"{where}: density is {rock.density:g} kg/m3, outside the range of rock and "
                "brick; it is "
                "meant in kg/m3: 2.7 t/m3 are 2700"
            )
    largest, (weakest, _) = np.abs(model.initial_stress).max(axis=1), USUAL["stress"]
    small = np.flatnonzero((largest > 0.0) & (largest < weakest))
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
    pulled = np.flatnonzero((model.initial_stress[:, :2] >= weakest).all(axis=1))
    if len(pulled):
        xx, yy, _ = model.initial_stress[pulled[0]].tolist()
        yield (
            f"initial_stress ({xx:g}, {yy:g}) Pa pulls block {named(model, pulled)} both ways: "
            f"tension is positive; rock under pressure has ({-xx:g}, {-yy:g})"
        )


def _strength_warnings(model: Model) -> Iterator[str]:
    for joint in model.joint_table.joints:
        where = f"joint '{shortened(joint.name)}'"
        strengths = {"cohesion": joint.cohesion, "tensile_strength": joint.tensile_strength}
        for key, value in strengths.items():
            if 0.0 < value < USUAL["stress"][0]:
                yield (
                    f"{where}: {key} is {value:g} Pa, very small; the unit is Pa: "
                    f"{value:g} kPa are {1e3 * value:g}"
                )
            if USUAL["stress"][1] < value != WELD_STRENGTH:
                yield f"{where}: {key} is {value:g} Pa, stronger than any rock; the unit is Pa"
        if joint.friction_angle > 75.0:
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
    size = size_of_smallest(model)
    far = float(np.abs(model.vertices + model.origin).max())
    rounding = float(np.spacing(far))
    if rounding > 1e-7 * size:
        yield (
            f"coordinates of {far:.3g} m are rounded to {rounding:.2g} m, but the smallest block "
            f"is only {size:.3g} m wide: too few digits are left for it. Subtract a common offset "
            "from all coordinates"
        )
    largest = float(np.sqrt(model.area.max()))
    if largest > 1e4 * size:
        smallest, broadest = int(model.area.argmin()), int(model.area.argmax())
        yield (
            f"block {named(model, np.array([smallest]))} is {size:.3g} m wide and block "
            f"{named(model, np.array([broadest]))} {largest:.3g} m: steps and tolerances follow "
            "the smallest. Leave it out, or check its coordinates"
        )
    thickness, block = _thickness(model)
    thin = np.flatnonzero(thickness < 1e-5)
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
    block, start, after = model.vertex_block, model.block_start, model.vertex_after
    before = np.argsort(after)
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
    if last < end and drift * (end - last) > 0.1 * size_of_smallest(model):
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
    if peak > USUAL["shaking"][1]:
        yield (
            f"the ground is accelerated by up to {peak:.3g} m/s2, more than any earthquake: give "
            "m/s2, or a scale (0.01 for a record in cm/s2)"
        )
    if peak < USUAL["shaking"][0]:
        yield (
            f"the ground is accelerated by no more than {peak:.3g} m/s2, which nobody would feel: "
            "check the columns and the scale of the record"
        )


def _viscous_warnings(model: Model, end: float) -> Iterator[str]:
    edges = model.viscous_edges
    if not len(edges):
        return
    at_once = edges.begins == 0.0
    loose = at_once & (edges.kept > 0.0) & (model.in_situ is None)
    if loose.any() and model.gravity.any() and not _is_supported(model):
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
    gravity = float(np.hypot(*model.gravity))
    for number, water in enumerate(model.water, 1):
        called = f"water {number}" + (f" '{shortened(water.name)}'" if water.name else "")
        owner = model.vertex_block
        wetted = [owner[water.faces.edge], owner[water.joints.edge.ravel()]]
        never = water.share == 0.0 or (water.factor and not water.factor.value.any())
        if never or model.fixed[np.concatenate(wetted)].all():
            why = "its amplitude is zero" if never else "all blocks that it touches are fixed"
            yield f"{called} has no effect: {why}. Remove it, or give it blocks that it can move"
        density = water.weight / gravity
        if not is_usual("density of water", density):
            yield f"{called} has a density of {density:g} kg/m3; water has 1000, sea water 1025"
    pairs = [{(int(a), int(b)) for a, b in water.joints.edge} for water in model.water]
    for (one, first), (other, second) in combinations(enumerate(pairs, 1), 2):
        if first & second:
            yield (
                f"waters {one} and {other} are both in {len(first & second)} joints, where their "
                "pressures add up: assign different joints to each, unless stages change from one "
                "to the other"
            )


def _bolt_warnings(model: Model) -> Iterator[str]:
    bolts = model.bolts
    idle = model.fixed[bolts.blocks].all(axis=1)
    acting = np.unique(bolts.of_spring[~idle])
    for k in np.setdiff1d(np.arange(len(bolts)), acting)[:NAMED]:
        yield (
            f"bolt '{shortened(bolts.name[k])}' is anchored in blocks that are all fixed: it has "
            "no effect. Move an end into a block that can move, or leave it out"
        )
    forces = bolts.yield_force[np.isfinite(bolts.yield_force)]
    if len(forces) and forces.max() < 1e3:
        yield (
            f"bolts yield at {forces.max():g} N/m at most: that looks like kN. Give yield_force in "
            "N per metre of thickness"
        )


def _lining_warnings(model: Model) -> Iterator[str]:
    linings, _ = linings_of(model)
    for one in linings.each if linings else ():
        if len(one.loose):
            yield (
                f"Lining '{shortened(one.name)}' has no rock beside {len(one.loose)} of its "
                f"{len(one.segments)} segments ({named(model, one.loose)}): those segments carry "
                "no load. Draw it along the faces of blocks, or without joint."
            )


def _servo_warnings(model: Model) -> Iterator[str]:
    actions = [action for action in model.actions if isinstance(action, Motions)]
    for one in (one for action in actions for one in action.each):
        if one.servo is None:
            continue
        first, past = model.block_start[one.block[0] :][:2]
        width, height = np.ptp(model.vertices[first:past], axis=0).tolist()
        stress = float((one.servo.largest / (height, width)).max())
        if not is_usual("stress", stress):
            size = "very small" if stress < USUAL["stress"][0] else "stronger than any rock"
            yield (
                f"{one.label} presses with {stress:g} Pa, {size}; the unit of stress is Pa: 1 MPa "
                "is 1e6; that of force is N per metre of thickness"
            )


def slide_warnings(model: Model) -> Iterator[str]:
    """Warn of slides into corners of ground that cannot move, and of slices over its bends.

    The latter where all that can move lies on such ground.
    Rock that slides over a bend has to shear inside.  A block whose base runs over the bend is
    locked.  Of two slices that meet at a bend where the ground flattens, the toe of the upper one
    would go into the next plane: it carries there from the first movement on, whatever the
    direction of the cut.
    """
    ground = model.fixed.copy()
    ground[model.fixed_points.block] = True
    if not ground.any() or ground.all() or model.block_count > 20_000:
        return
    owner = model.vertex_block
    _, length = edges(model.vertices, model.block_start)
    facing = facing_edges(edges_of(model.vertices, model.vertex_after, owner, model.area)).edge
    on_ground = np.zeros(len(length), np.bool_)
    for own, other in (facing.T, facing.T[::-1]):
        on_ground[own[ground[owner[other]] & ~ground[owner[own]]]] = True
    yield from _corners(model, facing, on_ground, ground)
    if len(np.setdiff1d(np.flatnonzero(~ground), owner[on_ground])):
        return
    yield from _locked(model, on_ground)
    yield from _toes(model, facing, on_ground)


def _corners(model: Model, facing: Ints, on_ground: Bools, ground: Bools) -> Iterator[str]:
    """Warn of planes that come out in a corner before which the ground is flatter."""
    owner, after = model.vertex_block, model.vertex_after
    along = edges(model.vertices, model.block_start)[0]
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    base, below = np.concatenate([facing, facing[:, ::-1]]).T
    on = on_ground[base] & ground[owner[below]]
    base, below = base[on], below[on]
    falls = along[base] @ model.gravity > 0.0  # to its end, where the ground's edge begins
    foot, corner = np.where(falls, after[base], base), np.where(falls, below, after[below])
    beyond = np.where(falls, before[below], after[below])
    way = np.where(falls, 1.0, -1.0)
    turn = way * _bends(model, way[:, None] * along[base], -way[:, None] * along[beyond])
    apart = np.hypot(*(model.vertices[foot] - model.vertices[corner]).T)
    meets = (apart <= 1e-6 * np.sqrt(model.area)[owner[base]]) & ~np.isin(beyond, facing)
    (buried,) = np.nonzero(meets & (turn > 0.0))
    if not len(buried):
        return
    worst = buried[np.argmax(turn[buried])]
    yield (
        f"the plane below block {named(model, np.unique(owner[base[buried]]), 3)} comes out in a "
        f"corner of the ground, which is flatter beyond by {np.degrees(turn[worst]):.2g} degrees, "
        f"at {_place(model, int(foot[worst]))}: the toe rests on it as soon as it moves, and "
        "factors of safety come out too high. Let the plane come out a little above the ground "
        "before it, and compare with limit equilibrium"
    )


def _locked(model: Model, on_ground: Bools) -> Iterator[str]:
    after, along = model.vertex_after, edges(model.vertices, model.block_start)[0]
    before = np.flatnonzero(on_ground & on_ground[after])
    corner = after[before]
    bend = _bends(model, along[before], along[corner])
    bent = np.flatnonzero(np.isfinite(bend))
    if not len(bent):
        return
    worst = bent[np.argmax(np.abs(bend[bent]))]
    blocks = named(model, np.unique(model.vertex_block[corner[bent]]), 3)
    yield (
        f"the base of block {blocks} runs over a bend of the ground, of "
        f"{np.degrees(abs(bend[worst])):.2g} degrees at {_place(model, int(corner[worst]))}: it is "
        "locked there until it leaves the ground, and factors of safety come out too high. Cut the "
        "slide at its bends, and give the cuts the strength of the rock inside"
    )


def _toes(model: Model, facing: Ints, on_ground: Bools) -> Iterator[str]:
    owner, after = model.vertex_block, model.vertex_after
    along = edges(model.vertices, model.block_start)[0]
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    # a cut stands where the base of one block ends (up) and that of the other begins (down)
    up, down = np.concatenate([facing, facing[:, ::-1]]).T
    one, other = before[up], after[down]
    near = 1e-6 * np.sqrt(model.area)[owner[up]]
    apart = np.hypot(*(model.vertices[up] - model.vertices[other]).T)
    standing = on_ground[one] & on_ground[other] & (apart <= near)
    up, bend = up[standing], _bends(model, along[one[standing]], along[other[standing]])
    flattens = np.flatnonzero(bend > 0.0)
    if not len(flattens):
        return
    worst = flattens[np.argmax(bend[flattens])]
    yield (
        f"the ground flattens under {len(flattens)} cut(s) between slices, by "
        f"{np.degrees(bend[worst]):.2g} degrees at {_place(model, int(up[worst]))}: the toe of "
        "the slice above rests on the next plane as soon as it moves, and factors of safety come "
        "out too high. Cut off the toe at the bend so that it can move, and compare "
        "with limit equilibrium"
    )


def _bends(model: Model, first: Floats, second: Floats) -> Floats:
    """Return the turn from one direction of a base (k, 2) to the next, rad; NaN where none counts.

    Both planes dip to the same side: a block between two that face each other is not a slide.
    """
    turn = np.arctan2(
        first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0], (first * second).sum(axis=1)
    )
    gravity = model.gravity / max(float(np.hypot(*model.gravity)), 1e-300)
    drop = np.stack([first @ gravity, second @ gravity])
    level = np.sin(np.radians(5.0))
    same = (drop.prod(axis=0) >= 0.0) | (np.abs(drop).min(axis=0) < level)
    steep = np.abs(drop).max(axis=0) > level
    bent = (np.abs(turn) >= BENDS[0]) & (np.abs(turn) <= BENDS[1])
    return np.where(same & steep & bent, turn, np.nan)


def _place(model: Model, vertex: int) -> str:
    """Return where a vertex is, as the user gave it."""
    x, y = model.vertices[vertex] + model.origin
    return f"({x:.6g}, {y:.6g})"
