"""Supports and motions of blocks from outside, and whose reactions are recorded."""
