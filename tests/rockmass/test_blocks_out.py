"""Blocks out as DXF, CSV and NPZ, and in again."""

from __future__ import annotations

import csv
import io
import os
import time
import zipfile
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from clast.errors import CaseError
from clast.rockmass.drawings.blocks_out import (
    read_blocks_npz,
    write_blocks_csv,
    write_blocks_dxf,
    write_blocks_npz,
)

VERTICES = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0.1), (1, 1.0)]) / 3.0
START = np.array([0, 4, 7])
ROCK = ("granite", "Schiefer, grün")
EDGE_JOINT = ("", "bedding", "default", "", "", "", "bedding")
SYSTEM = (VERTICES, START, ROCK, EDGE_JOINT)
WRITERS = {
    ".dxf": write_blocks_dxf,
    ".csv": write_blocks_csv,
    ".npz": write_blocks_npz,
}


def test_a_table_has_a_row_for_each_vertex(tmp_path):
    path = tmp_path / "blocks.csv"
    write_blocks_csv(path, *SYSTEM)
    with path.open(encoding="utf-8", newline="") as file:
        rows = [tuple(row.values()) for row in csv.DictReader(file)]
    owner, place = [0] * 4 + [1] * 3, [0, 1, 2, 3, 0, 1, 2]
    joints, rocks = EDGE_JOINT, [ROCK[block] for block in owner]
    assert [(int(b), int(v), float(x), float(y), *more) for b, v, x, y, *more in rows] == list(
        zip(owner, place, *VERTICES.T.tolist(), joints, rocks, strict=True)
    )


def test_a_drawing_has_a_closed_polyline_for_each_block(tmp_path):
    path = tmp_path / "blocks.dxf"
    write_blocks_dxf(path, VERTICES, START, ("granite", "Schiefer {grün}"), EDGE_JOINT)
    document = ezdxf.readfile(path)
    auditor = document.audit()
    assert not auditor.errors and not auditor.fixes
    assert int(document.header["$HANDSEED"], 16) > max(int(h, 16) for h in document.entitydb)
    assert document.header["$INSUNITS"] == 6
    lines = document.modelspace().query("LWPOLYLINE")
    assert [line.dxf.layer for line in lines] == ["granite", "Schiefer {grün}"]
    for block, line in enumerate(lines):
        assert line.closed
        points = np.array(list(line.get_points("xy")))
        np.testing.assert_array_equal(points, VERTICES[START[block] : START[block + 1]])
    joints = document.modelspace().query("LINE")
    # The line that both blocks share is drawn once.
    assert [line.dxf.layer for line in joints] == ["JOINTS_bedding", "JOINTS"]


@pytest.mark.parametrize("suffix", WRITERS)
def test_an_older_file_stays_until_the_new_one_is_whole(tmp_path, suffix, monkeypatch):
    path = tmp_path / f"blocks{suffix}"
    path.write_text("older")
    monkeypatch.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left")))
    with pytest.raises(CaseError, match="cannot be written: No space left"):
        WRITERS[suffix](path, VERTICES, START, ["a", "b"])
    assert path.read_text() == "older"
    assert os.listdir(tmp_path) == [path.name]


def test_links_are_followed(tmp_path):
    real, link = tmp_path / "real.csv", tmp_path / "link.csv"
    link.symlink_to(real)
    write_blocks_csv(link, VERTICES, START, ["a", "b"])
    assert link.is_symlink() and real.stat().st_size > 0


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("no/such/folder/x", "does not exist"),
        (".", "is a directory"),
        ("a\0b", "cannot be written"),
        ("x" * 300, "cannot be written"),
    ],
)
def test_places_that_cannot_be_written_to(tmp_path, suffix, place, message):
    with pytest.raises(CaseError, match=message):
        WRITERS[suffix](tmp_path / place, VERTICES, START, ["a", "b"])
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": VERTICES[:, :1]}, "shape"),
        ({"vertices": VERTICES * np.nan}, "not finite"),
        ({"vertices": "abc"}, "not numbers"),
        ({"block_start": [0, 4, 6]}, "from 0 to 6, not from 0 to 7"),
        ({"block_start": [0, 5, 7]}, "block 1 has 2 vertices"),
        ({"block_start": [0, 4.5, 7]}, "no whole numbers"),
        ({"block_start": []}, "not \\(nb"),
        ({"rock": ["a"]}, "1 rocks for 2 blocks"),
        ({"edge_joint": ["a"]}, "1 joints of edges for 7 vertices"),
    ],
)
def test_arrays_that_do_not_belong_together(tmp_path, suffix, change, message):
    system = {"vertices": VERTICES, "block_start": START, "rock": ["a", "b"], "edge_joint": None}
    path = Path(tmp_path / f"x{suffix}")
    with pytest.raises(CaseError, match=message):
        WRITERS[suffix](path, **{**system, **change})
    assert not path.exists()


@pytest.mark.parametrize(
    ("rocks", "message"),
    [
        (("a", "b:c"), "':'"),
        (("a", " "), "cannot be used as the name"),
        (("a", "A"), "layer names ignore case"),
        (("a", "x\ny"), "cannot be used as the name"),
    ],
)
def test_names_that_no_layer_can_have(tmp_path, rocks, message):
    with pytest.raises(CaseError, match=message):
        write_blocks_dxf(tmp_path / "x.dxf", VERTICES, START, rocks)


def damaged(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda path: path.write_text("x1,y1"), "not an archive of blocks"),
        (lambda path: path.write_bytes(b""), "not an archive of blocks"),
        (lambda path: path.write_bytes(path.read_bytes()[:200]), "not an archive of blocks"),
        (damaged, "not an archive of blocks"),
        (lambda path: np.savez(path, vertices=VERTICES), "no array block_start, rock, edge_joint"),
        (lambda path: np.savez(path, **dict.fromkeys(NAMES, np.zeros(3))), "not a list of texts"),
        (
            lambda path: np.savez(path, **{n: np.array([None], object) for n in NAMES}),
            "the array vertices does not match its header",
        ),
    ],
)
def test_archives_that_are_none(tmp_path, spoil, message):
    path = tmp_path / "blocks.npz"
    write_blocks_npz(path, *SYSTEM)
    spoil(path)
    with pytest.raises(CaseError, match=message):
        read_blocks_npz(path)


NAMES = ("vertices", "block_start", "rock", "edge_joint")


UNIT = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
ARCHIVE: dict[str, Any] = {
    "vertices": UNIT,
    "block_start": np.array([0, 4]),
    "rock": np.array(["a"]),
    "edge_joint": np.array(["", "b", "", ""]),
}


def refused_at_once(path: Path, words: str) -> None:
    start = time.perf_counter()
    with pytest.raises(CaseError, match=words):
        read_blocks_npz(path)
    assert time.perf_counter() - start < 1.0


def claiming(array: np.ndarray, shape: str) -> bytes:
    """Return an array whose heading says another shape."""
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue().replace(b"(4, 2), ", shape.encode().ljust(8)[:8])


@pytest.mark.slow
def test_what_expands_without_end_is_refused_at_once(tmp_path: Path):
    path = tmp_path / "bomb.npz"
    zeros = bytes(1 << 24)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in ARCHIVE:
            with archive.open(f"{name}.npy", "w") as file:
                for _ in range(16):
                    file.write(zeros)
    assert path.stat().st_size < 10_000_000
    refused_at_once(path, r"has arrays of 1.07e\+09 bytes, more than blocks should need")


def test_an_array_that_says_more_than_it_has(tmp_path: Path):
    path = tmp_path / "long.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("vertices.npy", claiming(UNIT, "(9**9,),"))
    refused_at_once(path, "is not an archive of blocks, or a damaged one")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("vertices.npy", claiming(UNIT, "(9999,2)"))
    refused_at_once(path, r"(the array vertices does not match its header|is not an archive)")


@pytest.mark.parametrize(
    ("name", "array", "words"),
    [
        (
            "vertices",
            np.array([[1, None]], object),
            "the array vertices does not match its header|damaged",
        ),
        ("vertices", UNIT * 1j, "the array vertices does not hold numbers"),
        ("vertices", UNIT.astype("U4"), "the array vertices does not hold numbers"),
        ("block_start", np.array([0.0, 4.0]), "the array block_start does not hold numbers"),
        ("rock", np.array([1]), "the array rock is not a list of texts"),
    ],
)
def test_arrays_hold_numbers_and_names(tmp_path: Path, name: str, array: Any, words: str):
    path = tmp_path / "a.npz"
    np.savez(path, allow_pickle=True, **{**ARCHIVE, name: array})
    refused_at_once(path, words)


def test_a_hidden_part_is_no_way_to_another_file(tmp_path: Path):
    victim = tmp_path / "victim.txt"
    victim.write_text("precious")
    (tmp_path / f".a.npz.{os.getpid()}.part").symlink_to(victim)
    write_blocks_npz(tmp_path / "a.npz", UNIT, [0, 4], ["a"])
    assert victim.read_text() == "precious"
    assert len(read_blocks_npz(tmp_path / "a.npz").vertices) == 4
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.npz", "victim.txt"]
