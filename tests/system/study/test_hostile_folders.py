"""What stands in the place of files and folders of a study: its runs are made, or one message."""

from __future__ import annotations

import csv
import errno
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.errors import CaseError, ResultsLost
from clast.inputs.declaring import text as case_text
from clast.study import folder as folders
from clast.study.collapsing.search import FactorSettings
from clast.study.folder import StudyFolder, make_folder
from clast.study.study_api import HowMade, go_on

PHI = "joint.default.friction_angle"
HERE = HowMade(array=(1, 1))
ALONE = HowMade(workers=1)


def study(**changes) -> clast.Study:
    """Return three runs of a block that slides; it begins at 1 m/s."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=20.0)
    builder.block(name="floor", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    builder.block(name="block", vertices=corners, velocity=(1, 0, 0))
    builder.measured_point("A", (1, 1), block="block")
    given = {"vary": {PHI: [20.0, 30.0, 40.0]}, "measure": {"u": "displacement(A)"}}
    return clast.Study(
        builder.case(step=2e-3, end=0.004), **{**given, "fail": "u > 0.001", **changes}
    )


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raise TimeoutError where the block waits for something that never comes."""

    def over(*_):
        raise AssertionError("it waits for ever")

    before = signal.signal(signal.SIGALRM, over)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _socket(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # a name of at most some hundred characters
    try:
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(path.name)
    finally:
        os.chdir(here)


def _sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(2**40)


def _full(path: Path) -> None:
    path.mkdir()
    (path / "of somebody").write_text("else")


THINGS = {
    "pipe": os.mkfifo,
    "socket": _socket,
    "folder": _full,
    "dangling link": lambda path: path.symlink_to("nowhere"),
    "link to itself": lambda path: path.symlink_to(path.name),
    "link to a device": lambda path: path.symlink_to("/dev/zero"),
    "link to a pipe": lambda path: (os.mkfifo(path.with_name("p")), path.symlink_to("p")),
    "sparse file": _sparse,
    "nested": lambda path: path.write_text("[" * 200_000),
    "binary": lambda path: path.write_bytes(bytes(range(256))),
    "empty file": lambda path: path.write_text(""),
}
"""What may stand in the place of a file."""
OURS = ["runs/0000/00000001/result.json", "runs/0000/00000001", "runs/0000", "runs"]
"""Places of the results of a run."""
OTHERS = ["study.toml", "results.csv", "worst.txt", "figures", "base"]
"""Other places in the folder of a study."""


def put(place: Path, thing: str) -> None:
    """Put a thing in the place of a file or folder."""
    if place.is_dir() and not place.is_symlink():
        shutil.rmtree(place)
    else:
        place.unlink(missing_ok=True)
    THINGS[thing](place)


@pytest.mark.parametrize("thing", THINGS)
def test_a_run_without_a_result_is_made_again_or_there_is_one_message(tmp_path, thing):
    whole = dict(study().run(tmp_path / "s", how=HERE))
    for place, how in zip(OURS, (HERE, ALONE, HERE, ALONE), strict=True):
        put(tmp_path / "s" / place, thing)
        with within(20.0):
            try:
                found = go_on(StudyFolder.opened(tmp_path / "s"), how)
            except CaseError as error:
                assert place in str(error) and error.remedy and place in ("runs", "runs/0000")
                there = tmp_path / "s" / place
                there.rename(tmp_path / place.replace("/", "-"))
                found = go_on(StudyFolder.opened(tmp_path / "s"), how)
        assert dict(found) == whole


@pytest.mark.parametrize("thing", THINGS)
def test_other_files_of_a_study_are_made_again_or_there_is_one_message(tmp_path, thing):
    made = study(keep="worst 1")
    whole = dict(made.run(tmp_path / "s", how=ALONE))
    for place in OTHERS:
        shutil.copytree(tmp_path / "s", tmp_path / place)
        put(tmp_path / place / place, thing)
        with within(30.0):
            try:
                found = go_on(StudyFolder.opened(tmp_path / place), ALONE)
                make_folder(tmp_path / place / "figures")
            except CaseError as error:
                assert str(tmp_path / place) in str(error) and error.remedy
            else:
                assert dict(found) == whole


def good(folder: Path) -> tuple[Path, dict]:
    """Return the file of the first run, and the result in it."""
    path = folder / "runs/0000/00000001/result.json"
    return path, json.loads(path.read_text())


EDITS = {
    "status": [None, 3, "well", ["done"], "no result", {}],
    "reason": [None, 3, ["a"], {"a": 1}, "\ud800", "too steep"],
    "run": [None, 2, "1", [1], 1e300],
    "blocks": [7, None, [7], {"a": 1}, "block", ["floor"]],
    "joints": [7, [None], "default"],
    "fails": [None, 1, "true", False],
    "measures": [None, [], {}, {"u": "1"}, {"u": None}, {"u": 10**400}, {"u": 7.0}, {"u": [1.0]}],
    "parameters": [None, 3, {}, {PHI: 30.0}, {PHI: "20"}, {PHI: float("nan")}, {PHI: [20.0]}],
    "study": [None, "of another"],
    "checksum": ["", 3, None],
}


@pytest.mark.parametrize("key", EDITS)
@pytest.mark.parametrize("signed", [False, True], ids=["edited", "without a checksum"])
def test_an_edited_result_is_none(tmp_path, key, signed):
    """Its run is made again; one without a checksum where values are of a wrong kind, or wrong."""
    whole = dict(study().run(tmp_path / "s", how=HERE))
    path, result = good(tmp_path / "s")
    right = {"status": "no result", "reason": "too steep", "fails": False}
    for value in EDITS[key]:
        edited = {**result, key: value}
        if signed:
            edited.pop("checksum")
        is_lawful = (key, value) in [*right.items(), ("blocks", ["floor"])]
        if signed and (is_lawful or key == "checksum" or value == {"u": 7.0}):
            continue  # such a result there may be
        path.write_text(json.dumps(edited))
        assert StudyFolder.opened(tmp_path / "s").result(1) is None, value
        assert dict(go_on(StudyFolder.opened(tmp_path / "s"), HERE)) == whole


def test_an_unchanged_result_is_not_made_again(tmp_path):
    study().run(tmp_path / "s", how=HERE)
    path, result = good(tmp_path / "s")
    path.write_text(json.dumps(dict(reversed(result.items()))))
    before = path.stat().st_ino
    go_on(StudyFolder.opened(tmp_path / "s"), HERE)
    assert path.stat().st_ino == before


def test_a_damaged_trial_is_made_again(slab, tmp_path):
    whole = clast.factor_of_safety(slab.file, folder=tmp_path / "s", tolerance=0.2)
    path = tmp_path / "s/runs/0000/00000002/result.json"
    result = json.loads(path.read_text())
    result.pop("checksum")
    edits = [{"factor": "1"}, {"verdict": "well"}, {"blocks": [3]}, {"more": 1}, {"steps": 1.5}]
    texts = [{**result, "trial": {**result["trial"], **one}} for one in edits]
    texts += [{**result, "trial": one} for one in (None, 3, [])]
    damaged = [partial(put, path, "pipe"), partial(put, path, "folder")]
    damaged += [partial(path.write_text, json.dumps(one)) for one in texts]
    for damage in damaged:
        damage()
        with within(30.0):
            found = clast.factor_of_safety(slab.file, folder=tmp_path / "s", tolerance=0.2)
        assert found.trials == whole.trials


def test_a_description_of_random_kinds_is_read_or_refused(tmp_path):
    """Each value of study.toml in turn takes values of other kinds."""
    draw = np.random.default_rng(3)
    made = study(factor=FactorSettings(by="gravity"), measure={"F": "factor_of_safety()"}, fail="")
    kept = StudyFolder.made(tmp_path / "s", made.case, made.described())
    content = case_text.parse(kept.study.text, "study.toml")
    values: list = [3, -1, 2.5, float("nan"), True, "x", "", [], [1], ["a"], {}, {"a": 1}]
    values += [[{"a": 1}], 10**20]
    places = [(content, key) for key in content]
    places += [(content[table], key) for table in ("factor", "measure") for key in content[table]]
    places += [(content["vary"][0], key) for key in content["vary"][0]]
    for table, key in places:
        before = table[key]
        for k in draw.permutation(len(values)):
            table[key] = values[k]
            (tmp_path / "s/study.toml").write_text(case_text.to_toml(content))
            try:
                opened = StudyFolder.opened(tmp_path / "s")
                list(opened.results())
                folders.Path(opened.study.case)
            except CaseError as error:
                assert error.remedy or error.where, (key, values[k])
        table[key] = before


# Full disks --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("most", "how"),
    [(0, HERE), (1000, ALONE), (20_000, HERE), (20_000, HowMade(workers=2))],
    ids=["plan", "case", "result file", "of workers"],
)
def test_a_full_disk_ends_a_study_and_is_no_result(tmp_path, how, most):
    """Files of at most so many bytes: of its plan, of results, or of result files of runs."""
    code = f"""
import resource, signal, sys
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parent)!r})
from importlib import import_module
from clast.errors import CaseError
if __name__ == "__main__":
    made = import_module({Path(__file__).stem!r}).study(keep="all")
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, ({most}, resource.RLIM_INFINITY))
    try:
        made.run("s", array={how.array!r}, workers={how.workers!r})
    except CaseError as error:
        print(error)
        sys.exit(2)
"""
    (tmp_path / "script.py").write_text(code)
    ended = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2 and not ended.stderr, ended.stderr
    assert "File too large" in ended.stdout and "s/" in ended.stdout
    table = study(keep="all").run(tmp_path / "s", how=HERE)
    assert table["status"] == ["done"] * 3
    assert len(list((tmp_path / "s").rglob("run.vtkhdf"))) == 3
    assert not list((tmp_path / "s").rglob(".*"))


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("study.toml", errno.ENOSPC),
        ("case.toml", errno.EDQUOT),
        ("result.json", errno.EFBIG),
        ("run.vtkhdf", errno.ENOSPC),
        ("results.csv", errno.EROFS),
        ("worst.txt", errno.EIO),
    ],
)
def test_every_file_that_cannot_be_written_is_named(tmp_path, monkeypatch, name, code):
    real = os.open

    def opened(path, flags, *given, **named):
        if flags & (os.O_CREAT | os.O_WRONLY) and name in Path(os.fsdecode(path)).name:
            raise OSError(code, os.strerror(code), os.fspath(path))
        return real(path, flags, *given, **named)

    made = study(keep="worst 1" if name == "worst.txt" else "all")
    monkeypatch.setattr(os, "open", opened)
    with pytest.raises(ResultsLost, match=name) as refused:
        made.run(tmp_path / "s", how=ALONE)
    assert os.strerror(code) in str(refused.value) and refused.value.remedy
    monkeypatch.undo()
    assert made.run(tmp_path / "s", how=ALONE)["status"] == ["done"] * 3


# Killed tasks ------------------------------------------------------------------------------------


def ended_process() -> int:
    """Return the number of a process that is no more."""
    one = subprocess.Popen([sys.executable, "-c", ""])
    one.wait()
    return one.pid


def test_folders_of_killed_array_tasks_are_tidied(tmp_path):
    study().run(tmp_path / "s", how=HowMade(array=(2, 3)))
    shard, host = tmp_path / "s/runs/0000", socket.gethostname()
    old = time.time() - 2 * folders.STALE_AFTER
    for number, machine, process, age in [
        (1, host, ended_process(), None),  # nobody goes on with it
        (3, host, ended_process(), None),
        (2, "elsewhere", 1, old),  # of a run that is done
        (3, "elsewhere", 2, old),  # it may be going on there
        (2, "elsewhere", 3, None),
        (1, host, os.getppid(), None),
    ]:
        part = shard / f".{number:08d}.{machine}.{process}"
        part.mkdir()
        (part / "case.toml").write_text("")
        if age is not None:
            os.utime(part / "case.toml", (age, age))
            os.utime(part, (age, age))
    study().run(tmp_path / "s", how=HowMade(array=(1, 3)))
    left = sorted(path.name for path in shard.iterdir() if path.name.startswith("."))
    assert left == sorted(
        [f".00000001.{host}.{os.getppid()}", ".00000002.elsewhere.3", ".00000003.elsewhere.2"]
    )


def test_an_array_task_that_is_killed_leaves_nothing_when_it_is_started_again(
    slab_in_steps, tmp_path
):
    words = "-m clast study montecarlo slab.toml -n 4 -q -o s --array 1/2".split()
    words += ["--vary", "joint.plane.friction_angle=normal(34, 4)"]
    command = [sys.executable, *words, "--measure", "u=displacement(A)"]
    text = slab_in_steps.file.read_text().replace("checkpoint_every = 1e6", "")
    slab_in_steps.file.write_text(text.replace("end = 0.5", "end = 50.0"))
    task = subprocess.Popen(command, cwd=tmp_path)
    while not list((tmp_path / "s").glob("runs/0000/.*")):
        assert task.poll() is None
        time.sleep(0.02)
    task.kill()
    task.wait()
    assert list((tmp_path / "s").glob("runs/0000/.*"))
    there = StudyFolder.opened(tmp_path / "s")
    there.tidy()
    assert not list((tmp_path / "s").glob("runs/0000/.*"))


# Links -------------------------------------------------------------------------------------------


def test_nothing_is_written_through_a_link(tmp_path):
    """Names of files that are being written are known: somebody may have put links there."""
    victim, elsewhere = tmp_path / "victim", tmp_path / "elsewhere"
    victim.write_text("mine")
    elsewhere.mkdir()
    made = study(keep="worst 2")
    kept = StudyFolder.made(tmp_path / "s", made.case, made.described())
    for name in ("worst.txt", "results.csv"):
        for end in (f".{os.getpid()}", f".{os.getpid()}.part"):
            (kept.path / f".{name}{end}").symlink_to(victim)
    shard = kept.place(1).parent
    shard.mkdir(parents=True)
    part = f".{kept.place(1).name}.{socket.gethostname()}.{os.getpid()}"
    (shard / part).symlink_to(elsewhere)
    (shard / part.replace("00000001", "00000002")).symlink_to(victim)
    kept.place(3).symlink_to(elsewhere)
    made.run(tmp_path / "s", how=ALONE)
    for number in (1, 2, 3):
        (kept.place(number) / "run.vtkhdf").unlink(missing_ok=True)
        (kept.place(number) / f"part{os.getpid()}.vtkhdf").symlink_to(victim)
    go_on(StudyFolder.opened(tmp_path / "s"), ALONE)
    assert victim.read_text() == "mine" and not any(elsewhere.iterdir())
    with (tmp_path / "s/results.csv").open() as file:
        assert [row["status"] for row in csv.DictReader(file)] == ["done"] * 3


def test_a_checkpoint_beside_links_is_not_gone_on_with(slab_in_steps, tmp_path):
    made = clast.Study(
        slab_in_steps.file,
        vary={"joint.plane.friction_angle": [30.0]},
        measure={"u": "displacement(A)"},
    )
    kept = StudyFolder.made(tmp_path / "s", made.case, made.described())
    victim = tmp_path / "victim"
    victim.write_text("mine")
    left = kept.place(1).with_name(
        f".{kept.place(1).name}.{socket.gethostname()}.{ended_process()}"
    )
    left.mkdir(parents=True)
    for name in ("run.checkpoint.h5", "case.toml", "run.vtkhdf"):
        (left / name).symlink_to(victim)
    assert made.run(tmp_path / "s", how=HERE)["status"] == ["done"]
    assert victim.read_text() == "mine" and not left.exists()
