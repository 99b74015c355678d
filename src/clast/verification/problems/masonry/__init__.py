"""Arches, walls and columns."""
