"""Prescribed motions: how far they go, and what they make blocks do."""
