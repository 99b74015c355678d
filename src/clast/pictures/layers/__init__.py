"""Layers above the blocks of a still picture, drawn where they are asked for."""
