"""Films of runs as MP4 by ffmpeg, and as GIF or WebP by Pillow.

Axes, legend and colour bar are drawn once, blocks anew in each picture.
"""

from __future__ import annotations

import math
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, groupby
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal, TypeAlias, cast

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas, draw_blocks
from clast.pictures.fields import check_field
from clast.pictures.figure_options import CM, Look
from clast.pictures.frames import FrameDrawing
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.layers import draw_scale_bar
from clast.results import Recording
from clast.rockmass.drawings.drawing_files import replaced_path

if TYPE_CHECKING:
    from PIL import Image

DOTS = 100
"""Dots per inch: type of 9 points is 12.5 pixels high."""
STEEPEST = 0.75
"""Height over width of a film at most, where neither is asked for."""
LEAST, MOST = 320, 3840
"""Width and height of a film, pixels."""
WIDTHS = {".mp4": 1280, ".webp": 960, ".gif": 720}
"""Width of a film without a size, pixels: an animated GIF holds all its pictures in memory."""
SLOWEST, FASTEST = 0.1, 240.0
"""Frames per second."""
PICTURES_MAX = 100_000
"""Pictures of a film: an hour at 25 a second."""


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
    water: bool = True
    """Whether levels and pressures of water are drawn."""
    magnify: float | Literal["auto"] = 1.0
    """Factor of displacements from the start; "auto": one with which they are seen."""

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
        words: dict[str, Any] = {"water": self.water, "magnify": self.magnify}
        return Look(limits=self.limits, zoom=self.zoom, size=size, dpi=DOTS, **words)


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


GIF_RATE_MAX, GIF_COLOURS = 50.0, 255
"""Pictures a second in a GIF, as browsers slow down faster ones, and its colours beside that of
paper, which Pillow would make a light grey."""

Pixels: TypeAlias = np.ndarray[Any, np.dtype[np.uint8]]
"""A picture: rows from above, pixels, red green blue alpha, shape (height, width, 4)."""
Encoder = Callable[[Path, Iterator[Pixels], Sequence[int], float], None]
"""Writes pictures into a file, each for a number of ticks, so many ticks a second."""


def ffmpeg() -> str:
    """Return the program ffmpeg: that of the machine, or of the package imageio-ffmpeg."""
    if program := shutil.which("ffmpeg"):
        return program
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise CaseError(
            "MP4 needs the program ffmpeg, which is not installed",
            remedy="install it, or: pip install 'clast[film]'; GIF and WebP need no other program",
        ) from None


def write_mp4(path: Path, pictures: Iterator[Pixels], ticks: Sequence[int], fps: float) -> None:
    """Write H.264 that browsers and slides play."""
    program = ffmpeg()
    first = next(pictures)
    height, width = first.shape[:2]
    command = [program, "-nostdin", "-loglevel", "error", "-y"]
    command += ["-f", "rawvideo", "-pix_fmt", "rgba", "-video_size", f"{width}x{height}"]
    command += ["-framerate", f"{fps:.9g}", "-i", "pipe:0", "-an"]
    command += ["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p"]
    command += ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]
    # a constant rate factor of 18 shows no loss in drawings
    command += ["-c:v", "libx264", "-preset", "veryfast", "-crf", "18"]
    command += ["-movflags", "+faststart", "-f", "mp4", str(path.absolute())]
    with tempfile.TemporaryFile() as log:
        # a session of its own: Ctrl-C is for clast, which ends it in order
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=log, stderr=log, start_new_session=True
        )
        try:
            # where ffmpeg has ended, its own words say why
            with suppress(BrokenPipeError), cast("IO[bytes]", process.stdin) as pipe:
                for picture, times in zip(chain([first], pictures), ticks, strict=True):
                    for _ in range(times):
                        pipe.write(picture.data)
            ended = process.wait()
        except BaseException:
            process.kill()
            process.wait()
            raise
        if ended != 0:
            log.seek(0)
            lines = log.read().decode("utf-8", "replace").strip().splitlines()
            raise OSError(f"ffmpeg ended with {ended}: {lines[-1] if lines else 'no reason given'}")


def write_gif(path: Path, pictures: Iterator[Pixels], ticks: Sequence[int], fps: float) -> None:
    """Write an animated GIF that goes round; its colours are those of the first picture."""
    from PIL import Image

    if fps > GIF_RATE_MAX:
        raise CaseError(
            f"a GIF shows {GIF_RATE_MAX:g} pictures per second at most",
            where="fps",
            remedy="give fewer, or write .mp4 or .webp",
        )
    first = _image(next(pictures))
    palette = first.quantize(GIF_COLOURS, dither=Image.Dither.NONE)
    colours = [*(palette.getpalette() or [])[: 3 * GIF_COLOURS], 255, 255, 255]

    def reduced(image: Image.Image) -> Image.Image:
        numbers = np.array(image.quantize(palette=palette, dither=Image.Dither.NONE))
        numbers[np.asarray(image).min(axis=2) == 255] = GIF_COLOURS
        image = Image.fromarray(numbers, "P")
        image.putpalette(colours)
        return image

    more = (reduced(_image(picture)) for picture in pictures)
    looks: dict[str, Any] = {"duration": _durations(ticks, fps, 10), "optimize": False}
    _save(reduced(first), more, path, "GIF", **looks)


def write_webp(path: Path, pictures: Iterator[Pixels], ticks: Sequence[int], fps: float) -> None:
    """Write an animated WebP that goes round."""
    looks: dict[str, Any] = {"duration": _durations(ticks, fps, 1), "quality": 90, "method": 1}
    _save(_image(next(pictures)), map(_image, pictures), path, "WEBP", **looks)


def _save(
    first: Image.Image, more: Iterator[Image.Image], path: Path, kind: str, **looks: Any
) -> None:
    first.save(path, format=kind, save_all=True, append_images=more, loop=0, **looks)


def _image(picture: Pixels) -> Image.Image:
    from PIL import Image

    return Image.fromarray(picture).convert("RGB")


def _durations(ticks: Sequence[int], fps: float, unit: int) -> list[int]:
    """Return how long each picture is shown, ms, in multiples of ``unit``, none of it lost."""
    ends = np.round(np.cumsum([0, *ticks]) * (1000.0 / fps / unit)).astype(int)
    return [int(unit * length) for length in np.diff(ends)]


ENCODERS: dict[str, Encoder] = {".mp4": write_mp4, ".gif": write_gif, ".webp": write_webp}
"""Ending of a name -> the writer of such a film."""


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
    """Return the numbers of all frames, or of those of a stage, from the state it begins with."""
    if stage is None:
        return range(len(results.times))
    last = results.frame(-1, stage=stage).number
    return range(max(0, results.frame_stages.index(stage) - 1), last + 1)


def timing(times: Floats, frames: Sequence[int], speed: FilmSpeed) -> tuple[tuple[int, int], ...]:
    """Return which of the frames are shown, one after the other, and for how many ticks of 1/fps s.

    Without a speed each frame is one picture.  With it each picture shows the last frame that is
    not after its time.  ``times`` are those of all frames of the run, s.
    """
    if speed.speed is None:
        _check_length(len(frames), speed)
        return tuple((frame, 1) for frame in frames)
    at = np.asarray(times, np.float64)[np.asarray(frames)]
    between = speed.speed / speed.fps
    pictures = math.floor((at[-1] - at[0]) / between + 1e-9) + 1
    _check_length(pictures, speed)
    shown = at[0] + between * np.arange(pictures)
    # of several frames at one time, as where a stage begins, the last
    place = np.searchsorted(at, shown + 1e-9 * between, side="right") - 1
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
        self._drawing = FrameDrawing(results, frames, look.field, look.of_picture(width))
        some = [*frames[: -1 : -(-len(frames) // 60)], frames[-1]]
        part, bars = self._drawing.part, int(self._drawing.has_scale)

        def lay_out(*pixels: float) -> tuple[canvas.Sheet, canvas.Keys]:
            title, handles = results.title or results.name, self._drawing.handles(frames[-1])
            return canvas.lay_out(part, look.of_picture(*pixels), title, handles, bars, 1)

        sheet, keys = lay_out(*(look.size or (width,)))
        if sheet.size[1] > STEEPEST * sheet.size[0] and not look.size:
            sheet, keys = lay_out(width, round(STEEPEST * width))
        self._seen = canvas.seen(*part, sheet.room)
        # films need even numbers of pixels
        across, up = (2 * max(1, round(DOTS * inches / 2)) / DOTS for inches in sheet.size)
        self._figure = canvas.new_figure((across, up), DOTS)
        agg: Any = FigureCanvasAgg(self._figure)
        self._canvas = agg
        self._axes = self._figure.add_axes(sheet.parts(sheet.axes))
        canvas.view(self._axes, *self._seen, sheet.room)
        canvas.head(self._figure, sheet.axes[0], sheet.title, "")
        keys.draw(self._figure, sheet)
        self._scale = self._drawing.scale(some, self._seen, look.limits)
        if self._scale is not None:
            sample = PolyCollection([])
            label = self._drawing.paint(sample, np.zeros(0), self._scale)
            extend = self._scale.extend
            draw_blocks.draw_colour_bar(self._figure, sheet, sample, label, extend)
        draw_scale_bar(self._figure, sheet, self._seen)
        top = 1.0 - (0.1 + canvas.LINE * (len(sheet.title) + 0.5)) / sheet.size[1]
        looks: dict[str, Any] = {"va": "center", "animated": True, **canvas.TEXT}
        self._clock = self._figure.text(sheet.axes[0] / sheet.size[0], top, "", **looks)
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


def _time(results: Recording, frame: int) -> str:
    """Return the text of the clock: digits that do not jump about, and the stage."""
    stage = results.frame(frame).stage
    last = float(results.times[-1])
    digits = int(np.clip(3 - np.floor(np.log10(last)), 0, 6)) if last > 0.0 else 3
    text = f"t = {results.times[frame]:.{digits}f} s"
    return f"{text}, stage {canvas.literal(stage)}" if stage else text
