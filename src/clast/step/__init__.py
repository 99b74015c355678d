"""One step: the three processes, their start and their finish."""
