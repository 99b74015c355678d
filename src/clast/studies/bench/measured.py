"""The measurements, as figures and ready for JSON."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from clast.results import Report
from clast.studies.bench.bandwidth import Product
from clast.studies.bench.counting import Costs
from clast.studies.bench.cuts import MeasuredCut
from clast.studies.bench.footprint import Footprint
from clast.studies.bench.machine import Machine
from clast.studies.bench.scenes import Scene
from clast.studies.bench.settings import BenchSettings
from clast.studies.bench.whole import MeasuredWhole

FORMAT = 1
"""Version of the layout of the JSON."""


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """The cost of one scene of one size."""

    scene: Scene
    """The scene."""
    wanted: int
    """Requested number of blocks."""
    blocks: int
    """Blocks, fixed ones among them."""
    contacts: int
    """Contacts of the last step."""
    pairs: int
    """Pairs of blocks that share them."""
    report: Report
    """How the whole run went."""
    costs: Costs
    """Cost of the steps that count."""
    drift: float | None
    """Largest horizontal movement of a vertex, m; None where things are meant to move."""
    build_seconds: float
    """Time to build and check the model, s."""
    footprint: Footprint
    """Bytes per block and per contact."""
    peak: int
    """Largest resident memory of the process while this scene was built and run, bytes."""
    product: Product | None
    """The matrix product; None where a step had no system."""

    @property
    def steps(self) -> int:
        """Accepted steps that count, at least 1."""
        return max(1, self.costs.steps)

    @property
    def stages(self) -> dict[str, float]:
        """Wall time per step by stage, ms; "other" is time that no stage accounts for."""
        known = {name: 1e3 * used / self.steps for name, used in self.costs.seconds.items()}
        return {**known, "other": self.milliseconds - sum(known.values())}

    @property
    def milliseconds(self) -> float:
        """Wall time per step, ms."""
        return 1e3 * self.costs.wall / self.steps

    @property
    def per_simulated_second(self) -> float:
        """Wall time per simulated second."""
        costs = self.costs
        return costs.wall / costs.simulated if costs.simulated > 0.0 else math.inf

    def counted(self, name: str) -> float | None:
        """Return a count of the process per step, or None where it does not count that."""
        total = self.costs.counts.get(name)
        return None if total is None else total / self.steps

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain numbers and texts, ready for JSON."""
        return {
            "scene": self.scene.name,
            "title": self.scene.title,
            "wanted": self.wanted,
            "blocks": self.blocks,
            "contacts": self.contacts,
            "pairs": self.pairs,
            "steps": self.costs.steps,
            "cut_steps": self.report.cut_steps,
            "finished": self.report.finished,
            "outcome": self.report.outcome,
            "simulated": self.costs.simulated,
            "build_seconds": self.build_seconds,
            "wall_seconds": self.costs.wall,
            "wall_per_simulated_second": self.per_simulated_second,
            "ms_per_step": self.milliseconds,
            "ms_per_step_by_stage": self.stages,
            "counts_per_step": {name: n / self.steps for name, n in self.costs.counts.items()},
            "drift": self.drift,
            "largest_penetration": self.costs.penetration,
            "bytes_per_block": self.footprint.per_block,
            "bytes_per_contact": self.footprint.per_contact,
            "peak_memory": self.peak,
            "product": None if self.product is None else self.product.as_dict(),
        }


@dataclass(frozen=True, kw_only=True)
class Benchmark:
    """Everything that was measured in one go."""

    machine: Machine
    """Where it was measured."""
    settings: BenchSettings
    """How it was measured."""
    rows: tuple[Measurement, ...]
    """Scenes and sizes, in the order in which they ran."""
    cuts: tuple[MeasuredCut, ...] = ()
    """The same for networks that were only cut."""
    wholes: tuple[MeasuredWhole, ...] = ()
    """The same for scenes that were simulated from beginning to end."""
    triad: float = 0.0
    """Rate of the triad in main memory by one thread, bytes per second; 0 where nothing ran."""
    triad_by_threads: float = 0.0
    """The same by all threads, bytes per second."""

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain numbers and texts, ready for JSON."""
        return {
            "format": FORMAT,
            "machine": self.machine.as_dict(),
            "settings": self.settings.as_dict(),
            "triad": self.triad,
            "triad_by_threads": self.triad_by_threads,
            "rows": [row.as_dict() for row in self.rows],
            "cuts": [row.as_dict() for row in self.cuts],
            "wholes": [row.as_dict() for row in self.wholes],
        }
