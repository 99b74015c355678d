"""clast import: a case file of a drawing, of finished blocks, or of a file of another program."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import typer

from clast.cli.options import AsJson
from clast.cli.rock_masses import (
    BLOCK_ENDINGS,
    PICTURE_ENDINGS,
    BlockNames,
    check_file,
    write_blocks,
    write_cut,
    write_names,
)
from clast.cli.terminal import print_json, tell
from clast.errors import CaseError

if TYPE_CHECKING:
    from clast.rockmass.readers import BlockReading, Reading


Drawing = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="Drawing or blocks: .dxf, .csv, .npz, .xml, Shi's text."),
]
NewCase = Annotated[
    Path, typer.Option("-o", "--output", help="Case file to write; it must not exist yet.")
]
AnalysisFile = Annotated[
    Path | None, typer.Option("--analysis", metavar="FILE", help="Analysis file of the geometry.")
]
DrawingUnit = Annotated[
    str,
    typer.Option(metavar="UNIT", help="Unit of a DXF: m, cm, mm, km, in, ft, or its length in m."),
]
MassUnit = Annotated[float, typer.Option(metavar="KG", help="Unit of mass, kg: 1000 for t and kN.")]
BlockFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Write the blocks: .dxf, .csv or .npz. A drawing is cut for it; finished blocks "
        "go to an .npz beside the case if absent.",
    ),
]
TakenAs = Annotated[
    Literal["drawing", "blocks"] | None,
    typer.Option(
        "--as",
        help="Meaning of closed lines: outlines of a drawing to cut, or finished blocks "
        "(archives and tables of blocks always are).",
    ),
]
RepairDistance = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        help="Repair distance, m: corners and edges of blocks, and ends of outlines in a "
        "DXF, within it are joined.",
    ),
]
FixedLayers = Annotated[
    str,
    typer.Option(metavar="NAME,NAME", help="Layers of a DXF whose blocks cannot move at all."),
]


def import_(
    file: Drawing,
    output: NewCase,
    analysis: AnalysisFile = None,
    unit: DrawingUnit = "",
    mass_unit: MassUnit = 1.0,
    blocks: BlockFile = None,
    taken_as: TakenAs = None,
    tolerance: RepairDistance = None,
    names: BlockNames = None,
    fixed_layers: FixedLayers = "",
    as_json: AsJson = False,
) -> None:
    """Make a case from a drawing, blocks or another program's file."""
    from clast.case.drawn_case import TO_BE_GIVEN
    from clast.rockmass.drawings.dxf import DxfReading
    from clast.rockmass.readers import BlockReading, Reading, has_blocks

    for path, endings in ((blocks, BLOCK_ENDINGS), (names, PICTURE_ENDINGS)):
        if path is not None:
            check_file(path, endings)
    _check_new(output)
    if output.suffix.casefold() != ".toml":
        what, remedy = "is not a valid case file name", "use a name ending in .toml"
        raise CaseError(what, where=str(output), remedy=remedy)
    try:
        length: str | float | None = float(unit)
    except ValueError:
        length = unit or None
    dxf = DxfReading(unit=length, tolerance=tolerance)
    if taken_as == "blocks" or (taken_as is None and has_blocks(file)):
        target = blocks or output.with_name(f"{output.stem}-blocks.npz")
        _check_new(target)
        reading = BlockReading(dxf=dxf, near=tolerance)
        held = [layer.strip() for layer in fixed_layers.split(",") if layer.strip()]
        done = _blocks(file, reading, _Blocks(output, target, names, held), tolerance)
    else:
        if fixed_layers:
            what = f"{file.name} is a drawing, whose blocks are made by cutting"
            remedy = "leave it out: [domain] fixed_sides holds blocks; or add --as blocks"
            raise CaseError(what, where="--fixed-layers", remedy=remedy)
        if tolerance is not None and file.suffix.casefold() != ".dxf":
            raise CaseError(
                f"{file.name} is a drawing, and --tolerance is for outlines drawn as separate "
                "lines",
                where="--tolerance",
                remedy="leave it out: [domain] has a tolerance of its own; finished blocks are "
                "imported with --as blocks",
            )
        drawn = Reading(dxf=dxf, mass_unit=mass_unit)
        done = _drawing(file, analysis, drawn, (output, blocks, names))
    text, lines, content = done
    if as_json:
        print_json(content)
        return
    for line in lines:
        tell(line)
    fill = f'fill in the values marked "{TO_BE_GIVEN}" there, then '
    next_step = fill if f'"{TO_BE_GIVEN}"' in text.partition("[")[2] else ""
    tell(f"wrote {output}; next: {next_step}clast check {output}")


Imported = tuple[str, list[str], dict[str, Any]]
"""Text of the case; lines on the parts taken over, repaired, noted and left out; all for JSON."""


def _drawing(
    file: Path,
    analysis: Path | None,
    reading: Reading,
    targets: tuple[Path, Path | None, Path | None],
) -> Imported:
    """Make a case of a drawing, and blocks where a file for them is named."""
    from clast.case.drawn_case import case_text, cut_of, left_out_of, notes_of
    from clast.rockmass.readers import read_drawing

    output, blocks, names = targets
    drawing = read_drawing(file, analysis, reading)
    text = case_text(drawing)
    cut = cut_of(drawing) if blocks or names else None
    if cut is not None and blocks is not None:
        write_cut(blocks, cut)
    if cut is not None and names is not None:
        write_names(names, cut.cut, (), output.stem)
    output.write_text(text, encoding="utf-8")
    counted = {
        "outline of the domain": int(drawing.boundary is not None),
        "traces": len(drawing.traces),
        "openings": len(drawing.openings),
        "regions": len(drawing.regions),
        "fixed points": len(drawing.fixed_points),
        "measured points": len(drawing.measured_points),
    }
    listed = ", ".join(f"{what} {count}" for what, count in counted.items() if count)
    notes, left = notes_of(drawing), [str(one) for one in left_out_of(drawing)]
    lines = [
        f"taken over: {listed or 'nothing'} ({drawing.unit_source})",
        *(f"note: {one}" for one in notes),
        *(f"left out: {one}" for one in left),
        *(f"{what}: {path}" for what, path in (("blocks", blocks), ("names", names)) if path),
    ]
    content = {
        "file": str(file),
        "unit": drawing.unit_source,
        **counted,
        "notes": notes,
        "left_out": left,
        "blocks": None if blocks is None else str(blocks),
        "output": str(output),
    }
    return text, lines, content


class _Blocks(NamedTuple):
    """Files to write of finished blocks, and the layers that are fixed."""

    case: Path
    blocks: Path
    names: Path | None
    fixed_layers: list[str]


def _blocks(
    file: Path, reading: BlockReading, wanted: _Blocks, tolerance: float | None
) -> Imported:
    """Make a case of finished blocks, which are put together and kept beside it."""
    from clast.case.drawn_case import blocks_text, put_together
    from clast.inputs.blocks import on_layers
    from clast.rockmass.readers import read_blocks

    output, blocks, names, layers = wanted
    drawn = put_together(read_blocks(file, reading), file, tolerance)
    held = on_layers(drawn.blocks, layers, "--fixed-layers")
    arrays = {
        "vertices": drawn.blocks.vertices,
        "block_start": drawn.blocks.block_start,
        "rock": drawn.blocks.rock,
        "edge_joint": drawn.blocks.edge_joint,
        **({"name": drawn.blocks.name} if blocks.suffix.casefold() == ".npz" else {}),
    }
    check_file(blocks, BLOCK_ENDINGS)
    write_blocks(blocks, arrays)
    if names is not None:
        write_names(names, drawn.blocks, drawn.blocks.name, output.stem)
    beside = Path(os.path.relpath(blocks, output.absolute().parent)).as_posix()
    text = blocks_text(drawn, beside, [k for k, one in enumerate(held.tolist(), 1) if one])
    output.write_text(text, encoding="utf-8")
    content = drawn.as_dict()
    named = {"rocks": list(content["rocks"]), "joints": content["joints"]}
    listed = "; ".join(f"{what} {', '.join(names)}" for what, names in named.items() if names)
    lines = [
        f"taken over: {drawn.blocks.count} blocks; {listed}",
        *([f"repair: {one}" for one in drawn.repairs] or ["repair: nothing to put together"]),
        f"tolerance {drawn.tolerance:.3g} m: no vertex moved by more than "
        f"{drawn.largest_movement:.3g} m",
        *(f"note: {one}" for one in content["notes"]),
        *(f"left out: {one}" for one in content["left_out"]),
        *([f"fixed: {held.sum()} blocks on {', '.join(layers)}"] if layers else []),
        f"blocks: {blocks}",
        *([f"names: {names}"] if names else []),
    ]
    return text, lines, {**content, "written": str(blocks), "output": str(output)}


def _check_new(path: Path) -> None:
    """Refuse a file that is there already, or in a folder that is not."""
    if path.exists() or path.is_symlink():
        raise CaseError("already exists", where=str(path), remedy="choose another name")
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="create it first")
