"""Checkpoints that somebody has changed, with checksums that are right all the same."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from hashlib import sha256
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from clast.results.checkpoints.checkpoint_files import MARK, SUMS

Change = Callable[[dict[str, Any], dict[str, Any]], None]
"""Changes what a checkpoint says, as JSON, and its arrays by their names."""


def parts(path: Path) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Return what a checkpoint says, its arrays with their attributes, and its own attributes."""
    with h5py.File(io.BytesIO(path.read_bytes()[: -SUMS.size]), "r") as file:
        written = json.loads(file["checkpoint"][()])
        arrays = {name: (one[()], dict(one.attrs)) for name, one in file["arrays"].items()}
        return written, arrays, dict(file["checkpoint"].attrs)


def signed(content: bytes) -> bytes:
    """Return a file whose checksum is right."""
    return content + SUMS.pack(len(content), sha256(content).digest(), MARK)


def put(
    path: Path,
    written: Any,
    arrays: dict[str, Any],
    attributes: dict[str, Any],
) -> None:
    """Write a checkpoint of these parts."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver=("v108", "v108")) as file:
        held = file.create_dataset("checkpoint", data=json.dumps(written))
        held.attrs.update(attributes)
        group = file.create_group("arrays")
        for name, (array, of_array) in arrays.items():
            group.create_dataset(name, data=array).attrs.update(of_array)
    path.write_bytes(signed(buffer.getvalue()))


def forge(path: Path, target: Path, change: Change) -> Path:
    """Write a checkpoint that is another one changed."""
    written, arrays, attributes = parts(path)
    change(written, arrays)
    put(target, written, arrays, attributes)
    return target


def mutations(path: Path, count: int, seed: int) -> Iterator[tuple[str, bytes]]:
    """Give a checkpoint changed at random in one or two places, each with what was done."""
    rng = np.random.default_rng(seed)
    whole = parts(path)
    scratch = path.with_name("scratch.h5")
    for _ in range(count):
        written, arrays, attributes = deepcopy(whole)
        said = [_mutate(written, arrays, rng) for _ in range(int(rng.integers(1, 3)))]
        put(scratch, written, arrays, attributes)
        yield "; ".join(said), scratch.read_bytes()
    scratch.unlink(missing_ok=True)


def _mutate(written: Any, arrays: dict[str, Any], rng: np.random.Generator) -> str:
    """Change an entry of the text or an array; return what was changed."""
    if rng.random() < 0.4:
        name = str(rng.choice(sorted(arrays)))
        array, attributes = arrays[name]
        number = int(rng.integers(len(ARRAY_CHANGES)))
        arrays[name] = (ARRAY_CHANGES[number](np.array(array), rng), attributes)
        return f"array {name}: change {number}"
    places = list(_places(written))
    holder, key = places[int(rng.integers(len(places)))]
    number = int(rng.integers(len(TEXT_CHANGES) + 1))
    if number == len(TEXT_CHANGES):
        del holder[key]
        return f"{key}: dropped"
    before = holder[key]
    holder[key] = TEXT_CHANGES[number](before)
    return f"{key}: {str(before)[:60]} -> {str(holder[key])[:60]}"


def _places(written: Any) -> Iterator[tuple[Any, Any]]:
    """Give all entries of a text: what holds each, and its key in it."""
    entries = written.items() if isinstance(written, dict) else enumerate(written)
    for key, value in list(entries):
        yield written, key
        if isinstance(value, dict | list):
            yield from _places(value)


TEXT_CHANGES: list[Callable[[Any], Any]] = [
    lambda _: None,
    lambda _: -1,
    lambda _: 10**9,
    lambda _: 0.5,
    lambda _: float("nan"),
    lambda _: float("-inf"),
    lambda _: "text",
    lambda _: [],
    lambda _: {},
    lambda value: [value],
    lambda value: {"tuple": [value]},
    lambda _: {"array": 0},
    lambda _: {"is": "clast.model.state:Ledger", "with": {}},
    lambda _: True,
    lambda _: "../../etc/passwd",
]

ARRAY_CHANGES: list[Callable[[np.ndarray, np.random.Generator], np.ndarray]] = [
    lambda array, _: array.reshape(-1)[: array.size // 2],
    lambda array, _: np.concatenate([array, array]) if array.ndim else array[None],
    lambda array, _: array.astype(np.float32),
    lambda array, _: array.astype(np.int64),
    lambda array, _: np.full_like(array, -1) if array.dtype.kind != "u" else array[:1],
    lambda array, _: np.full_like(array, 120) if array.dtype.kind == "u" else array + 1000,
    lambda array, _: np.full(array.shape, np.nan),
    lambda array, rng: np.frombuffer(rng.bytes(array.nbytes), array.dtype).reshape(array.shape),
    lambda array, _: array[None],
    lambda array, _: array != 0,
]
