"""Runs scenes and measures their cost: time by stage, iterations, accuracy, memory."""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from clast.errors import RunStopped, StepRejected
from clast.linear.system import BlockSystem
from clast.model.model import Model
from clast.results import Run, RunRecorder
from clast.run.schedule import Progress
from clast.run.simulate import simulate
from clast.step.method import Method
from clast.studies.bench.bandwidth import (
    Product,
    matrix_of_directions,
    measured_product,
    system_of_step,
    triad_rate,
)
from clast.studies.bench.counting import Counted
from clast.studies.bench.cuts import measure_cut
from clast.studies.bench.footprint import footprint
from clast.studies.bench.machine import forget_peak, peak_memory, this_machine
from clast.studies.bench.measured import Benchmark, Measurement
from clast.studies.bench.scenes import SCENES, Scene
from clast.studies.bench.settings import BenchSettings, method_for, schedule_of
from clast.studies.bench.whole import WARM, measure_whole
from clast.studies.bench.whole_scenes import WHOLE_SCENES

WARM_SIZES = (100, 400)
"""Sizes that are run first and not counted: one is factorised and one iterated."""
WARM_STEPS = 3
"""Steps of such a run."""
OFTEN = 100
"""Steps of a whole scene between reports of its progress."""

Watch = Callable[[str], None]
"""Called with the progress."""


def benchmark(settings: BenchSettings, watch: Watch = lambda _: None) -> Benchmark:
    """Return the cost of all scenes and sizes of the settings, compilation not counted."""
    cuts = []
    for network in settings.cuts:
        for size in settings.cut_sizes:
            watch(f"{network.title}, {size} blocks")
            cuts.append(measure_cut(network, size))
    wholes = []
    if settings.wholes:
        measure_whole(WHOLE_SCENES["rest"], WARM)
    for whole in settings.wholes:
        for size in settings.whole_sizes:
            watch(f"{whole.title}, {size} blocks")
            wholes.append(measure_whole(whole, size, told(watch, f"{whole.title}, {size} blocks")))
    found = Benchmark(
        machine=this_machine(),
        settings=settings,
        rows=(),
        cuts=tuple(cuts),
        wholes=tuple(wholes),
    )
    return _simulated(found, watch) if settings.models else found


def told(watch: Watch, what: str) -> Callable[[Progress], None]:
    """Return a function that reports the progress of a scene every hundred steps."""

    def say(progress: Progress) -> None:
        if progress.steps % OFTEN == 0:
            watch(f"{what}: {progress.time:.3g} s of {progress.end:.3g} s")

    return say


def _simulated(found: Benchmark, watch: Watch) -> Benchmark:
    """Return a benchmark with the cost of scenes that are simulated."""
    settings = found.settings
    watch("compiling")
    warm_up(settings.models, settings)
    rows = []
    for scene in settings.models:
        for size in settings.model_sizes:
            watch(f"{scene.title}, {size} blocks")
            rows.append(measure(scene, size, settings))
    watch("memory bandwidth")
    return replace(
        found, rows=tuple(rows), triad=triad_rate(), triad_by_threads=triad_rate(threads=True)
    )


def warm_up(scenes: Sequence[Scene], settings: BenchSettings) -> None:
    """Run small scenes, so that kernels are compiled and loaded before anything is measured."""
    short = replace(settings, steps=WARM_STEPS, end=None, settle=0, results=None)
    for size in WARM_SIZES:
        for scene in dict.fromkeys((SCENES["wall"], *scenes)):
            measure(scene, size, short)


def measure(scene: Scene, size: int, settings: BenchSettings) -> Measurement:
    """Build a scene, run it and return the cost."""
    gc.collect()
    forget_peak()
    begun = perf_counter()
    model = scene.build(size)
    built = perf_counter() - begun
    method = method_for(model, settings)
    counted = Counted(method.process, settings.settle)
    recorder = RunRecorder(model, output=settings.file_of(scene.name, size))
    run = _run(model, replace(method, process=counted), settings, recorder)
    peak = peak_memory()
    system = system_of_step(model, method, run.state, settings.step)
    moved = run.state.vertices[:, 0] - model.vertices[:, 0]
    return Measurement(
        scene=scene,
        wanted=size,
        blocks=model.block_count,
        contacts=len(counted.last.contacts) if counted.last else 0,
        pairs=len(counted.last.contacts.pairs) if counted.last else 0,
        report=run.report,
        costs=counted.costs,
        drift=float(np.abs(moved).max()) if scene.rests else None,
        build_seconds=built,
        footprint=footprint(model, run.state, counted.last, system),
        peak=peak,
        product=None if system is None else _product(system),
    )


def _product(system: BlockSystem) -> Product | None:
    """Return the rate of the matrix product, or None where the system is singular."""
    try:
        return measured_product(matrix_of_directions(system))
    except StepRejected:
        return None


def _run(model: Model, method: Method, settings: BenchSettings, recorder: RunRecorder) -> Run:
    """Return the run, also where it could not go on; interrupting it interrupts everything."""
    try:
        run = simulate(model, method, schedule_of(settings), recorder=recorder)
    except RunStopped as stopped:
        partial: Run = stopped.run  # type: ignore[assignment]
        return partial
    if not run.report.finished:
        raise KeyboardInterrupt
    return run
