"""A run from its first step to its last: checks before, step control, warnings after."""
