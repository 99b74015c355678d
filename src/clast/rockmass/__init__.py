"""The rock mass before it is blocks: drawings in and out, joint sets, and the cutting of blocks."""
