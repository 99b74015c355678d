"""Runs in memory that are written afterwards, drawn on one's own axes, and read by column."""

import numpy as np
import pytest

import clast
from clast.errors import CaseError


@pytest.fixture(scope="module")
def case():
    builder = clast.ModelBuilder(title="Two stages")
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="ground", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="a", vertices=[(0, 0.01), (1, 0.01), (1, 1), (0, 1)])
    builder.measured_point("A", (0, 1), block="a")
    stages = [
        clast.Stage(name="fall", until="time", time=0.02, reset_displacement=True),
        clast.Stage(name="rest", until="time", time=0.02),
    ]
    return builder.case(end=0.1, step=1e-3, every=4e-3, stages=stages)


@pytest.fixture(scope="module")
def run(case):
    return case.run()


def test_a_saved_run_is_the_file_that_it_would_have_written(case, run, tmp_path):
    saved = clast.read_results(run.save(tmp_path / "saved.vtkhdf"))
    written = clast.read_results(case.run(output=tmp_path / "written.vtkhdf").output)
    assert (saved.times == written.times).all()
    assert saved.frame_stages == written.frame_stages
    for frame in range(len(saved.times)):
        for name in (*written.field_names, "vertices"):
            one, other = ([r.series(name, range(frame, frame + 1), 0, 2)] for r in (saved, written))
            assert np.array_equal(one, other, equal_nan=True), (frame, name)
        assert (saved.contact_rows(frame) == written.contact_rows(frame)).all()
    for name in ("energy", "steps"):
        assert (saved.table(name).rows == written.table(name).rows).all()
    assert (saved.history("A").rows == written.history("A").rows).all()
    assert saved.report.steps == written.report.steps


def test_a_run_with_a_file_is_copied(case, tmp_path):
    run = case.run(output=tmp_path / "first.vtkhdf")
    again = run.save(tmp_path / "second.vtkhdf")
    assert again.read_bytes() == (tmp_path / "first.vtkhdf").read_bytes()
    assert run.save(tmp_path / "first.vtkhdf").exists()


def test_what_cannot_be_written_is_refused(run, tmp_path):
    (tmp_path / "text.vtkhdf").write_text("mine")
    for name in ("text.vtkhdf", "none/run.vtkhdf", "."):
        with pytest.raises(CaseError):
            run.save(tmp_path / name)
    assert (tmp_path / "text.vtkhdf").read_text() == "mine"


def test_columns_and_attributes_are_one(run):
    history = run.history("A")
    assert history.displacement_x is history["displacement_x"]
    assert (history["displacement"][:, 0] == history.displacement_x).all()
    assert (history.displacement == history["displacement"]).all()
    with pytest.raises(CaseError, match=r"(?s)no column 'displacment_x'.*'displacement_x'"):
        history["displacment_x"]
    with pytest.raises(AttributeError, match="displacement_x"):
        _ = history.displacment_x
    assert "displacement" not in history and history.get("none") is None


def test_a_run_is_drawn_on_axes_of_ones_own(run, tmp_path):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 3))
    left, right = figure.subplots(1, 2)
    right.plot(run.history("A").time, run.history("A").displacement_y)
    picture = run.plot(ax=left, field="displacement_y", frame=2)
    assert picture.figure is figure
    assert left.collections and left.get_aspect() == 1.0
    low, high = left.get_xlim()
    assert low <= -1.0 and high >= 2.0
    assert len(figure.axes) == 3  # the scale
    assert picture.save(tmp_path / "own.png").stat().st_size > 1000
    with pytest.raises(CaseError, match="not axes of matplotlib"):
        run.plot(ax=figure)
