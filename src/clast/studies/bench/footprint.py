"""Memory that the arrays of a system of blocks take, per block and per contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.linear.system import BlockSystem
from clast.model.model import Model
from clast.model.state import State
from clast.step.method import StepResult


@dataclass(frozen=True, kw_only=True)
class Footprint:
    """Arrays that live through a step; temporary memory of kernels is in the peak alone."""

    per_block: float
    """Model, state and the diagonal of the system, bytes per block."""
    per_contact: float
    """Contacts, forces, contact memory and the pairs of the system, bytes per contact; 0: none."""


def footprint(
    model: Model, state: State, last: StepResult | None, system: BlockSystem | None
) -> Footprint:
    """Return the bytes held after a step ``last`` with a system like ``system``."""
    blocks = held(model, state)
    contacts, count = held(state.memory), 0
    if last is not None:
        contacts += held(last.contacts, last.response)
        count = len(last.contacts)
    if system is not None:
        blocks += system.diagonal.nbytes + system.force.nbytes
        contacts += system.pairs.nbytes + system.upper.nbytes
    return Footprint(
        per_block=blocks / model.block_count, per_contact=contacts / count if count else 0.0
    )


def held(*things: object) -> int:
    """Return the bytes of all arrays that things have as fields, shared ones counted once."""
    sizes: dict[int, int] = {}
    for thing in things:
        for value in vars(thing).values():
            if isinstance(value, np.ndarray):
                owner = value
                while isinstance(owner.base, np.ndarray):
                    owner = owner.base
                sizes[id(owner)] = owner.nbytes
    return sum(sizes.values())
