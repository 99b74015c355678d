"""Checkpoint files: to the bit, whole or not at all, and clear words for all that is none."""

from __future__ import annotations

import errno
import os
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from clast.errors import CaseError
from clast.model.state import Ledger
from clast.results.checkpoints import checkpoint_files
from clast.results.checkpoints.checkpoint import Checkpoint, Recorded, Source
from clast.results.checkpoints.checkpoint_files import (
    check_place,
    checkpoint_path,
    is_checkpoint,
    read_checkpoint,
    write_checkpoint,
)
from clast.results.checkpoints.encode import classes_near, name_of
from clast.results.checkpoints.fingerprints import digest
from clast.results.schema import HISTORY
from clast.step.convex import Convex
from scenes.recorded_run import record, three_blocks


class Way(Enum):
    UP = 1
    DOWN = 2


@dataclass(frozen=True)
class Held:
    """A class of a script."""

    values: Any


def holding(held: Any) -> Checkpoint:
    """Return a checkpoint of a run that carries something."""
    none = np.zeros(1)
    recorded = Recorded(
        file="a.vtkhdf",
        lineage=(("a", 0),),
        frames=1,
        frame=none,
        energy=none,
        since={},
        contacts=none,
    )
    return Checkpoint(version="1", time=0.5, source=Source(text=""), recorded=recorded, run=held)


def there_and_back(held: Any, folder: Path) -> Any:
    path = folder / "a.checkpoint.h5"
    write_checkpoint(path, holding(held))
    return read_checkpoint(path, classes_near([Held(0)])).run


VALUES = {
    "none": None,
    "truth": True,
    "whole": 2**70,
    "number": 0.1 + 0.2,
    "infinite": -np.inf,
    "minus zero": -0.0,
    "text": "Tück \U0001f9f1 \0\n",
    "tuple": (1, (2.5, "a"), ()),
    "list": [1, [2]],
    "set": frozenset({"a", 1}),
    "mapping": {("a", "b"): 1.0, 3: {}},
    "enumeration": Way.DOWN,
    "of clast": Ledger(kinetic=0.1),
    "of a script": Held((1, Held(None))),
}


@pytest.mark.parametrize("name", VALUES)
def test_plain_data_is_what_it_was(name: str, tmp_path: Path):
    value = VALUES[name]
    found = there_and_back(value, tmp_path)
    assert type(found) is type(value)
    assert found == value
    assert repr(found) == repr(value)


ARRAYS = {
    "floats": np.linspace(0.0, 1.0, 7) / 3.0,
    "not finite": np.array([np.nan, -np.inf, -0.0]),
    "single": np.arange(4, dtype=np.float32),
    "bytes": np.arange(4, dtype=np.uint8),
    "big end first": np.arange(4, dtype=">i4"),
    "truths": np.array([[True, False]]),
    "complex": np.array([1 + 2j]),
    "one": np.array(3.5),
    "none": np.zeros((0, 3), np.int64),
    "turned": np.arange(6.0).reshape(2, 3).T,
    "texts": np.array(["a", "Tück"]),
    "rows": np.zeros(3, np.dtype([("time", "f8"), ("at", "f8", 2)])),
    "rows of no points": np.zeros(2, HISTORY.rows(0)),
    "rows of two points": np.ones(2, HISTORY.rows(2)),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_keep_their_type_and_bits(name: str, tmp_path: Path):
    array = ARRAYS[name]
    found = there_and_back({"it": array, "same": Held(array)}, tmp_path)
    for one in (found["it"], found["same"].values):
        assert one.dtype == array.dtype
        assert one.shape == array.shape
        assert one.tobytes() == array.tobytes()


@pytest.mark.parametrize("value", [iter([]), object(), lambda: 1, np.array([object()]), {1, 2}])
def test_what_is_not_plain_is_refused_with_its_place(value: Any, tmp_path: Path):
    with pytest.raises(CaseError, match=r"^run\.values\[1\]: a checkpoint cannot hold a "):
        there_and_back(Held((1, value)), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_classes_of_scripts_must_be_handed_in(tmp_path: Path):
    path = tmp_path / "a.checkpoint.h5"
    write_checkpoint(path, holding(Held(1)))
    with pytest.raises(
        CaseError, match=r"(?s)holds data unknown to this version: Held.*model=\.\.\."
    ):
        read_checkpoint(path, {})


@pytest.mark.parametrize("name", ["os:system", "clast.errors:CaseError", "clast.none:A", "clast.x"])
def test_a_file_makes_nothing_but_dataclasses(name: str, tmp_path: Path, monkeypatch):
    monkeypatch.setattr("clast.results.checkpoints.encode.name_of", lambda kind: name)
    path = tmp_path / "a.checkpoint.h5"
    write_checkpoint(path, holding(Ledger()))
    with pytest.raises(CaseError, match="holds data unknown to this version"):
        read_checkpoint(path, {})


def test_a_class_with_other_fields_is_refused(tmp_path: Path):
    @dataclass(frozen=True)
    class Held2:
        other: int = 0

    path = tmp_path / "a.checkpoint.h5"
    write_checkpoint(path, holding(Held(1)))
    with pytest.raises(CaseError, match="has other fields than it had"):
        read_checkpoint(path, {name_of(Held): Held2})


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    path = tmp_path / "a.checkpoint.h5"
    write_checkpoint(path, holding({"a": np.arange(100.0)}))
    return path


def test_every_truncated_checkpoint_is_refused(whole: Path):
    content = whole.read_bytes()
    lengths = {0, 1, 7, 8, 100, len(content) - 1, *range(48, len(content), len(content) // 40)}
    for length in sorted(lengths):
        whole.write_bytes(content[:length])
        with pytest.raises(CaseError, match=r"is damaged|is not a (clast )?checkpoint"):
            read_checkpoint(whole, {})


def test_every_changed_byte_is_seen(whole: Path):
    content = whole.read_bytes()
    for at in range(0, len(content), len(content) // 60):
        whole.write_bytes(content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1 :])
        with pytest.raises(CaseError, match=r"is damaged|is not a (clast )?checkpoint"):
            read_checkpoint(whole, {})


def test_other_things_are_no_checkpoints(tmp_path: Path):
    (tmp_path / "case.toml").write_text("schema = 1\n")
    result = tmp_path / "a.vtkhdf"
    record(three_blocks(), result)
    for path, words in {
        tmp_path / "case.toml": "is not a clast checkpoint",
        tmp_path: "is a directory",
        tmp_path / "none.checkpoint.h5": "there is no such file",
        result: r"(?s)is a result file, not a checkpoint.*a\.checkpoint\.h5",
    }.items():
        with pytest.raises(CaseError, match=words):
            read_checkpoint(path, {})


def test_a_newer_layout_is_named(whole: Path, monkeypatch):
    monkeypatch.setattr(checkpoint_files, "LAYOUT", 2)
    write_checkpoint(whole, holding(1))
    monkeypatch.setattr(checkpoint_files, "LAYOUT", 1)
    with pytest.raises(
        CaseError, match=r"(?s)was written by a newer version of clast \(1\).*update clast"
    ):
        read_checkpoint(whole, {})


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_a_full_disk_leaves_the_checkpoint_before(whole: Path, monkeypatch, failing: str):
    before = whole.read_bytes()

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as context:
        context.setattr(checkpoint_files.os, failing, full)
        with pytest.raises(OSError, match="No space left"):
            write_checkpoint(whole, holding(2))
    assert whole.read_bytes() == before
    assert [path.name for path in whole.parent.iterdir()] == [whole.name]


def test_what_is_no_checkpoint_is_not_written_over(tmp_path: Path):
    path = tmp_path / "a.checkpoint.h5"
    path.write_text("mine")
    for write in (lambda: check_place(path), lambda: write_checkpoint(path, holding(1))):
        with pytest.raises(CaseError, match="it is not overwritten"):
            write()
    assert path.read_text() == "mine"
    assert not is_checkpoint(path)


def test_no_two_files_and_stages_share_a_checkpoint():
    checkpoint_files = [
        "n.vtkhdf",
        "n.rest.vtkhdf",
        "n.h5",
        "n.h5.vtkhdf",
        "n",
        "n.",
        "n.%.vtkhdf",
        "n%.vtkhdf",
    ]
    checkpoint_files += [
        "n%2Eh5.vtkhdf",
        "n%2Erest.vtkhdf",
        "n.vtkhdf.vtkhdf",
        "n.VTKHDF",
        "n.rest",
        ".vtkhdf",
    ]
    stages = ["", "rest", "h5", "vtkhdf", "%", ".", "rest.rest", "checkpoint", "2E"]
    names = [checkpoint_path(Path(one), stage).name for one in checkpoint_files for stage in stages]
    assert len(set(names)) == len(checkpoint_files) * len(stages)


def test_fingerprints_tell_what_differs():
    things = [
        np.zeros(2),
        np.zeros(2, np.float32),
        np.zeros((1, 2)),
        (0.0, 0.0),
        [0.0, 0.0],
        0.0,
        0,
        False,
        None,
        "0",
        Way.UP,
        Way.DOWN,
        Ledger(),
        Ledger(loads=1e-300),
        Held(Ledger()),
        {"a": 1},
        {"a": 2},
        Convex(),
        Convex,
    ]
    assert len({digest(one) for one in things}) == len(things)
    assert digest(three_blocks()) == digest(three_blocks())
    assert digest(three_blocks()) != digest(three_blocks(shift=1.0))


def test_what_is_computed_on_the_way_is_no_part_of_a_fingerprint():
    model = three_blocks()
    before = digest(model)
    assert model.vertex_block is not None
    assert model.material_points is not None
    assert digest(model) == before
    assert digest(replace(model, title="other")) != before


def test_a_part_that_a_kill_has_left_is_written_over(whole: Path):
    part = whole.with_name(f".{whole.name}.part")
    part.write_bytes(b"half")
    write_checkpoint(whole, holding(3))
    assert read_checkpoint(whole, {}).run == 3
    assert not part.exists()
