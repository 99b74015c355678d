"""The equations of one step: contributions, block system, solvers."""
