"""Rockfall: thousands of paths as a study, its tables, statistics, figures and report."""
