"""Reactions of supports, drawn on a picture."""
