"""Finished blocks put together: near vertices made one, vertices near an edge put onto it."""
