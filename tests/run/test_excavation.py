"""Blocks that are excavated: what is left behaves as if they had never been there."""

from dataclasses import fields, replace

import numpy as np
import pytest

import clast
from clast.actions.relaxation import SupportForces
from clast.errors import ModelError
from clast.model.model import Model
from clast.model.state import Ledger, State
from clast.run.excavation import excavated
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method
from scenes.tiers import pairwise

G = 9.8
STIFF = {"modified": 2e8, "open-close": 1e9, "convex": 1e9}
STEP = 1e-3


def rock(poisson: float = 0.2) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=1e9, poisson=poisson, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    return builder


def box(builder: clast.ModelBuilder, name: str, x: float, y: float, w: float, h: float, **more):
    corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
    builder.block(name=name, vertices=corners, **more)


def method_of(model: Model, process: str = "convex", law: str = "penalty", **more) -> Method:
    settings = clast.Case.validated(
        {
            "rock": {},
            "time": {"step": STEP, "end": 1.0, "max_displacement": 0.05, **more},
            "method": {
                "process": process,
                "contact_law": {"name": law, "normal_stiffness": STIFF[process]},
                "critdis": 0.01,
            },
        },
        "test",
    )
    return settings.method(model)


def run(model: Model, method: Method, steps: int, begin: RunState | None = None):
    """Return the run and what it carries, after so many more steps."""
    kept: list[RunState] = []
    start = 0.0 if begin is None else begin.state.time
    end = start + steps * STEP
    schedule = Schedule(step=STEP, end=end, every=0.1)
    return simulate(model, method, schedule, begin=begin, keep=kept.append), kept


def digging(model, method, now: RunState, names, relax=1.0, relax_time=0.0):
    """Return model and run after an excavation."""
    blocks = model.blocks_called(names)
    left, state = excavated(model, method, now.state, blocks, relax, relax_time)
    return left, replace(now, state=state)


def held(ledger: Ledger) -> float:
    """What stays but for what the time integration takes."""
    return ledger.stored - ledger.brought + ledger.lost + ledger.numerical


def wall() -> Model:
    """Three rows of bricks on a floor, one of them an opening; a falling block; a support."""
    builder = rock()
    box(builder, "floor", -1, -1, 6, 1, fixed=True)
    for row in range(3):
        for column in range(3):
            x = column + 0.5 * (row % 2)
            box(builder, f"{row}-{column}", x, 0.5 * row, 1, 0.5)
    box(builder, "falls", 1.2, 1.7, 0.5, 0.5)
    builder.fixed_point((0.2, 0.1), block="0-0")
    builder.fixed_point((1.2, 0.1), block="0-1")
    builder.opening("hole", ["0-1", "1-1"])
    builder.measured_point("in it", (1.5, 0.2), block="0-1")
    return builder.build()


@pytest.mark.parametrize(
    ("law", "process", "relax"),
    pairwise(
        ["penalty", "augmented-lagrangian"], ["modified", "open-close", "convex"], [1.0, 0.25]
    ),
)
def test_the_ledger_stays_closed(process: str, law: str, relax: float):
    model = wall()
    method = method_of(model, process, law)
    first, kept = run(model, method, 60)
    before = first.state.ledger
    left, now = digging(model, method, kept[-1], ["hole"], relax, 0.05)
    after = now.state.ledger
    turned_over = abs(before.gravity)
    assert held(after) == pytest.approx(held(before), abs=1e-12 * turned_over)
    assert after.removed != 0.0 and after.fixed_points < before.fixed_points
    second, _ = run(left, method, 100, now)
    end = second.state.ledger
    turned_over += abs(end.gravity) + abs(end.removed)
    assert abs(end.unaccounted) < 1e-6 * turned_over
    assert held(end) == pytest.approx(held(after), abs=1e-6 * turned_over)
    assert second.report.finished
    point = second.history("in it").displacement
    assert np.array_equal(point, np.broadcast_to(point[0], point.shape))


def jump_of_numerical(model: Model, method: Method, names: list[str]) -> tuple[float, State]:
    """Return what the time integration takes in ten steps after an excavation; and the end.

    A spring whose energy is booked twice, or not at all, would show there.
    """
    _, kept = run(model, method, 50)
    left, now = digging(model, method, kept[-1], names)
    end = run(left, method, 10, now)[1][-1].state
    return end.ledger.numerical - now.state.ledger.numerical, end


def test_a_moving_base_leaves_fixed_points_of_gone_blocks_alone():
    builder = rock()
    box(builder, "table", 0, 0, 2, 1)
    box(builder, "foot", 3, 0, 1, 1)
    for x, block in ((0.2, "table"), (1.8, "table"), (3.2, "foot"), (3.8, "foot")):
        builder.fixed_point((x, 0.2), block=block)
    time = np.linspace(0.0, 0.5, 51)
    shaking = np.stack([2.0 * np.sin(30.0 * time), 0.0 * time], axis=1)
    builder.ground_motion = clast.MovingBase(clast.Accelerogram(time, shaking))
    model = builder.build()
    jump, end = jump_of_numerical(model, method_of(model), ["foot"])
    whole = run(model, method_of(model), 60)[1][-1].state
    assert end.ledger.removed != 0.0
    # the table goes on as it would beside the foot
    assert np.abs(end.vertices[:4] - whole.vertices[:4]).max() < 1e-12
    assert abs(jump) < 1e-6 * (end.ledger.kinetic + end.ledger.elastic)
    assert abs(end.ledger.unaccounted) < 1e-6 * abs(end.ledger.loads)


def test_the_loaded_outline_of_a_gone_block_holds_nothing():
    builder = rock()
    builder.in_situ = clast.InSituStress(stress=(-1e6, -2e6, 0.0))
    builder.gravity = (0.0, 0.0)
    for k in range(3):
        box(builder, str(k), k, 0, 1, 1)
    model = builder.build()
    method = method_of(model)
    _, kept = run(model, method, 5)
    left, now = digging(model, method, kept[-1], ["1"], 0.0, 0.1)
    forces = gone_state(now)
    # the stress of 1 MPa on 1 m of joint on either side, which pushes what is left apart
    sums = [forces.force[forces.block == block].sum(axis=0) for block in (0, 2)]
    assert sums[0] == pytest.approx([-1e6, 0.0], abs=1.0)
    assert sums[1] == pytest.approx([1e6, 0.0], abs=1.0)
    end = run(left, method, 30, now)[1][-1].state
    assert abs(end.ledger.unaccounted) < 1e-6 * abs(end.ledger.loads)
    assert end.vertices[1, 0] > 1.0  # the free end has moved in


def test_what_is_removed_is_what_the_blocks_held():
    builder = rock(poisson=0.0)
    box(builder, "floor", -1, -1, 3, 1, fixed=True)
    box(builder, "1", 0, 0, 1, 1)
    box(builder, "2", 0.1, 1, 0.8, 1)
    model = builder.build()
    method = method_of(model, dynamic_ratio=0.0)
    _, kept = run(model, method, 200)
    before = kept[-1].state
    _, now = digging(model, method, kept[-1], ["2"])
    after = now.state.ledger
    weight = 2500.0 * G * np.array([1.0, 0.8])
    stiffness = STIFF["convex"]
    # half of the two contacts of each joint carries half of what is above
    joints = np.array([weight.sum(), weight[1]])
    springs = 2 * (0.5 * joints) ** 2 / (2.0 * stiffness)
    assert before.ledger.contact == pytest.approx(springs.sum(), rel=1e-4)
    assert after.contact == pytest.approx(springs[0], rel=1e-4)
    sunk = model.vertices[-4:].mean(axis=0) - before.vertices[-4:].mean(axis=0)
    assert after.gravity == pytest.approx(before.ledger.gravity + weight[1] * sunk[1], rel=1e-9)
    energy = 0.5 * 0.8 * before.stress[2] @ model.compliance[2] @ before.stress[2]
    assert after.elastic == pytest.approx(before.ledger.elastic - energy, rel=1e-12)


def without_last(model: Model, state: State) -> State:
    """Return the state of a model whose last block was never there."""
    first = model.block_start[-2]
    rows = slice(None, model.block_count - 1)
    memory = state.memory
    stays = (memory.vertex < first) & (memory.edge < first)
    return replace(
        state,
        vertices=state.vertices[:first],
        velocity=state.velocity[rows],
        stress=state.stress[rows],
        rotation=state.rotation[rows],
        memory=replace(memory, **{f.name: getattr(memory, f.name)[stays] for f in fields(memory)}),
        actions=(),
    )


def heap(with_last: bool) -> Model:
    """Bricks on a floor, and one that is wedged in between them last."""
    builder = rock()
    box(builder, "floor", -2, -1, 8, 1, fixed=True)
    for k, (x, y) in enumerate([(0, 0), (2, 0), (0.6, 0.52), (1.9, 0.51), (1.1, 1.05)]):
        box(builder, str(k), x, y, 1.2, 0.5, velocity=(0.1 * k, 0.0, 0.2))
    if with_last:
        box(builder, "last", 1.25, 0.0, 0.6, 0.5)
    return builder.build()


@pytest.mark.parametrize("process", ["modified", "open-close", "convex"])
def test_a_gone_block_is_as_one_that_never_was(process: str):
    model, other = heap(True), heap(False)
    method = method_of(model, process)
    _, kept = run(model, method, 40)
    left, now = digging(model, method, kept[-1], ["last"])
    bare = replace(now, state=without_last(model, now.state))
    one, _ = run(left, method, 80, now)
    two, _ = run(other, method, 80, bare)
    first = model.block_start[-2]
    assert np.abs(one.final.vertices[:first] - two.final.vertices).max() < 1e-12
    assert np.abs(one.final.velocity[:-1] - two.final.velocity).max() < 1e-10
    assert np.array_equal(one.final.vertices[first:], now.state.vertices[first:])
    # and something has happened
    assert np.abs(two.final.vertices - now.state.vertices[:first]).max() > 1e-3


def propped() -> Model:
    """A block on two props."""
    builder = rock()
    box(builder, "floor", -1, -1, 4, 1, fixed=True)
    box(builder, "left", 0, 0, 0.3, 1)
    box(builder, "right", 1.7, 0, 0.3, 1)
    box(builder, "roof", 0, 1, 2, 0.5)
    builder.opening("props", ["left", "right"])
    return builder.build()


def gone_state(now: RunState) -> SupportForces:
    return next(own for own in now.state.actions if isinstance(own, SupportForces))


def test_forces_of_excavations_one_after_another_add_up():
    model = propped()
    method = method_of(model)
    _, kept = run(model, method_of(model, dynamic_ratio=0.0), 400)
    once, whole = digging(model, method, kept[-1], ["props"], 0.0, 1.0)
    half, now = digging(model, method, kept[-1], ["left"], 0.0, 1.0)
    both, now = digging(half, method, now, ["right"], 0.0, 1.0)
    assert np.array_equal(both.absent, once.absent)
    total = gone_state(now).force.sum(axis=0)
    assert total == pytest.approx(gone_state(whole).force.sum(axis=0), rel=1e-12)
    assert total[1] == pytest.approx(2500.0 * G * 1.0, rel=1e-3)
    # what is gone is not borne any more: the forces go with the block that they acted on
    roofless, now = digging(both, method, now, ["roof"])
    assert len(gone_state(now).block) == 0
    assert roofless.absent.sum() == 3


def test_other_blocks_pass_through_the_place_of_a_gone_one():
    model = propped()
    method = method_of(model)
    _, kept = run(model, method, 5)
    left, now = digging(model, method, kept[-1], ["props"])
    end, _ = run(left, method, 600, now)
    assert end.final.vertices[-4:, 1].min() == pytest.approx(0.0, abs=2e-4)
    assert not end.report.overlaps


# openings and welds ------------------------------------------------------------------------------


def cantilever(weld: str | None) -> Model:
    """A beam of two halves between a wall and nothing, welded to each other and to the wall."""
    builder = rock()
    if weld:
        builder.add_weld(weld)
    joints = lambda *edges: [weld or "" if k in edges else "" for k in range(4)]  # noqa: E731
    box(builder, "wall", -1, 0, 1, 1, fixed=True, edge_joint=joints(1))
    box(builder, "near", 0, 0, 1, 1, edge_joint=joints(1, 3))
    box(builder, "far", 1, 0, 1, 1, edge_joint=joints(3))
    box(builder, "other", 5, 0, 1, 1)
    box(builder, "below", 4, -1, 3, 1, fixed=True)
    builder.opening("heading", ["far"], weld=weld)
    builder.opening("elsewhere", ["other"])
    return builder.build()


@pytest.mark.parametrize("process", ["open-close", "convex"])
def test_welded_halves_are_one_block_until_their_opening_is_excavated(process: str):
    model = cantilever("joint of heading")
    method = method_of(model, process)
    held_up, kept = run(model, method, 300)
    assert np.abs(held_up.final.vertices - model.vertices).max() < 2e-3
    # digging elsewhere leaves the weld
    aside, now = digging(model, method, kept[-1], ["elsewhere"])
    assert np.array_equal(aside.edge_joint, model.edge_joint)
    held_up, _ = run(aside, method, 100, now)
    assert np.abs(held_up.final.vertices[:12] - model.vertices[:12]).max() < 2e-3
    # with the opening goes the weld, on the wall as well: what was held by it falls
    left, now = digging(model, method, kept[-1], ["heading"])
    assert (left.edge_joint == -1).all()
    fallen, _ = run(left, method, 300, now)
    assert fallen.final.vertices[4:8, 1].max() < 0.7


def test_without_a_weld_the_same_beam_falls():
    model = cantilever(None)
    fallen, _ = run(model, method_of(model), 300)
    assert fallen.final.vertices[4:12, 1].max() < 0.8


def test_a_weld_ends_where_what_it_held_is_gone():
    """Of an opening of two blocks one is excavated by its name: the other keeps its own welds."""
    builder = rock()
    builder.add_weld("w")
    box(builder, "a", 0, 0, 1, 1, edge_joint=["", "w", "", ""])
    box(builder, "b", 1, 0, 1, 1, edge_joint=["", "w", "", "w"])
    box(builder, "c", 2, 0, 1, 1, edge_joint=["", "w", "", "w"])
    box(builder, "d", 3, 0, 1, 1, fixed=True, edge_joint=["", "", "", "w"])
    builder.opening("both", ["b", "c"], weld="w")
    model = builder.build()
    method = method_of(model)
    _, kept = run(model, method, 2)
    left, now = digging(model, method, kept[-1], ["b"])
    free = np.flatnonzero((left.edge_joint == -1) & (model.edge_joint != -1))
    assert free.tolist() == [1, 11]  # of a beside b, and of c beside b
    last, _ = digging(left, method, now, ["c"])
    assert (last.edge_joint == -1).all()


# frames and faults -------------------------------------------------------------------------------


def test_frames_mark_gone_blocks(tmp_path):
    model = wall()
    method = method_of(model)
    _, kept = run(model, method, 10)
    left, now = digging(model, method, kept[-1], ["hole"])
    recorder = clast.RunRecorder(left, output=tmp_path / "out.vtkhdf")
    schedule = Schedule(step=STEP, end=0.02, every=5e-3)
    simulate(left, method, schedule, begin=now, recorder=recorder)
    results = clast.read(tmp_path / "out.vtkhdf")
    assert np.array_equal(results.field("gone", -1) != 0.0, left.absent)
    assert left.absent.sum() == 2
    kept_frames, _ = run(left, method, 10, now)
    assert np.array_equal(kept_frames.field("gone")[-1] != 0.0, left.absent)
    whole, _ = run(model, method, 10)
    assert not whole.field("gone").any()


@pytest.mark.parametrize(
    ("relax", "time", "what"),
    [
        (1.5, 0.0, "1.5 is not a valid share"),
        (np.nan, 0.0, "nan"),
        (0.5, -1.0, "not a valid duration"),
    ],
)
def test_refuses_shares_and_times_out_of_range(relax: float, time: float, what: str):
    model = propped()
    method = method_of(model)
    _, kept = run(model, method, 1)
    with pytest.raises(ModelError, match=what):
        excavated(model, method, kept[-1].state, np.array([1]), relax, time)


def test_refuses_to_take_everything():
    model = propped()
    method = method_of(model)
    _, kept = run(model, method, 1)
    with pytest.raises(ModelError, match="no block would be left"):
        excavated(model, method, kept[-1].state, np.arange(4))


def test_names_that_are_unknown_or_taken_are_refused():
    model = propped()
    with pytest.raises(ModelError, match="did you mean 'props'"):
        model.blocks_called(["prop"])
    assert model.blocks_called(["props", "left"]).tolist() == [1, 2]

    def opening(*entries: tuple[str, list[str]]) -> Model:
        builder = rock()
        box(builder, "a", 0, 0, 1, 1)
        box(builder, "b", 1, 0, 1, 1)
        for name, blocks in entries:
            builder.opening(name, blocks)
        return builder.build()

    with pytest.raises(ModelError, match="block with this name"):
        opening(("a", ["b"]))
    with pytest.raises(ModelError, match="opening with this name"):
        opening(("x", ["a"]), ("x", ["b"]))
    with pytest.raises(ModelError, match="there is no block 'c'"):
        opening(("x", ["c"]))
    with pytest.raises(ModelError, match="already belongs to opening 'x'"):
        opening(("x", ["a"]), ("y", ["a", "b"]))
    with pytest.raises(ModelError, match="is an empty list"):
        opening(("x", []))
