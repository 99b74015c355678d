"""What scenes of any size cost: time by stage, iterations, accuracy and memory.

    python -m benchmarks.bench                      the first 50 steps of all scenes
    python -m benchmarks.bench wall heap --size 1000,1e5 -o build/bench.json
    python -m benchmarks.bench whole --size 100     scenes from beginning to end, or one of them
    python -m benchmarks.bench cut                  networks of joints that are only cut

Compilation is not counted.  ``make bench`` runs it with BENCH_ARGS; NUMBA_NUM_THREADS=2 in the
environment has it use two threads.
"""

from __future__ import annotations

import argparse
import gc
import json
import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
import shapely

from benchmarks.cuts import CUTS, measure_cut
from benchmarks.machine import forget_peak, peak_memory, this_machine
from benchmarks.scenes import (
    SCENES,
    WHOLE_SCENES,
    WHOLE_SHARE,
    WHOLE_STEP,
    BenchSettings,
    Scene,
    WholeScene,
    method_for,
)
from benchmarks.tables import printed
from clast.compute.compilation import COMPILATION, processor_time, working_time
from clast.errors import RunStopped
from clast.model.model import Floats, Model
from clast.model.state import Ledger, State
from clast.results import Run, RunRecorder
from clast.run.schedule import Progress, Schedule
from clast.run.simulate import simulate
from clast.step.method import Method, StepProcess, StepResult, Workspace
from clast.studies.comparison_pages import finite

SIZES, WHOLE_SIZES, CUT_SIZES = (100, 1000), (100,), (100_000,)
"""Numbers of blocks by default."""
SIZE_MIN, SIZE_MAX = 10, 10_000_000
"""Blocks that a scene can have."""
WARM_SIZES = (100, 400)
"""Sizes that are run first and not counted: one is factorised and one iterated."""
REPORT_STEPS = 100
"""Steps of a whole scene between reports of its progress."""

Say = Callable[[str], None]


class Counted:
    """A process whose accepted steps are counted; it keeps the last.

    With ``by_processor`` stages are timed by the processor's clock, which others do not slow down.
    """

    def __init__(self, process: StepProcess, *, by_processor: bool = False):
        self._process = process
        self._start = working_time()
        self._by_processor = by_processor
        self.any_step = getattr(process, "any_step", False)
        self.advice = process.advice
        self.stiffness = process.stiffness
        self.steps = 0
        self.simulated = 0.0
        self.wall = 0.0
        self.seconds: dict[str, float] = {}
        self.counts: dict[str, float] = {}
        self.penetration = 0.0
        self.last: StepResult | None = None

    def step(
        self, model: Model, method: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        """Return the state ``step`` seconds later."""
        if self._by_processor:
            workspace.clock = processor_time
        result = self._process.step(model, method, state, step, workspace)
        self.last = result
        self.steps += 1
        self.simulated += step
        self.wall = working_time() - self._start
        for sums, more in ((self.seconds, result.seconds), (self.counts, result.counts)):
            for name, value in more.items():
                sums[name] = sums.get(name, 0.0) + value
        self.penetration = max(self.penetration, result.penetration)
        return result


def run_scene(model: Model, method: Method, schedule: Schedule, **options: Any) -> Run:
    """Return the run, also where it could not go on; interrupting it interrupts everything."""
    try:
        run = simulate(model, method, schedule, **options)
    except RunStopped as stopped:
        partial: Run = stopped.run  # type: ignore[assignment]
        return partial
    if not run.report.finished:
        raise KeyboardInterrupt
    return run


def measure(scene: Scene, size: int, settings: BenchSettings) -> dict[str, Any]:
    """Build a scene, run it and return the cost of its steps, ready for JSON."""
    gc.collect()
    forget_peak()
    start = perf_counter()
    model = scene.build(size)
    build_seconds = perf_counter() - start
    method = method_for(model, settings)
    counted = Counted(method.process)
    file = settings.results and settings.results / f"{scene.name}-{size}.vtkhdf"
    recorder = RunRecorder(model, output=file)
    run = run_scene(model, replace(method, process=counted), settings.schedule, recorder=recorder)
    peak = peak_memory()
    moved = run.state.vertices[:, 0] - model.vertices[:, 0]
    contacts = counted.last.contacts if counted.last else ()
    return {
        **_row(scene, size, run),
        "blocks": model.block_count,
        "contacts": len(contacts),
        "pairs": len(counted.last.contacts.pairs) if counted.last else 0,
        **_costs(counted),
        "build_seconds": build_seconds,
        "drift": float(np.abs(moved).max()) if scene.rests else None,
        "peak_memory": peak,
    }


def _row(scene: Scene | WholeScene, size: int, run: Run) -> dict[str, Any]:
    """Return the part of a row that both kinds of scenes have."""
    report = run.report
    return {
        "scene": scene.name,
        "title": scene.title,
        "wanted": size,
        "cut_steps": report.cut_steps,
        "finished": report.finished,
        "outcome": report.outcome,
    }


def _costs(counted: Counted) -> dict[str, Any]:
    """Return times of the steps that count; "other" is time that no stage accounts for."""
    steps = max(1, counted.steps)
    whole = 1e3 * counted.wall / steps
    stages = {name: 1e3 * used / steps for name, used in counted.seconds.items()}
    simulated = counted.simulated
    return {
        "steps": counted.steps,
        "simulated": simulated,
        "wall_seconds": counted.wall,
        "wall_per_simulated_second": counted.wall / simulated if simulated > 0.0 else np.inf,
        "ms_per_step": whole,
        "ms_per_step_by_stage": {**stages, "other": whole - sum(stages.values())},
        "counts_per_step": {name: count / steps for name, count in counted.counts.items()},
        "largest_penetration": counted.penetration,
    }


def measure_whole(scene: WholeScene, size: int, say: Say = lambda _: None) -> dict[str, Any]:
    """Simulate a scene from beginning to end, and return cost and accuracy, ready for JSON.

    Times are those of the processor without compilation; speed, m/s, and overlap, m, are the
    largest at the end.
    """

    def watch(progress: Progress) -> None:
        if progress.steps % REPORT_STEPS == 0:
            say(f"{scene.title}, {size}: {progress.time:.3g} s of {progress.end:.3g} s")

    gc.collect()
    forget_peak()
    model, end = scene.build(size), scene.end(size)
    method = method_of(model)
    timed = replace(method, process=Counted(method.process, by_processor=True))
    compiled, start = COMPILATION.over_by_processor, process_time()
    schedule = Schedule(step=WHOLE_STEP, end=end, every=end)
    run = run_scene(model, timed, schedule, recorder=RunRecorder(model), watch=watch)
    used = process_time() - start - (COMPILATION.over_by_processor - compiled)
    outlines = np.split(run.state.vertices, model.block_start[1:-1])
    report = run.report
    stages = {name: each for name, each in report.seconds.items() if name != "compilation"}
    return {
        **_row(scene, size, run),
        "blocks": int(np.count_nonzero(~model.fixed)),
        "steps": report.steps,
        "simulated": run.state.time,
        "processor_seconds": used,
        "processor_seconds_by_stage": stages,
        "share_of_impacts": stages.get("impacts", 0.0) / used if used > 0.0 else 0.0,
        "counts_per_step": {
            name: count / max(1, report.steps) for name, count in report.counts.items()
        },
        "speed_at_end": float(np.hypot(*run.state.velocity[:, :2].T).max()),
        "overlap_at_end": deepest_overlap(outlines),
        "largest_penetration": report.largest_penetration,
        "energy_turned_over": turned_over(report.ledger),
        "energy_of_gravity": report.ledger.gravity,
        "energy_lost_in_impacts": report.ledger.impacts,
        "energy_lost_by_integration": report.ledger.numerical,
        "energy_unaccounted": report.ledger.unaccounted,
        "peak_memory": peak_memory(),
    }


def method_of(model: Model) -> Method:
    """Return the method of whole scenes: blocks may move by a tenth of their size in a step."""
    method = method_for(model, BenchSettings(step=WHOLE_STEP, share=WHOLE_SHARE))
    return replace(method, max_displacement=2.0 * method.max_displacement)


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


def warm_up(scenes: Sequence[Scene], settings: BenchSettings) -> None:
    """Run small scenes, so that kernels are compiled and loaded before anything is measured."""
    short = replace(settings, steps=3, results=None)
    for size in WARM_SIZES:
        for scene in dict.fromkeys((SCENES["wall"], *scenes)):
            measure(scene, size, short)


def benchmark(
    names: Sequence[str],
    sizes: Sequence[int] | None = None,
    settings: BenchSettings | None = None,
    say: Say = lambda _: None,
) -> dict[str, Any]:
    """Return the cost of scenes and sizes, ready for JSON, compilation not counted."""
    settings = settings or BenchSettings()
    models = [SCENES[name] for name in names if name in SCENES]
    content: dict[str, Any] = {
        "machine": this_machine(),
        "settings": {
            "step": settings.step,
            "end": settings.schedule.end,
            "stiffness": settings.share,
        },
    }

    def measured(scenes: Sequence[Any], default: Sequence[int], work: Callable[..., Any]) -> Any:
        rows = []
        for scene in scenes:
            for size in sizes or default:
                say(f"{scene.title}, {size} blocks")
                rows.append(work(scene, size))
        return rows

    networks = [CUTS[name] for name in _chosen(names, "cut", CUTS)]
    content["cuts"] = measured(networks, CUT_SIZES, measure_cut)
    wholes = [WHOLE_SCENES[name] for name in _chosen(names, "whole", WHOLE_SCENES)]
    if wholes:
        measure_whole(WHOLE_SCENES["rest"], 10)  # loads the kernels
    content["wholes"] = measured(
        wholes, WHOLE_SIZES, lambda scene, size: measure_whole(scene, size, say)
    )
    if models:
        say("compiling")
        warm_up(models, settings)
    content["rows"] = measured(models, SIZES, lambda scene, size: measure(scene, size, settings))
    return content


def _chosen(names: Sequence[str], together: str, known: Collection[str]) -> list[str]:
    """Return the names of a kind, each once; the name ``together`` stands for all of them."""
    listed = [name for one in names for name in (known if one == together else (one,))]
    return [name for name in dict.fromkeys(listed) if name in known]


def sizes_in(text: str) -> tuple[int, ...]:
    """Return the sizes of a list such as "100,1e5"; raises ValueError for an invalid one."""
    numbers = [float(word) for word in text.split(",")]
    if not all(number.is_integer() and SIZE_MIN <= number <= SIZE_MAX for number in numbers):
        raise ValueError(f"give whole numbers of blocks from {SIZE_MIN} to {SIZE_MAX:,}")
    return tuple(int(number) for number in numbers)


def positive(text: str) -> float:
    """Return a number above 0; raises ValueError for another."""
    number = float(text)
    if not 0.0 < number < np.inf:
        raise ValueError("must be above 0 and finite")
    return number


def arguments_of(words: Sequence[str]) -> argparse.Namespace:
    """Return the arguments of the command line; exits where they cannot be used."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.bench", description=__doc__.splitlines()[0]
    )
    known = (*SCENES, "whole", *WHOLE_SCENES, "cut", *CUTS)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(known))
    parser.add_argument("--size", type=sizes_in, metavar="N,...", help="numbers of blocks")
    parser.add_argument("--step", type=positive, default=1e-3, help="length of a step, s")
    parser.add_argument("--steps", type=int, default=50, help="steps")
    parser.add_argument("--stiffness", type=positive, default=1.0, help="p/E")
    parser.add_argument("--results", type=Path, help="folder for first and last states")
    parser.add_argument("-o", "--output", type=Path, help="also write JSON to this file")
    given = parser.parse_args(words)
    for name in given.scenes:
        if name not in known:
            parser.error(f"there is no scene '{name}': {', '.join(known)}")
    if given.steps < 1:
        parser.error("--steps must be at least 1")
    for folder in (given.results, given.output and given.output.absolute().parent):
        if folder is not None and not folder.is_dir():
            parser.error(f"{folder} is not a folder: create it first")
    return given


def main(words: Sequence[str]) -> None:
    """Measure the scenes that are asked for; print their tables."""
    given = arguments_of(words)
    settings = BenchSettings(
        step=given.step, steps=given.steps, share=given.stiffness, results=given.results
    )

    def say(text: str) -> None:
        sys.stderr.write(f"{text}\n")

    content = finite(benchmark(given.scenes or list(SCENES), given.size, settings, say))
    if given.output is not None:
        given.output.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    sys.stdout.write(printed(content))


if __name__ == "__main__":
    main(sys.argv[1:])
