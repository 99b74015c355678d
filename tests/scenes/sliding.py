"""A small block that slides down a plane, beside others."""

import numpy as np

from scenes.systems import box, system, turned

STEEP, FRICTION_ANGLE = 40.0, 30.0
"""Dip of a plane and friction angle, degrees: a block slides down it."""


def sliding(others):
    """Return a model of a plane, a small block upon it, and others, of which the first is fixed."""
    dip = -np.radians(STEEP)
    places = (box(-1.0, -1.0, 12.0), box(0.0, 0.0, 0.1, 0.1))
    plane, slider = (turned(place, dip, (100.0, 0.0)) for place in places)
    return system([plane, slider, *others], fixed=[0, 2], friction_angle=FRICTION_ANGLE)
