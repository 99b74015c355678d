"""One function for every drawing: the kind of file decides which reader is used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from clast.errors import CaseError, shortened
from clast.rockmass.drawings.csv_lines import read_csv
from clast.rockmass.drawings.drawing import Drawing, with_analysis
from clast.rockmass.drawings.drawing_files import checked_file
from clast.rockmass.drawings.dxf import DxfReading, MissingLayer, read_dda_dxf, read_dxf, role_of
from clast.rockmass.legacy.dda_xml import read_dda_xml
from clast.rockmass.legacy.shi_analysis import read_shi_analysis
from clast.rockmass.legacy.shi_geometry import read_shi_geometry


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a drawing is read, as far as its kind of file asks."""

    dxf: DxfReading = field(default_factory=DxfReading)
    mass_unit: float = 1.0
    """Kilograms in the unit of mass of Shi's files: 1000 for t, kN and kPa."""


def read_drawing(
    path: str | Path, analysis: str | Path | None = None, reading: Reading | None = None
) -> Drawing:
    """Return the drawing of a file: .dxf, .csv, .xml or else a text geometry of Shi.

    A DXF file without a layer of clast is read by the convention of DDA for Windows where it has
    the texts F, L, M or H of that.  ``analysis`` is the analysis file, .xml or text, that belongs
    to a legacy geometry.  Raises CaseError for files that cannot be read.
    """
    path, how = Path(path), reading or Reading()
    reader = READERS.get(path.suffix.casefold(), _shi)
    drawing = reader(path, how)
    return drawing if analysis is None else _analysed(drawing, Path(analysis), how)


def _analysed(drawing: Drawing, path: Path, how: Reading) -> Drawing:
    """Return a drawing with the materials of an analysis file."""
    if path.suffix.casefold() != ".xml":
        return with_analysis(drawing, read_shi_analysis(path, how.mass_unit))
    other = read_dda_xml(path, how.mass_unit)
    if not other.analysis.rocks:
        raise CaseError("has no materials", where=str(path), remedy="give the analysis file")
    return with_analysis(drawing, other.analysis)


def _dxf(path: Path, how: Reading) -> Drawing:
    """Return a DXF drawing by clast's layers, else by the convention of DDA for Windows."""
    try:
        return read_dxf(path, how.dxf)
    except MissingLayer as missing:
        if any(role_of(layer)[0] for layer in missing.layers):
            raise
        refused = missing
    try:
        drawing = read_dda_dxf(path, how.dxf)
    except CaseError:
        raise refused from None
    marks = (drawing.fixed_points, drawing.load_points, drawing.measured_points)
    if any(marks) or drawing.hole_points:
        return drawing
    raise refused


def _csv(path: Path, how: Reading) -> Drawing:
    return read_csv(path)


def _xml(path: Path, how: Reading) -> Drawing:
    return read_dda_xml(path, how.mass_unit)


def _shi(path: Path, how: Reading) -> Drawing:
    return read_shi_geometry(path, how.mass_unit)


def _not_read(path: Path, how: Reading) -> Drawing:
    """Refuse kinds of file that are known not to be drawings."""
    checked_file(path)
    raise CaseError(
        f"a {shortened(path.suffix)} file is not a drawing that clast can read",
        where=str(path),
        remedy="save it as DXF (R2000 or later), or as CSV with a heading x1,y1,x2,y2",
    )


READERS: dict[str, Callable[[Path, Reading], Drawing]] = {
    ".dxf": _dxf,
    ".csv": _csv,
    ".xml": _xml,
    **dict.fromkeys((".dwg", ".svg", ".pdf", ".png", ".toml", ".xlsx", ".xls", ".npz"), _not_read),
}
"""Ending of a file's name -> who reads it; any other is a text geometry of Shi."""
