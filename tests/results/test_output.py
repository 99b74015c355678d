"""Where results go: nothing of somebody else is written over, and one run has a file for itself."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from clast.case.templates import INCLINE
from clast.errors import CaseError
from clast.results import RunRecorder, read_results
from clast.results.output import claimed, fresh, hidden
from scenes.recorded_run import moved, record, report, step_result, three_blocks

posix = pytest.mark.skipif(os.name != "posix", reason="needs what POSIX systems have")


def refused(path: Path | str) -> str:
    with pytest.raises(CaseError) as caught:
        RunRecorder(three_blocks(), output=path)
    assert caught.value.remedy
    assert caught.value.where == str(path)
    return str(caught.value)


@posix
@pytest.mark.parametrize("make", [os.mkfifo, lambda path: os.mknod(path, 0o140600)])
def test_a_pipe_or_a_socket_is_not_written_over(tmp_path, make):
    path = tmp_path / "out.vtkhdf"
    try:
        make(path)
    except OSError:
        pytest.skip("it cannot be made here")
    before = path.lstat()
    assert "is not overwritten" in refused(path)
    assert os.path.samestat(before, path.lstat())
    with pytest.raises(CaseError, match="no result file"):
        read_results(path)
    assert os.listdir(tmp_path) == [path.name]


@posix
@pytest.mark.parametrize("device", ["/dev/null", "/dev/zero"])
def test_a_device_is_not_written_over(device):
    assert "is not overwritten" in refused(device)


@pytest.mark.parametrize("other", ["another group", "groups of the same names", "text", "cut"])
def test_a_file_of_another_program_is_not_written_over(tmp_path, other):
    path = tmp_path / "out.vtkhdf"
    if other == "text":
        path.write_text("results of years")
    elif other == "cut":
        whole = record(three_blocks(), path).run.output.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
    else:
        with h5py.File(path, "w") as file:
            file["data"] = 1.0
            if other == "groups of the same names":
                file.create_group("VTKHDF").attrs["Type"] = "ImageData"
                file.create_group("model")
    before = path.read_bytes()
    assert "is not overwritten" in refused(path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == [path.name]


def test_an_empty_file_is_nobodys(tmp_path):
    path = tmp_path / "out.vtkhdf"
    path.touch()
    record(three_blocks(), path)
    assert len(read_results(path).times) == 5


@posix
def test_a_link_is_followed(tmp_path):
    (tmp_path / "store").mkdir()
    link, target = tmp_path / "out.vtkhdf", tmp_path / "store" / "real.vtkhdf"
    link.symlink_to(target)
    for _ in range(2):  # first to nothing, then to an older result
        run = record(three_blocks(), link).run
        assert link.is_symlink()
        assert run.output == target
        assert len(read_results(target).times) == 5
    assert os.listdir(tmp_path / "store") == [target.name]


@posix
def test_links_that_lead_nowhere_or_to_a_device(tmp_path):
    (tmp_path / "round").symlink_to(tmp_path / "round")
    (tmp_path / "null").symlink_to("/dev/null")
    refused(tmp_path / "round")
    assert "is not overwritten" in refused(tmp_path / "null")


@pytest.mark.parametrize("name", ["o" * 300, "o" * 252, "o\0o"])
def test_names_that_no_file_can_have(tmp_path, name):
    assert "cannot be written to" in refused(tmp_path / name)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("older", [False, True])
@pytest.mark.parametrize("begun", [False, True])
def test_a_second_run_to_the_same_file_is_refused(tmp_path, older, begun):
    path, model = tmp_path / "out.vtkhdf", three_blocks()
    if older:
        record(model, path)
    first = RunRecorder(model, output=path)
    if begun:
        first.start(moved(model, 0.0))
        read_results(path)  # reading and closing it does not end the lock
    assert "another run is writing to it" in refused(path)
    if not begun:
        first.start(moved(model, 0.0))
    result = step_result(model, 0.1)
    first.step(result, 0.1)
    first.finish(report(result.state))
    assert len(read_results(path).times) == 2
    record(model, path)
    assert len(read_results(path).times) == 5
    assert os.listdir(tmp_path) == [path.name]


def test_a_run_that_never_began_leaves_nothing(tmp_path):
    recorder = RunRecorder(three_blocks(), output=tmp_path / "out.vtkhdf")
    del recorder
    assert os.listdir(tmp_path) == []
    record(three_blocks(), tmp_path / "out.vtkhdf")


KILLED = """
import os, sys
sys.path.insert(0, sys.argv[2])
from scenes.recorded_run import moved, three_blocks
from clast.results import RunRecorder
recorder = RunRecorder(three_blocks(), output=sys.argv[1])
if sys.argv[3] == "begun":
    recorder.start(moved(three_blocks(), 0.0))
os.kill(os.getpid(), 9)
"""


@pytest.mark.slow
@posix
@pytest.mark.parametrize("when", ["begun", "before"])
def test_a_run_that_was_killed_locks_nothing_and_is_cleared_away(tmp_path, when):
    path, here = tmp_path / "out.vtkhdf", str(Path(__file__).parents[1])
    done = subprocess.run([sys.executable, "-c", KILLED, str(path), here, when], check=False)
    assert done.returncode == -signal.SIGKILL
    assert len(os.listdir(tmp_path)) == 1
    record(three_blocks(), path)
    assert os.listdir(tmp_path) == [path.name]


@pytest.mark.slow
@posix
def test_a_process_that_is_forked_during_a_run_leaves_its_file_alone(tmp_path):
    path, model = tmp_path / "out.vtkhdf", three_blocks()
    recorder = RunRecorder(model, output=path)
    recorder.start(moved(model, 0.0))
    result = step_result(model, 0.1)
    recorder.step(result, 0.1)
    waiting, telling = os.pipe()
    child = os.fork()
    if child == 0:
        os.read(waiting, 1)
        recorder._file._storage.close()  # as its end may do
        os._exit(0)
    recorder.frame(result.state, result.contacts, result.response)
    os.write(telling, b".")
    assert os.waitpid(child, 0)[1] == 0
    assert len(read_results(path).times) == 2
    recorder.finish(report(result.state))
    assert len(read_results(path).times) == 2


# --- names of measured points --------------------------------------------------------------------


NAMES = ["a", "a/b", "a∕b", "a%2Fb", "..", ".", "...", "/", "//", "%", "%2E", " ", "model"]


def test_points_of_any_name_are_read_back(tmp_path):
    model = three_blocks()
    count = len(NAMES)
    at = np.tile(model.measured_points.at[0], (count, 1)) + 1e-3 * np.arange(count)[:, None]
    block = np.full(count, model.measured_points.block[0])
    points = dataclasses.replace(model.measured_points, name=tuple(NAMES), block=block, at=at)
    model = dataclasses.replace(model, measured_points=points)
    run = record(model, tmp_path / "out.vtkhdf").run
    results = read_results(run.output)
    assert results.point_name == tuple(NAMES)
    for name in NAMES:
        ours, theirs = run.history(name), results.history(name)
        np.testing.assert_array_equal(ours.displacement, theirs.displacement)


@pytest.mark.parametrize("title", ["a\0b", "\ud800"])
def test_texts_that_no_file_can_hold(tmp_path, title):
    model = dataclasses.replace(three_blocks(), title=title)
    with pytest.raises(CaseError, match="cannot store"):
        RunRecorder(model, output=tmp_path / "out.vtkhdf")
    assert os.listdir(tmp_path) == []


# --- full disks ----------------------------------------------------------------------------------

LIMITED = """
import resource, sys
from clast.case.case_file import Case
from clast.case.templates import INCLINE
Case.from_toml(INCLINE, ["time.end=0.002"]).run()  # what is compiled is kept on disk
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
sys.argv[:] = ["clast", *sys.argv[2:]]
from clast.cli.commands import main
main()
"""


@pytest.mark.slow
@posix
@pytest.mark.parametrize(("room", "code"), [(20_000, 2), (700_000, 3)])
@pytest.mark.one_in(2)
def test_a_full_disk_is_said_in_two_lines(tmp_path, room, code):
    case, path = tmp_path / "a.toml", tmp_path / "out.vtkhdf"
    case.write_text(INCLINE, encoding="utf-8")
    settings = ["--set", "output.every=0.001", "--set", "time.end=10"]
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(room), "run", str(case), "-o", str(path), *settings],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == code, done.stderr
    assert "the results cannot be written" in done.stderr
    assert len(done.stderr) < 600
    assert "HDF5" not in done.stderr
    if code == 2:
        assert os.listdir(tmp_path) == [case.name]
    else:
        assert "the results until then are in" in done.stderr
        assert "stopped" in done.stdout
        results = read_results(path)
        assert results.times[-1] == pytest.approx(0.001 * (len(results.times) - 1))
        assert path.stat().st_size <= room


def in_the_way(part: Path, victim: Path, how: str) -> None:
    """Put something else in the place of a hidden file."""
    if how == "link":
        part.symlink_to(victim)
    elif how == "second name":
        part.hardlink_to(victim)
    elif how == "pipe":
        os.mkfifo(part)
    else:
        part.mkdir()


@pytest.mark.parametrize("how", ["link", "second name", "pipe", "folder"])
def test_what_is_in_the_place_of_a_hidden_file_stays(tmp_path: Path, how: str):
    output, victim = tmp_path / "k.vtkhdf", tmp_path / "victim.txt"
    victim.write_text("precious")
    part = hidden(output)
    in_the_way(part, victim, how)
    with pytest.raises(CaseError, match="has the name of the temporary result file, but does not"):
        claimed(output)
    assert victim.read_text() == "precious"
    assert part.is_symlink() == (how == "link")
    assert not output.exists()


@pytest.mark.parametrize("how", ["link", "second name", "pipe"])
def test_a_checkpoint_is_written_to_a_file_of_its_own(tmp_path: Path, how: str):
    victim = tmp_path / "victim.txt"
    victim.write_text("precious")
    part = hidden(tmp_path / "k.checkpoint.h5")
    in_the_way(part, victim, how)
    with fresh(part) as file:
        file.write(b"mine")
    assert victim.read_text() == "precious"
    assert part.read_bytes() == b"mine"
    assert not part.is_symlink()
