"""The result file: written, opened by VTK, read back."""

from __future__ import annotations

import json
import os
from pathlib import Path
from uuid import UUID

import h5py
import numpy as np
import pytest

from clast.contact.laws import AugmentedLagrangian
from clast.errors import CaseError
from clast.results import RunRecorder, read_results, summary
from clast.results.result_writer import _Column
from clast.results.run_report import texts
from clast.results.schema import BLOCK_FIELDS, ENERGY
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.modified import Modified
from scenes.recorded_run import Recorded, moved, record, report, step_result, three_blocks
from scenes.systems import incline, method


def vtk_frames(path: Path) -> list[tuple[float, object]]:
    """Every time step that VTK's reader gives, copied."""
    vtk = pytest.importorskip("vtk")
    reader = vtk.vtkHDFReader()
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    key = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    frames = []
    for time in times:
        reader.UpdateTimeStep(time)
        grid = vtk.vtkUnstructuredGrid()
        grid.DeepCopy(reader.GetOutput())
        frames.append((time, grid))
    return frames


def array(attributes: object, name: str) -> np.ndarray:
    from vtk.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(attributes.GetArray(name))  # type: ignore[attr-defined]


def test_vtk_reads_every_frame(recorded: Recorded):
    model, run = recorded.run.model, recorded.run
    frames = vtk_frames(run.output)
    assert [time for time, _ in frames] == [state.time for state in recorded.frames]
    for (_, grid), state in zip(frames, recorded.frames, strict=True):
        from vtk.util.numpy_support import vtk_to_numpy

        points = vtk_to_numpy(grid.GetPoints().GetData())
        np.testing.assert_array_equal(points[:, :2], state.vertices + model.origin)
        np.testing.assert_array_equal(points[:, 2], 0.0)
        cells, nodes = grid.GetCellData(), grid.GetPointData()
        np.testing.assert_array_equal(
            array(nodes, "displacement")[:, :2], state.vertices - model.vertices
        )
        np.testing.assert_array_equal(array(cells, "velocity")[:, :2], state.velocity[:, :2])
        np.testing.assert_array_equal(array(cells, "stress"), state.stress)
        np.testing.assert_array_equal(array(cells, "rotation"), state.rotation)
        np.testing.assert_array_equal(array(cells, "block"), [0, 1, 2])
        np.testing.assert_array_equal(array(cells, "rock"), [0, 0, 1])
        np.testing.assert_array_equal(array(cells, "fixed"), [1, 0, 0])


def test_vtk_sees_the_polygons(recorded: Recorded):
    grid = vtk_frames(recorded.run.output)[-1][1]
    assert grid.GetNumberOfCells() == 3
    start = recorded.run.model.block_start
    for cell in range(3):
        assert grid.GetCellType(cell) == 7
        ids = grid.GetCell(cell).GetPointIds()
        assert [ids.GetId(k) for k in range(ids.GetNumberOfIds())] == list(
            range(start[cell], start[cell + 1])
        )


@pytest.mark.slow
def test_vtk_reads_many_frames_of_many_chunks(tmp_path: Path):
    recorded = record(three_blocks(), tmp_path / "out.vtkhdf", steps=1500)
    frames = vtk_frames(recorded.run.output)
    assert len(frames) == 301
    for index in (0, 100, 200, 300):
        np.testing.assert_array_equal(
            array(frames[index][1].GetCellData(), "stress"), recorded.frames[index].stress
        )


def test_results_read_back(recorded: Recorded):
    results = read_results(recorded.run.output)
    model = recorded.run.model
    np.testing.assert_array_equal(results.times, [state.time for state in recorded.frames])
    for frame, state in enumerate(recorded.frames):
        np.testing.assert_array_equal(results.vertices(frame), state.vertices)
        np.testing.assert_array_equal(results.field("stress", frame), state.stress)
        np.testing.assert_array_equal(results.field("velocity", frame), state.velocity[:, :2])
        np.testing.assert_allclose(
            results.field("displacement", frame), state.time * state.velocity[:, :2], atol=1e-14
        )
        sigma_1, sigma_3 = results.field("sigma_1", frame), results.field("sigma_3", frame)
        np.testing.assert_allclose(sigma_1 + sigma_3, state.stress[:, 0] + state.stress[:, 1])
        np.testing.assert_allclose(2 * results.field("max_shear", frame), sigma_1 - sigma_3)
    assert results.block_name == ("base", "wedge", "corner")
    assert results.rock_name == ("granite", "marl")
    assert results.title == "three blocks"
    assert results.case_text == "schema = 1\n# Tück\n"
    assert results.report == recorded.run.report
    np.testing.assert_array_equal(results.block_start, model.block_start)
    np.testing.assert_array_equal(results.fixed, [True, False, False])
    assert set(results.field_names) >= {one.name for one in BLOCK_FIELDS}


def test_tables_read_back(recorded: Recorded):
    results = read_results(recorded.run.output)
    for name in ("tip", "left/right"):
        ours, theirs = recorded.run.history(name), results.history(name)
        for column in ("time", "displacement", "velocity", "rotation"):
            np.testing.assert_array_equal(getattr(ours, column), getattr(theirs, column))
    for entry, values in recorded.run.energy.items():
        np.testing.assert_array_equal(results.energy[entry], values)
    np.testing.assert_array_equal(results.steps["step"], recorded.run.step_sizes)
    np.testing.assert_array_equal(results.steps["passes"], 2)


def test_contacts_read_back(recorded: Recorded):
    results = read_results(recorded.run.output)
    assert len(results.contacts(0)) == 0
    contacts = results.contacts(2)
    # The contact without a force is left out.
    np.testing.assert_array_equal(contacts.vertex, [5, 7])
    np.testing.assert_array_equal(contacts.position, recorded.frames[2].vertices[[5, 7]])
    np.testing.assert_allclose(contacts.normal_force, [1e3, 2e3])
    # The base's top edge runs to the left: so does a positive shear force.
    np.testing.assert_allclose(contacts.force, [[-1e2, 1e3], [-2e2, 2e3]])


def test_contacts_can_be_left_out(tmp_path: Path):
    model = three_blocks()
    recorder = RunRecorder(model, output=tmp_path / "out.vtkhdf", contacts=False)
    recorder.start(moved(model, 0.0))
    result = step_result(model, 0.1)
    recorder.step(result, 0.1)
    recorder.frame(result.state, result.contacts, result.response)
    run = recorder.finish(report(result.state))
    assert len(read_results(run.output).contacts(-1)) == 0


def test_coordinates_of_the_file_are_the_users(tmp_path: Path):
    recorded = record(three_blocks(shift=1e6), tmp_path / "out.vtkhdf")
    vertices = read_results(recorded.run.output).vertices(0)
    np.testing.assert_allclose(vertices[0], [1e6, 1e6], rtol=0, atol=1e-9)


def test_finish_writes_the_last_state_as_a_frame(tmp_path: Path):
    recorded = record(three_blocks(), tmp_path / "out.vtkhdf", steps=23)
    results = read_results(recorded.run.output)
    assert results.times[-1] == pytest.approx(0.23)
    np.testing.assert_array_equal(results.vertices(-1), recorded.states[-1].vertices)


def test_same_run_gives_the_same_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    # all but the identity, by which its checkpoints know it
    monkeypatch.setattr("clast.results.checkpoints.checkpoint.uuid4", lambda: UUID(int=1))
    for name in ("a", "b"):
        record(three_blocks(), tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_large_frames_and_small_ones_take_little_more_than_their_numbers(tmp_path: Path):
    recorded = record(three_blocks(), tmp_path / "out.vtkhdf", steps=1000)
    # 13 vertices and 3 blocks, two contacts, and 5 steps of histories and energies per frame.
    numbers = 8 * (13 * 6 + 3 * 14 + 2 * 13 + 5 * (2 * 6 + len(ENERGY.row) + 6) + 10)
    assert recorded.run.output.stat().st_size / len(recorded.frames) < 1.6 * numbers


def test_summary_says_how_the_run_was_made(tmp_path: Path):
    law = AugmentedLagrangian(normal_stiffness=2e8)
    how = method(contact_law=law, process=Modified(passes=2))
    model = incline(20.0)
    recorder = RunRecorder(model, output=tmp_path / "a.vtkhdf")
    simulate(model, how, Schedule(step=1e-3, end=2e-3, every=1e-3), recorder=recorder)
    results = read_results(tmp_path / "a.vtkhdf")
    rows = summary(results)
    assert json.loads(json.dumps(rows)) == rows
    assert (rows["process"], rows["contact_law"]) == ("modified", "augmented-lagrangian")
    assert (rows["normal_stiffness"], rows["step"], rows["end"]) == (2e8, 1e-3, 2e-3)
    assert rows["young"] == {"rock": 50e9}
    assert rows["version"] == rows["versions"]["clast"]
    assert rows["about"]["process"] == {"name": "modified", "passes": 2}
    said = texts(results.about)
    assert said["process"] == "modified (passes 2)"
    assert said["p"] == "2e+08 N/m per m"
    assert said["h"] == "0.001 s, to 0.002 s"
    assert said["rocks"].startswith("rock: E = 5e+10 Pa")
    assert texts({}) == {}


# --- what can go wrong ---------------------------------------------------------------------------


def test_an_earlier_result_stays_until_the_new_run_writes(recorded: Recorded):
    path, model = recorded.run.output, recorded.run.model
    before = path.read_bytes()
    recorder = RunRecorder(model, output=path)
    assert path.read_bytes() == before
    recorder.start(moved(model, 0.0))
    assert len(read_results(path).times) == 1
    assert os.listdir(path.parent) == [path.name]
    recorder.finish(report(moved(model, 0.0)))


def test_an_earlier_result_stays_where_the_first_frame_fails(recorded: Recorded, monkeypatch):
    path, model = recorded.run.output, recorded.run.model
    before = path.read_bytes()
    recorder = RunRecorder(model, output=path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("clast.results.result_writer._Column.put", full)
    with pytest.raises(CaseError, match="No space left"):
        recorder.start(moved(model, 0.0))
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


def test_a_frame_that_was_interrupted_is_written_by_finish(tmp_path: Path, monkeypatch):
    model = three_blocks()
    recorder = RunRecorder(model, output=tmp_path / "out.vtkhdf")
    recorder.start(moved(model, 0.0))
    result = step_result(model, 0.1)
    recorder.step(result, 0.1)
    put = _Column.put

    def interrupted(self: _Column, first: int, rows: np.ndarray) -> None:
        if next(left) == 0:
            raise KeyboardInterrupt
        put(self, first, rows)

    for calls in range(0, 15, 2):
        left = iter(range(calls, -1, -1))
        with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
            patch.setattr(_Column, "put", interrupted)
            recorder.frame(result.state, result.contacts, result.response)
    results = read_results(recorder.finish(report(result.state)).output)
    np.testing.assert_array_equal(results.times, [0.0, 0.1])
    np.testing.assert_array_equal(results.vertices(-1), result.state.vertices)
    assert len(results.history("tip").time) == 2
    assert len(results.contacts(-1)) == 2


@pytest.mark.parametrize("place", ["", "missing/out.vtkhdf", "file/out.vtkhdf"])
def test_output_that_cannot_be(tmp_path: Path, place: str):
    (tmp_path / "file").write_text("")
    with pytest.raises(CaseError) as caught:
        RunRecorder(three_blocks(), output=tmp_path / place)
    assert caught.value.remedy and caught.value.where == str(tmp_path / place)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("none", "no such file"),
        ("", "is a directory"),
        ("text", "not a clast"),
        ("h5", "not a clast"),
    ],
)
def test_other_things_are_no_result_files(tmp_path: Path, name: str, words: str):
    (tmp_path / "text").write_text("schema = 1\n" * 100)
    with h5py.File(tmp_path / "h5", "w") as file:
        file["data"] = 1.0
    with pytest.raises(CaseError, match=words):
        read_results(tmp_path / name)


@pytest.mark.parametrize(("layout", "words"), [(99, "newer version"), (1, "older version")])
def test_file_of_another_layout(recorded: Recorded, layout: int, words: str):
    with h5py.File(recorded.run.output, "r+") as file:
        file["model"].attrs["format"] = layout
    with pytest.raises(CaseError, match=words):
        read_results(recorded.run.output)


def test_frame_that_does_not_exist(recorded: Recorded):
    results = read_results(recorded.run.output)
    for frame in (5, -6):
        with pytest.raises(CaseError, match="0 to 4"):
            results.vertices(frame)


def test_unknown_field_is_answered_with_the_nearest(recorded: Recorded):
    with pytest.raises(CaseError, match="did you mean 'stress'"):
        read_results(recorded.run.output).field("stres")
