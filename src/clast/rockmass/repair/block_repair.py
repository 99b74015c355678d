"""The repair of blocks as builders take it: ``builder.repair = BlockRepair(tolerance=1e-3)``."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.model.checks import BlockOutlines, RepairedBlocks
from clast.model.repairs import Repair
from clast.rockmass.repair.repair import RepairReport, repaired


@dataclass(frozen=True, kw_only=True)
class BlockRepair:
    """Puts the blocks of a ModelBuilder together where they are nearer than a tolerance."""

    tolerance: float
    """Distance within which things are meant to touch, m."""

    def __call__(self, outlines: BlockOutlines) -> RepairedBlocks:
        """Return the repaired blocks, and the repairs."""
        found = repaired(outlines.vertices, outlines.start, self.tolerance, outlines.label)
        vertices = np.ascontiguousarray(found.vertices)
        return RepairedBlocks(
            outlines=replace(outlines, start=found.start, vertices=vertices),
            edge=found.edge,
            moved=found.report.largest_movement,
            repairs=repairs_of(found.report, tuple(outlines.origin.tolist())),
        )


def repairs_of(report: RepairReport, origin: tuple[float, ...] = (0.0, 0.0)) -> tuple[Repair, ...]:
    """Return the repairs in the form of a model; places are about an origin, m."""
    return tuple(
        Repair(
            what=what,
            count=one.count,
            places=tuple((x + origin[0], y + origin[1]) for x, y in one.places),
        )
        for what, one in report.changes.items()
    )
