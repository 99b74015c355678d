"""A corner of a box, and what is remembered of a contact there."""

import numpy as np

from clast.model.state import ContactMemory

RIGHT, TOP = 1, 2
"""Edges of a box that meet at its upper right corner (its vertex 2)."""


def memory_of(vertex, block, edge, gap, **given):
    """Return the memory of contacts (m,), of which all that is not given is 0 or False."""
    known = {"vertex": vertex, "block": block, "edge": edge, "gap": gap, **given}
    empty = ContactMemory()
    count = len(known["vertex"])
    rows = {one: np.zeros(count, getattr(empty, one).dtype) for one in vars(empty)}
    return ContactMemory(**rows | {name: np.asarray(values) for name, values in known.items()})


def remembering(edge, gap=0.0, vertex=4, block=0, shear_force=7.0):
    """Return the memory of one contact of the second outline's first vertex."""
    whole = {"mode": [2], "bonded": [True], "cohesive": [True]}
    forces = {"normal_force": [1.0], "shear_force": [shear_force]}
    return memory_of([vertex], [block], [edge], [gap], **forces, **whole)
