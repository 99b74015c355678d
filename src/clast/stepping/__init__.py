"""Processes of a step, each one short file."""
