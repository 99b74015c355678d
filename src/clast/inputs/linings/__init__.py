"""Linings: their table, the lines that they follow, their segments."""
