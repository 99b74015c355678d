"""Rows of tables with a row per step that need more than the step's own numbers."""
