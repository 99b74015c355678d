"""Archives of blocks hold numbers and names alone, and expand to no more than blocks need."""

from __future__ import annotations

import io
import os
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from clast.errors import CaseError
from clast.rockmass.drawings.blocks_out import read_blocks_npz, write_blocks_npz

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
GOOD: dict[str, Any] = {
    "vertices": SQUARE,
    "block_start": np.array([0, 4]),
    "rock": np.array(["a"]),
    "edge_joint": np.array(["", "b", "", ""]),
}


def refused(path: Path, words: str) -> None:
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
        for name in GOOD:
            with archive.open(f"{name}.npy", "w") as file:
                for _ in range(16):
                    file.write(zeros)
    assert path.stat().st_size < 10_000_000
    refused(path, r"has arrays of 1.07e\+09 bytes, more than blocks should need")


def test_an_array_that_says_more_than_it_has(tmp_path: Path):
    path = tmp_path / "long.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("vertices.npy", claiming(SQUARE, "(9**9,),"))
    refused(path, "is not an archive of blocks, or a damaged one")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("vertices.npy", claiming(SQUARE, "(9999,2)"))
    refused(path, r"(the array vertices does not match its header|is not an archive)")


@pytest.mark.parametrize(
    ("name", "array", "words"),
    [
        (
            "vertices",
            np.array([[1, None]], object),
            "the array vertices does not match its header|damaged",
        ),
        ("vertices", SQUARE * 1j, "the array vertices does not hold numbers"),
        ("vertices", SQUARE.astype("U4"), "the array vertices does not hold numbers"),
        ("block_start", np.array([0.0, 4.0]), "the array block_start does not hold numbers"),
        ("rock", np.array([1]), "the array rock is not a list of texts"),
    ],
)
def test_arrays_hold_numbers_and_names(tmp_path: Path, name: str, array: Any, words: str):
    path = tmp_path / "a.npz"
    np.savez(path, allow_pickle=True, **{**GOOD, name: array})
    refused(path, words)


def test_a_hidden_part_is_no_way_to_another_file(tmp_path: Path):
    victim = tmp_path / "victim.txt"
    victim.write_text("precious")
    (tmp_path / f".a.npz.{os.getpid()}.part").symlink_to(victim)
    write_blocks_npz(tmp_path / "a.npz", SQUARE, [0, 4], ["a"])
    assert victim.read_text() == "precious"
    assert len(read_blocks_npz(tmp_path / "a.npz").vertices) == 4
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.npz", "victim.txt"]
