"""Motions that are prescribed to blocks, and what supports bear."""
