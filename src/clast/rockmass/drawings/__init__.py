"""Drawings in (DXF, CSV) and blocks out (DXF, CSV, NPZ): what a file draws of a rock mass."""
