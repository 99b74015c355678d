"""Water in joints and blocks in one potential: pressures open joints, and openings move water.

In a step every node of the network keeps its mass,

    V d + e0 - e + S (p - p0) + h (C p + gravity - Q) = 0,    p >= 0,  e >= 0,  p e = 0

with the opening V d, the void e that water has not followed into, S = V/K and the conductances C.
The process minimises the potential of both (minimise/joint_water.py).  Conductances, the flow down
from dry nodes, and volumes are those of the end of the step, found by solving it again.

While time waits in a static stage, the flow of its last increment is solved again from the start of
that, so that however many steps the blocks need, water flows once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.actions.flow import (
    JointWater,
    begun_at,
    carried,
    conditions_at,
    faces_pressed,
    flow_of,
    is_whole,
    pressed_faces,
    removed_by,
    water_at,
    wet_share,
)
from clast.actions.openings import (
    LINEAR,
    gap_rows,
    lengths_at,
    shares_in_wedges,
    shares_of_wet_part,
    volumes_of,
)
from clast.actions.water import sums_on_blocks
from clast.errors import StepOutcome, StepRejected
from clast.linear.guesses import Guesses
from clast.linear.opening_joints import Channels, OpeningJoints, Pressures, pushed
from clast.model.arrays import Bools, Floats, Ints, no_floats
from clast.model.flow.apertures import at_start, conductance, hydraulic
from clast.model.flow.balance import GIVEN, SEEPAGE, Solved
from clast.model.flow.channels import Network
from clast.model.flow.conditions import Conditions
from clast.model.model import Model
from clast.model.state import Ledger

AGREES = 1e-6
"""Change of apertures and pressures, as a share of the largest, at which a step is not renewed."""
NEARLY = 1e-3
"""The same with which a step is kept that has been renewed as often as may be."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Increment:
    """Water at the start of an increment of time, and the changes since."""

    pressure: Floats = no_floats()
    """p0, Pa, shape (m,)."""
    void: Floats = no_floats()
    """e0, m2, shape (m,)."""
    opened: Floats = no_floats()
    """By how much nodes have opened since, m2, shape (m,)."""
    length: float = 0.0
    """Length of the increment, s."""
    stored: float = 0.0
    """Energy in the water at its start, J/m."""
    energies: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Energy brought in, stored and lost since, J/m."""


@dataclass(frozen=True, kw_only=True, repr=False)
class CoupledWater(JointWater):
    """Water in joints that open and close with its pressure."""

    opening: Floats
    """Mechanical aperture at both ends of each channel, m, shape (k, 2)."""
    void: Floats
    """Empty part of the volume of each node, m2, shape (m,)."""
    since: Increment

    def flows_on(self, model: Model) -> bool:
        """Return whether the water in the joints still changes, as far as is known."""
        before, pressure = self.since, self.solved.pressure
        if len(model.begun) != self.begun or before.length == 0.0:
            return True
        rise = np.abs(pressure - before.pressure).max(initial=0.0)
        emptied = np.abs(self.void - before.void).max(initial=0.0)
        still = rise <= AGREES * max(float(np.abs(pressure).max(initial=0.0)), 1.0)
        return not (still and emptied <= AGREES * self.volume.max(initial=0.0))


@dataclass(frozen=True, kw_only=True, repr=False)
class Flowing:
    """A step of the water, with conductances and gravity as they are taken to be."""

    before: CoupledWater
    conditions: Conditions
    step: float
    """h, s; 0: no time passes."""
    gaps: Floats
    """Opening of the ends of channels by d of their blocks, (k, end, side, 6)."""
    channels: Channels
    length: Floats
    """Length of channels, m, shape (k,)."""
    aperture: Floats
    """Hydraulic aperture at both ends of channels, m, shape (k, 2)."""
    conductance: Floats
    """m2/(s Pa), shape (k,)."""
    falls: Floats
    """Fall of pressure by gravity from first to second nodes, Pa, shape (k,)."""
    joined: Bools
    """Channels in which pressures at both nodes count: water fills them, shape (k,)."""
    inflow: Floats
    """What wells bring to nodes, m2/s, shape (m,)."""
    volume: Floats
    """Volume of nodes, m2, shape (m,)."""
    wet: Floats
    """Share of channels that is full at the start of the step, from a full end, shape (k,)."""
    dry: Bools
    """Which ends of channels are not full then, shape (k, 2)."""
    pressure: Floats = no_floats()
    """Pressures by the last conductances, Pa, shape (m,); (0,): none."""
    guesses: Guesses = field(default_factory=Guesses)
    """Logarithms of apertures taken and of those that came of them, shape (2 k,)."""
    passes: int = 0
    """Times that it has been renewed."""

    @property
    def node(self) -> Ints:
        """Nodes of channels, shape (k, 2)."""
        return self.before.network.node

    def net_out(self, flow: Floats) -> Floats:
        """Return the net outflow of the nodes by flows (k,) of channels, (m,)."""
        count = len(self.volume)
        first, second = self.node.T
        into = np.bincount(second, flow, count)
        return np.asarray(np.bincount(first, flow, count) - into, np.float64)

    def flows(self, pressure: Floats) -> Floats:
        """Return the flow of channels from first to second nodes by p (m,), m2/s, (k,)."""
        return self.conductance * self.heads(pressure)

    def heads(self, pressure: Floats) -> Floats:
        """Return what channels lose of their head from first to second nodes by p (m,), Pa."""
        first, second = pressure[self.node].T
        return np.asarray(self.joined * (first - second) + self.falls)


@dataclass(frozen=True, kw_only=True)
class CoupledContribution(Contribution):
    """Forces of water in joints at the start of a step, and the water that changes in it."""

    flowing: Flowing
    on_faces: Contribution
    uneven: Floats
    """What gravity adds to the force that water between nodes exerts by d, N/m, N, (n, 6)."""


@dataclass(frozen=True)
class CoupledFlow(Action):
    """Water that flows in joints, and the blocks that it moves, in one potential."""

    repeats: int
    """Times that a step is solved again at most, for conductances to agree with its end."""

    entries: ClassVar[Mapping[str, float]] = {"water": 1.0}

    def begin(self, model: Model) -> CoupledWater:
        """Return the water at the start of the run."""
        return begun(model, 0.0)

    def may_be(self, state: Any, model: Model) -> bool:
        """Return whether an object can be a state of the flow, of a checkpoint for one."""
        if not isinstance(state, CoupledWater) or not is_whole(state, model):
            return False
        nodes, channels = len(state.volume), state.aperture.shape
        since = (state.since.pressure, state.since.void, state.since.opened)
        whole = all(one.shape == (nodes,) for one in (state.void, *since))
        return whole and state.opening.shape == channels

    def contribution(self, start: StepStart, state: CoupledWater) -> CoupledContribution:
        """Return the forces of water as it is, and how it changes as blocks move."""
        model, time = start.model, start.end
        state = _renewed(model, state, time)
        conditions = conditions_at(model, state.network, time)
        waits = start.clock is not None and start.clock == 0.0
        if not waits:
            since = Increment(
                pressure=state.solved.pressure,
                void=state.void,
                opened=np.zeros(len(state.void)),
                length=start.step if start.clock is None else start.clock,
                stored=energy_stored(model, state.volume, state.solved.pressure),
            )
            state = replace(state, since=since)
        midway, network, after = start.midway, state.network, model.vertex_after
        length = lengths_at(network, midway.vertices, after)
        full = saturation_of(state.void, state.volume)
        falls, joined = _falls(model, state, state.solved.pressure, full)
        flowing = Flowing(
            before=state,
            conditions=conditions,
            step=state.since.length,
            gaps=gap_rows(network, midway.vertices, after, midway.centroid),
            channels=channels_of(network),
            length=length,
            aperture=state.aperture,
            conductance=state.conductance,
            falls=falls,
            joined=joined,
            inflow=_drawn(conditions, full),
            volume=state.volume,
            wet=wet_share(state, flow_of(model)),
            dry=full[network.node] < 1.0,
        )
        faces = pressed_faces(state, model, midway.vertices, start.time_of_forces)
        block, force = sums_on_blocks((faces,), midway.centroid)
        return _contribution(model, flowing, Contribution(block=block, force=force))

    def again(
        self, start: StepStart, contribution: CoupledContribution, unknowns: Floats
    ) -> CoupledContribution | None:
        """Return the contribution with conductances of the end of the step, None where they agree.

        ``unknowns`` (n, 6) are d.  Raises StepRejected where they do not come to agree.
        """
        model, flowing, water = start.model, contribution.flowing, _water(contribution)
        found = water.pressures(water.opened(unknowns))
        opening, volume = opened_by(model, flowing, unknowns)
        aperture = hydraulic(model, flowing.before.network, opening)
        full = saturation_of(voids(flowing, found), volume)
        inflow = _drawn(flowing.conditions, full)
        falls, joined = _falls(model, flowing.before, found.pressure, full)
        largest = max(float(np.abs(found.pressure).max(initial=0.0)), 1.0)
        off = np.abs(aperture - flowing.aperture).max(initial=0.0) / aperture.max(initial=1e-300)
        heads = replace(flowing, falls=falls, joined=joined).heads(found.pressure)
        heads -= flowing.heads(found.pressure)
        off = max(off, np.abs(heads).max(initial=0.0) / largest)
        most = max(float(np.abs(flowing.conditions.inflow).max(initial=0.0)), 1e-300)
        off = max(off, np.abs(inflow - flowing.inflow).max(initial=0.0) / most)
        if len(flowing.pressure):
            off = max(off, np.abs(found.pressure - flowing.pressure).max() / largest)
        if off <= AGREES or flowing.passes + 1 >= self.repeats:
            if off > NEARLY:
                raise StepRejected(StepOutcome.NOT_CONVERGED, "apertures and pressures of joints")
            return None
        taken = np.log(flowing.aperture).ravel(), flowing.falls / largest, flowing.inflow / most
        came = np.log(aperture).ravel(), falls / largest, inflow / most
        guesses = flowing.guesses if np.array_equal(joined, flowing.joined) else Guesses()
        guesses = guesses.with_one(np.concatenate(taken), np.concatenate(came))
        ends = np.cumsum([aperture.size, len(falls)])
        logs, of_falls, of_inflow = np.split(guesses.next_guess(), ends)
        aperture, falls = np.exp(logs).reshape(aperture.shape), largest * of_falls
        renewed = replace(
            flowing,
            aperture=aperture,
            guesses=guesses,
            conductance=conductance(
                aperture, flowing.before.network.length, flow_of(model).viscosity
            ),
            falls=falls,
            joined=joined,
            inflow=most * of_inflow,
            volume=volume,
            pressure=found.pressure,
            passes=flowing.passes + 1,
        )
        return _contribution(model, renewed, contribution.on_faces)

    def finish(
        self, start: StepStart, state: CoupledWater, contribution: Any, solution: Solution
    ) -> ActionResult:
        """Return the work of the water, where its energy went, and the water."""
        model, flowing, water = start.model, contribution.flowing, _water(contribution)
        displacement = solution.displacement
        opened = water.opened(displacement)
        found = water.pressures(opened)
        on_faces, _ = energy_of_linear(contribution.on_faces, displacement)
        added = float(np.vdot(contribution.uneven, displacement))
        work = float(found.pressure @ opened) + added
        before = flowing.before.since
        energies = _energies(model, flowing, found)
        brought, stored, lost = (
            now - then for now, then in zip(energies, before.energies, strict=True)
        )
        opening, _ = opened_by(model, flowing, displacement)
        since = replace(before, opened=before.opened + opened, energies=energies)
        after = replace(
            flowing.before,
            conditions=flowing.conditions,
            aperture=flowing.aperture,
            conductance=flowing.conductance,
            volume=flowing.volume,
            opening=opening,
            void=voids(flowing, found),
            solved=_solved(model, flowing, found, since),
            since=since,
            time=start.end,
        )
        # what was in joints that have been excavated
        gone = 0.0
        if not np.array_equal(state.absent, after.absent):
            held = energy_stored(model, state.volume, state.solved.pressure)
            gone = held - before.stored
        ledger = Ledger(
            water=on_faces + brought + added, water_stored=stored - gone, seepage=lost, removed=gone
        )
        return ActionResult(work=on_faces + work, ledger=ledger, state=after)


def begun(model: Model, time: float) -> CoupledWater:
    """Return the water at the start, in joints as blocks lie there."""
    water = water_at(model, time)
    return _coupled(model, water, at_start(model, water.network))


def _coupled(model: Model, water: JointWater, opening: Floats) -> CoupledWater:
    """Return water in joints of mechanical apertures (k, 2), m, at the start of an increment."""
    solved, count = water.solved, water.network.count
    volume = volumes_at(model, water.network, opening, water.network.length)
    void = np.zeros(count) if flow_of(model).confined else volume * (1.0 - solved.saturation)
    of_flow = {one.name: getattr(water, one.name) for one in fields(JointWater)}
    return CoupledWater(
        **{**of_flow, "volume": volume},
        opening=opening,
        void=void,
        since=Increment(
            pressure=solved.pressure,
            void=void,
            opened=np.zeros(count),
            stored=energy_stored(model, volume, solved.pressure),
        ),
    )


def channels_of(network: Network) -> Channels:
    """Return the channels of a network, each opened in four places: two ends, two blocks."""
    node = np.repeat(network.node, 2, axis=1).ravel()
    return Channels.of(network.count, network.node, node, np.tile(network.block, (1, 2)).ravel())


def volumes_at(model: Model, network: Network, opening: Floats, length: Floats) -> Floats:
    """Return the volumes of nodes, m2, (m,), with mechanical apertures (k, 2) and lengths (k,)."""
    least = hydraulic(model, network, np.zeros(opening.shape))
    return volumes_of(network, length, np.maximum(opening, least))


def opened_by(model: Model, flowing: Flowing, unknowns: Floats) -> tuple[Floats, Floats]:
    """Return mechanical apertures (k, 2), m, and volumes of nodes (m,), m2, after d (n, 6)."""
    network = flowing.before.network
    opened = np.einsum("kesd,ksd->ke", flowing.gaps, unknowns[network.block])
    opening = flowing.before.opening + opened
    return opening, volumes_at(model, network, opening, flowing.length)


def energy_stored(model: Model, volume: Floats, pressure: Floats) -> float:
    """Return the energy in water at nodes, 1/2 p V/K p, J/m."""
    return float(0.5 * (volume / flow_of(model).bulk_modulus) @ pressure**2)


def saturation_of(void: Floats, volume: Floats) -> Floats:
    """Return the saturation of nodes, (m,), with their voids and volumes (m,), m2."""
    return np.clip(1.0 - np.maximum(void, 0.0) / volume, 0.0, 1.0)


def voids(flowing: Flowing, found: Pressures) -> Floats:
    """Return the void of nodes at the end, m2, (m,): none where a pressure is given."""
    inner = flowing.conditions.kind != GIVEN
    return np.where(inner, np.maximum(found.rest, 0.0), 0.0)


def _water(contribution: CoupledContribution) -> OpeningJoints:
    """Return the term of the potential of a contribution, which has one."""
    water: Any = contribution.opening
    known: OpeningJoints = water
    return known


def _renewed(model: Model, water: CoupledWater, time: float) -> CoupledWater:
    """Return the water after stages have begun."""
    if not np.array_equal(water.absent, model.absent):
        return _in_new_network(model, water)
    if len(model.begun) == water.begun:
        return water
    pressed = faces_pressed(model, water.network)
    return replace(water, begun=len(model.begun), pressed=pressed)


def _in_new_network(model: Model, before: CoupledWater) -> CoupledWater:
    """Return water in the joints between the blocks that are left, as it was in them."""
    from scipy.spatial import KDTree

    water = carried(model, before, begun_at(model, before.time))
    network = water.network
    distance, same = KDTree(before.network.middle).query(network.middle)
    known = distance <= network.near[network.node].min(axis=1)
    opening = np.where(known[:, None], before.opening[same], at_start(model, network))
    aperture = hydraulic(model, network, opening)
    flows = conductance(aperture, network.length, flow_of(model).viscosity)
    coupled = _coupled(model, replace(water, aperture=aperture, conductance=flows), opening)
    return replace(coupled, removed=removed_by(model, before, coupled))


def _falls(
    model: Model, water: CoupledWater, pressure: Floats, full: Floats
) -> tuple[Floats, Bools]:
    """Return the fall by gravity along channels, Pa, and where both pressures count, (k,) each.

    With p and saturation of nodes (m,).  Below a dry node the flow down is that of
    min(s G, G - p_l), balance.py.
    """
    flow, network = flow_of(model), water.network
    height = network.at[network.node, 1]
    weight = flow.weight * (height[:, 0] - height[:, 1])
    upper = np.where(weight >= 0.0, network.node[:, 0], network.node[:, 1])
    lower = np.where(weight >= 0.0, network.node[:, 1], network.node[:, 0])
    share = full[upper]
    joined = (share == 1.0) | ((1.0 - share) * np.abs(weight) <= pressure[lower])
    joined = joined if not flow.confined else np.full(len(weight), True)
    return np.where(joined, weight, share * weight), joined


def _drawn(on: Conditions, full: Floats) -> Floats:
    """Return what wells bring to nodes, m2/s, (m,): pumps draw no air from those that are dry."""
    return np.where(on.inflow < 0.0, on.inflow * full, on.inflow)


def _contribution(model: Model, flowing: Flowing, on_faces: Contribution) -> CoupledContribution:
    """Return the contribution of water with its conductances, and of that on outer faces."""
    flow, on, since, h = flow_of(model), flowing.conditions, flowing.before.since, flowing.step
    elastic, count = flowing.volume / flow.bulk_modulus, len(flowing.volume)
    between = h * flowing.conductance * flowing.joined
    run = flowing.net_out(flowing.conductance * flowing.falls)
    known = elastic * since.pressure + h * (flowing.inflow - run) - since.void - since.opened
    low = np.full(count, -np.inf if flow.confined else 0.0)
    high = np.where(on.kind == SEEPAGE, on.pressure, np.inf)
    given = on.kind == GIVEN
    low, high = (
        np.where(given, on.pressure, np.minimum(low, high)),
        np.where(given, on.pressure, high),
    )
    acting = np.clip(flowing.before.solved.pressure, low, high)
    rows, uneven = _in_wedges(model, flowing)
    water = OpeningJoints(
        channels=flowing.channels,
        rows=rows,
        between=between,
        own=elastic + np.bincount(flowing.node.ravel(), np.repeat(between, 2), count),
        known=known,
        low=low,
        high=high,
        acting=acting,
    )
    pushes = water.forces(acting, len(uneven)) + uneven
    block = np.flatnonzero(pushes.any(axis=1))
    return CoupledContribution(
        block=np.concatenate([on_faces.block, block]),
        force=np.concatenate([on_faces.force, pushes[block]]),
        opening=water,
        flowing=flowing,
        on_faces=on_faces,
        uneven=uneven,
    )


def _in_wedges(model: Model, flowing: Flowing) -> tuple[Floats, Floats]:
    """Return how places open nodes, (4 k, 6), and the forces that gravity adds to those, (n, 6).

    Between full nodes the head is that of a wedge, and the pressure what its weight leaves of that;
    towards a dry one pressure falls evenly, to 0 where the water ends.
    """
    network, node = flowing.before.network, flowing.node
    within = shares_in_wedges(flowing.aperture)
    within[flowing.dry.any(axis=1)] = LINEAR
    height = network.at[node, 1]
    added = np.einsum("ken,kn->ke", within - LINEAR, flow_of(model).weight * height)
    for end in (0, 1):
        partly = np.flatnonzero(flowing.dry[:, end] & ~flowing.dry[:, 1 - end])
        within[partly] = shares_of_wet_part(flowing.wet[partly], end)
    gaps = flowing.length[:, None, None, None] * flowing.gaps
    rows = np.einsum("ken,kesd->knsd", within, gaps).reshape(-1, 6)
    uneven = np.einsum("ke,kesd->ksd", added, gaps).reshape(-1, 6)
    block = network.block.ravel()
    return rows, pushed(block, uneven, np.ones(len(block)), model.block_count)


def _energies(model: Model, flowing: Flowing, found: Pressures) -> tuple[float, float, float]:
    """Return the energy brought into water since the start of the increment, stored, and lost.

    Lost is the energy that flow dissipates, h q2/C.
    """
    h, p = flowing.step, found.pressure
    flow, heads = flowing.flows(p), flowing.heads(p)
    put_in = h * flowing.inflow + found.rest
    first, second = p[flowing.node].T
    brought = float(p @ put_in) + h * float(flow @ (heads - (first - second)))
    lost = h * float(heads @ flow)
    stored = energy_stored(model, flowing.volume, p) - flowing.before.since.stored
    return brought, stored, lost


def _solved(model: Model, flowing: Flowing, found: Pressures, since: Increment) -> Solved:
    """Return the record of the water at the end of a step; rates are means of the step."""
    on, h, p, rest = flowing.conditions, flowing.step, found.pressure, found.rest
    rate = 1.0 / h if h > 0.0 else 0.0
    void, flow = voids(flowing, found), flowing.flows(p)
    elastic = flowing.volume / flow_of(model).bulk_modulus
    stored = rate * (since.opened + since.void - void + elastic * (p - since.pressure))
    given = np.where(on.kind == GIVEN, rate * rest, 0.0)
    out = np.where(on.kind == SEEPAGE, rate * np.maximum(-rest, 0.0), 0.0)
    runoff = np.minimum(out, np.where(on.kind == SEEPAGE, np.maximum(on.inflow, 0.0), 0.0))
    put_in = flowing.inflow * (h > 0.0)
    terms = rate * (flowing.volume + elastic * np.abs(p))
    size = np.abs(p).max(initial=0.0) * flowing.conductance.max(initial=0.0) + terms.max(
        initial=0.0
    )
    into = np.maximum(given, 0.0).sum() + np.maximum(put_in, 0.0).sum()
    return Solved(
        pressure=p,
        saturation=saturation_of(void, flowing.volume),
        flow=flow,
        given=given,
        outflow=out - runoff,
        runoff=runoff,
        missing=flowing.inflow - on.inflow,
        stored=float(stored.sum()),
        unaccounted=float(given.sum() + put_in.sum() - out.sum() - stored.sum()),
        throughput=max(float(into + max(-stored.sum(), 0.0)), 1e-3 * float(size), 1e-300),
        iterations=flowing.passes + 1,
    )
