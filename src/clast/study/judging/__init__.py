"""Judging runs: measures of their results, and expressions of these."""
