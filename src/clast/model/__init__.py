"""A system of blocks, and one instant of it."""
