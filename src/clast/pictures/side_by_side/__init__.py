"""Frames of a run beside each other."""
