"""Motions that are prescribed to blocks, and reactions of supports."""
