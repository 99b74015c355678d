"""The cost of simulations: scenes of any size, measured by stage, beside the machine's memory.

benchmark = bench.benchmark(bench.Settings(scenes=("wall",), sizes=(1000,), steps=20))
benchmark.rows[0].milliseconds
bench.benchmark(bench.Settings(scenes=("cut",), sizes=(1000,))).cuts[0].total
bench.benchmark(bench.Settings(scenes=("whole",), sizes=(100,))).wholes[0].processor_seconds
"""

from __future__ import annotations

from clast.studies.bench.cuts import CUTS, CutScene, MeasuredCut, measure_cut
from clast.studies.bench.measured import Benchmark, Measurement
from clast.studies.bench.measuring import benchmark, measure, warm_up
from clast.studies.bench.scenes import SCENES, Scene
from clast.studies.bench.settings import BenchSettings, sizes_in
from clast.studies.bench.whole import MeasuredWhole, deepest_overlap, measure_whole, method_of
from clast.studies.bench.whole_scenes import WHOLE_SCENES, WholeScene

__all__ = [
    "CUTS",
    "SCENES",
    "WHOLE_SCENES",
    "BenchSettings",
    "Benchmark",
    "CutScene",
    "MeasuredCut",
    "MeasuredWhole",
    "Measurement",
    "Scene",
    "WholeScene",
    "benchmark",
    "deepest_overlap",
    "measure",
    "measure_cut",
    "measure_whole",
    "method_of",
    "sizes_in",
    "warm_up",
]
