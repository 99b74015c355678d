"""Drawings in (DXF, CSV) and blocks out (DXF, CSV, NPZ): rock masses in files of other programs."""
