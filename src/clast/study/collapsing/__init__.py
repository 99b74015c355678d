"""Factors of safety and loads at collapse: trials, and the search that they belong to."""
