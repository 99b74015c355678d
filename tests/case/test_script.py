"""Scripts: a builder gives a case file of the same model, a model runs in a line."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import usual_step
from clast.case.case_file import Case
from clast.contact.laws import Carried, Penalty
from clast.errors import CaseError, ModelError
from clast.step.convex import Convex


def bytes_of(value: Any) -> Any:
    """Everything that a model holds, down to the bits of its arrays."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if dataclasses.is_dataclass(value):
        names = (field.name for field in dataclasses.fields(value))
        return type(value).__name__, {name: bytes_of(getattr(value, name)) for name in names}
    return [bytes_of(item) for item in value] if isinstance(value, tuple) else value


def everything() -> clast.ModelBuilder:
    """A builder that uses all it knows."""
    record = clast.Accelerogram(
        np.array([0.0, 0.1, 0.30000000000000004]), np.array([[0.0, 0.0], [1 / 3, -0.1], [2.0, 0.7]])
    )
    builder = clast.ModelBuilder(
        title='All "of it" \\ Tück 1 $',
        plane=clast.PlaneStrain(),
        gravity=np.array([0.1, -9.80665]),
        ground_motion=clast.MovingBase(record),
    )
    stress = (-1e6 / 3, -2e6, 1e5)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0, initial_stress=stress)
    builder.add_rock("marl, soft", young=5e9, poisson=1 / 3, density=2300)
    builder.add_joint(friction_angle=30.1, cohesion=1e4)
    builder.add_joint(
        "soft",
        friction_angle=0.5,
        allow_small_friction_angle=True,
        between_rocks=[("granite", "marl, soft")],
    )
    builder.add_joint("glued", tensile_strength=1e5, cohesion=1e6, between=[("floor", "2")])
    far = np.array([1e6, 2e6])

    def at(x: float, y: float) -> np.ndarray:
        return far + np.array([x, y])

    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    builder.block(
        name="floor",
        vertices=far + square * [10, -1][0] - [0, 10],
        rock="granite",
        velocity=(0, 0, 0),
    )
    builder.block(vertices=(far + square).tolist(), rock="marl, soft", velocity=(0.1, 1 / 3, -2))
    shifts = 2.0 * np.arange(1, 5)[:, None, None] * np.array([1.0, 0.0])
    builder.blocks(
        vertices=far + square + shifts,
        names=["a", "b", "c.d", "e'f"],
        rock="granite",
        fixed=np.array([False, True, False, False]),
        velocity=np.outer([1, 0, 0, 1], [0.0, 0.0, 1 / 7]),
        initial_stress=np.outer([1, 2, 3, 4], [1.0, 1e-300, -7.3e5]),
    )
    builder.fixed_point(at(0.5, -0.1), block="floor")
    builder.fixed_point(at(9.5, -0.1))
    builder.point_load(at(1, 1), (1e3, -1e4 / 3), block="2")
    builder.line_load(at(2, 1), at(3, 1), (0, -5e3), block="a")
    builder.add_amplitude("ramp up", [0.0, 0.1, 0.30000000000000004], np.array([0.0, 1 / 3, 1.0]))
    builder.add_amplitude("pulse", [0, 1], [1, 0])
    builder.point_load(at(2, 1), (1e3, 0), block="a", amplitude="pulse")
    builder.line_load(at(4, 1), at(5, 1), (0, -5e3), block="b", amplitude="ramp up")
    builder.pressure(at(0, 1), at(0.7, 1), 1e5 / 3)
    builder.pressure(at(6, 1), at(6, 0), np.array([0.1, 2e4]), block="c.d", amplitude="ramp up")
    builder.measured_point("top", at(0, 1), block="2")
    return builder


def test_a_case_file_of_a_builder_gives_the_same_model_to_the_bit(tmp_path):
    builder = everything()
    file = tmp_path / "all.toml"
    file.write_text(builder.to_toml(), encoding="utf-8")
    assert bytes_of(clast.load(file).model()) == bytes_of(builder.build())
    again = clast.load(file).to_toml()
    assert bytes_of(Case.from_toml(again).model()) == bytes_of(builder.build())


@pytest.mark.slow
def test_many_blocks_come_back_to_the_bit():
    rng = np.random.default_rng(1)
    count = 3000
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    grid = 3.0 * np.stack(np.divmod(np.arange(count), 60), axis=1)
    vertices = grid[:, None] + square + rng.uniform(-0.3, 0.3, (count, 4, 2))
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.blocks(vertices=vertices, velocity=rng.normal(size=(count, 3)))
    assert bytes_of(Case.from_toml(builder.to_toml()).model()) == bytes_of(builder.build())


def two_bricks(**given: Any) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(title="Two bricks", **given)
    builder.add_rock("brick", young=5e9, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], velocity=(1, 0, 0))
    builder.measured_point("P", (0.5, 0.5), block="brick")
    return builder


def test_a_model_runs_in_a_line_as_its_case_does():
    builder = two_bricks()
    run = clast.simulate(builder.build(), end=0.05)
    assert run.report.finished
    assert run.state.time == pytest.approx(0.05)
    assert run.report.steps == 50
    stopped = run.history("P").displacement[-1, 0]
    assert stopped == pytest.approx(0.05 - 0.5 * 9.8 * np.tan(np.pi / 6) * 0.05**2, rel=0.01)
    for other in (
        builder.case(end=0.05).run(),
        clast.simulate(builder, end=0.05, process="convex", step=1e-3),
        Case.from_toml(builder.to_toml(end=0.05)).run(),
    ):
        np.testing.assert_array_equal(other.history("P").rows, run.history("P").rows)


def test_the_function_stays_when_the_module_of_that_name_is_loaded():
    from clast.run.schedule import Schedule

    model = two_bricks().build()
    case = two_bricks().case(end=0.01)
    schedule = Schedule(step=1e-3, end=0.01, every=0.01)
    run = clast.simulate(model, case.method(model), schedule)
    assert (len(run.times), run.report.steps) == (2, 10)


def test_defaults_follow_from_the_model():
    assert usual_step(two_bricks().build()) == 1e-3
    small = two_bricks(gravity=(0, 0))
    small.block(vertices=[(5, 0), (5.1, 0), (5.1, 0.1), (5, 0.1)])
    assert usual_step(small.build()) == 2e-4
    case = two_bricks().case()
    assert (case.time.step, case.time.end) == (1e-3, 1.0)
    assert two_bricks().case(end=1e-4).time.step == 1e-4


@pytest.mark.slow
def test_a_run_and_its_file_have_the_same_picture(tmp_path):
    pytest.importorskip("matplotlib")
    file = tmp_path / "a.vtkhdf"
    pictures = []
    for source in (
        clast.simulate(two_bricks(), end=0.01),
        clast.simulate(two_bricks(), end=0.01, output=file),
        clast.read(file),
    ):
        path = clast.plot_results(source, tmp_path / "a.png", look=clast.Look(dpi=50))
        assert clast.plot_history(source, tmp_path / "P.png", "P").stat().st_size > 1000
        pictures.append(path.read_bytes())
    assert pictures[0] == pictures[1] == pictures[2]


@pytest.mark.slow
def test_parts_of_the_package_are_there_without_importing_them():
    code = "import clast; assert clast.studies.compare; assert callable(clast.simulate)"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert set(clast.__all__) <= set(dir(clast))
    for name in clast.__all__:
        assert getattr(clast, name).__doc__, name


def test_results_say_what_was_asked_of_them(tmp_path):
    file = tmp_path / "a.vtkhdf"
    clast.simulate(two_bricks(), end=0.01, process="modified", every=0.005, output=file)
    results = clast.read(file)
    assert len(results.times) == 3
    assert 'process = "modified"' in results.case_text


@dataclass(frozen=True)
class Own:
    """The convex process under another name."""

    inner: Convex = dataclasses.field(default_factory=Convex)

    def step(self, model, method, state, step, workspace):
        return self.inner.step(model, method, state, step, workspace)

    def advice(self, model, method, state, step):
        return ("this is my own",)

    def stiffness(self, model, step):
        return 1e8, "because"


def test_objects_are_taken_in_the_place_of_names():
    builder = two_bricks()
    run = clast.simulate(builder, end=0.01, process=Own(), contact_law=Penalty(1e7))
    assert "this is my own" in run.report.warnings
    case = builder.case(end=0.01, process=Own(), contact_law={"name": "penalty"})
    method = case.method()
    assert isinstance(method.process, Own)
    assert method.contact_law == Penalty(1e8)
    assert case.run().report.finished
    multipliers = {"name": "augmented-lagrangian", "multipliers": Carried()}
    nested = builder.case(contact_law=multipliers)
    assert isinstance(nested.method().contact_law.multipliers, Carried)
    assert "Own(inner=" in case.text
    with pytest.raises(CaseError, match="object of a script, which a case file cannot hold"):
        case.to_toml()
    assert 'multipliers = "carried"' in nested.to_toml()


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            {"process": Penalty()},
            "Penalty is not a valid process: it has no step, advice, stiffness",
        ),
        ({"contact_law": Penalty}, r"Penalty is a class, not an instance\n  give Penalty\(...\)"),
        ({"end": 0.01, "step": 0.1}, "longer than the whole run"),
    ],
)
def test_bad_keys_are_answered(keys, said):
    for call in (two_bricks().case, lambda **keys: clast.simulate(two_bricks(), **keys)):
        with pytest.raises(CaseError, match=said):
            call(**keys)


def test_keys_beside_an_object_that_has_them_are_refused():
    builder = two_bricks()
    method = builder.case().method()
    with pytest.raises(CaseError, match="process and a Method are both given"):
        clast.simulate(builder, method, process="modified")


def test_bad_blocks_are_answered_by_the_case_too():
    builder = two_bricks()
    builder.block(vertices=[(5, 0), (6, 0), (6, 1)], name="brick")
    for call in (builder.case, builder.to_toml, partial(clast.simulate, builder)):
        with pytest.raises(ModelError, match="two blocks with that name"):
            call(step=1e-3)
    with pytest.raises(ModelError, match="two rocks with that name"):
        builder.add_rock("brick", young=1e9, poisson=0.2, density=1000.0)


def test_only_cases_and_models_are_simulated():
    for wrong in ([two_bricks()], None, clast.Case):
        with pytest.raises(CaseError, match="is neither a case nor a model"):
            clast.simulate(wrong)
    with pytest.raises(CaseError, match="there is no such file"):
        clast.simulate("none.toml")


def test_what_no_file_can_hold_is_refused_but_runs():
    class Hover:
        def body_acceleration(self, start, end):
            return np.array([0.0, 9.8])

        def anchor_displacement(self, time):
            return np.zeros(2)

    builder = two_bricks(ground_motion=Hover())
    with pytest.raises(CaseError, match="Hover is an object of a script"):
        builder.to_toml()
    assert clast.simulate(builder, end=0.01).report.finished
