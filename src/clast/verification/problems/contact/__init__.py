"""Contacts: stiffness, penetration, shared loads, impact."""
