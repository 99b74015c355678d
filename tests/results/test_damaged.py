"""Result files that are damaged or made up: one message each, and no wrong number."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from clast.cli.commands import app
from clast.errors import CaseError
from clast.results import open_file, read_results, summary
from scenes.crafted_files import crafted, replaced
from scenes.recorded_run import record, three_blocks


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result file that is whole."""
    path = tmp_path_factory.mktemp("good") / "out.vtkhdf"
    record(three_blocks(), path)
    return path


def everything(path: Path) -> None:
    """Read all that can be asked of a result file."""
    results = read_results(path)
    summary(results)
    assert results.edge_joint.max() < len(results.joint_name)
    for frame in range(len(results.times)):
        results.vertices(frame)
        results.contacts(frame)
        for name in results.field_names:
            results.field(name, frame)
    for name in results.point_name:
        results.history(name)
    assert results.energy
    assert results.steps


def refused(path: Path) -> str:
    with pytest.raises(CaseError) as caught:
        everything(path)
    assert caught.value.where == str(path)
    assert caught.value.remedy
    return str(caught.value)


def test_every_flipped_bit_is_noticed(good: Path, tmp_path: Path):
    whole, path, chance = good.read_bytes(), tmp_path / "out.vtkhdf", random.Random(7)
    places = [0, 8, 9, 28, len(whole) - 1, *chance.sample(range(len(whole)), 120)]
    for place in places:
        spoiled = bytearray(whole)
        spoiled[place] ^= 1 << chance.randrange(8)
        path.write_bytes(spoiled)
        with pytest.raises(CaseError):
            read_results(path)


@pytest.mark.slow
def test_what_is_not_read_is_not_checked_in_a_large_file(tmp_path: Path):
    path = tmp_path / "out.vtkhdf"
    record(three_blocks(), path, steps=1600)
    with h5py.File(path) as file:
        chunk = file["steps"].id.get_chunk_info(2)
    with path.open("r+b") as file:
        file.seek(chunk.byte_offset + chunk.size // 2)
        file.write(b"\xaa\xaa\xaa")
    results = read_results(path, whole=0)
    assert len(results.vertices(-1)) == 13
    with pytest.raises(CaseError, match="differ from those written"):
        _ = results.steps
    assert CliRunner().invoke(app, ["info", str(path)]).exit_code == 2


KEPT = """
import sys
from clast.errors import CaseError
from clast.results import read_results
kept = []
for path in sys.argv[1:]:
    try:
        read_results(path)
    except CaseError as error:
        error.itself = error  # a cycle: it lives until the end
        kept.append(error)
print(len(kept))
"""


@pytest.mark.slow
def test_a_process_that_keeps_the_errors_ends_well(good: Path, tmp_path: Path):
    """HDF5 would call Python, which is gone, for a file that an error has kept open."""
    whole, paths = good.read_bytes(), []
    for place in (0, 9, 30, 400, len(whole) // 2, len(whole) - 10):
        spoiled = bytearray(whole)
        spoiled[place] ^= 255
        paths.append(tmp_path / f"{place}.vtkhdf")
        paths[-1].write_bytes(spoiled)
    done = subprocess.run(
        [sys.executable, "-c", KEPT, *map(str, paths)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, f"{len(paths)}\n"), done.stderr


def test_a_file_that_somebody_has_changed_is_refused(good: Path, tmp_path: Path):
    path = tmp_path / "out.vtkhdf"
    shutil.copy(good, path)
    with h5py.File(path, "r+") as file:
        file["VTKHDF/Points"][0] = 7.0
    assert "is damaged" in refused(path)


def test_files_without_their_end(good: Path, tmp_path: Path):
    whole, path = good.read_bytes(), tmp_path / "out.vtkhdf"
    # zeros that are missing at the end are read as zeros, and one checksum in 256 ends with one
    last = len(whole.rstrip(b"\0"))
    for length in (1, 100, len(whole) // 2, len(whole) - 4, last - 1):
        path.write_bytes(whole[:length])
        refused(path)


# --- made up, with checksums that fit ----------------------------------------------------------


def cell(place: str, column: str | None, row: int, value: float) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        values = file[place][...]
        (values if column is None else values[column])[row] = value
        file[place][...] = values

    return change


def attribute(place: str, name: str, value: Any) -> Callable[[Any], None]:
    return lambda file: file[place].attrs.__setitem__(name, value)


def report_with(**entries: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        plain = json.loads(file["report/json"].asstr()[()])
        replaced("report/json", json.dumps({**plain, **entries}))(file)

    return change


STAGE = {
    **{"name": "a", "start": 0.0, "end": 1.0, "steps": 3, "outcome": "moving"},
    **{"force_ratio": 0.1, "seconds": 0.1, "reset": []},
    "mover": {"block": "b", "speed": 0.1, "direction": 0.0},
}
"""How a stage went, as reports have it."""

MADE_UP = {
    "no frames": attribute("VTKHDF/Steps", "NSteps", 0),
    "a thousand million frames": attribute("VTKHDF/Steps", "NSteps", 10**9),
    "-1 frames": attribute("VTKHDF/Steps", "NSteps", -1),
    "frames in words": attribute("VTKHDF/Steps", "NSteps", "many"),
    "layout -1": attribute("model", "format", -1),
    "layout in words": attribute("model", "format", "one"),
    "layout of several": attribute("model", "format", [1, 1]),
    "blocks start at 0": replaced("model/block_start", np.zeros(4, int)),
    "blocks start far away": replaced("model/block_start", np.array([0, 4, 7, 10**15])),
    "blocks start before 0": replaced("model/block_start", np.array([0, 4, 7, -5])),
    "blocks start at halves": replaced("model/block_start", np.array([0.0, 4.0, 7.0, 13.0])),
    "one start too few": replaced("model/block_start", np.array([0, 4, 13])),
    "no start": replaced("model/block_start", np.zeros(0, int)),
    "rocks that are not": replaced("model/block_rock", np.array([0, 0, 9])),
    "one rock too few": replaced("model/block_rock", np.array([0, 0])),
    "joints that are not": cell("model/edge_joint", None, 2, 3),
    "joints below none": cell("model/edge_joint", None, 2, -2),
    "joints in halves": replaced("model/edge_joint", np.zeros(13)),
    "one joint too few": replaced("model/edge_joint", np.zeros(12, int)),
    "joints in a table": replaced("model/edge_joint", np.zeros((13, 1), int)),
    "joint names that are numbers": replaced("model/joint_name", np.zeros(3)),
    "no joint names": replaced("model/joint_name", np.zeros(0, h5py.string_dtype())),
    "contacts along joints that are not": cell("contacts", "joint", -1, 3),
    "contacts along no joint": cell("contacts", "joint", -1, -1),
    "contacts with joints, and a model without": lambda file: [
        file["model"].__delitem__(name) for name in ("joint_name", "edge_joint")
    ],
    "names that are numbers": replaced("model/block_name", np.zeros(3)),
    "a case that is a number": replaced("model/case", 1.0),
    "a point without a place": replaced("model/point_start", np.zeros((1, 2))),
    "a point nowhere": replaced("model/point_start", np.full((2, 2), np.nan)),
    "vertices that are not numbers": cell("VTKHDF/Points", None, 3, np.nan),
    "vertices that are endless": cell("VTKHDF/Points", None, -1, np.inf),
    "vertices out of this world": cell("VTKHDF/Points", None, -1, 1e300),
    "contacts out of this world": cell("contacts", "position", -1, 1e300),
    "normals that are endless": cell("contacts", "normal", -1, np.inf),
    "forces that are not numbers": cell("contacts", "normal_force", -1, np.nan),
    "vertices in a plane": replaced("VTKHDF/Points", np.zeros((65, 2))),
    "vertices in words": replaced("VTKHDF/Points", [b"x"] * 65),
    "vertices elsewhere": replaced("VTKHDF/Points", h5py.ExternalLink("other.h5", "/x")),
    "vertices by a link": replaced("VTKHDF/Points", h5py.SoftLink("/VTKHDF/Points")),
    "a model elsewhere": replaced("model", h5py.ExternalLink("other.h5", "/x")),
    "contacts that end far away": cell("frames", "contacts", -1, 10**15),
    "contacts that end before 0": cell("frames", "contacts", 1, -3),
    "time goes back": cell("frames", "time", -1, -1.0),
    "no time": cell("frames", "time", 2, np.nan),
    "more room than there is": lambda file: file["contacts"].resize((10**15,)),
    "energies of nothing": lambda file: file["energy"].resize((10**12,)),
    "no history left": lambda file: file["history/tip"].resize((0,)),
    "contacts without a column": replaced("contacts", np.zeros(9, [("position", "f8", 2)])),
    "energies in words": replaced("energy", np.zeros(21, [("time", "f8"), ("kinetic", "S4")])),
    "connected otherwise": cell("VTKHDF/Offsets", None, 1, 10**9),
    "other cells": cell("VTKHDF/Types", None, 0, 9),
    **{
        f"made as {text}": replaced("model/about", text)
        for text in ("", "[]", "7", '{"process": 7}', '{"process": {}}', '{"rocks": [{}]}')
    },
    "report of nothing": replaced("report/json", "[]"),
    "report that breaks off": replaced("report/json", '{"finished": true'),
    "report that is deep": replaced("report/json", "[" * 100_000),
    "report without numbers": replaced("report/json", "{}"),
    "report that counts in words": report_with(steps="many"),
    "report with energies in words": report_with(ledger={"kinetic": "much"}),
    "report with one number for all": report_with(seconds=3),
    "report with stages that are none": report_with(stages=[{}]),
    "report with a stage in words": report_with(stages=[{**STAGE, "steps": "many"}]),
    "report with a mover in words": report_with(stages=[{**STAGE, "mover": {"speed": "high"}}]),
    "report with events of nothing": report_with(events=[7]),
    "frames of stages that are not": lambda file: file.create_dataset("frame_stage", data=[1] * 5),
    "stages without names": replaced("model/about", '{"stages": [7]}'),
    "report that is a table": replaced("report/json", np.zeros(3)),
    **{
        f"without {place}": lambda file, place=place: file.__delitem__(place)
        for place in (
            *("frames", "contacts", "energy", "steps", "history", "history/tip", "model/case"),
            *("model/joint_name", "model/edge_joint"),
            *("model/fixed", "VTKHDF/Points", "VTKHDF/CellData/stress", "VTKHDF/CellData/rock"),
            *("VTKHDF/Steps", "VTKHDF/Steps/PointOffsets", "VTKHDF/Connectivity", "report/json"),
        )
    },
}


@pytest.mark.parametrize("change", MADE_UP.values(), ids=MADE_UP.keys())
def test_files_that_are_made_up(good: Path, tmp_path: Path, change: Callable[[Any], None]):
    path = tmp_path / "out.vtkhdf"
    crafted(good, path, change)
    assert len(refused(path)) < 500


def test_a_report_with_a_stage_is_read(good: Path, tmp_path: Path):
    path = tmp_path / "out.vtkhdf"
    crafted(good, path, report_with(stages=[STAGE]))
    (stage,) = read_results(path).stages
    assert (stage.name, stage.mover.block, stage.steps) == ("a", "b", 3)


def test_tables_with_more_columns_are_read(good: Path, tmp_path: Path):
    """A later clast may write more of a contact and have more energies."""
    path = tmp_path / "out.vtkhdf"

    def wider(file: Any) -> None:
        for place in ("contacts", "energy", "history/tip"):
            old = file[place][...]
            new = np.zeros(len(old), [*old.dtype.descr, ("more", "f8")])
            for name in old.dtype.names:
                new[name] = old[name]
            replaced(place, new)(file)
        report_with(more=1, ledger={"kinetic": 1.0, "more": 2.0})(file)

    crafted(good, path, wider)
    everything(path)
    assert "more" in read_results(path).energy


def test_a_file_that_changes_while_it_is_read_is_read_again(good: Path, monkeypatch):
    """Where there are no locks, a frame may come in between."""
    answers = iter([OSError("torn"), KeyError("gone"), "whole"])

    def answer(path: Path, *_: object) -> str:
        path.touch()
        given = next(answers)
        if isinstance(given, Exception):
            raise given
        return given

    monkeypatch.setattr(open_file, "_answer", answer)
    assert open_file.ask(good, lambda _: None) == "whole"
