"""Supports that move, and what is recorded of them."""
