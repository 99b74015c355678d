"""Stages of a run: what changes where one begins, and when it is over."""
