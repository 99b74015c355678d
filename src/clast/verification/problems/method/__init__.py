"""The method as a whole: energy, convergence, invariance."""
