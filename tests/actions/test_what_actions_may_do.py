"""What actions of a script may not do: edit state or model, hand back what no step can use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

import clast
from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.actions.loads import Loads
from clast.contact.clipped_spring import Clipped, table
from clast.errors import ClastError
from clast.model.state import Ledger
from scenes.shaken import shaken

AT_STEP = 3


def no_contribution(start: StepStart) -> Contribution:
    return Contribution()


def no_done(start: StepStart) -> ActionResult:
    return ActionResult(work=0.0, ledger=Ledger())


@dataclass(frozen=True)
class Acts:
    """An action that does something in its fourth step."""

    contribution_of: Callable[[StepStart], Any] = no_contribution
    done_of: Callable[[StepStart], Any] = no_done

    def begin(self, model: Any) -> int:
        return 0

    def contribution(self, start: StepStart, state: int) -> Contribution:
        return self.contribution_of(start) if state == AT_STEP else Contribution()

    def finish(
        self, start: StepStart, state: int, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        done = self.done_of(start) if state == AT_STEP else no_done(start)
        return replace(done, state=state + 1) if isinstance(done, ActionResult) else done


def on_a_floor(*actions: Any) -> clast.ModelBuilder:
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    builder.block(name="b", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.measured_point("A", (0.5, 0.5), block="b")
    builder.actions.extend(actions)
    return builder


def stopped(action: Any) -> tuple[str, Any]:
    """Return what is said of a run that an action stops, and that run."""
    with pytest.raises(ClastError) as error:
        clast.simulate(on_a_floor(action), end=0.02, step=1e-3)
    return " ".join(str(error.value).split()), error.value.run


def edit_vertices(start: StepStart) -> Contribution:
    start.state.vertices[4:8, 0] += 0.25
    return Contribution()


def edit_memory(start: StepStart) -> Contribution:
    start.state.memory.normal_force[:] = 0.0
    return Contribution()


def edit_mass(start: StepStart) -> Contribution:
    start.model.mass[1] = 1.0
    return Contribution()


@pytest.mark.parametrize("edit", [edit_vertices, edit_memory, edit_mass])
def test_an_action_that_edits_is_stopped(edit: Callable[[StepStart], Contribution]):
    said, run = stopped(Acts(contribution_of=edit))
    assert "action Acts: contribution() writes into an array that is read-only" in said
    assert "array.copy()" in said
    assert run.report.steps == AT_STEP
    assert run.times[-1] == pytest.approx(AT_STEP * 1e-3)
    np.testing.assert_allclose(run.state.vertices, run.model.vertices, atol=1e-3)

    def edit_at_end(start: StepStart) -> ActionResult:
        edit(start)
        return no_done(start)

    assert "action Acts: finish() writes into" in stopped(Acts(done_of=edit_at_end))[0]


def arrays_in(thing: Any, at: str = "") -> list[tuple[str, np.ndarray]]:
    """Return all arrays that a dataclass holds or has computed, with their places."""
    if isinstance(thing, np.ndarray):
        return [(at, thing)]
    if isinstance(thing, tuple):
        return [one for k, part in enumerate(thing) for one in arrays_in(part, f"{at}[{k}]")]
    if not is_dataclass(thing):
        return []
    return [one for key, part in vars(thing).items() for one in arrays_in(part, f"{at}.{key}")]


def test_no_array_of_model_and_state_can_be_written():
    model = shaken().build()
    run = clast.simulate(model, step=2e-3, end=0.01)
    names = [name for name in dir(type(model)) if not name.startswith("_")]
    assert [getattr(model, name) for name in names]  # all that is computed on the way, too
    for thing in (model, run.model, run.state, run.final):
        found = arrays_in(thing)
        assert len(found) > 10
        assert [place for place, array in found if array.flags.writeable] == []
    assert len(run.state.memory) > 10


def test_arrays_of_a_script_stay_its_own():
    vertices = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)])
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=vertices)
    model = builder.build()
    vertices[0] = 7.0
    velocity = np.zeros((1, 6))
    state = clast.simulate(model, end=0.01, step=1e-3).state
    changed = replace(state, velocity=velocity)
    velocity[0, 0] = 1.0
    assert not changed.velocity.flags.writeable
    assert {one.name for one in fields(changed)} == set(vars(changed))


def springs(**changes: Any) -> Contribution:
    none, one = np.zeros(1), np.ones(1)
    clipped = Clipped(at_zero=none, stiffness=one, low=none - np.inf, high=none + np.inf)
    found, _ = table(
        vertex_block=np.array([1]),
        edge_block=np.array([0]),
        arms=np.zeros((1, 6)),
        gap=none,
        slip=none,
        normal=clipped,
        shear=clipped,
    )
    return Contribution(springs=replace(found, **changes))


FORCE = np.zeros((1, 6))
SHARES: dict[str, tuple[Any, str]] = {
    "too large": (
        Contribution(block=np.array([2]), force=FORCE),
        "block 2, and there are only the blocks",
    ),
    "negative": (
        Contribution(block=np.array([-1]), force=FORCE),
        "block -1, and there are only the",
    ),
    "huge": (Contribution(block=np.array([10**9]), force=FORCE), "block 1000000000, and there"),
    "not whole": (
        Contribution(block=np.array([1.0]), force=FORCE),
        "block as numbers of type float64",
    ),
    "truths": (Contribution(block=np.array([True]), force=FORCE), "block as numbers of type bool"),
    "a list": (Contribution(block=[1], force=FORCE), "block as a list"),
    "square": (
        Contribution(block=np.array([[1]]), force=FORCE),
        "block as a ndarray of shape (1, 1)",
    ),
    "forces": (
        Contribution(block=np.array([1]), force=np.zeros((2, 6))),
        "force of shape (2, 6), not (1",
    ),
    "vectors": (Contribution(block=np.array([1]), force=np.zeros((1, 2))), "force of shape (1, 2)"),
    "nan": (
        Contribution(block=np.array([1]), force=FORCE * np.nan),
        "force with a value that is not a finite",
    ),
    "stiff": (
        Contribution(block=np.array([1]), force=FORCE, stiffness=np.zeros((1, 3, 3))),
        "stiffness of shape (1, 3, 3), not (1, 6, 6)",
    ),
    "weight": (Contribution(acceleration=np.zeros(3)), "acceleration of shape (3,), not (2,)"),
    "slowed": (Contribution(carried=-0.5), "carried = -0.5, which is not a valid share"),
    "nothing": (None, "contribution() gives a NoneType, not a Contribution"),
    "links": (springs(vertex_block=np.array([5])), "springs with vertex_block 5, and there are"),
    "pairs": (springs(pairs=np.array([[0, 9]])), "springs with pairs 9"),
    "pair": (springs(pair=np.array([1])), "springs with pair 1"),
    "arms": (springs(arms=np.zeros((1, 4))), "springs with arms of shape (1, 4)"),
}


@pytest.mark.parametrize("name", SHARES)
def test_shares_that_no_step_can_use(name: str):
    contribution, words = SHARES[name]
    said, run = stopped(Acts(contribution_of=lambda start: contribution))
    assert "action Acts: contribution() gives " in said
    assert words in said
    assert run.report.steps == AT_STEP


DONE: dict[str, tuple[Any, str]] = {
    "nothing": (None, "finish() gives a NoneType, not an ActionResult"),
    "nan": (ActionResult(work=np.nan, ledger=Ledger()), "work = nan, which is not a finite number"),
    "text": (ActionResult(work="all", ledger=Ledger()), "work = 'all', which is no"),
    "ledger": (ActionResult(work=0.0, ledger=0.0), "a float as its ledger, not a Ledger"),
    "entry": (ActionResult(work=0.0, ledger=Ledger(loads=np.inf)), "a ledger with an entry"),
}


@pytest.mark.parametrize("name", DONE)
def test_what_is_done_must_be_numbers(name: str):
    done, words = DONE[name]
    said, _ = stopped(Acts(done_of=lambda start: done))
    assert "action Acts: finish() gives " in said
    assert words in said


def test_what_an_action_itself_gets_wrong_is_its_own():
    def wrong(start: StepStart) -> Contribution:
        raise ValueError("mine")

    with pytest.raises(ValueError, match=r"^mine$"):
        clast.simulate(on_a_floor(Acts(contribution_of=wrong)), end=0.02, step=1e-3)
    run = clast.simulate(on_a_floor(Acts()), end=0.02, step=1e-3)
    assert run.report.finished
    assert Loads.__module__.startswith("clast.")  # those of clast are not looked at twice
