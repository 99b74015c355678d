"""The tables of the case file: one file a group."""
