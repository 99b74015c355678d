"""The command that writes results for other programs: export."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from clast.cli.options import FrameNumber, FrameTime, ResultFile, StageName, frame_asked, words
from clast.cli.terminal import tell
from clast.errors import CaseError

if TYPE_CHECKING:
    from clast.results import Results

Frames = Sequence[int] | None
"""Numbers of frames; None for all."""


@dataclass(frozen=True, kw_only=True)
class _Form:
    """A form in which results are written."""

    write: Callable[[Results, Path, Frames, Sequence[str]], list[Path]]
    """Writes some frames and tables to a path; returns the paths of all files."""
    one: str
    """Ending of the name for one frame."""
    several: str
    """Ending of the name for several frames."""
    frames: Frames
    """The default frames."""


def export(
    file: ResultFile,
    to: Annotated[
        Literal["csv", "vtu", "dxf"],
        typer.Option(help="Tables in a folder, polygons for ParaView, or drawings."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File, or folder of tables; named as FILE if absent."),
    ] = None,
    frame: FrameNumber = None,
    time: FrameTime = None,
    stage: StageName = None,
    every: Annotated[
        bool, typer.Option("--all", help="Write all frames, as csv and vtu do anyway.")
    ] = False,
    tables: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help="Only these of blocks, vertices, contacts, histories, measured_contacts, linings, "
            "links, reactions, bolts, energy, steps, stages, events.",
        ),
    ] = "",
) -> None:
    """Write frames and histories of a result file for other programs."""
    from clast.results import read_results

    form = FORMS[to]
    named = any(one is not None for one in (frame, time, stage))
    if named and every:
        raise CaseError(
            "a frame and --all are both given", where="--all", remedy="leave one of them out"
        )
    if tables and to != "csv":
        raise CaseError(
            f"{to} has no tables", where="--tables", remedy="leave it out: --to csv has"
        )
    results = read_results(file)
    frames = None if every else form.frames
    if named:
        frames = [frame_asked(results, frame, time, stage)]
    count = len(results.times) if frames is None else len(frames)
    ending = form.one if count == 1 else form.several
    written = form.write(
        results, output or file.with_name(f"{file.stem}{ending}"), frames, words(tables)
    )
    tell(f"wrote {written[0]}" + (f" and {len(written) - 1} more" if len(written) > 1 else ""))


def _csv(results: Results, path: Path, frames: Frames, tables: Sequence[str]) -> list[Path]:
    from clast.exports import TABLES, write_csv

    written = write_csv(results, path, frames, tables or None)
    missing = {*(tables or TABLES)} - {file.stem for file in written}
    # most systems have none of these, and nobody misses them
    present = {
        "bolts": results.bolt_name,
        "links": results.link_name,
        "linings": results.lining_joint_name,
        "measured_contacts": results.measured_contact_name,
        "stages": results.frame_stages,
        "events": results.events,
    }
    missing -= {name for name, found in present.items() if not found}
    if missing:
        tell(f"left out, nothing is recorded of: {', '.join(sorted(missing))}")
    return written


def _vtu(results: Results, path: Path, frames: Frames, _: Sequence[str]) -> list[Path]:
    from clast.exports import write_vtu

    return write_vtu(results, path, frames)


def _dxf(results: Results, path: Path, frames: Frames, _: Sequence[str]) -> list[Path]:
    from clast.exports import write_dxf

    return write_dxf(results, path, frames)


FORMS = {
    "csv": _Form(write=_csv, one="-tables", several="-tables", frames=None),
    "vtu": _Form(write=_vtu, one=".vtu", several=".pvd", frames=None),
    "dxf": _Form(write=_dxf, one=".dxf", several=".dxf", frames=(-1,)),
}
"""Name of a form -> how it is written."""
