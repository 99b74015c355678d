"""Systems of blocks, methods and short runs that tests share."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from clast.block import polygon
from clast.block.inertia import block_frames
from clast.block.rotation import Sine
from clast.contact.broad_phase import VerletList, near_pairs
from clast.contact.candidates import Candidates, SearchDistance, find_candidates
from clast.contact.contacts import Contacts
from clast.contact.corner_rules import Bisector, CornerRule
from clast.contact.detection import detect
from clast.contact.laws import Penalty
from clast.errors import RunStopped, StepOutcome, StepRejected
from clast.inputs.builder import InputBuilder
from clast.linear.solvers import Automatic, Direct
from clast.model.model import Floats, Ints, Model
from clast.model.state import ContactMemory, State, initial_state
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step import energy_balance as energy
from clast.step.convex import Convex
from clast.step.integration import ConstantAcceleration
from clast.step.method import Method, StepProcess, StepResult, Workspace
from clast.step.modified import Modified

GRAVITY = 9.8


# --- outlines ------------------------------------------------------------------------------


def box(x: float, y: float, width: float = 1.0, height: float = 1.0) -> Floats:
    """Return a rectangle by its lower left corner."""
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]], float)


def regular(count: int, radius: float = 1.0, start: float = 0.0) -> Floats:
    """Return a regular polygon about (0, 0), its first vertex at the angle ``start``, rad."""
    angle = start + 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def convex(rng: np.random.Generator, count: int, radius: float = 1.0) -> Floats:
    """Return a random convex polygon about (0, 0): vertices on an ellipse, turned."""
    angle = np.cumsum(rng.uniform(0.4, 1.6, count))
    angle *= 2.0 * np.pi / (angle[-1] + rng.uniform(0.4, 1.6))
    points = np.stack([np.cos(angle), rng.uniform(0.5, 1.0) * np.sin(angle)], axis=1)
    return radius * turned(points, rng.uniform(0.0, 2.0 * np.pi))


def star(rng: np.random.Generator, count: int, radius: float = 1.0) -> Floats:
    """Return a random star-shaped polygon about (0, 0), mostly not convex."""
    angle = np.cumsum(rng.uniform(0.5, 1.5, count))
    angle *= 2.0 * np.pi / (angle[-1] + rng.uniform(0.5, 1.5))
    distance = radius * rng.uniform(0.45, 1.0, count)
    return distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def turned(points: Floats, angle: float, shift: Sequence[float] = (0.0, 0.0)) -> Floats:
    """Return points turned about (0, 0) by an angle, rad, then shifted."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.asarray(shift, float)


def bricks(courses: int, columns: int, bond: float = 0.5) -> list[Floats]:
    """Return courses of 1 m x 0.5 m bricks, every second one shifted by ``bond`` m."""
    return [
        box(column + bond * (course % 2), 0.5 * course, 1.0, 0.5)
        for course in range(courses)
        for column in range(columns)
    ]


def courses_of_bricks(courses: int, columns: int, *, bonded: bool = True) -> list[Floats]:
    """Return a wall of 1 m x 0.5 m bricks, half bricks at the ends of every second course.

    Without bond all joints are aligned, so that four corners meet everywhere.
    """
    outlines = []
    for course in range(courses):
        joints = np.arange(columns + 1.0)
        if bonded and course % 2:
            joints = np.array([0.0, *(joints[:-1] + 0.5), columns])
        ends = itertools.pairwise(joints)
        outlines += [box(left, 0.5 * course, right - left, 0.5) for left, right in ends]
    return outlines


def loose_polygons(count: int, columns: int, seed: int = 1) -> list[Floats]:
    """Return random polygons of up to 1.1 m, every second one not convex, none touching."""
    rng = np.random.default_rng(seed)
    outlines = []
    for k in range(count):
        outline = star if k % 2 else convex
        shape = outline(rng, int(rng.integers(4, 8)), rng.uniform(0.35, 0.55))
        at = 1.15 * np.array([k % columns, k // columns]) + rng.uniform(-0.01, 0.01, 2)
        outlines.append(shape + at + 0.7)
    return outlines


def trough(width: float, height: float) -> list[Floats]:
    """Return floor and walls, 1 m thick, about the space from (0, 0)."""
    return [
        box(-1.0, -1.0, width + 2.0, 1.0),
        box(-1.0, 0.0, 1.0, height),
        box(width, 0.0, 1.0, height),
    ]


def voussoirs(count: int, inner: float = 2.0, outer: float = 2.6) -> list[Floats]:
    """Return the voussoirs of a semicircular arch from right to left, faces radial."""
    angle = np.linspace(0.0, np.pi, count + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return [
        np.array([inner * ring[k], outer * ring[k], outer * ring[k + 1], inner * ring[k + 1]])
        for k in range(count)
    ]


# --- models and methods --------------------------------------------------------------------


def system(
    outlines: Sequence[Floats],
    *,
    fixed: Sequence[int] = (),
    velocity: dict[int, Sequence[float]] | None = None,
    friction_angle: float = 0.0,
    cohesion: float = 0.0,
    tensile_strength: float = 0.0,
    young: float = 5e9,
    poisson: float = 0.2,
    density: float = 2500.0,
    gravity: Sequence[float] = (0.0, -GRAVITY),
) -> Model:
    """Return a model of one rock and one joint; ``fixed`` and ``velocity`` go by block index."""
    builder = InputBuilder(gravity=gravity)
    builder.add_rock("rock", young=young, poisson=poisson, density=density)
    builder.add_joint(
        friction_angle=friction_angle, cohesion=cohesion, tensile_strength=tensile_strength
    )
    for k, outline in enumerate(outlines):
        start = (velocity or {}).get(k, (0.0, 0.0, 0.0))
        builder.block(vertices=outline, fixed=k in fixed, velocity=start)
    return builder.build()


def at_start(model: Model, vertices: Floats | None = None) -> State:
    """Return the first state, with other vertices where some are given."""
    state = initial_state(model)
    return state if vertices is None else replace(state, vertices=np.ascontiguousarray(vertices))


def method(**changes: object) -> Method:
    """Return the paper's method with some things changed."""
    usual = Method(
        process=Modified(),
        contact_law=Penalty(normal_stiffness=1e8),
        corner_rule=Bisector(),
        rotation=Sine(),
        integrator=ConstantAcceleration(),
        solver=Direct(),
        fixed_point_stiffness=1e11,
        critdis=0.005,
        max_displacement=0.01,
    )
    return replace(usual, **changes)  # type: ignore[arg-type]


def by_convex(normal_stiffness: float, **changes: object) -> Method:
    """Return the convex process with a penalty law and some things changed."""
    usual = method(
        process=Convex(),
        contact_law=Penalty(normal_stiffness=normal_stiffness),
        solver=Automatic(),
        fixed_point_stiffness=1e13,
    )
    return replace(usual, **changes)  # type: ignore[arg-type]


def wall(
    courses: int,
    columns: int,
    *,
    bonded: bool = True,
    friction_angle: float = 30.0,
    poisson: float = 0.0,
    gravity: float = GRAVITY,
) -> Model:
    """Return a wall of bricks (rho 2600 kg/m3) on a fixed base, which is block 0."""
    base = box(-1.0, -1.0, columns + 2.0, 1.0)
    return system(
        [base, *courses_of_bricks(courses, columns, bonded=bonded)],
        fixed=[0],
        friction_angle=friction_angle,
        poisson=poisson,
        density=2600.0,
        gravity=(0.0, -gravity),
    )


def heap(count: int, columns: int, *, seed: int = 1, friction_angle: float = 30.0) -> Model:
    """Return loose polygons above the floor of a fixed trough, which is blocks 0 to 2."""
    height = 1.15 * (count // columns + 2) + 1.0
    return system(
        [*trough(1.15 * (columns - 1) + 1.4, height), *loose_polygons(count, columns, seed)],
        fixed=[0, 1, 2],
        friction_angle=friction_angle,
    )


# --- contact detection ---------------------------------------------------------------------

REACH = SearchDistance(front=0.005, depth=0.025, critdis=0.005)
BISECTOR = Bisector()


@dataclass(frozen=True)
class Flat:
    """Outlines as the kernels take them."""

    vertices: Floats
    start: Ints

    @property
    def owner(self) -> Ints:
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def flat(outlines: Sequence[Floats]) -> Flat:
    """Return outlines as flat arrays."""
    start = np.concatenate([[0], np.cumsum([len(one) for one in outlines])]).astype(np.int64)
    return Flat(np.ascontiguousarray(np.concatenate(outlines), dtype=float), start)


def candidates_of(
    outlines: Sequence[Floats],
    reach: SearchDistance = REACH,
    memory: ContactMemory | None = None,
    shift: Floats | None = None,
) -> Candidates:
    """Return the candidate edges among outlines, free to move; ``shift`` as in find_candidates."""
    flats = flat(outlines)
    free = np.zeros(len(outlines), np.bool_)
    pairs = near_pairs(VerletList(), flats.vertices, flats.start, free, reach.front + reach.critdis)
    known = memory or ContactMemory()
    return find_candidates(flats.vertices, flats.start, pairs, known, reach, shift)


@dataclass(frozen=True)
class Touch:
    """One contact found among outlines: (block, vertex) against (block, edge)."""

    vertex: tuple[int, int]
    edge: tuple[int, int]
    gap: float


def touches_of(
    outlines: Sequence[Floats],
    reach: SearchDistance = REACH,
    memory: ContactMemory | None = None,
    rule: CornerRule = BISECTOR,
) -> list[Touch]:
    """Return the contacts that detection and a corner rule find among outlines."""
    flats = flat(outlines)
    found = candidates_of(outlines, reach, memory)

    def local(vertex: int) -> tuple[int, int]:
        block = int(flats.owner[vertex])
        return block, vertex - int(flats.start[block])

    return [
        Touch(local(int(found.vertex[c])), local(int(found.edge[c])), float(found.gap[c]))
        for c in np.flatnonzero(rule.choose(found))
    ]


def contacts_of(
    model: Model,
    state: State | None = None,
    reach: SearchDistance = REACH,
    rule: CornerRule = BISECTOR,
) -> Contacts:
    """Return the contacts of a state as a step sees them."""
    state = state or at_start(model)
    centroid = polygon.moments(state.vertices, model.block_start)[1]
    return detect(model, rule, state, centroid, reach)


# --- runs to their end -----------------------------------------------------------------------


@dataclass(frozen=True)
class Watched:
    """A process that counts why its steps were rejected."""

    process: StepProcess
    watch: Callable[[StepResult], None] | None = None
    """Called with every step taken."""
    rejected: Counter[StepOutcome] = field(default_factory=Counter)

    def step(
        self, model: Model, how: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        try:
            result = self.process.step(model, how, state, step, workspace)
        except StepRejected as rejected:
            self.rejected[rejected.outcome] += 1
            raise
        if self.watch:
            self.watch(result)
        return result

    def advice(self, model: Model, how: Method, state: State, step: float) -> tuple[str, ...]:
        return self.process.advice(model, how, state, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        return self.process.stiffness(model, step)


STEP_CONTROL = {StepOutcome.TRAVELLED_TOO_FAR, StepOutcome.ROTATED_TOO_FAR}
"""Rejections by which a run keeps its movement per step within bounds, not failures."""


@dataclass(frozen=True)
class Finished:
    """A run and what was rejected on its way."""

    run: Run
    rejected: Counter[StepOutcome]

    @property
    def failed_steps(self) -> int:
        """Steps rejected for anything but moving or turning too far."""
        return sum(n for outcome, n in self.rejected.items() if outcome not in STEP_CONTROL)

    @property
    def iterations(self) -> float:
        """Assemblies and solves per step."""
        return self.run.report.passes / self.run.report.steps

    @property
    def moved(self) -> Floats:
        """Movement of every vertex since the start, m, shape (nv, 2)."""
        return self.run.state.vertices - self.run.model.vertices

    @property
    def drift(self) -> float:
        """Largest horizontal movement of a vertex, m."""
        return float(np.abs(self.moved[:, 0]).max())

    @property
    def created(self) -> float:
        """Largest energy ever held beyond what the start and the loads gave, J/m."""
        held = [self.run.energy[name] for name in STORED]
        return float((np.sum(held, axis=0) - self.run.energy["loads"] - held[0][0]).max())

    @property
    def turnover(self) -> float:
        """Energy that changed its form, J/m: the yardstick of the ledger."""
        return float(np.abs(self.run.energy["gravity"]).max() + self.run.energy["kinetic"].max())


STORED = ("kinetic", "elastic", "gravity", "contact", "fixed_points")
"""Entries of the ledger that a system holds."""


def finish(
    model: Model,
    how: Method,
    step: float,
    end: float,
    *,
    may_stop: bool = False,
    watch: Callable[[StepResult], None] | None = None,
) -> Finished:
    """Return the run of a model to ``end``, s.

    Raises RunStopped where it cannot go on, unless it ``may_stop``.
    """
    watched = Watched(how.process, watch)
    schedule = Schedule(step=step, end=end, every=end)
    try:
        run = simulate(model, replace(how, process=watched), schedule)
    except RunStopped as stopped:
        if not may_stop:
            raise
        run = stopped.run  # type: ignore[assignment]
    return Finished(run, watched.rejected)


def overlaps(model: Model, vertices: Floats) -> list[tuple[int, int, float]]:
    """Return pairs of blocks whose outlines overlap, and the area, m2."""
    shapes = np.array([shapely.Polygon(one) for one in np.split(vertices, model.block_start[1:-1])])
    low, high = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    low, high = low[low < high], high[low < high]
    area = shapely.area(shapely.intersection(shapes[low], shapes[high]))
    return [(int(i), int(j), float(a)) for i, j, a in zip(low, high, area, strict=True) if a > 0]


# --- running -------------------------------------------------------------------------------


def open_ledger(model: Model, how: Method, state: State) -> State:
    """Return the state with the ledger that a run starts with."""
    return replace(state, ledger=energy.opening(model, state))


def march(
    model: Model, how: Method, step: float, end: float, state: State | None = None
) -> list[StepResult]:
    """Return the results of all steps to ``end``; a rejected step is halved, at most ten times."""
    state = open_ledger(model, how, state or at_start(model))
    results: list[StepResult] = []
    wanted, workspace = step, Workspace()
    while end - state.time > 1e-9 * step:
        try:
            result = how.process.step(model, how, state, min(wanted, end - state.time), workspace)
        except StepRejected:
            wanted *= 0.5
            if wanted < step / 1024.0:
                raise
            continue
        results.append(result)
        state = result.state
        wanted = min(step, 2.0 * wanted)
    return results


def centroids(model: Model, state: State) -> Floats:
    """Return the blocks' centroids, m, shape (n, 2)."""
    return polygon.moments(state.vertices, model.block_start)[1]


def momentum(model: Model, how: Method, state: State) -> Floats:
    """Return linear momentum and angular momentum about (0, 0), shape (3,)."""
    frames = block_frames(model, state)
    linear = model.mass[:, None] * state.velocity[:, :2]
    at = frames.centroid
    orbital = at[:, 0] * linear[:, 1] - at[:, 1] * linear[:, 0]
    spin = np.einsum("nj,nj->n", frames.mass_matrix[:, 2], state.velocity)
    return np.array([*linear.sum(axis=0), np.sum(orbital + spin)])


def incline(friction_angle: float, *, young: float = 50e9) -> Model:
    """Return the paper's block on a 45 degree incline, the incline fixed."""
    slope = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]])
    slider = np.array([[1.0, 9.0], [4.0, 6.0], [4.0, 9.0]])
    return system([slope, slider], fixed=[0], friction_angle=friction_angle, young=young)


def slide(friction_angle: float, time: float) -> float:
    """Return how far the block on the incline moves to the right from rest, m."""
    tangent = np.tan(np.radians(friction_angle))
    return 0.25 * GRAVITY * (1.0 - tangent) * time**2
