"""Which frame of a run a film shows when."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.results import Recording

MOST_PICTURES = 100_000
"""Pictures of a film at most: an hour at 25 a second."""
ROUNDING = 1e-9
"""Share of the time between two pictures by which a frame may lie after its picture."""

Shown = tuple[tuple[int, int], ...]
"""Number of each frame that is shown, and for how many ticks; a tick is 1/fps s of the film."""


def frames_of(results: Recording, stage: str | None) -> Sequence[int]:
    """Return the numbers of all frames, or of those of a stage, from the state that it begins with.

    Raises CaseError for a stage that the run does not have.
    """
    if stage is None:
        return range(len(results.times))
    last = results.frame(-1, stage=stage).number
    first = results.frame_stages.index(stage)
    return range(max(0, first - 1), last + 1)


def timing(times: Floats, frames: Sequence[int], fps: float, speed: float | None) -> Shown:
    """Return which of the frames are shown, one after the other, and for how many pictures.

    Without a ``speed`` each frame is one picture.  With it, s of the run in a second of the film,
    each picture shows the last frame that is not after its time: frames are left out where they
    are closer together than pictures, and stand still where they are further apart.  ``times``
    are those of all frames of the run, s.  Raises CaseError for a film that would be too long.
    """
    if speed is None:
        _check_length(len(frames), fps, speed)
        return tuple((frame, 1) for frame in frames)
    own = np.asarray(times, np.float64)[np.asarray(frames)]
    between = speed / fps
    pictures = math.floor((own[-1] - own[0]) / between + ROUNDING) + 1
    _check_length(pictures, fps, speed)
    at = own[0] + between * np.arange(pictures)
    # of several frames at one time, as where a stage begins, the last
    place = np.searchsorted(own, at + ROUNDING * between, side="right") - 1
    return tuple((frames[k], len(list(same))) for k, same in groupby(place.tolist()))


def _check_length(pictures: float, fps: float, speed: float | None) -> None:
    if pictures > MOST_PICTURES:
        way = "write fewer frames, or give a speed" if speed is None else "give a larger one"
        raise CaseError(
            f"the film would have {pictures:,.0f} pictures and last {pictures / fps / 60:,.0f} min",
            where="speed",
            remedy=f"{way}: {MOST_PICTURES:,} pictures at most",
        )
