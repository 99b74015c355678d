"""Checkpoints that do not belong to a run's results, or were made to do harm, are refused."""

from __future__ import annotations

import io
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import clast
from clast.errors import CaseError, RunStopped
from clast.results.checkpoints.checkpoint_files import SUMS, checkpoint_path
from scenes.command_line import clast_command
from scenes.forged_checkpoints import forge, mutations, signed
from scenes.restarts import differences, pressed_at

CASE = """
schema = 1
time = {step = 1e-3, end = 0.012}
rock.r = {young = 1e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
output = {every = 2e-3}
[in_situ]
vertical = "overburden"
k0 = 0.5
contacts = "none"
[[measured_point]]
name = "A"
at = [0, 0.5]
block = "b"
[[block]]
name = "floor"
fixed = true
vertices = [[-1, -1], [9, -1], [9, 0], [-1, 0]]
[[block]]
name = "b"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[stage]]
name = "rest"
until = "time"
time = 6e-3
[[stage]]
name = "push"
until = "time"
time = 6e-3
loads = ["push"]
[[point_load]]
name = "push"
at = [0, 0.5]
block = "b"
force = [1e6, 0.0]
"""


def the_case(force: str = "1e6", file: str = "a.toml") -> clast.Case:
    return clast.Case.from_text(CASE.replace("1e6", force), file)


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that was interrupted after nine steps."""
    folder = tmp_path_factory.mktemp("interrupted")
    run = the_case().run(output=folder / "a.vtkhdf", progress=pressed_at(9))
    assert run.checkpoint == folder / "a.checkpoint.h5"
    return folder


@pytest.fixture
def part(interrupted: Path, tmp_path: Path) -> Path:
    """Its checkpoint, in a folder of the test's own."""
    shutil.copytree(interrupted, tmp_path, dirs_exist_ok=True)
    return tmp_path / "a.checkpoint.h5"


def contents(folder: Path) -> dict[str, bytes]:
    return {one.name: one.read_bytes() for one in folder.iterdir() if one.is_file()}


def refused(words: str, *arguments: object) -> None:
    """Check that `clast resume` refuses in one message, and leaves the folder as it was."""
    folder = Path(str(arguments[0])).parent
    before = contents(folder)
    result = clast_command("resume", *arguments)
    assert result.exit_code == 2, result.output
    assert words in " ".join(result.stderr.split()), result.stderr
    assert "Traceback" not in result.stderr
    assert contents(folder) == before


# a checkpoint belongs to its run ----------------------------------------------------------------


def test_a_new_run_makes_older_checkpoints_unusable(part: Path):
    output, older = part.with_name("a.vtkhdf"), part.with_name("older.checkpoint.h5")
    shutil.copy(part, older)
    the_case("9e6").run(output=output)  # its ends of stages replace those of before
    refused("its frames are those of another, later run", older)
    refused("belongs to another run than older.checkpoint.h5", older, "--stage", "push")
    assert clast.resume(checkpoint_path(output, "rest")).report.finished


def test_checkpoints_of_a_course_that_was_left_are_refused(part: Path):
    output = part.with_name("a.vtkhdf")
    clast.resume(part)
    kept = part.with_name("end.checkpoint.h5")
    shutil.copy(part, kept)
    clast.resume(part, ["point_load.1.force=[2e6, 0]"], stage="push")
    refused("those of another, later run", kept)
    # the end of the stage before is now that of the changed run, and still that of the results
    again = clast.resume(checkpoint_path(output, "rest"))
    whole = the_case("2e6").run(output=part.with_name("whole.vtkhdf"))
    assert differences(whole.output, again.output) == ["model/case"]


def test_only_ends_of_stages_are_gone_back_to(part: Path):
    end = checkpoint_path(part.with_name("a.vtkhdf"), "rest")
    shutil.copy(part, end)
    refused("is not a checkpoint of the end of stage 'rest'", part, "--stage", "push")

    def pretended(written: Any, arrays: Any) -> None:
        written["with"]["stage"] = "rest"

    forge(part, end, pretended)
    refused("is not a checkpoint of the end of stage 'rest'", end, "--stage", "push")


# what else it names -----------------------------------------------------------------------------


def test_a_case_file_that_has_changed_is_said(tmp_path: Path):
    file = tmp_path / "a.toml"
    file.write_text(CASE, "utf-8")
    set_later = clast.Case.from_toml(file, ["time.max_displacement=0.1"])
    part = set_later.run(output=tmp_path / "a.vtkhdf", progress=pressed_at(3)).checkpoint
    kept = part.read_bytes()
    told: list[str] = []
    clast.resume(part, warn=told.append)
    assert not [text for text in told if "a.toml" in text]
    clast.resume(part, warn=told.append)
    assert not [text for text in told if "a.toml" in text]
    file.write_text(CASE.replace("1e6", "2e6"), "utf-8")
    part.write_bytes(kept)
    result = clast_command("resume", part, "-o", tmp_path / "b.vtkhdf")
    assert result.exit_code == 0
    said = " ".join(result.stderr.split())
    assert said.count("a.toml has changed since the run began") == 1


# forged ones ------------------------------------------------------------------------------------


def other_file(name: str) -> Callable[[Any, Any], None]:
    def change(written: Any, arrays: Any) -> None:
        written["with"]["recorded"]["with"]["file"] = name

    return change


def test_results_elsewhere_are_never_cut_back(part: Path):
    foreign = part.parent / "there" / "a.vtkhdf"
    foreign.parent.mkdir()
    shutil.copy(part.with_name("a.vtkhdf"), foreign)
    before = foreign.read_bytes()
    for name in ("there/a.vtkhdf", str(foreign), "../" + part.parent.name + "/a.vtkhdf", "", ".."):
        forged = forge(part, part.with_name("f.checkpoint.h5"), other_file(name))
        refused("a result file that does not lie beside it", forged)
    link = part.with_name("link.vtkhdf")
    link.symlink_to(foreign)
    refused("is not a regular file", forge(part, part.with_name("f.h5"), other_file("link.vtkhdf")))
    assert foreign.read_bytes() == before
    # a run of the same case that is not the checkpoint's
    the_case().run(output=part.with_name("mine.vtkhdf"))
    refused(
        "those of another, later run",
        forge(part, part.with_name("f.h5"), other_file("mine.vtkhdf")),
    )


def named(*files: str) -> Callable[[Any, Any], None]:
    def change(written: Any, arrays: Any) -> None:
        source = written["with"]["source"]["with"]
        source["files"] = {"map": [[name, "00"] for name in files]}

    return change


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/stdin", "pipe", "/etc/passwd", "a.toml"])
def test_files_that_its_case_does_not_name_are_not_read(part: Path, name: str):
    if sys.platform != "win32":
        os.mkfifo(part.with_name("pipe"))
    refused("its case is another than its run's", forge(part, part, named(name)))


def test_devices_and_pipes_are_no_checkpoints(tmp_path: Path):
    pipe = tmp_path / "pipe.checkpoint.h5"
    os.mkfifo(pipe)
    refused("is a device, a pipe or the like, not a checkpoint", pipe)
    (tmp_path / "zero.h5").symlink_to("/dev/zero")
    refused("is a device, a pipe or the like, not a checkpoint", tmp_path / "zero.h5")
    with open(tmp_path / "huge.checkpoint.h5", "wb") as file:
        file.truncate(2**40)
    result = clast_command("resume", tmp_path / "huge.checkpoint.h5")
    assert result.exit_code == 2
    assert "more than is read" in result.stderr


def rebuilt(path: Path, change: Callable[[Any], None]) -> Path:
    """Change the HDF5 part of a checkpoint by HDF5's own means."""
    image = io.BytesIO(path.read_bytes()[: -SUMS.size])
    with h5py.File(image, "r+") as file:
        change(file)
    path.write_bytes(signed(image.getvalue()))
    return path


def huge(file: Any) -> None:
    del file["arrays/0"]
    file.create_dataset("arrays/0", shape=(10**12,), dtype="f8")


def packed(file: Any) -> None:
    del file["arrays/0"]
    file.create_dataset("arrays/0", data=np.zeros(10**6), compression="gzip")


def elsewhere(file: Any) -> None:
    del file["arrays/0"]
    file["arrays/0"] = h5py.ExternalLink("a.vtkhdf", "/energy")


def outside(file: Any) -> None:
    del file["arrays/0"]
    file.create_dataset("arrays/0", shape=(4,), dtype="u1", external=[("/etc/passwd", 0, 4)])


def deep(file: Any) -> None:
    attributes = dict(file["checkpoint"].attrs)
    del file["checkpoint"]
    file.create_dataset("checkpoint", data='{"list": [' * 50_000).attrs.update(attributes)


def without_layout(file: Any) -> None:
    del file["checkpoint"].attrs["layout"]


def objects(file: Any) -> None:
    one = next(one for one in file["arrays"].values() if "dtype" in one.attrs)
    one.attrs["dtype"] = '[["", "|O"]]'


@pytest.mark.parametrize(
    "change", [huge, packed, elsewhere, outside, deep, without_layout, objects]
)
def test_what_hdf5_can_hold_is_not_trusted(part: Path, change: Callable[[Any], None]):
    refused("is damaged: its parts do not fit together", rebuilt(part, change))


def test_only_data_of_a_run_are_made(part: Path):
    for name in ("clast.__main__:x", "clast.cli.commands:app", "os:system", "clast.model:x"):

        def change(written: Any, arrays: Any, name: str = name) -> None:
            written["with"]["run"] = {"is": name, "with": {}}

        refused("holds data unknown to this version", forge(part, part, change))


def array_of(written: Any, *keys: str) -> str:
    """Return the name of an array by the fields that lead to it."""
    for key in keys:
        written = written["with"][key]
    return str(written["array"])


@pytest.mark.parametrize(
    ("keys", "change", "words"),
    [
        (("run", "state", "vertices"), lambda a: a[:-1], "it has vertices of other blocks"),
        (("run", "state", "vertices"), lambda a: a * 0.0, "it has blocks without an area"),
        (("run", "state", "velocity"), lambda a: a * np.nan, "its velocity are not finite"),
        (("run", "state", "memory", "vertex"), lambda a: a + 1000, "a vertex that does not exist"),
        (("run", "state", "memory", "edge"), lambda a: a - 9, "a edge that does not exist"),
        (("run", "state", "memory", "mode"), lambda a: a + 7, "a mode that does not exist"),
        (("run", "state", "memory", "gap"), lambda a: a[1:], "as many numbers each"),
        (("run", "state", "memory", "bonded"), lambda a: a * 1.0, "its content is not as expected"),
        (("run", "seen", "least"), lambda a: a[:2], "energies that were seen"),
    ],
)
def test_arrays_must_fit_to_the_model(
    part: Path, keys: tuple[str, ...], change: Callable[[Any], Any], words: str
):
    def forged(written: Any, arrays: Any) -> None:
        name = array_of(written, *keys)
        array, attributes = arrays[name]
        assert len(array)
        arrays[name] = change(array), attributes

    refused(words, forge(part, part, forged))


@pytest.mark.slow
@pytest.mark.one_in(3)
def test_mutations_are_refused_or_harmless(interrupted: Path, tmp_path: Path):
    """Several hundred changes at random: a message or a run, and nothing else touched."""
    shutil.copytree(interrupted, tmp_path, dirs_exist_ok=True)
    part, output = tmp_path / "a.checkpoint.h5", tmp_path / "a.vtkhdf"
    whole, results = part.read_bytes(), output.read_bytes()
    others = contents(tmp_path).keys() - {"a.checkpoint.h5", "a.vtkhdf"}
    before = {name: (tmp_path / name).read_bytes() for name in others}
    refusals = 0
    for said, content in mutations(part, 400, seed=9):
        part.write_bytes(content)
        try:
            clast.resume(part)
        except CaseError as error:
            refusals += 1
            assert output.read_bytes() == results, said
            assert "Traceback" not in str(error)
        except RunStopped:
            pass  # numbers that a run can have, but no run can go on from
        except Exception as error:
            raise AssertionError(said) from error
        output.write_bytes(results)
        part.write_bytes(whole)
        for name in others:
            (tmp_path / name).write_bytes(before[name])
    assert refusals > 300
