"""A corner of a box, and what is remembered of a contact there."""

import numpy as np

from clast.model.state import ContactMemory

RIGHT, TOP = 1, 2
"""Edges of a box that meet at its upper right corner (its vertex 2)."""


def remembering(edge, gap=0.0, vertex=4, block=0, shear_force=7.0):
    """Return the memory of one contact of the second outline's first vertex."""
    return ContactMemory(
        vertex=np.array([vertex]),
        block=np.array([block]),
        edge=np.array([edge]),
        gap=np.array([gap]),
        normal_force=np.array([1.0]),
        shear_force=np.array([shear_force]),
        multiplier=np.array([0.0]),
        rest_force=np.array([0.0]),
        slip=np.array([0.0]),
        slide_length=np.array([0.0]),
        slide=np.array([0.0]),
        slide_speed=np.array([0.0]),
        dilation=np.array([0.0]),
        mode=np.array([2]),
        bonded=np.array([True]),
        cohesive=np.array([True]),
        point=np.array([0]),
    )
