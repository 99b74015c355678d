"""Water that flows in joints: pressures on both faces of channels, and on outer faces below heads.

Pressures act on blocks as they lie halfway through a step.
Steady flow is found anew where a stage changes blocks or boundaries, or a head changes with time;
flow that takes time goes on from step to step, and the water in joints that are excavated goes with
them, into the ledger of mass.
Apertures are those of the start, or of the last equilibrium (following.py).  In a channel that is
dry at its upper end water stands up to the height p/(rho g - q/(C dy)) above its lower one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
from clast.actions.water import Pressed, sums_on_blocks
from clast.model.arrays import Bools, Floats, Ints
from clast.model.flow.apertures import at_start, conductance, hydraulic, of_blocks
from clast.model.flow.balance import GIVEN, Balance, Solved
from clast.model.flow.channels import Network, faces_at
from clast.model.flow.conditions import Conditions, conditions_of, faces_on
from clast.model.flow.given import HEAD, STEADY, Flow
from clast.model.flow.network import network_of
from clast.model.flow.solving import advanced, steady
from clast.model.model import Model
from clast.model.water import WetFaces, ends_of_faces, wetted


@dataclass(frozen=True, kw_only=True, repr=False)
class JointWater:
    """Water in the joints of a model at an instant: k channels, m nodes."""

    network: Network
    aperture: Floats
    """Hydraulic aperture at both ends of each channel, m, shape (k, 2)."""
    conductance: Floats
    """Flow of each channel by difference of pressure, m2/(s Pa), shape (k,)."""
    volume: Floats
    """Volume of the joints at each node, m2, shape (m,)."""
    conditions: Conditions
    solved: Solved
    pressed: tuple[Ints, ...]
    """Which of the outer faces each boundary presses on by its head, (q,) each."""
    absent: Bools
    """Blocks that are not there, shape (n,)."""
    begun: int
    """Number of the stages that have begun."""
    time: float
    """Time for which it is solved, s."""
    taken: tuple[Floats, ...] = ()
    """Logarithms of the apertures of the last equilibria of this stage, (2 k,) each."""
    came: tuple[Floats, ...] = ()
    """Those of the apertures that came of them, (2 k,) each."""
    passes: int = 0
    """Equilibria of this stage after which the flow was found again."""
    left: float = 0.0
    """Change of an aperture that the last of them left, as a share of it."""
    removed: float = 0.0
    """Water gone with excavated joints since the start, in flow that takes time, m2."""
    hardest: int = 0
    """Most linear systems that a step of flow that takes time has taken."""

    @cached_property
    def exchange(self) -> Floats:
        """Flows in, out, and run off at the parts of the conditions, m2/s, shape (3, parts)."""
        into, out = self.flows
        part = self.conditions.part + 1
        every = (into, out, self.solved.runoff)
        return np.array([np.bincount(part, one, 1)[1:] for one in every])

    @property
    def flows(self) -> tuple[Floats, Floats]:
        """Flows into the joints and out of them at the nodes, m2/s, (m,) each."""
        solved = self.solved
        put_in = self.conditions.inflow + solved.missing
        into = np.maximum(solved.given, 0.0) + np.maximum(put_in, 0.0) - solved.runoff
        out = np.maximum(-solved.given, 0.0) + np.maximum(-put_in, 0.0) + solved.outflow
        return into, out

    def content(self, flow: Flow) -> float:
        """Return the volume that the water would have without pressure, m2."""
        solved = self.solved
        return float(self.volume @ (solved.saturation + solved.pressure / flow.bulk_modulus))

    def __repr__(self) -> str:
        return f"JointWater({self.network}, at t = {self.time:.6g} s)"


@dataclass(frozen=True, kw_only=True)
class WetContribution(Contribution):
    """Forces of water in joints, and that water."""

    water: JointWater


def water_at(
    model: Model, time: float, before: JointWater | None = None, vertices: Floats | None = None
) -> JointWater:
    """Return the water in the joints of a model at a time, s; ``before``: the state before it.

    A network that is found anew has apertures with blocks at ``vertices`` (nv, 2), m, or at first.
    """
    flow, begun = flow_of(model), len(model.begun)
    if before is None:
        return _started(model, begun_at(model, time))
    same = np.array_equal(before.absent, model.absent)
    water = before if same else begun_at(model, time, vertices)
    if flow.state == "transient":
        water = before if same else carried(model, before, water)
        return _advanced(model, water, time)
    if same and begun == before.begun and not flow.changes:
        return before
    conditions = conditions_at(model, water.network, time)
    if not same or not conditions.same(before.conditions):
        near = before.solved if same else None
        water = replace(water, conditions=conditions)
        water = replace(water, solved=solved_in(model, water, flow.state, near))
    pressed = faces_pressed(model, water.network)
    if begun != before.begun:
        water = replace(water, taken=(), came=(), passes=0, left=0.0)
    return replace(water, begun=begun, time=time, pressed=pressed)


def _started(model: Model, water: JointWater) -> JointWater:
    """Return water as it is at the start of a run."""
    flow = flow_of(model)
    state = flow.initial if flow.state == "transient" else flow.state
    return replace(water, solved=solved_in(model, water, state, None))


def _advanced(model: Model, before: JointWater, time: float) -> JointWater:
    """Return the water at a later time, s."""
    flow, begun, conditions = flow_of(model), len(model.begun), before.conditions
    if begun != before.begun or flow.changes:
        conditions = conditions_at(model, before.network, time)
    water = replace(before, conditions=conditions, begun=begun)
    if begun != before.begun:
        water = replace(water, pressed=faces_pressed(model, before.network))
    step = time - before.time
    # static steps may wait for time to go on
    if not step > CLOCK * abs(time):
        return water
    solved = advanced(balance_of(model, water, conditions), before.solved, step)
    hardest = max(before.hardest, solved.iterations)
    return replace(water, solved=solved, time=time, hardest=hardest)


CLOCK = 1e-12
"""Share of the time below which two instants are one."""


def carried(model: Model, before: JointWater, water: JointWater) -> JointWater:
    """Return water in a network that is found anew, with the earlier state at its nodes."""
    from scipy.spatial import KDTree

    solved = before.solved
    nearest = KDTree(before.network.at).query(water.network.at)[1]
    none = np.zeros(water.network.count)
    solved = replace(
        EMPTY,
        pressure=solved.pressure[nearest],
        saturation=solved.saturation[nearest],
        flow=np.zeros(len(water.conductance)),
        given=none,
        outflow=none,
        runoff=none,
        missing=none,
    )
    water = replace(water, solved=solved, time=before.time)
    removed = removed_by(model, before, water)
    return replace(water, removed=removed, hardest=before.hardest)


def removed_by(model: Model, before: JointWater, water: JointWater) -> float:
    """Return the water gone with joints, m2, by the time of ``water`` in what is left of them."""
    flow = flow_of(model)
    return before.removed + (before.content(flow) - water.content(flow))


def balance_of(model: Model, water: JointWater, conditions: Conditions) -> Balance:
    """Return the balance of water in joints under some conditions at their nodes."""
    flow, network = flow_of(model), water.network
    height = network.at[network.node, 1]
    return Balance(
        node=network.node,
        conductance=water.conductance,
        weight=flow.weight * (height[:, 0] - height[:, 1]),
        kind=conditions.kind,
        pressure=conditions.pressure,
        inflow=conditions.inflow,
        volume=water.volume,
        opened=np.zeros(network.count),
        bulk_modulus=flow.bulk_modulus,
        confined=flow.confined,
    )


def pressed_channels(water: JointWater, model: Any, vertices: Floats) -> Pressed:
    """Return where water presses on both faces of channels, with blocks at ``vertices`` (nv, 2), m.

    Only where there is pressure; ``model`` may be a frame as well.
    """
    network = water.network
    ends = faces_at(network, vertices, model.vertex_after).mean(axis=1)
    pressure = water.solved.pressure[network.node]
    some = np.flatnonzero(pressure.any(axis=1))
    wet = wet_share(water, flow_of(model))[some, None]
    ends, pressure = ends[some], pressure[some]
    for end in (0, 1):
        partly = np.flatnonzero((wet[:, 0] < 1.0) & (pressure[:, end] == 0.0))
        first = ends[partly, 1 - end]
        ends[partly, end] = first + wet[partly] * (ends[partly, end] - first)
    left, right = network.block[some].T
    return Pressed(network.edge[some, 0], left, right, ends, pressure)


def wet_share(water: JointWater, flow: Flow) -> Floats:
    """Return the share of each channel under pressure, from the end that has one, shape (k,)."""
    network, solved = water.network, water.solved
    pressure = solved.pressure[network.node]
    wet = np.asarray(pressure.any(axis=1), np.float64)
    dry = solved.saturation[network.node] < 1.0
    for end in (0, 1):
        partly = np.flatnonzero(dry[:, end] & ~dry[:, 1 - end])
        height = network.at[network.node[partly], 1]
        rise = height[:, end] - height[:, 1 - end]
        down = solved.flow[partly] * (1.0 if end == 0 else -1.0)
        # flow that takes all of the weight leaves no column
        lost = flow.weight * rise - down / water.conductance[partly]
        deep = pressure[partly, 1 - end]
        wet[partly] = np.where(lost > deep, deep / np.where(lost > deep, lost, 1.0), 1.0)
    return wet


def pressed_faces(water: JointWater, model: Any, vertices: Floats, time: float) -> Pressed:
    """Return where heads press on outer faces, with blocks at ``vertices`` (nv, 2), m."""
    network, flow = water.network, flow_of(model)
    none = np.zeros(0, np.int64)
    parts = [Pressed(none, none, none, np.zeros((0, 2, 2)), np.zeros((0, 2)))]
    for one, which in zip(flow.boundaries, water.pressed, strict=True):
        if not len(which):
            continue
        faces = WetFaces(edge=network.face_edge[which], share=network.face_share[which])
        level = np.array([[0.0, one.at(time) - model.origin[1]]])
        wet = wetted(level, ends_of_faces(faces, vertices, model.vertex_after))
        edge = faces.edge[wet.line]
        block, air = model.vertex_block[edge], np.full(len(edge), -1)
        parts.append(Pressed(edge, block, air, wet.ends, flow.weight * wet.head))
    every = (one.name for one in fields(Pressed))
    return Pressed(*(np.concatenate([getattr(one, name) for one in parts]) for name in every))


@dataclass(frozen=True)
class JointFlow(Action):
    """The water that flows in the joints of the model."""

    entries: ClassVar[Mapping[str, float]] = {"water": 1.0}

    def begin(self, model: Model) -> JointWater:
        """Return the flow at the start of the run."""
        return water_at(model, 0.0)

    def may_be(self, state: Any, model: Model) -> bool:
        """Return whether an object can be a state of the flow, of a checkpoint for one."""
        return isinstance(state, JointWater) and is_whole(state, model)

    def contribution(self, start: StepStart, state: JointWater) -> WetContribution:
        """Return the sum of the forces of water on each block, as it flows in this step."""
        model, midway, time = start.model, start.midway, start.time_of_forces
        flow = flow_of(model)
        takes_time, follows = flow.state == "transient", flow.coupling == STEADY
        vertices = start.state.vertices if follows else None
        water = water_at(model, start.end if takes_time else time, state, vertices)
        # flow that takes time from the next step on goes on from here
        water = replace(water, time=start.end)
        pressed = (
            pressed_channels(water, model, midway.vertices),
            pressed_faces(water, model, midway.vertices, time),
        )
        block, force = sums_on_blocks(pressed, midway.centroid)
        return WetContribution(block=block, force=force, water=water)

    def finish(
        self, start: StepStart, state: JointWater, contribution: Any, solution: Solution
    ) -> ActionResult:
        """Return the work of the water, and the water."""
        done = super().finish(start, state, contribution, solution)
        return replace(done, state=contribution.water)


def is_whole(water: JointWater, model: Model) -> bool:
    """Return whether the arrays of water in joints fit each other and a model."""
    network, solved, on = water.network, water.solved, water.conditions
    k, m, faces = len(network.length), len(network.at), len(network.face_edge)
    edges, blocks = len(model.vertices), model.block_count
    of_channels = (solved.flow, water.conductance, network.joint)
    of_nodes: tuple[Any, ...] = (
        solved.pressure,
        solved.saturation,
        solved.given,
        solved.outflow,
        solved.runoff,
    )
    of_nodes += (solved.missing, water.volume, network.near, on.pressure, on.inflow)
    pairs = [(network.node, m), (network.edge, edges), (network.block, blocks)]
    shapes: list[tuple[Any, tuple[int, ...]]] = [(one, (k,)) for one in of_channels]
    shapes += [(one, (m,)) for one in of_nodes]
    shapes += [(one, (k, 2)) for one, _ in pairs] + [(water.aperture, (k, 2))]
    shapes += [(network.share, (k, 2, 2)), (network.at, (m, 2)), (water.absent, (blocks,))]
    shapes += [(one, (2 * k,)) for one in (*water.taken, *water.came)]
    shapes += [(network.face_share, (faces, 2)), (on.kind, (m,)), (on.part, (m,))]
    if not all(one.shape == shape for one, shape in shapes):
        return False
    limits = [*pairs, (network.face_edge, edges), *((one, faces) for one in water.pressed)]
    exist = all(((one >= 0) & (one < limit)).all() for one, limit in limits)
    known = (on.part >= -1) & (on.part < len(flow_of(model).names))
    right = len(water.pressed) == len(flow_of(model).boundaries) and (water.conductance > 0.0).all()
    finite = all(np.isfinite(one).all() for one, _ in shapes)
    return bool(exist and known.all() and right and finite)


def flow_of(model: Any) -> Flow:
    """Return the flow of a model that has one."""
    flow: Flow = model.flow
    return flow


def begun_at(model: Model, time: float, vertices: Floats | None = None) -> JointWater:
    """Return the water in a network that is found anew, with blocks at ``vertices`` or at first."""
    flow = flow_of(model)
    network = flow.network
    if network is None or (model.absent & ~model.lined).any():
        network = network_of(model, flow.longest, flow.points)
    if vertices is None:
        mechanical = at_start(model, network)
    else:
        mechanical = of_blocks(model, network, vertices)
    aperture = hydraulic(model, network, mechanical)
    # half of each channel belongs to the node at either end
    half = 0.25 * network.length * np.maximum(mechanical, 0.0).sum(axis=1)
    volume = np.bincount(network.node.ravel(), np.repeat(half, 2), network.count)
    conditions = conditions_at(model, network, time)
    return JointWater(
        network=network,
        aperture=aperture,
        conductance=conductance(aperture, network.length, flow.viscosity),
        volume=np.asarray(volume, np.float64),
        conditions=conditions,
        solved=EMPTY,
        pressed=faces_pressed(model, network),
        absent=model.absent,
        begun=len(model.begun),
        time=time,
    )


def solved_in(model: Model, water: JointWater, state: str, near: Solved | None) -> Solved:
    """Return the flow in a state; of steady flow ``near`` saves time."""
    if state == "steady":
        return steady(balance_of(model, water, water.conditions), near)
    flow, network, on = flow_of(model), water.network, water.conditions
    deep = flow.level - model.origin[1] - network.at[:, 1]
    rests = flow.weight * np.maximum(deep, 0.0), (deep >= 0.0).astype(np.float64)
    none, given = np.zeros(network.count), (on.kind == GIVEN) & (state == "dry")
    pressure, saturation = rests if state == "hydrostatic" else (none, none)
    full = flow.confined or given
    return replace(
        EMPTY,
        pressure=np.where(given, on.pressure, pressure),
        saturation=np.where(full, 1.0, saturation),
        flow=np.zeros(len(water.conductance)),
        given=none,
        outflow=none,
        runoff=none,
        missing=none,
    )


NONE = np.zeros(0)
EMPTY = Solved(
    pressure=NONE,
    saturation=NONE,
    flow=NONE,
    given=NONE,
    outflow=NONE,
    runoff=NONE,
    missing=NONE,
    stored=0.0,
    unaccounted=0.0,
    throughput=0.0,
    iterations=0,
)
"""No water."""


def _faces(model: Model, network: Network) -> Floats:
    """Return the outer faces as they are at the start, m, shape (r, 2, 2)."""
    faces = WetFaces(edge=network.face_edge, share=network.face_share)
    return ends_of_faces(faces, model.vertices, model.vertex_after)


def conditions_at(model: Model, network: Network, time: float) -> Conditions:
    """Return the conditions at the nodes of a network at a time, s."""
    faces = _faces(model, network)
    return conditions_of(model, network, faces, time)


def faces_pressed(model: Model, network: Network) -> tuple[Ints, ...]:
    """Return which of the outer faces each boundary presses on, (q,) each."""
    faces, none = _faces(model, network), np.zeros(0, np.int64)
    return tuple(
        faces_on(faces, one.lines(model.absent)) if one.kind == HEAD and one.presses else none
        for one in flow_of(model).boundaries
    )
