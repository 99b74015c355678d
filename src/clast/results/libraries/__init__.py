"""Recordings as objects of other libraries, which are loaded when they are asked for."""
