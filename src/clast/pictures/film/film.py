"""A film of a run: which pictures, drawn, into one file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from clast.errors import CaseError
from clast.pictures.canvas import check_installed
from clast.pictures.film.encoders import ENCODERS
from clast.pictures.film.film_frames import FilmLook, FrameDrawer, Pixels
from clast.pictures.film.timing import frames_of, timing
from clast.results import Recording
from clast.rockmass.drawings.drawing_files import replaced_path

WIDTHS = {".mp4": 1280, ".webp": 960, ".gif": 720}
"""Width of a film without a size, pixels: an animated GIF holds all its pictures in memory."""
SLOWEST, FASTEST = 0.1, 240.0
"""Frames per second."""


@dataclass(frozen=True, kw_only=True)
class FilmSpeed:
    """How fast a film goes."""

    fps: float = 25.0
    """Frames per second."""
    speed: float | None = None
    """Time of the run in a second of the film, s: 1 for as fast as it happens; None for each frame
    in one picture."""

    def __post_init__(self) -> None:
        if not SLOWEST <= self.fps <= FASTEST:
            raise CaseError(
                f"{self.fps:g} pictures per second cannot be shown",
                where="fps",
                remedy=f"give {SLOWEST:g} to {FASTEST:g}",
            )
        if self.speed is not None and not (math.isfinite(self.speed) and self.speed > 0.0):
            raise CaseError(
                f"{self.speed:g} is not a valid speed",
                where="speed",
                remedy="give the simulated time per second of film, s, above 0",
            )


AS_IS = FilmLook()
EACH_FRAME = FilmSpeed()


def write_film(
    results: Recording,
    path: Path | str,
    *,
    stage: str | None = None,
    look: FilmLook = AS_IS,
    speed: FilmSpeed = EACH_FRAME,
    watch: Callable[[int, int], None] = lambda drawn, of: None,
) -> Path:
    """Write a film of a run, or of a stage of it, as .mp4, .webp or .gif; return its path.

    ``results`` are a run, or the content of a result file.  ``watch`` hears how many pictures of
    how many have been drawn.  The name ``path`` is taken when all of the film is written: nothing
    of it is left otherwise.  Raises CaseError for a stage, a field or a part that is not there, and
    where the film cannot be written.
    """
    check_installed()
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ENCODERS:
        raise CaseError(
            f"films cannot be written as '{path.suffix or path.name}'",
            where=str(path),
            remedy=f"end the name in one of: {', '.join(ENCODERS)}",
        )
    shown = timing(results.times, frames_of(results, stage), speed.fps, speed.speed)
    frames = [frame for frame, _ in shown]
    drawing = FrameDrawer(results, frames, look, WIDTHS[ending])

    def pictures() -> Iterator[Pixels]:
        for number, frame in enumerate(frames, 1):
            yield drawing.picture(frame)
            watch(number, len(frames))

    with replaced_path(path) as part:
        ENCODERS[ending](part, pictures(), [ticks for _, ticks in shown], speed.fps)
    return path
