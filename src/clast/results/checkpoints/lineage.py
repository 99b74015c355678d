"""Which runs have written the frames of a result file, one after the other.

Every run that begins a file, or goes on with one, has an identity of its own, which stands in the
file with the number of the frames before it, and in the run's checkpoints.  A checkpoint belongs to
a file where its run has written there and no other has gone on from an earlier frame.
"""

from __future__ import annotations

import json
from typing import Any
from uuid import uuid4

Lineage = tuple[tuple[str, int], ...]
"""Identity of each run, and the number of the frames in the file that it went on from."""
PLACE = "runs"
"""Attribute of a result file that has its lineage."""
LONGEST = 500
"""Most runs that are kept: an attribute of HDF5 has little room."""


def extended(lineage: Lineage, frames: int) -> Lineage:
    """Return the lineage of a file in which a new run goes on behind its first ``frames``."""
    kept = tuple(one for one in lineage if one[1] <= frames)
    return (*kept[1 - LONGEST :], (uuid4().hex, frames))


def belongs(lineage: Lineage, frames: int, file: Lineage) -> bool:
    """Return whether the first ``frames`` of a file are those of the last run of a lineage."""
    identities = [identity for identity, _ in file]
    if not lineage or lineage[-1][0] not in identities:
        return False
    at = identities.index(lineage[-1][0])
    later = [first for _, first in file[at + 1 :]]
    return file[at][1] <= frames <= min(later, default=frames)


def read_lineage(file: Any) -> Lineage:
    """Return the lineage in an open result file, nothing where there is none."""
    try:
        found = json.loads(file.attrs[PLACE])
        return tuple((str(identity), int(first)) for identity, first in found)
    except (KeyError, TypeError, ValueError, OSError, RecursionError):
        return ()


def write_lineage(file: Any, lineage: Lineage) -> None:
    """Write the lineage into an open result file."""
    file.attrs[PLACE] = json.dumps(lineage)
