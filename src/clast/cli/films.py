"""The command that writes films."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clast.cli.options import Limits, ResultFile, Zoom, numbers
from clast.cli.terminal import counting, tell


def film(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Argument(metavar="OUT.mp4", help=".mp4, .webp or .gif; FILE with .mp4 if absent."),
    ] = None,
    field: Annotated[
        str,
        typer.Option(help="Colour of the blocks or joints, as of clast plot."),
    ] = "displacement",
    stage: Annotated[str | None, typer.Option(metavar="NAME", help="Show only this stage.")] = None,
    fps: Annotated[float, typer.Option(metavar="N", help="Frames per second.")] = 25.0,
    speed: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="Simulated time per second of film, s: 1 is real time. If "
            "absent, every frame is one picture.",
        ),
    ] = None,
    limits: Limits = "",
    zoom: Zoom = "",
    size: Annotated[
        str, typer.Option(metavar="W[,H]", help="Width and height, pixels; about 1280 if absent.")
    ] = "",
) -> None:
    """Write a film of a run; MP4 needs the program ffmpeg."""
    from clast.pictures.film import FilmLook, FilmSpeed, write_film
    from clast.results import read_results

    look = FilmLook(
        field=field,
        size=numbers("--size", size, 1, 2),
        zoom=numbers("--zoom", zoom, 4),
        limits=numbers("--limits", limits, 2),
    )
    pace = FilmSpeed(fps=fps, speed=speed)
    target = output or file.with_suffix(".mp4")
    results = read_results(file)
    with counting("drawing") as watch:
        write_film(results, target, stage=stage, look=look, speed=pace, watch=watch)
    tell(f"film: {target} ({target.stat().st_size / 1e6:.3g} MB)")
