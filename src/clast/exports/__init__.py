"""Results for other programs: tables (CSV), meshes of polygons (VTU), drawings (DXF).

    from clast.exports import write_csv, write_dxf, write_vtu

    write_vtu(clast.read("out.vtkhdf"), "out.pvd")

Nothing is written over; each file is written whole or not at all.
"""

from clast.exports.csv_tables import TABLES, write_csv
from clast.exports.frames_to_dxf import write_dxf
from clast.exports.vtu import write_vtu

__all__ = ["TABLES", "write_csv", "write_dxf", "write_vtu"]
