"""When runs write checkpoints, and what is said where they cannot or where one does not fit."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.contact.laws import Penalty
from clast.errors import CaseError, RunStopped
from clast.results import read_results
from clast.results.checkpoints import checkpoint_files
from clast.results.checkpoints.checkpoint_files import checkpoint_path, read_checkpoint
from clast.results.output import claimed, hidden, taken_up
from scenes.command_line import clast_command, good
from scenes.own_state import Closer, Forgetful
from scenes.restarts import differences, pressed_at, with_closer
from scenes.shaken import shaken, shaken_case

STOPPED_AT = 17


@pytest.fixture(scope="module")
def case() -> clast.Case:
    return shaken_case("modified", "penalty")


@pytest.fixture
def part(case: clast.Case, tmp_path: Path) -> Path:
    """The checkpoint of a run that was interrupted."""
    run = case.run(output=tmp_path / "part.vtkhdf", progress=pressed_at(STOPPED_AT))
    assert run.checkpoint is not None
    return run.checkpoint


@pytest.fixture(scope="module")
def whole(case: clast.Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result file of a run that was not."""
    path = tmp_path_factory.mktemp("whole") / "whole.vtkhdf"
    assert case.run(output=path).checkpoint is None
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    return path


def with_settings(case: clast.Case, *settings: str) -> clast.Case:
    return clast.Case.from_text(case.text, "case", settings)


# when there is one -----------------------------------------------------------------------------


def test_a_run_that_is_interrupted_leaves_one(part: Path):
    held = read_checkpoint(part, {})
    assert held.time == pytest.approx(STOPPED_AT * 2e-3)
    assert held.outcome.startswith("interrupted at t = ")
    assert not held.finished
    assert held.recorded.file == "part.vtkhdf"


def test_a_run_that_stops_leaves_one(case: clast.Case, tmp_path: Path):
    stops = with_settings(case, "time.max_displacement=1e-9", "time.smallest_step=1e-3")
    with pytest.raises(RunStopped) as stopped:
        stops.run(output=tmp_path / "a.vtkhdf")
    assert stopped.value.run.report.steps == 0
    assert stopped.value.run.checkpoint is None  # there is nothing to go on from
    falls = shaken()
    falls.add_amplitude("later", [0.0, 0.03, 0.031], [0.0, 0.0, 1.0])
    falls.point_load((-0.3, 1.25), (1e12, 0.0), block="2-1", amplitude="later")
    with pytest.raises(RunStopped) as stopped:
        falls.case(step=2e-3, end=0.1, smallest_step=1.9e-3).run(output=tmp_path / "b.vtkhdf")
    run: Any = stopped.value.run
    assert run.report.steps > 5
    held = read_checkpoint(run.checkpoint, {})
    assert held.run.tally.steps == run.report.steps
    before = read_results(run.output).times
    with pytest.raises(RunStopped, match="stopped at"):
        clast.resume(run.checkpoint)
    np.testing.assert_array_equal(read_results(run.output).times, before)


def test_one_that_is_asked_for_is_renewed_while_the_run_goes(case: clast.Case, tmp_path: Path):
    path, seen = checkpoint_path(tmp_path / "a.vtkhdf"), []

    def watch(at: Any) -> None:
        if path.exists():
            seen.append(at.steps - read_checkpoint(path, {}).run.tally.steps)

    often = with_settings(case, "output.checkpoint_every=1e-9")
    run = often.run(output=tmp_path / "a.vtkhdf", progress=watch)
    assert set(seen) == {1}
    assert len(seen) == run.report.steps - 1
    assert run.checkpoint == path
    assert read_checkpoint(path, {}).finished


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="needs POSIX signals")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_signals_to_the_command_line(case: clast.Case, whole: Path, tmp_path: Path, name: str):
    number = getattr(signal, name)
    (tmp_path / "a.toml").write_text(case.to_toml(), "utf-8")
    text = f"""
import os, sys
import clast.run.launch
from clast.cli.commands import main
from contextlib import contextmanager

def watch(at):
    if at.steps == {STOPPED_AT}:
        os.kill(os.getpid(), {int(number)})

@contextmanager
def shown(progress):
    yield watch

clast.run.launch.shown = shown
sys.argv = ["clast", "run", "a.toml", "-o", "a.vtkhdf"]
main()
"""
    done = subprocess.run(
        [sys.executable, "-c", text], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 128 + number, done.stderr
    path = checkpoint_path(tmp_path / "a.vtkhdf")
    assert f"clast resume {path} continues it" in done.stderr.replace("\n", " ")
    assert "the run reached its end" in good("resume", path)
    assert differences(whole, tmp_path / "a.vtkhdf") == []


# a full disk, a folder that cannot be written -----------------------------------------------------

LIMITED = """
import resource, sys
import clast

resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    clast.load("a.toml").run(output=sys.argv[1])
except clast.RunStopped as stopped:
    print(stopped.run.report.steps, stopped.run.checkpoint)
    print(stopped, file=sys.stderr)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs limits of POSIX")
def test_a_run_goes_on_when_there_is_room_again(case: clast.Case, tmp_path: Path):
    every = with_settings(case, "output.every=0.002")
    whole = tmp_path / "whole.vtkhdf"
    every.run(output=whole)
    (tmp_path / "a.toml").write_text(every.to_toml(), "utf-8")
    limit = whole.stat().st_size  # a frame takes more for a moment
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, "a.vtkhdf", str(limit)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "the results cannot be written: File too large" in done.stderr
    steps, checkpoint = done.stdout.split()
    assert int(steps) > 3
    clast.resume(checkpoint)
    assert differences(whole, tmp_path / "a.vtkhdf") == []


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS])
def test_a_run_goes_on_without_checkpoints(
    case: clast.Case, whole: Path, tmp_path: Path, monkeypatch, number: int
):
    usual, told = checkpoint_files._as_bytes, []
    path = checkpoint_path(tmp_path / "a.vtkhdf")

    def full_later(checkpoint: Any) -> bytes:
        if checkpoint.run.tally.steps > 5:
            raise OSError(number, os.strerror(number))
        return usual(checkpoint)

    monkeypatch.setattr(checkpoint_files, "_as_bytes", full_later)
    often = with_settings(case, "output.checkpoint_every=1e-9")
    run = often.run(output=tmp_path / "a.vtkhdf", warn=told.append)
    assert run.report.finished
    words = f"no checkpoint could be written to {path}: {os.strerror(number)}; that of t = 0.01 s"
    assert [text for text in told if "checkpoint" in text] == [f"{words} stays"]
    assert f"{words} stays" in run.report.warnings
    assert read_checkpoint(path, {}).run.tally.steps == 5
    monkeypatch.undo()
    again = clast.resume(path, ["output.checkpoint_every=1e6"])
    assert again.report.finished
    named = [name for name in differences(whole, run.output) if name != "model/case"]
    assert named == []


def test_what_stands_in_the_place_of_a_checkpoint_stays(case: clast.Case, tmp_path: Path):
    output = tmp_path / "a.vtkhdf"
    path = checkpoint_path(output)
    path.write_text("mine")
    with pytest.raises(CaseError, match="is not a clast checkpoint"):
        with_settings(case, "output.checkpoint_every=1").run(output=output)
    assert not output.exists()
    run = case.run(output=output, progress=pressed_at(3))
    assert run.checkpoint is None
    assert any("it is not overwritten" in text for text in run.report.warnings)
    assert path.read_text() == "mine"


def test_an_action_that_cannot_be_kept_is_named(tmp_path: Path):
    builder = shaken()
    builder.actions.append(Forgetful())
    run = clast.simulate(
        builder, step=2e-3, end=0.1, output=tmp_path / "a.vtkhdf", progress=pressed_at(3)
    )
    assert run.report.steps == 3
    assert run.checkpoint is None
    (text,) = (text for text in run.report.warnings if "checkpoint" in text)
    assert "run.state.actions" in text
    assert "a checkpoint cannot hold a list_iterator" in text
    assert "frozen dataclass" in text
    assert not checkpoint_path(tmp_path / "a.vtkhdf").exists()


# what does not fit -----------------------------------------------------------------------------


def refused(words: str, *arguments: object) -> None:
    """Check that a command refuses in one message."""
    result = clast_command("resume", *arguments)
    assert result.exit_code == 2, result.output
    assert words in " ".join(result.stderr.split()), result.stderr
    assert "Traceback" not in result.stderr


def test_settings_that_would_have_changed_what_was_done(part: Path):
    before = part.with_name("part.vtkhdf").read_bytes()
    refused(
        "'joint.default.friction_angle' would change the run before its checkpoint",
        part,
        "--set",
        "joint.default.friction_angle=20",
    )
    refused("0.01 s is over: the checkpoint is of t = 0.034 s", part, "--set", "time.end=0.01")
    refused("sets no value", part, "--set", "time.end")
    assert part.with_name("part.vtkhdf").read_bytes() == before


def test_a_result_file_that_is_missing(part: Path, whole: Path):
    output = part.with_name("part.vtkhdf")
    output.unlink()
    refused("the result file of the checkpoint is missing clast resume CHECKPOINT -o FILE", part)
    rest = part.with_name("rest.vtkhdf")
    result = clast_command("resume", part, "-o", rest)
    assert result.exit_code == 0, result.stderr
    assert "rest.vtkhdf begins where the checkpoint was written" in result.stderr.replace("\n", "")
    last, found = read_results(whole), read_results(rest)
    assert found.times[0] == pytest.approx(STOPPED_AT * 2e-3)
    np.testing.assert_array_equal(found.times[1:], last.times[-len(found.times) + 1 :])
    np.testing.assert_array_equal(found.vertices(-1), last.vertices(-1))
    assert not output.exists()


def broken(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def of_another_run(path: Path) -> None:
    with_settings(shaken_case("modified", "penalty"), "gravity=[0.0, -5.0]").run(output=path)


def of_other_blocks(path: Path) -> None:
    builder = shaken()
    builder.block(vertices=[(9, 9), (10, 9), (10, 10)])
    builder.case(step=2e-3, end=4e-3).run(output=path)


def shorter(path: Path) -> None:
    with_settings(shaken_case("modified", "penalty"), "time.end=0.01").run(output=path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (broken, "is damaged"),
        (of_another_run, "its frames are those of another, later run"),
        (of_other_blocks, "it has other blocks"),
        (shorter, "frames, the checkpoint continues from"),
    ],
)
def test_a_result_file_that_does_not_fit_stays(
    part: Path, change: Callable[[Path], None], words: str
):
    output = part.with_name("part.vtkhdf")
    change(output)
    before = output.read_bytes()
    refused(words, part)
    refused("-o FILE", part)
    assert output.read_bytes() == before


def test_another_file_goes_on_from_a_copy(part: Path, whole: Path):
    output = part.with_name("part.vtkhdf")
    before, kept = output.read_bytes(), part.read_bytes()
    run = clast.resume(part, output=part.with_name("copy.vtkhdf"))
    assert differences(whole, run.output) == []
    assert output.read_bytes() == before
    assert part.read_bytes() == kept


def test_a_file_in_use_is_refused(part: Path):
    output = part.with_name("part.vtkhdf")
    with taken_up(output):
        refused("another run is writing to it", part)
        with pytest.raises(CaseError, match="another run is writing to it"):
            claimed(output)
    assert not hidden(output).exists()
    assert clast.resume(part).report.finished


def test_a_run_that_is_over_may_be_resumed(case: clast.Case, whole: Path, tmp_path: Path):
    kept = with_settings(case, "output.checkpoint_every=1e6").run(output=tmp_path / "a.vtkhdf")
    before = tmp_path / "before.vtkhdf"
    before.write_bytes(kept.output.read_bytes())
    again = clast.resume(kept.checkpoint)
    assert again.report.steps == kept.report.steps
    assert differences(before, again.output) == []


# what a script gives ---------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class MyLaw(Penalty):
    """A law of a script."""


def test_a_script_gives_its_model_again(tmp_path: Path):
    output = tmp_path / "a.vtkhdf"
    keys: dict[str, Any] = {"step": 2e-3, "end": 0.06, "process": "modified"}
    law = {"name": "penalty", "normal_stiffness": 2e7}
    run = clast.simulate(
        with_closer(), output=output, contact_law=law, progress=pressed_at(7), **keys
    )
    refused("objects of a script must be given again", run.checkpoint)
    refused("model=...)", run.checkpoint)
    bare = clast.simulate(
        shaken(), output=tmp_path / "c.vtkhdf", contact_law=law, progress=pressed_at(3), **keys
    )
    refused("the objects that a file cannot hold must be given again", bare.checkpoint)
    refused("clast.resume('c.checkpoint.h5', model=...)", bare.checkpoint)
    other = shaken()
    other.actions.append(Closer("falls", 1e3))
    with pytest.raises(CaseError, match=r"changed parts: model\.actions$"):
        try:
            clast.resume(run.checkpoint, model=other.build())
        except CaseError as error:
            raise CaseError(error.what) from None
    rest = clast.resume(run.checkpoint, model=with_closer())
    assert rest.report.finished
    whole = clast.simulate(with_closer(), output=tmp_path / "b.vtkhdf", contact_law=law, **keys)
    assert differences(whole.output, rest.output) == []


def test_a_script_gives_its_own_law_again(case: clast.Case, tmp_path: Path):
    law = MyLaw(normal_stiffness=2e7)
    own = case.with_method(contact_law=law)
    part = own.run(output=tmp_path / "a.vtkhdf", progress=pressed_at(7))
    whole = own.run(output=tmp_path / "b.vtkhdf")
    refused("model=..., method=...)", part.checkpoint)
    rest = clast.resume(part.checkpoint, model=own.model(), method=own.method())
    assert differences(whole.output, rest.output) == []
    with pytest.raises(CaseError, match=r"method\.contact_law"):
        clast.resume(part.checkpoint, model=own.model(), method=case.method())


# files that a case names -----------------------------------------------------------------------


def test_a_record_must_be_what_it_was(case: clast.Case, tmp_path: Path):
    folder = tmp_path / "there"
    folder.mkdir()
    times = np.linspace(0.0, 0.2, 21)
    record = "t,ax\n" + "\n".join(f"{t:.2f},{np.sin(40 * t):.6f}" for t in times)
    (folder / "quake.csv").write_text(record)
    text = shaken_text() + '\n[ground_motion]\nacts = "body-force"\nfile = "quake.csv"\n'
    (folder / "a.toml").write_text(text, "utf-8")
    shaking = clast.load(folder / "a.toml")
    part = shaking.run(output=tmp_path / "a.vtkhdf", progress=pressed_at(7))
    whole = shaking.run(output=tmp_path / "b.vtkhdf")
    (folder / "quake.csv").write_text(record.replace("0.0", "0.1"))
    refused("the case names quake.csv, which is missing or has changed", part.checkpoint)
    (tmp_path / "quake.csv").write_text(record)
    rest = clast.resume(part.checkpoint)
    assert [name for name in differences(whole.output, rest.output)] == []


def shaken_text() -> str:
    """Return the shaken bricks as a case without their ground motion."""
    from clast.model.ground_motion import Still

    builder = shaken()
    builder.ground_motion = Still()
    law = {"name": "penalty", "normal_stiffness": 2e7}
    return builder.to_toml(step=2e-3, end=0.04, process="modified", contact_law=law)
