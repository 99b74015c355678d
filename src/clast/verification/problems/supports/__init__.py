"""Supports: prescribed motions and reactions, links, linings."""
