"""Openings, and the rock mass around them."""
