"""Contacts between blocks: how they are found, and the forces in them."""
