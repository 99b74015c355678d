"""Portions of paths, which are the runs of a study of rockfall."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from clast.model.model import Floats
from clast.rockmass.drawings.drawing_files import write_rows
from clast.study.description import ROCKFALL, Description
from clast.study.folder import ARRAYS, BLOWS, DONE, write_whole
from clast.trajectory import path
from clast.trajectory.campaign import Campaign, portion

PATHS = 50
"""Paths of a portion: a fifth of a second of work."""
BLOW_COLUMNS = (
    *("path", "time", "x", "y", "angle", "surface", "block"),
    *("vx_before", "vy_before", "spin_before", "vx_after", "vy_after", "spin_after", "lost"),
)


def study_of(campaign: Campaign) -> Description:
    """Return the study that follows all rocks of a campaign."""
    return Description(kind=ROCKFALL, n=-(-campaign.count // PATHS))


def paths_of(campaign: Campaign, run: int, part: Path) -> dict[str, Any]:
    """Return the result of a portion, from 1; write its arrays and its blows into a folder."""
    first = (run - 1) * PATHS + 1
    rows, arrays = portion(campaign, range(first, min(first + PATHS, campaign.count + 1)))
    content = BytesIO()
    np.savez_compressed(content, **arrays)
    write_whole(part / ARRAYS, content.getvalue())
    write_rows(part / BLOWS, blow_rows(campaign, arrays["records"]))
    files = {name: sha256((part / name).read_bytes()).hexdigest() for name in (ARRAYS, BLOWS)}
    return {"status": DONE, "rows": rows, "files": files}


def blow_rows(campaign: Campaign, records: Floats) -> Iterator[list[Any]]:
    """Give the rows of the table of blows, in the order of paths and times."""
    blows = records[records[:, 1 + path.KIND] == path.BLOW]
    values = blows[:, 1:]
    place = values[:, [path.CLOCK, path.X, path.Y, path.ANGLE]]
    place[:, 1:3] += campaign.origin
    place[:, 3] = np.degrees(place[:, 3])
    rest = values[:, [*range(path.BEFORE, path.FACE), path.LOST]]
    numbers, faces, barriers = (
        column.astype(np.int64).tolist()
        for column in (blows[:, 0], values[:, path.FACE], values[:, path.BARRIER])
    )
    surfaces = [campaign.surfaces[k] for k in campaign.ground.surface.tolist()]
    columns = zip(numbers, place.tolist(), faces, barriers, rest.tolist(), strict=True)
    for number, where, face, barrier, moves in columns:
        named = campaign.barriers[barrier] if barrier >= 0 else surfaces[face]
        yield [number, *where, named, campaign.block_of(face), *moves]
