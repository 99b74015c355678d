"""Stages of a run: changes at the start of each, and the conditions of its end."""
