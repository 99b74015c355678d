"""Portions of paths, which are the runs of a study of rockfall."""

from __future__ import annotations

from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from clast.study.description import ROCKFALL, Description
from clast.study.folder import ARRAYS, DONE, write_whole
from clast.trajectory.campaign import Campaign, portion

PATHS = 50
"""Paths of a portion: a fifth of a second of work."""


def study_of(campaign: Campaign) -> Description:
    """Return the study that follows all rocks of a campaign."""
    return Description(kind=ROCKFALL, n=-(-campaign.count // PATHS))


def paths_of(campaign: Campaign, run: int, part: Path) -> dict[str, Any]:
    """Return the result of a portion, from 1, and write its arrays into the folder ``part``."""
    first = (run - 1) * PATHS + 1
    rows, arrays = portion(campaign, range(first, min(first + PATHS, campaign.count + 1)))
    content = BytesIO()
    np.savez_compressed(content, **arrays)
    write_whole(part / ARRAYS, content.getvalue())
    return {"status": DONE, "rows": rows, "arrays": sha256(content.getvalue()).hexdigest()}
