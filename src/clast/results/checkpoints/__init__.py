"""Checkpoints: all that a run carries, so that another process can go on to the same bits."""
