"""Result files that are made up: changed at will, with checksums that fit."""

from __future__ import annotations

import shutil
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from clast.results.page_checksums import END_PLACE, PAGE, packed


def crafted(good: Path, path: Path, change: Callable[[Any], None]) -> None:
    """Copy a result file and change it."""
    shutil.copy(good, path)
    with h5py.File(path, "r+") as file:
        change(file)
    content = path.read_bytes()
    end = int.from_bytes(content[END_PLACE : END_PLACE + 8], "little")
    content = content[:end].ljust(end, b"\0")
    sums = [zlib.crc32(content[first : first + PAGE]) for first in range(0, end, PAGE)]
    path.write_bytes(content + packed(np.array(sums, np.uint32), end))


def replaced(place: str, values: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[place]
        file[place] = values

    return change
