"""What simulations cost: scenes of any size, measured by stage, beside the machine's memory.

benchmark = bench.benchmark(bench.Settings(scenes=("wall",), sizes=(1000,), steps=20))
benchmark.rows[0].milliseconds
"""

from __future__ import annotations

from clast.studies.bench.measured import Benchmark, Measured
from clast.studies.bench.measuring import benchmark, measure, warm_up
from clast.studies.bench.scenes import SCENES, Scene
from clast.studies.bench.settings import Settings, sizes_in

__all__ = [
    "SCENES",
    "Benchmark",
    "Measured",
    "Scene",
    "Settings",
    "benchmark",
    "measure",
    "sizes_in",
    "warm_up",
]
