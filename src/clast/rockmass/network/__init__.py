"""From straight pieces to blocks: a planar graph on a grid of whole numbers, its faces, its care."""
