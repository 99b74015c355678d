"""Inputs turned into arrays of a model: their place on blocks, and checks against these."""
