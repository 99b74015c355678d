"""clast cut: a rock mass cut into blocks, as tables, files and pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

import typer

from clast.cli.options import AsJson, CaseFile, Settings
from clast.cli.terminal import print_json, print_table, status, tell, warn
from clast.cli.terminal_tables import cut_content, cut_table, sets_table
from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.inputs.placing.place_rock_mass import CutCase

Arrays = Mapping[str, Any]
"""vertices, block_start, rock and edge_joint, as the writers of files take them."""
Blocks = TypeVar("Blocks")


def _write_blocks(path: Path, blocks: Arrays) -> None:
    from clast.rockmass.drawings import blocks_out

    if path.suffix.casefold() == ".dxf":
        # names of layers have no colons
        joints = [name.replace(":", "-") for name in blocks["edge_joint"]]
        blocks_out.write_blocks_dxf(path, **{**blocks, "edge_joint": joints})
    elif path.suffix.casefold() == ".csv":
        blocks_out.write_blocks_csv(path, **blocks)
    else:
        blocks_out.write_blocks_npz(path, **blocks)


BLOCK_WRITERS = dict.fromkeys((".dxf", ".csv", ".npz"), _write_blocks)
"""Ending of a file's name -> who writes blocks to it."""


def writer(
    path: Path, writers: Mapping[str, Callable[[Path, Blocks], None]]
) -> Callable[[Path, Blocks], None]:
    """Return the writer for a file with that name; CaseError where there is none."""
    write = writers.get(path.suffix.casefold())
    if write is None:
        ending = shortened(path.suffix) or "nothing"
        raise CaseError(
            f"ends in {ending}, which is not a known format",
            where=str(path),
            remedy=f"use a name ending in {', '.join(writers)}",
        )
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="create it first")
    return write


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
    """Cut a rock mass into blocks. Reports the blocks and all changes on the way."""
    from clast.case.case_file import Case

    writers = {**WRITERS, **pictures(by, case.stem)}
    write = None if output is None else writer(output, writers)
    with status() as show:
        show("cutting")
        result = Case.from_toml(case, settings or ()).cut()
    if write is not None and output is not None:
        write(output, result)
    if as_json:
        print_json({**cut_content(result), "output": None if output is None else str(output)})
        return
    print_table(cut_table(result, case.stem))
    if result.cut.report.sets:
        print_table(sets_table(result))
    for note in result.notes:
        tell(f"note: {note}")
    warn(result.warnings)
    if output is not None:
        tell(f"wrote {output}")


# Files of blocks ---------------------------------------------------------------------------------

Writer = Callable[[Path, "CutCase"], None]


def _write_cut(path: Path, result: CutCase) -> None:
    arrays = {
        "vertices": result.cut.vertices,
        "block_start": result.cut.block_start,
        "rock": result.rocks,
        "edge_joint": result.edge_joints,
    }
    _write_blocks(path, arrays)


WRITERS: dict[str, Writer] = dict.fromkeys(BLOCK_WRITERS, _write_cut)
"""Ending of a file's name -> who writes the blocks of a cut to it."""


def pictures(by: Literal["set", "rock"], title: str) -> dict[str, Writer]:
    """Return who draws a cut: ending of a file's name -> function."""

    def picture(path: Path, result: CutCase) -> None:
        from clast.pictures.rock_mass import plot_cut

        plot_cut(result.cut, path, by=by, title=title)

    def report(path: Path, result: CutCase) -> None:
        from clast.pictures.rock_mass import write_cut_report

        write_cut_report(result.cut, path, title=title)

    return {".png": picture, ".svg": picture, ".pdf": picture, ".html": report}
