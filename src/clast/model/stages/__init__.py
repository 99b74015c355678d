"""Stages of a run: their start, their end, and their records."""
