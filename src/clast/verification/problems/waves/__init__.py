"""Waves and ground motion."""
