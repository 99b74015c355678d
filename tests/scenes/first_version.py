"""Result files as the first versions of clast wrote them, without checksums; changed at will."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
from numpy.lib import recfunctions


def crafted(good: Path, path: Path, change: Callable[[Any], None]) -> None:
    """Write a result file of the first layout and change it."""
    shutil.copy(good, path)
    with h5py.File(path, "r+") as file:
        file["model"].attrs["format"] = 1
        file["history"].move("left%2Fright", "left∕right")
        change(file)


def replaced(place: str, values: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[place]
        file[place] = values

    return change


def of_the_first_version(file: Any) -> None:
    """Leave out what later versions added: how the run was made, and the joints."""
    for name in ("about", "joint_name", "edge_joint"):
        del file["model"][name]
    del file["VTKHDF/CellData/gone"], file["VTKHDF/Steps/CellDataOffsets/gone"]
    columns = [name for name in file["contacts"].dtype.names if name != "joint"]
    replaced("contacts", recfunctions.repack_fields(file["contacts"][...][columns]))(file)
