"""Friction: sliding, joints in the surface, direct shear, limit equilibrium."""
