"""Friction: sliding, seams, direct shear."""
