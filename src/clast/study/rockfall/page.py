"""The scene of the page of rockfall: paths as records, with closed forms between them."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.study.rockfall_page import write_rocks
from clast.study.folder import StudyFolder, writing
from clast.study.rockfall.results import RockfallResults
from clast.trajectory import path

SHOWN = 300
"""Paths of the page, at most: the first ones."""
DIGITS = 4
"""Decimals of lengths, m, times, s, and angles, rad."""
COLUMNS = (path.CLOCK, path.X, path.Y, path.ANGLE, *range(path.AFTER, path.FACE))


def write_page(results: RockfallResults, target: Path | None = None) -> Path:
    """Write the page, paths.html in the folder of the results if no other; return its path."""
    campaign, origin = results.campaign, results.campaign.origin
    standing = campaign.blocks.outline if campaign.blocks else ()
    scene = {
        "title": StudyFolder.opened(results.folder).base.title or "Rockfall",
        "gravity": campaign.gravity.tolist(),
        "profile": [_rounded(campaign.profile + origin)],
        "blocks": [_rounded(one + origin) for one in standing],
        "barriers": [_rounded(one + origin) for one in campaign.barrier_lines],
        "paths": [
            _path(results, row, records)
            for row, records in enumerate(islice(results.courses(), SHOWN))
        ],
    }
    with writing(results.folder):
        return write_rocks(scene, target or results.folder / "paths.html")


def _path(results: RockfallResults, row: int, records: Floats) -> dict[str, Any]:
    """Return the rock and the records of a path: time, place, angle, velocities, whether it flies.

    The last column is 0 where a rock moves in contact up to the next record.
    """
    number = results.paths["path"][row]
    rock = results.campaign.begin(number).rock
    rows = records[:, COLUMNS].copy()
    rows[:, 1:3] += results.campaign.origin
    flies = (records[:, path.KIND] != path.ON_GROUND).astype(np.float64)
    return {
        "number": number,
        "source": results.paths["source"][row],
        "end": results.paths["end"][row],
        "mass": float(rock.numbers[0]),
        "inertia": float(rock.numbers[1]),
        "corners": _rounded(rock.corners),
        "rows": _rounded(np.column_stack([rows, flies])),
    }


def _rounded(values: Floats) -> list[Any]:
    """Return numbers as the page has them."""
    kept: list[Any] = np.round(values, DIGITS).tolist()
    return kept
