"""clast cut: a rock mass cut into blocks, as tables, files and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from clast.cli.options import AsJson, CaseFile, Settings
from clast.cli.terminal import print_json, print_table, status, tell, warn
from clast.cli.terminal_tables import cut_content, cut_table, sets_table
from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.inputs.placing.place_rock_mass import CutCase
    from clast.pictures.block_names import Corners

BlockNames = Annotated[
    Path | None,
    typer.Option(
        "--names",
        metavar="FILE",
        help="Write a picture of the blocks with their numbers and names: .png, .svg, .pdf.",
    ),
]
BLOCK_ENDINGS = (".dxf", ".csv", ".npz")
PICTURE_ENDINGS = (".png", ".svg", ".pdf")


def check_file(path: Path, endings: Sequence[str]) -> None:
    """Raise CaseError for a file with another ending, or in a folder that is not there."""
    if path.suffix.casefold() not in endings:
        raise CaseError(
            f"ends in {shortened(path.suffix) or 'nothing'}, which is not a known format",
            where=str(path),
            remedy=f"use a name ending in {', '.join(endings)}",
        )
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="create it first")


def write_blocks(path: Path, blocks: Mapping[str, Any]) -> None:
    """Write vertices, block_start, rock and edge_joint of blocks, by the ending of the file."""
    from clast.rockmass.drawings import blocks_out

    if path.suffix.casefold() == ".dxf":
        # names of layers have no colons
        joints = [name.replace(":", "-") for name in blocks["edge_joint"]]
        blocks_out.write_blocks_dxf(path, **{**blocks, "edge_joint": joints})
    elif path.suffix.casefold() == ".csv":
        blocks_out.write_blocks_csv(path, **blocks)
    else:
        blocks_out.write_blocks_npz(path, **blocks)


def write_names(path: Path, blocks: Corners, names: Sequence[str], title: str) -> None:
    """Write a picture of blocks with their numbers and names."""
    from clast.pictures.block_names import plot_block_names

    plot_block_names(blocks, path, names=names, title=title)


def write_cut(path: Path, result: CutCase) -> None:
    """Write the blocks of a cut."""
    arrays = {
        "vertices": result.cut.vertices,
        "block_start": result.cut.block_start,
        "rock": result.rocks,
        "edge_joint": result.edge_joints,
    }
    write_blocks(path, arrays)


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
        Literal["set", "joint", "rock"],
        typer.Option(help="Colour edges by set or by joint, or blocks by rock."),
    ] = "set",
    names: BlockNames = None,
    settings: Settings = None,
    as_json: AsJson = False,
) -> None:
    """Cut a rock mass into blocks. Reports the blocks and all changes to them."""
    from clast.case.case_file import Case

    if output is not None:
        check_file(output, (*BLOCK_ENDINGS, *PICTURE_ENDINGS, ".html"))
    if names is not None:
        check_file(names, PICTURE_ENDINGS)
    with status() as show:
        show("cutting")
        read = Case.from_toml(case, settings or ())
        result, title = read.cut(), read.title or read.name
    if output is not None:
        from clast.pictures.rock_mass import plot_cut, write_cut_report

        if output.suffix.casefold() in BLOCK_ENDINGS:
            write_cut(output, result)
        elif output.suffix.casefold() == ".html":
            write_cut_report(result.cut, output, title=title)
        else:
            plot_cut(result.cut, output, by=by, title=title)
    if names is not None:
        write_names(names, result.cut, (), title)
    if as_json:
        print_json({**cut_content(result), "output": None if output is None else str(output)})
        return
    print_table(cut_table(result, title))
    if result.cut.report.sets:
        print_table(sets_table(result))
    for note in result.notes:
        tell(f"note: {note}")
    warn(result.warnings)
    for path in (output, names):
        if path is not None:
            tell(f"wrote {path}")
