"""One step: the three processes, what they begin with and how they finish."""
