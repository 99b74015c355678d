"""Supports that move, and the records of them."""
