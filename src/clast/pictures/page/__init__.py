"""A run as one page that a browser plays: blocks, contacts, curves, report."""
