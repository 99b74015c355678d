"""A run that is killed leaves everything up to its last frame readable."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import clast
from clast import Stage
from clast.exports import write_csv
from clast.results import read_results
from clast.results.journal import read_journal
from scenes.places import TESTS
from scenes.recorded_run import moved, three_blocks

KILLED = 30


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Path, int]]:
    """Files of writers that were killed, and the frames that each had written for certain."""
    if not hasattr(os, "fork"):
        pytest.skip("writers are killed by POSIX signals")
    folder = tmp_path_factory.mktemp("killed")
    said = subprocess.run(
        [sys.executable, "-m", "scenes.killed_writers", str(folder), str(KILLED)],
        cwd=TESTS,
        capture_output=True,
        text=True,
        check=True,
    )
    return [(Path(path), int(frames)) for path, frames in map(str.split, said.stdout.splitlines())]


def test_everything_up_to_the_last_frame_is_there(killed: list[tuple[Path, int]]):
    model = three_blocks()
    for path, written in killed:
        results = read_results(path)
        frames = len(results.times)
        # One more may have been on its way.
        assert written <= frames <= written + 1
        assert results.report is None
        for frame in {*range(0, frames, 20), *range(max(0, frames - 3), frames)}:
            state = moved(model, 0.01 * frame)
            np.testing.assert_array_equal(results.vertices(frame), state.vertices)
            np.testing.assert_array_equal(results.field("stress", frame), state.stress)
            assert len(results.contacts(frame)) == (2 if frame else 0)
        assert len(results.history("tip").time) == frames
        assert len(results.energy["kinetic"]) == frames
        assert len(results.steps["step"]) == frames - 1
        np.testing.assert_allclose(results.energy["gravity"], -3.0 * results.energy["time"])


def test_vtk_opens_what_is_left(killed: list[tuple[Path, int]]):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    model = three_blocks()
    whole = [entry for entry in killed if not is_torn(entry[0])]
    assert len(whole) >= KILLED // 2
    for path, written in whole:
        reader = vtk.vtkHDFReader()
        assert reader.CanReadFile(str(path))
        reader.SetFileName(str(path))
        reader.UpdateInformation()
        assert written <= reader.GetNumberOfSteps() <= written + 1
        reader.SetStep(written - 1)
        reader.Update()
        points = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
        np.testing.assert_array_equal(points[:, :2], moved(model, 0.01 * (written - 1)).vertices)


def is_torn(path: Path) -> bool:
    """Whether the writer was killed while a frame took effect.

    A few in a thousand are, four of thirty on a machine that hardly came to write.
    Such a file has a whole journal at its end, which only clast looks at (decision 42).
    """
    with open(path, "rb") as file:
        return read_journal(file) is not None


DIES = """
import os, signal, sys
import clast

def watch(now):
    if now.stage == "dig" and now.time > now.start + 0.0045:
        os.kill(os.getpid(), signal.SIGKILL)

clast.load(sys.argv[1]).run(output=sys.argv[2], progress=watch)
"""


def test_a_killed_run_keeps_the_stages_of_its_frames(tmp_path: Path):
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    for y, name in enumerate(("floor", "low", "high")):
        corners = [(0, y), (1, y), (1, y + 1), (0, y + 1)]
        builder.block(vertices=corners, name=name, fixed=name == "floor")
    stages = [
        Stage(name="rest", until="time", time=0.004),
        Stage(name="dig", until="time", time=0.1, excavate=("high",)),
    ]
    case = tmp_path / "dug.toml"
    case.write_text(builder.to_toml(step=1e-3, end=1.0, every=1e-3, stages=stages), "utf-8")
    path = tmp_path / "dug.vtkhdf"
    done = subprocess.run([sys.executable, "-c", DIES, str(case), str(path)], check=False)
    assert done.returncode == -signal.SIGKILL
    results = read_results(path)
    assert results.report is None
    assert results.frame_stages[:6] == ("rest",) * 5 + ("dig",)
    assert len(results.times) == len(results.frame_stages) >= 8
    assert results.frame(stage="rest").time == pytest.approx(0.004)
    assert results.frame(stage="dig").field("gone").tolist() == [0.0, 0.0, 1.0]
    written = write_csv(results, tmp_path / "tables")
    assert not {"stages", "events"} & {one.stem for one in written}
    assert ",dig," in (tmp_path / "tables" / "blocks.csv").read_text("utf-8")
