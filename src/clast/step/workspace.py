"""What a run keeps between its steps to save time."""

from __future__ import annotations

from dataclasses import dataclass, field

from clast.contact.verlet_list import VerletList


@dataclass(kw_only=True)
class Workspace:
    """What is found once and serves several steps; a run has its own.

    It may be thrown away before any step without changing a digit, and so is no part of what a run
    must carry on.
    """

    near: VerletList = field(default_factory=VerletList)
    """Pairs of blocks near each other."""
