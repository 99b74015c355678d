"""Measures scenes from beginning to end: time of the processor by stage, accuracy, energy."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import process_time
from typing import Any

import numpy as np
import shapely

from clast.compute.compilation import COMPILATION, processor_time
from clast.errors import RunStopped
from clast.model.model import Floats, Model
from clast.model.state import Ledger, State
from clast.results import Report, Run, RunRecorder
from clast.run.schedule import Progress, Schedule
from clast.run.simulate import simulate
from clast.step.method import Method, StepProcess, StepResult, Workspace
from clast.studies.bench.machine import forget_peak, peak_memory
from clast.studies.bench.settings import BenchSettings, method_for
from clast.studies.bench.whole_scenes import SHARE, STEP, TRAVEL, WholeScene

IMPACTS = "impacts"
"""Stage of a step in which contacts strike."""
WARM = 10
"""Blocks of the scene by which kernels are loaded before anything is measured."""

Watch = Callable[[Progress], None]


@dataclass(frozen=True, kw_only=True)
class MeasuredWhole:
    """The cost of one scene of one size from beginning to end, and its accuracy."""

    scene: WholeScene
    """The scene."""
    wanted: int
    """Requested number of blocks."""
    blocks: int
    """Blocks that move."""
    report: Report
    """How the run went."""
    simulated: float
    """Simulated time, s."""
    processor_seconds: float
    """Time of the processor for the whole run but compilation, s."""
    seconds: dict[str, float]
    """The same of each stage of accepted steps, s."""
    speed: float
    """Fastest block at the end, m/s."""
    overlap: float
    """Thickness of the thickest overlap of two blocks at the end, m."""
    turned_over: float
    """Largest change of any entry of the energy ledger from beginning to end, J/m."""
    peak: int
    """Largest resident memory of the process meanwhile, bytes."""

    @property
    def impacts(self) -> float:
        """Share of the time that impacts take."""
        if self.processor_seconds <= 0.0:
            return 0.0
        return self.seconds.get(IMPACTS, 0.0) / self.processor_seconds

    @property
    def per_simulated_second(self) -> float:
        """Time of the processor for a simulated second, s."""
        return self.processor_seconds / self.simulated if self.simulated > 0.0 else np.inf

    @property
    def microseconds(self) -> float:
        """Time of the processor for a block and a step, microseconds."""
        return 1e6 * self.processor_seconds / max(1, self.report.steps) / max(1, self.blocks)

    def share(self, energy: float) -> float:
        """Return an energy, J/m, as a share of the energy turned over."""
        return abs(energy) / self.turned_over if self.turned_over > 0.0 else 0.0

    def counted(self, name: str) -> float:
        """Return a count of the process per step."""
        return self.report.counts.get(name, 0) / max(1, self.report.steps)

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain numbers and texts, ready for JSON."""
        report = self.report
        return {
            "scene": self.scene.name,
            "title": self.scene.title,
            "wanted": self.wanted,
            "blocks": self.blocks,
            "steps": report.steps,
            "cut_steps": report.cut_steps,
            "finished": report.finished,
            "outcome": report.outcome,
            "simulated": self.simulated,
            "processor_seconds": self.processor_seconds,
            "processor_seconds_by_stage": dict(self.seconds),
            "share_of_impacts": self.impacts,
            "counts_per_step": {name: self.counted(name) for name in report.counts},
            "speed_at_end": self.speed,
            "overlap_at_end": self.overlap,
            "largest_penetration": report.largest_penetration,
            "energy_turned_over": self.turned_over,
            "energy_lost_in_impacts": report.ledger.impacts,
            "energy_lost_by_integration": report.ledger.numerical,
            "energy_unaccounted": report.ledger.unaccounted,
            "peak_memory": self.peak,
        }


class ByProcessor:
    """A process whose stages are timed by the processor's clock, which others do not slow down."""

    def __init__(self, process: StepProcess) -> None:
        self._process = process
        self.any_step = getattr(process, "any_step", False)

    def step(
        self, model: Model, method: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        """Return the state ``step`` seconds later."""
        workspace.clock = processor_time
        return self._process.step(model, method, state, step, workspace)

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Return the advice of the process itself."""
        return self._process.advice(model, method, state, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return the stiffness of the process itself."""
        return self._process.stiffness(model, step)


def method_of(model: Model) -> Method:
    """Return the method with which whole scenes are simulated."""
    method = method_for(model, BenchSettings(step=STEP, share=SHARE))
    return replace(method, max_displacement=TRAVEL * method.max_displacement)


def measure_whole(scene: WholeScene, size: int, watch: Watch | None = None) -> MeasuredWhole:
    """Simulate a scene from beginning to end, and return the cost."""
    gc.collect()
    forget_peak()
    model, end = scene.build(size), scene.end(size)
    method = method_of(model)
    timed = replace(method, process=ByProcessor(method.process))
    compiled, begun = COMPILATION.over_by_processor, process_time()
    run = _run(model, timed, Schedule(step=STEP, end=end, every=end), watch)
    taken = process_time() - begun - (COMPILATION.over_by_processor - compiled)
    outlines = np.split(run.state.vertices, model.block_start[1:-1])
    return MeasuredWhole(
        scene=scene,
        wanted=size,
        blocks=int(np.count_nonzero(~model.fixed)),
        report=run.report,
        simulated=run.state.time,
        processor_seconds=taken,
        seconds={k: used for k, used in run.report.seconds.items() if k != "compilation"},
        speed=float(np.hypot(*run.state.velocity[:, :2].T).max()),
        overlap=deepest_overlap(outlines),
        turned_over=turned_over(run.report.ledger),
        peak=peak_memory(),
    )


def _run(model: Model, method: Method, schedule: Schedule, watch: Watch | None) -> Run:
    """Return the run, also where it could not go on; interrupting it interrupts everything."""
    try:
        run = simulate(model, method, schedule, recorder=RunRecorder(model), watch=watch)
    except RunStopped as stopped:
        partial: Run = stopped.run  # type: ignore[assignment]
        return partial
    if not run.report.finished:
        raise KeyboardInterrupt
    return run


def turned_over(ledger: Ledger) -> float:
    """Return the largest entry of the ledger at the end of a run that began at rest, J/m."""
    entries = {name: value for name, value in vars(ledger).items() if name != "unaccounted"}
    return max(abs(value) for value in entries.values())


def deepest_overlap(outlines: list[Floats] | Floats) -> float:
    """Return twice the area over the perimeter of the thickest overlap of outlines (k, 2), m."""
    corners = np.concatenate(outlines)
    if not np.isfinite(corners).all():
        return np.inf
    number = np.repeat(np.arange(len(outlines)), [len(outline) for outline in outlines])
    shapes = shapely.make_valid(shapely.polygons(shapely.linearrings(corners, indices=number)))
    one, other = shapely.STRtree(shapes).query(shapes)
    one, other = one[one < other], other[one < other]
    shared = shapely.intersection(shapes[one], shapes[other])
    area = shapely.area(shared)
    deep = area > 0.0
    return float((2.0 * area[deep] / shapely.length(shared[deep])).max(initial=0.0))
