"""Openings and retained rock."""
