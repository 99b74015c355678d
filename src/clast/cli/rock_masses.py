"""Commands on rock masses: cut, import."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from clast.cli.cut_tables import cut_content, cut_table, sets_table
from clast.cli.options import AsJson, CaseFile, Settings
from clast.cli.terminal import print_json, print_table, status, tell
from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.case.cutting import CutCase


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
        Literal["set", "rock"], typer.Option(help="What colours say in a picture.")
    ] = "set",
    settings: Settings = None,
    as_json: AsJson = False,
) -> None:
    """Cut the domain of a case into blocks, and say what was cut and what was changed."""
    from clast.case.case_file import Case

    write = None if output is None else writer(output, {**WRITERS, **pictures(by, case.stem)})
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
    if output is not None:
        tell(f"wrote {output}")


def import_(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Drawing: .dxf, .csv, .xml, or Shi's text.")
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Case file to write; it must not exist yet.")
    ],
    analysis: Annotated[
        Path | None,
        typer.Option("--analysis", metavar="FILE", help="Analysis that goes with a geometry."),
    ] = None,
    unit: Annotated[
        str, typer.Option(metavar="UNIT", help="Unit of a DXF: m, cm, mm, km, in, ft, or metres.")
    ] = "",
    mass_unit: Annotated[
        float, typer.Option(metavar="KG", help="Kilograms in the unit of mass: 1000 for t and kN.")
    ] = 1.0,
    blocks: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Cut the drawing at once; .dxf, .csv or .npz."),
    ] = None,
) -> None:
    """Make a case file of a drawing or of a file of another program."""
    from clast.case.drawn_case import case_text, cut_of, left_out_of, notes_of
    from clast.rockmass.drawings.dxf import DxfReading
    from clast.rockmass.reading import Reading, read_drawing

    write = None if blocks is None else writer(blocks)
    _check_target(output)
    reading = Reading(dxf=DxfReading(unit=_length(unit)), mass_unit=mass_unit)
    drawing = read_drawing(file, analysis, reading)
    text = case_text(drawing)
    if write is not None and blocks is not None:
        write(blocks, cut_of(drawing))
    output.write_text(text, encoding="utf-8")
    taken = {
        "outline of the domain": drawing.boundary is not None,
        "traces": len(drawing.traces),
        "openings": len(drawing.openings),
        "regions": len(drawing.regions),
        "fixed points": len(drawing.fixed_points),
        "measured points": len(drawing.measured_points),
    }
    listed = ", ".join(f"{what} {int(count)}" for what, count in taken.items() if count)
    tell(f"taken over: {listed or 'nothing'} ({drawing.unit_source})")
    for note in notes_of(drawing):
        tell(f"note: {note}")
    for left in left_out_of(drawing):
        tell(f"left out: {left}")
    if blocks is not None:
        tell(f"blocks: {blocks}")
    tell(f"wrote {output}; next: {_next(text, output)}")


def _next(text: str, output: Path) -> str:
    """Return what is to be done with a case that was imported."""
    from clast.case.drawn_case import TO_BE_GIVEN

    if f'"{TO_BE_GIVEN}"' in text.partition("[")[2]:
        return f'give the numbers that are "{TO_BE_GIVEN}" there, then clast check {output}'
    return f"clast check {output}"


def _length(unit: str) -> str | float | None:
    """Return a unit as its symbol or as a number of metres."""
    try:
        return float(unit)
    except ValueError:
        return unit or None


def _check_target(path: Path) -> None:
    """Refuse to write over a case, and into folders that are not there."""
    if path.exists() or path.is_symlink():
        raise CaseError("exists already", where=str(path), remedy="choose another name")
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="make it first")
    if path.suffix.casefold() != ".toml":
        raise CaseError("is no name of a case file", where=str(path), remedy="let it end in .toml")


# Files of blocks ---------------------------------------------------------------------------------

Writer = Callable[[Path, "CutCase"], None]


def _arrays(found: CutCase) -> dict[str, Any]:
    """Return blocks as the writers of files take them."""
    return {
        "vertices": found.cut.vertices,
        "block_start": found.cut.block_start,
        "rock": found.rocks,
        "edge_joint": found.edge_joints,
    }


def _dxf(path: Path, found: CutCase) -> None:
    from clast.rockmass.drawings.dxf_out import write_blocks_dxf

    arrays = _arrays(found)
    # Names of layers have no colons.
    arrays["edge_joint"] = [name.replace(":", "-") for name in arrays["edge_joint"]]
    write_blocks_dxf(path, **arrays)


def _csv(path: Path, found: CutCase) -> None:
    from clast.rockmass.drawings.blocks_out import write_blocks_csv

    write_blocks_csv(path, **_arrays(found))


def _npz(path: Path, found: CutCase) -> None:
    from clast.rockmass.drawings.blocks_out import write_blocks_npz

    write_blocks_npz(path, **_arrays(found))


WRITERS: dict[str, Writer] = {".dxf": _dxf, ".csv": _csv, ".npz": _npz}
"""Ending of a file's name -> who writes blocks to it."""


def pictures(by: Literal["set", "rock"], title: str) -> dict[str, Writer]:
    """Return who draws a cut: ending of a file's name -> function."""

    def picture(path: Path, found: CutCase) -> None:
        from clast.pictures.rock_mass import plot_cut

        plot_cut(found.cut, path, by=by, title=title)

    def report(path: Path, found: CutCase) -> None:
        from clast.pictures.rock_mass import write_cut_report

        write_cut_report(found.cut, path, title=title)

    return {".png": picture, ".svg": picture, ".pdf": picture, ".html": report}


def writer(path: Path, writers: Mapping[str, Writer] = WRITERS) -> Writer:
    """Return who writes a cut to a file of that name; CaseError where nobody does."""
    found = writers.get(path.suffix.casefold())
    if found is None:
        ending = shortened(path.suffix) or "nothing"
        raise CaseError(
            f"ends in {ending}, for which there is no form",
            where=str(path),
            remedy=f"let it end in {', '.join(writers)}",
        )
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="make it first")
    return found
