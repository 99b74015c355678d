"""Contacts: impact, penetration, stacks and columns."""
