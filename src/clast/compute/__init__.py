"""The machine: compiled loops, threads, vectors and matrices of six; only this imports numba."""
