"""Joints: which one a contact lies along and how much of it, faces that are integrated, bonds."""
