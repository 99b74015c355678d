"""Arrays of a checkpoint in HDF5: numbers alone, no more of them than the file has bytes for."""

from __future__ import annotations

import json
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

PLAIN = "biuf"
"""Kinds of numbers that HDF5 knows as NumPy does (its letters); others are written as bytes."""
AS_BYTES = "biufcSUV"
"""Kinds that are written as bytes."""


def put_array(group: Any, name: str, array: NDArray[Any]) -> None:
    """Write an array; one of rows or of texts as its bytes."""
    if array.dtype.kind in PLAIN:
        group.create_dataset(name, data=array)
        return
    content = np.frombuffer(np.ascontiguousarray(array).tobytes(), np.uint8)
    one = group.create_dataset(name, data=content)
    one.attrs["dtype"] = json.dumps(array.dtype.descr)
    one.attrs["shape"] = np.array(array.shape, np.int64)


def arrays_of(group: Any) -> list[NDArray[Any]]:
    """Return the arrays of a group by their numbers, not to be written to.

    Raises any error where they are not as ``put_array`` writes them.
    """
    return [_array(_stored(group, str(number))) for number in range(len(group))]


def _stored(group: Any, name: str) -> Any:
    """Return a dataset all of whose bytes are in the file, one by one."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise ValueError(f"/arrays/{name} is not in this file")
    found = group[name]
    if not isinstance(found, h5py.Dataset) or found.shape is None:
        raise TypeError(f"/arrays/{name} is not an array")
    if found.chunks is not None or found.external or found.is_virtual:
        raise ValueError(f"/arrays/{name} is not in one piece")
    if found.dtype.kind not in PLAIN or found.id.get_storage_size() != found.nbytes:
        raise ValueError(f"/arrays/{name} claims more data than the file holds")
    return found


def _array(dataset: Any) -> NDArray[Any]:
    """Return an array as it was."""
    content: NDArray[Any] = dataset[()] if dataset.shape else np.asarray(dataset[()])
    if "dtype" in dataset.attrs:
        kind = _kind(json.loads(dataset.attrs["dtype"]))
        shape = tuple(int(size) for size in dataset.attrs["shape"])
        content = np.frombuffer(content.tobytes(), kind).reshape(shape).copy()
    content.flags.writeable = False
    return content


def _kind(entries: Any) -> np.dtype[Any]:
    """Return the type that ``dtype.descr`` describes."""
    if entries[0][0] == "":
        kind = np.dtype(entries[0][1])
    else:
        kind = np.dtype([(name, of, *map(tuple, shape)) for name, of, *shape in entries])
    if kind.hasobject or kind.kind not in AS_BYTES:
        raise TypeError("holds more than numbers")
    return kind
