"""Films of runs: axes, legend and colour bar are drawn once, blocks anew in each picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas, draw_blocks
from clast.pictures.encoders import ENCODERS, Pixels
from clast.pictures.fields import check_field
from clast.pictures.figure_options import CM, Look
from clast.pictures.frames import FrameDrawing
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.layers import draw_scale_bar
from clast.results import Recording
from clast.rockmass.drawings.drawing_files import replaced_path

DOTS = 100
"""Dots per inch: type of 9 points is 12.5 pixels high."""
STEEPEST = 0.75
"""Height over width of a film at most, where neither is asked for."""
SCALE_FRAMES_MAX = 60
"""Frames at most from which the ends of the colours follow."""
LEAST, MOST = 320, 3840
"""Width and height of a film, pixels."""
WIDTHS = {".mp4": 1280, ".webp": 960, ".gif": 720}
"""Width of a film without a size, pixels: an animated GIF holds all its pictures in memory."""
SLOWEST, FASTEST = 0.1, 240.0
"""Frames per second."""
PICTURES_MAX = 100_000
"""Pictures of a film: an hour at 25 a second."""
ROUNDING = 1e-9
"""Share of the time between two pictures by which a frame may lie after its picture."""


@dataclass(frozen=True, kw_only=True)
class FilmLook:
    """The part of a run that a film shows, its size and its colours."""

    field: str = "displacement"
    """The quantity that colours the blocks; "joint": their edges, "slip" and "opening": their
    joints."""
    size: tuple[float, ...] | None = None
    """Width and height, or the width alone, pixels."""
    zoom: tuple[float, float, float, float] | None = None
    """Part that is shown: xmin, ymin, xmax, ymax, m; None for all that blocks pass through."""
    limits: tuple[float, float] | None = None
    """Values at the ends of the colours, in m, m/s, degrees or Pa; None for those of all frames."""

    def __post_init__(self) -> None:
        check_field(self.field, JOINT_FIELDS)
        for length in self.size or ():
            if not LEAST <= length <= MOST:
                raise CaseError(
                    f"{length:g} pixels are too {'few' if length < LEAST else 'many'}",
                    where="size",
                    remedy=f"give width and height in pixels, {LEAST} to {MOST} each",
                )
        self.of_picture(LEAST)

    def of_picture(self, *pixels: float) -> Look:
        """Return the look of a picture of a width, or a width and a height, in pixels."""
        size = tuple(length / DOTS / CM for length in pixels)
        return Look(limits=self.limits, zoom=self.zoom, size=size, dpi=DOTS)


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
    canvas.check_installed()
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ENCODERS:
        raise CaseError(
            f"films cannot be written as '{path.suffix or path.name}'",
            where=str(path),
            remedy=f"end the name in one of: {', '.join(ENCODERS)}",
        )
    shown = timing(results.times, frames_of(results, stage), speed)
    frames = [frame for frame, _ in shown]
    drawer = FrameDrawer(results, frames, look, WIDTHS[ending])

    def pictures() -> Iterator[Pixels]:
        for number, frame in enumerate(frames, 1):
            yield drawer.picture(frame)
            watch(number, len(frames))

    with replaced_path(path) as part:
        ENCODERS[ending](part, pictures(), [ticks for _, ticks in shown], speed.fps)
    return path


def frames_of(results: Recording, stage: str | None) -> Sequence[int]:
    """Return the numbers of all frames, or of those of a stage, from the state that it begins with.

    Raises CaseError for a stage that the run does not have.
    """
    if stage is None:
        return range(len(results.times))
    last = results.frame(-1, stage=stage).number
    return range(max(0, results.frame_stages.index(stage) - 1), last + 1)


def timing(times: Floats, frames: Sequence[int], speed: FilmSpeed) -> tuple[tuple[int, int], ...]:
    """Return which of the frames are shown, one after the other, and for how many ticks of 1/fps s.

    Without a speed each frame is one picture.  With it each picture shows the last frame that is
    not after its time: frames are left out where they are closer together than pictures, and stand
    still where they are further apart.  ``times`` are those of all frames of the run, s.  Raises
    CaseError for a film that would be too long.
    """
    if speed.speed is None:
        _check_length(len(frames), speed)
        return tuple((frame, 1) for frame in frames)
    at = np.asarray(times, np.float64)[np.asarray(frames)]
    between = speed.speed / speed.fps
    pictures = math.floor((at[-1] - at[0]) / between + ROUNDING) + 1
    _check_length(pictures, speed)
    shown = at[0] + between * np.arange(pictures)
    # of several frames at one time, as where a stage begins, the last
    place = np.searchsorted(at, shown + ROUNDING * between, side="right") - 1
    return tuple((frames[k], len(list(same))) for k, same in groupby(place.tolist()))


def _check_length(pictures: float, speed: FilmSpeed) -> None:
    if pictures > PICTURES_MAX:
        action = "give a larger one" if speed.speed else "write fewer frames, or give a speed"
        minutes = pictures / speed.fps / 60
        raise CaseError(
            f"the film would have {pictures:,.0f} pictures and last {minutes:,.0f} min",
            where="speed",
            remedy=f"{action}: {PICTURES_MAX:,} pictures at most",
        )


class FrameDrawer:
    """Draws frames of a run alike: part, colours and legend are those of the whole film."""

    def __init__(
        self, results: Recording, frames: Sequence[int], look: FilmLook, width: int
    ) -> None:
        """Lay out pictures of some frames, ``width`` pixels wide unless the look has a size."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import PolyCollection

        self._results = results
        self._drawing = FrameDrawing(results, frames, look.field, look.zoom)
        some = [*frames[: -1 : -(-len(frames) // SCALE_FRAMES_MAX)], frames[-1]]
        sheet, box, keys = self._sheet(self._drawing.handles(frames[-1]), look, width)
        self._seen = canvas.seen(*self._drawing.part, box)
        self._figure = canvas.new_figure(_even(sheet.size), DOTS)
        agg: Any = FigureCanvasAgg(self._figure)
        self._canvas = agg
        self._axes = self._figure.add_axes(sheet.share(sheet.axes))
        canvas.view(self._axes, *self._seen, box)
        canvas.head(self._figure, sheet.axes[0], sheet.title, "")
        keys.draw(self._figure, sheet)
        self._scale = self._drawing.scale(some, self._seen, look.limits)
        if self._scale is not None:
            sample = PolyCollection([])
            label = self._drawing.paint(sample, np.zeros(0), self._scale)
            extend = self._scale.extend
            draw_blocks.draw_colour_bar(self._figure, sheet, sample, label, extend)
        draw_scale_bar(self._figure, sheet, self._seen)
        self._clock = self._figure.text(
            sheet.axes[0] / sheet.size[0],
            1.0 - (0.1 + canvas.LINE * (len(sheet.title) + 0.5)) / sheet.size[1],
            "",
            fontsize=canvas.TEXT_SIZE,
            color=canvas.INK,
            va="center",
            animated=True,
        )
        self._canvas.draw()
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)
        self._standing = frozenset(self._axes.get_children())

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels; both are even, as films need it."""
        width, height = self._canvas.get_width_height()
        return int(width), int(height)

    def picture(self, frame: int) -> Pixels:
        """Return the picture of a frame."""
        self._canvas.restore_region(self._ground)
        self._drawing.draw(self._axes, frame, self._seen, self._scale)
        moving = [artist for artist in self._axes.get_children() if artist not in self._standing]
        for artist in sorted(moving, key=lambda one: float(one.get_zorder())):
            self._axes.draw_artist(artist)
            artist.remove()
        self._clock.set_text(_time(self._results, frame))
        self._figure.draw_artist(self._clock)
        return np.array(self._canvas.buffer_rgba(), np.uint8)

    def _sheet(
        self, handles: list[Any], look: FilmLook, width: int
    ) -> tuple[canvas.Sheet, tuple[float, float], canvas.Keys]:
        """Return the sheet, the size of its axes, inches, and its legend."""
        title = self._results.title or self._results.name
        part, bars = self._drawing.part, int(self._drawing.has_scale)

        def laid_out(*pixels: float) -> tuple[canvas.Sheet, tuple[float, float], canvas.Keys]:
            box, keys, narrowest = canvas.sizes(
                part, look.of_picture(*pixels), title, handles, bars, 1
            )
            return canvas.sheet_for(box, title, keys.lines + 1, bars, narrowest), box, keys

        layout = laid_out(*(look.size or (width,)))
        high = layout[0].size[1] > STEEPEST * layout[0].size[0]
        return laid_out(width, round(STEEPEST * width)) if high and not look.size else layout


def _even(size: tuple[float, float]) -> tuple[float, float]:
    """Return a size in inches whose pixels are even numbers."""
    width, height = (2 * max(1, round(DOTS * length / 2)) / DOTS for length in size)
    return width, height


def _time(results: Recording, frame: int) -> str:
    """Return the text of the clock: digits that do not jump about, and the stage."""
    stage = results.frame(frame).stage
    last = float(results.times[-1])
    digits = int(np.clip(3 - np.floor(np.log10(last)), 0, 6)) if last > 0.0 else 3
    text = f"t = {results.times[frame]:.{digits}f} s"
    return f"{text}, stage {canvas.literal(stage)}" if stage else text
