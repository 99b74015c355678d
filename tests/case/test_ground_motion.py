"""The accelerogram, the [ground_motion] table and what the two ways of acting do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.model.ground_motion import Accelerogram, InertialForce, MovingBase, Still
from clast.run.preflight import examine

CASE = """
schema = 1
time = {step = 1e-3, end = 0.2, max_displacement = 0.01}
rock.granite = {young = 5e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
method.process = "PROCESS"

[[block]]
name = "base"
vertices = [[-2, -1], [3, -1], [3, 0], [-2, 0]]

[[block]]
name = "block"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]

[[fixed_point]]
at = [-2, -1]
[[fixed_point]]
at = [3, -1]
[[measured_point]]
name = "base"
at = [0, -1]
[[measured_point]]
name = "block"
at = [0.5, 0.5]

[ground_motion]
acts = "ACTS"
time = [0.0, 0.1, 0.2]
acceleration = [0.0, 2.0, -1.0]
"""


def test_integrals_are_those_of_a_piecewise_linear_record():
    time = np.array([0.1, 0.3, 0.35, 1.0])
    record = Accelerogram(time, np.array([[1.0, 0.0], [-2.0, 3.0], [0.5, 0.0], [4.0, -1.0]]))
    for axis in (0, 1):
        for instant in (0.05, 0.1, 0.22, 0.3, 0.34, 0.9, 1.0):
            expected, _ = quad(
                lambda t, axis=axis: np.interp(t, time, record.acceleration[:, axis], left=0.0),
                0.1,
                max(instant, 0.1),
                points=[t for t in time if t < instant],
            )
            assert record.velocity(instant)[axis] == pytest.approx(expected, abs=1e-12)
            way, _ = quad(
                lambda t, axis=axis: record.velocity(t)[axis],
                0.0,
                instant,
                points=[t for t in time if t < instant],
            )
            assert record.displacement(instant)[axis] == pytest.approx(way, abs=1e-12)
    later = record.displacement(1.0) + 0.5 * record.velocity(1.0)
    assert record.displacement(1.5) == pytest.approx(later)


def test_without_the_table_the_ground_is_still():
    text = CASE[: CASE.index("[ground_motion]")].replace("PROCESS", "convex")
    assert isinstance(Case.from_toml(text).model().ground_motion, Still)


@pytest.mark.parametrize("process", ["modified", "convex", "open-close"])
@pytest.mark.parametrize("acts", ["base", "body-force"])
def test_a_block_that_sticks_goes_with_its_base(acts, process):
    loaded = Case.from_toml(CASE.replace("ACTS", acts).replace("PROCESS", process))
    run, model = loaded.run(), loaded.model()
    ground = {"base": MovingBase, "body-force": InertialForce}[acts]
    assert isinstance(model.ground_motion, ground)
    record = model.ground_motion.accelerogram
    moved = record.displacement(0.2)[0] if acts == "base" else 0.0
    for point in ("base", "block"):
        assert run.history(point).displacement[-1, 0] == pytest.approx(moved, abs=1e-5)
    ledger = run.report.ledger
    assert abs(ledger.unaccounted) < 1e-6 * max(ledger.loads, 1.0)
    if acts == "base":
        # the base is moved by work that its motion shows again
        speed = record.velocity(0.2)[0]
        assert ledger.loads == pytest.approx(0.5 * 6.0 * 2500.0 * speed**2, rel=0.02)


def test_the_velocity_under_a_body_force_is_exact_for_any_step():
    text = CASE.replace("ACTS", "body-force").replace("PROCESS", "modified")
    text = text.replace("[[fixed_point]]\nat = [-2, -1]\n[[fixed_point]]\nat = [3, -1]\n", "")
    run = Case.from_toml(text, ["time.step=0.013", "time.max_displacement=1"]).run()
    velocity = run.history("block").velocity[-1, 0]
    assert velocity == pytest.approx(-0.15, rel=1e-9)


@pytest.mark.parametrize(
    ("content", "axes"),
    [
        ("t,ax\n0,0\n0.1,1\n0.2,0\n", [[0, 0], [2, 0], [0, 0]]),
        ("# made up\n0 0 1\n0.1; 1; 2\n\n0.2\t0\t3\n", [[0, 2], [2, 4], [0, 6]]),
    ],
)
def test_a_record_from_a_file(tmp_path, content, axes):
    (tmp_path / "record.csv").write_text(content, encoding="utf-8")
    text = CASE[: CASE.index("[ground_motion]")].replace("PROCESS", "convex")
    text += '[ground_motion]\nacts = "base"\nfile = "record.csv"\nscale = 2.0\n'
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    record = Case.from_toml(tmp_path / "case.toml").model().ground_motion.accelerogram
    assert record.time.tolist() == [0.0, 0.1, 0.2]
    assert record.acceleration.tolist() == axes


@pytest.mark.parametrize("line", ["0.1,x", "0.1,1,2,3", "0.1,1,2"])
def test_a_bad_line_is_named(tmp_path, line):
    (tmp_path / "record.csv").write_text(f"t,a\n0,0\n{line}\n", encoding="utf-8")
    (tmp_path / "case.toml").write_text(
        CASE[: CASE.index("[ground_motion]")].replace("PROCESS", "convex")
        + '[ground_motion]\nacts = "base"\nfile = "record.csv"\n',
        encoding="utf-8",
    )
    with pytest.raises(CaseError, match="line 3"):
        Case.from_toml(tmp_path / "case.toml").model()


def test_a_fixed_block_that_stays_behind_is_warned_of():
    loaded = Case.from_toml(
        CASE.replace("ACTS", "base").replace("PROCESS", "convex")
        + '\n[[block]]\nname = "wall"\nvertices = [[4, -1], [5, -1], [5, 1]]\nfixed = true\n'
    )
    model = loaded.model()
    sanity = examine(model, loaded.method(model), loaded.schedule())
    assert any("stay where they are while the base moves" in text for text in sanity.warnings)


def test_displacement_under_a_body_force_is_of_second_order():
    errors = []
    for step in ("0.02", "0.01"):
        text = CASE.replace("ACTS", "body-force").replace("PROCESS", "modified")
        text = text.replace("[[fixed_point]]\nat = [-2, -1]\n[[fixed_point]]\nat = [3, -1]\n", "")
        loaded = Case.from_toml(text, [f"time.step={step}", "time.max_displacement=1"])
        exact = -loaded.model().ground_motion.accelerogram.displacement(0.2)[0]
        errors.append(loaded.run().history("base").displacement[-1, 0] - exact)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
