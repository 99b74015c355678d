"""clast cut: a rock mass cut into blocks, as tables, files and pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from clast.cli.block_writers import BLOCK_WRITERS, Arrays, writer
from clast.cli.cut_tables import cut_content, cut_table, sets_table
from clast.cli.options import AsJson, CaseFile, Settings
from clast.cli.terminal import print_json, print_table, status, tell, warn

if TYPE_CHECKING:
    from clast.inputs.placing.place_rock_mass import CutCase


def cut(
    case: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Write the blocks (.dxf, .csv, .npz), a picture (.png, .svg, .pdf) or a report "
            "with pictures (.html).",
        ),
    ] = None,
    by: Annotated[
        Literal["set", "rock"], typer.Option(help="Colour the blocks of a picture by this.")
    ] = "set",
    settings: Settings = None,
    as_json: AsJson = False,
) -> None:
    """Cut the domain of a case into blocks, and report the blocks and all changes."""
    from clast.case.case_file import Case

    writers = {**WRITERS, **pictures(by, case.stem)}
    write = None if output is None else writer(output, writers)
    with status() as show:
        show("cutting")
        found = Case.from_toml(case, settings or ()).cut()
    if write is not None and output is not None:
        write(output, found)
    if as_json:
        print_json({**cut_content(found), "output": None if output is None else str(output)})
        return
    print_table(cut_table(found, case.stem))
    if found.cut.report.sets:
        print_table(sets_table(found))
    for note in found.notes:
        tell(f"note: {note}")
    warn(found.warnings)
    if output is not None:
        tell(f"wrote {output}")


# Files of blocks ---------------------------------------------------------------------------------

Writer = Callable[[Path, "CutCase"], None]


def _arrays(found: CutCase) -> Arrays:
    """Return blocks as the writers of files take them."""
    return {
        "vertices": found.cut.vertices,
        "block_start": found.cut.block_start,
        "rock": found.rocks,
        "edge_joint": found.edge_joints,
    }


def _of_cut(write: Callable[[Path, Arrays], None]) -> Writer:
    """Return the writer of the blocks of a cut, made from a writer of arrays."""

    def written(path: Path, found: CutCase) -> None:
        write(path, _arrays(found))

    return written


WRITERS: dict[str, Writer] = {ending: _of_cut(write) for ending, write in BLOCK_WRITERS.items()}
"""Ending of a file's name -> who writes the blocks of a cut to it."""


def pictures(by: Literal["set", "rock"], title: str) -> dict[str, Writer]:
    """Return who draws a cut: ending of a file's name -> function."""

    def picture(path: Path, found: CutCase) -> None:
        from clast.pictures.rock_mass import plot_cut

        plot_cut(found.cut, path, by=by, title=title)

    def report(path: Path, found: CutCase) -> None:
        from clast.pictures.rock_mass import write_cut_report

        write_cut_report(found.cut, path, title=title)

    return {".png": picture, ".svg": picture, ".pdf": picture, ".html": report}
