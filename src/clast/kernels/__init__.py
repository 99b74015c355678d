"""Compiled loops: arrays and scalars in, arrays out.  The only importer of numba.

No jitted function is an argument of another (that would defeat the on-disk cache), and no 6 x 6
product goes through ``@`` (a BLAS call each): the loops are written out.
"""
