"""What simulations cost: scenes of any size, measured by stage, beside the machine's memory.

benchmark = bench.benchmark(bench.Settings(scenes=("wall",), sizes=(1000,), steps=20))
benchmark.rows[0].milliseconds
bench.benchmark(bench.Settings(scenes=("cut",), sizes=(1000,))).cuts[0].total
"""

from __future__ import annotations

from clast.studies.bench.cuts import CUTS, CutScene, MeasuredCut, measure_cut
from clast.studies.bench.measured import Benchmark, Measured
from clast.studies.bench.measuring import benchmark, measure, warm_up
from clast.studies.bench.scenes import SCENES, Scene
from clast.studies.bench.settings import Settings, sizes_in

__all__ = [
    "CUTS",
    "SCENES",
    "Benchmark",
    "CutScene",
    "Measured",
    "MeasuredCut",
    "Scene",
    "Settings",
    "benchmark",
    "measure",
    "measure_cut",
    "sizes_in",
    "warm_up",
]
