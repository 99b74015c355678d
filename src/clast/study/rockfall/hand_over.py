"""A path handed over to a run of blocks, in which those that the rock strikes may move."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from clast.case.case_file import FALLING, Case
from clast.errors import CaseError
from clast.model.model import Floats
from clast.study.folder import StudyFolder, write_whole, writing
from clast.trajectory import path
from clast.trajectory.campaign import Campaign

FALLING_ROCK = "falling rock"
"""Name of the block, and of its rock, that falls in the run of blocks."""


def hand_over(folder: Path, number: int) -> Path:
    """Write the case in which a path's rock strikes blocks; return its file.

    The rock is a block at its first blow on a block that is not fixed, with its velocity and spin
    before the blow; the run is one per metre of thickness.  Raises CaseError where there is none.
    """
    there = StudyFolder.opened(folder)
    base, campaign = there.base, there.base.campaign()
    where = f"path {number}"
    if not 1 <= number <= campaign.count:
        remedy = f"paths are numbered from 1 to {campaign.count}"
        raise CaseError("there is no such path", where=where, remedy=remedy)
    if not base.has_blocks:
        what, remedy = "cannot be handed over: the case has no blocks", "give it the blocks, free"
        raise CaseError(what, where=where, remedy=remedy)
    struck = _first_on_free(campaign, number)
    if struck is None:
        what = "strikes no block that can move"
        raise CaseError(what, where=where, remedy="choose a path of blows.csv that strikes one")
    outline, velocity, density, block = struck
    content = _without_rockfall(base)
    rock = content["rock"][campaign.blocks.rock[block]] if campaign.blocks else {}
    content["rock"][FALLING_ROCK] = {**rock, "density": density}
    falling = {"name": FALLING_ROCK, "rock": FALLING_ROCK, "velocity": velocity.tolist()}
    blocks = [*content.get("block", []), {**falling, "vertices": outline.tolist()}]
    file = folder / f"path-{number}.toml"
    with writing(folder):
        write_whole(file, there.case_text({**content, "block": blocks}, back=""))
    return file


def _first_on_free(campaign: Campaign, number: int) -> tuple[Floats, Floats, float, int] | None:
    """Return outline, m, velocity and spin, density, and the block of the first such blow."""
    one, blocks = campaign.follow(number), campaign.blocks
    for row in one.course.records[: one.course.tally[0]]:
        face = int(row[path.FACE])
        block = int(campaign.face_block[face]) if face >= 0 else -1
        if blocks is None or row[path.KIND] != path.BLOW or block < 0 or blocks.fixed[block]:
            continue
        c, s = np.cos(row[path.ANGLE]), np.sin(row[path.ANGLE])
        turned = one.rock.corners @ np.array([[c, s], [-s, c]])
        outline = turned + row[[path.X, path.Y]] + campaign.origin
        density = float(one.rock.numbers[0]) / one.begun.volume
        return outline, row[path.BEFORE : path.AFTER], density, block
    return None


def _without_rockfall(base: Case) -> dict[str, Any]:
    """Return the content of a case without its tables of rockfall."""
    content = base.model_dump(by_alias=True, exclude_unset=True)
    return {key: one for key, one in content.items() if key not in ("rockfall", *FALLING)}
