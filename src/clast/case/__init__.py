"""The case file: its tables, reading, checks and writing."""
