"""The case file: what may be in it, how it is read, judged and written."""
