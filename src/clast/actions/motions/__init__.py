"""Prescribed motions: how far they go, and how blocks follow."""
