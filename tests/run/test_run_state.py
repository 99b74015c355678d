"""A run that goes on from what it carried at any of its steps ends with the same bits."""

import dataclasses

import numpy as np
import pytest

import clast
from clast.model.model import Model
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import RunState, simulate
from clast.step.method import Method

STEPS = 60
STEP = 2e-3


def shaken() -> clast.ModelBuilder:
    """Bricks with bonds, loads and a fixed point on a floor, in an earthquake."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("granite", young=5e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, cohesion=1e3, tensile_strength=2e2)
    builder.block(vertices=[(-4, -1), (4, -1), (4, 0), (-4, 0)], name="floor", fixed=True)
    for row in range(3):
        for column in range(4):
            x = column + 0.5 * (row % 2) - 2.0
            y = 0.5 * row
            builder.block(
                vertices=[(x, y), (x + 1, y), (x + 1, y + 0.5), (x, y + 0.5)],
                name=f"{row}-{column}",
            )
    builder.block(
        vertices=[(0, 1.7), (0.4, 1.7), (0.4, 2.1), (0, 2.1)], name="falls", velocity=(1, -2, 3)
    )
    builder.add_table("ramp", [0.0, 0.05, 0.1], [0.2, 1.0, 0.5])
    builder.point_load((-1.6, 0.25), (1e3, -2e3), block="0-0", factor="ramp")
    builder.pressure((0, 1.7), (0.3, 1.7), [2e3, 5e2], factor="ramp")
    builder.measured_point("top", (0.3, 2.0), block="falls")
    time = np.linspace(0.0, 0.5, 51)
    acceleration = np.stack([3.0 * np.sin(40.0 * time), np.cos(30.0 * time)], axis=1)
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(time, acceleration))
    return builder


def prepared(process: str, law: str) -> tuple[Model, Method, Schedule]:
    """Return the model, the method and the schedule of the test."""
    stiffness = {"modified": 2e7, "open-close": 2e7, "convex": 5e9}[process]
    case = shaken().case(
        step=STEP,
        end=STEPS * STEP,
        every=7.5 * STEP,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
    )
    model = case.model()
    return model, case.method(model), case.schedule()


def same(one: object, other: object) -> bool:
    """Return whether two records hold the same bits, wall times apart."""
    if dataclasses.is_dataclass(one):
        names = [entry.name for entry in dataclasses.fields(one) if entry.name != "seconds"]
        return all(same(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, np.ndarray):
        return one.dtype == np.asarray(other).dtype and np.array_equal(one, other, equal_nan=True)
    return bool(one == other)


@pytest.mark.parametrize("law", ["penalty", "augmented-lagrangian"])
@pytest.mark.parametrize("process", ["modified", "open-close", "convex"])
def test_a_run_goes_on_from_any_of_its_steps(process: str, law: str):
    model, method, schedule = prepared(process, law)
    carried: list[RunState] = []
    whole = simulate(model, method, schedule, keep=carried.append)
    assert whole.report.cut_steps < len(carried)
    chosen = np.linspace(0, len(carried) - 2, 10).astype(int)
    for at in chosen:
        ends: list[RunState] = []
        rest = simulate(model, method, schedule, begin=carried[at], keep=ends.append)
        assert same(ends[-1], carried[-1])
        assert same(rest.final, whole.final)
        assert_same_tail(whole, rest)


def assert_same_tail(whole: Run, rest: Run) -> None:
    """Compare tables, frames and the report of a run with those of one that began later."""
    for table in ("energy", "steps"):
        for name, column in getattr(rest, table).items():
            later = getattr(whole, table)[name][-len(column) :]
            np.testing.assert_array_equal(column, later, err_msg=name)
    for entry in ("steps", "passes", "cut_steps", "largest_penetration", "ledger", "counts"):
        assert getattr(rest.report, entry) == getattr(whole.report, entry), entry
    assert rest.report.warnings == whole.report.warnings
    assert list(rest.times[1:]) == list(whole.times[-len(rest.times) + 1 :])
