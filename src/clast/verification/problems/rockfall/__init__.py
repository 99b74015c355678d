"""Rocks that fall on a profile."""
