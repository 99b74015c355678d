"""From straight lines to blocks: a planar graph on a grid of whole numbers, and its faces."""
