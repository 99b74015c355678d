"""The minimum of the incremental potential energy of a step."""
