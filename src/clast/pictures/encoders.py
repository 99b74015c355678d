"""Pictures one after the other into a file: MP4 by ffmpeg, GIF and WebP by Pillow."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from clast.errors import CaseError

if TYPE_CHECKING:
    from PIL import Image

QUALITY = 18
"""Constant rate factor of H.264: 18 shows no loss in drawings, 23 is smaller."""
FASTEST_GIF = 50.0
"""Pictures a second in a GIF at most: browsers slow down faster ones."""
COLOURS = 255
"""Colours of a GIF beside that of paper, which Pillow would make a light grey."""

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
    """Write H.264 that browsers and slides play.

    Raises OSError where ffmpeg ends before all is written, as on a full disk.
    """
    program = ffmpeg()
    first = next(pictures)
    height, width = first.shape[:2]
    command = [program, "-nostdin", "-loglevel", "error", "-y"]
    command += ["-f", "rawvideo", "-pix_fmt", "rgba", "-video_size", f"{width}x{height}"]
    command += ["-framerate", f"{fps:.9g}", "-i", "pipe:0", "-an"]
    command += ["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p"]
    command += ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]
    command += ["-c:v", "libx264", "-preset", "veryfast", "-crf", str(QUALITY)]
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
    """Write an animated GIF that goes round; its colours are those of the first picture.

    That one holds the colour bar and the legend, and so all colours.
    """
    from PIL import Image

    if fps > FASTEST_GIF:
        raise CaseError(
            f"a GIF shows {FASTEST_GIF:g} pictures per second at most",
            where="fps",
            remedy="give fewer, or write .mp4 or .webp",
        )
    first = _image(next(pictures))
    palette = first.quantize(COLOURS, dither=Image.Dither.NONE)
    colours = [*(palette.getpalette() or [])[: 3 * COLOURS], 255, 255, 255]

    def reduced(image: Image.Image) -> Image.Image:
        numbers = np.array(image.quantize(palette=palette, dither=Image.Dither.NONE))
        numbers[np.asarray(image).min(axis=2) == 255] = COLOURS
        image = Image.fromarray(numbers, "P")
        image.putpalette(colours)
        return image

    more = (reduced(_image(picture)) for picture in pictures)
    looks = {"duration": _durations(ticks, fps, 10), "optimize": False}
    _save(reduced(first), more, path, "GIF", **looks)


def write_webp(path: Path, pictures: Iterator[Pixels], ticks: Sequence[int], fps: float) -> None:
    """Write an animated WebP that goes round."""
    looks = {"duration": _durations(ticks, fps, 1), "quality": 90, "method": 1}
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
