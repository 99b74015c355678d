"""A benchmark as tables of texts, for the command line and pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clast.studies.bench.cuts import MeasuredCut
from clast.studies.bench.measured import Benchmark, Measurement
from clast.studies.bench.whole import MeasuredWhole

NOTHING = "-"
"""The text where there is no figure."""
STAGES = (
    "contacts",
    "impacts",
    "base system",
    "law",
    "small islands",
    "assembly",
    "solve",
    "line search",
    "advance",
    "tunnelling",
    "ledger",
)
"""Stages in the order of a step; others follow."""
HEADINGS = (
    "scene",
    "blocks",
    "contacts",
    "steps",
    "passes",
    "pcg",
    "drift, m",
    "penetration, m",
    "wall per s",
    "µs/block/step",
)
"""Headings of the first table."""
MEMORY_HEADINGS = (
    "scene",
    "blocks",
    "build, s",
    "B/block",
    "B/contact",
    "peak, MiB",
    "product, GB/s",
    "of triad",
    "of triad in main memory",
)
"""Headings of the third table."""


WHOLE_HEADINGS = (
    "scene",
    "blocks",
    "simulated, s",
    "steps",
    "processor, s",
    "per s",
    "µs/block/step",
    "impacts",
    "passes",
    "overlap, mm",
    "speed, m/s",
    "numerical",
    "unaccounted",
)
"""Headings of the table of scenes that were simulated from beginning to end."""
CUT_HEADINGS = ("network", "blocks", "wall, s", "processor, s")
"""First headings of the table of networks that were cut; stages follow."""


def cut_headings(rows: Sequence[MeasuredCut]) -> tuple[str, ...]:
    """Return the headings of the table of networks that were cut: s in all, and by stage."""
    stages = dict.fromkeys(name for row in rows for name in row.seconds)
    return (*CUT_HEADINGS, *stages, "µs/block", "peak, MiB", "area error")


def cut_cells(rows: Sequence[MeasuredCut], row: MeasuredCut) -> tuple[str, ...]:
    """Return the texts of a row of that table."""
    stages = cut_headings(rows)[len(CUT_HEADINGS) : -3]
    return (
        row.scene.name,
        str(row.blocks),
        _number(row.total),
        _number(row.processor_seconds),
        *(_number(row.seconds.get(name)) for name in stages),
        _number(1e6 * row.total / row.blocks),
        f"{row.peak / 2**20:.0f}",
        f"{row.area_error:.1e}",
    )


def whole_cells(row: MeasuredWhole) -> tuple[str, ...]:
    """Return the texts of a row of the table of whole scenes, in the order of the headings."""
    ledger, cut = row.report.ledger, row.report.cut_steps
    return (
        row.scene.name,
        str(row.blocks),
        _number(row.simulated),
        f"{row.report.steps} ({cut} cut)" if cut else str(row.report.steps),
        _number(row.processor_seconds),
        f"{row.per_simulated_second:.3g} s",
        _number(row.microseconds),
        f"{100.0 * row.impacts:.1f} %",
        _number(row.counted("passes")),
        _number(1e3 * row.overlap),
        f"{row.speed:.1e}",
        f"{row.share(ledger.numerical):.1e}",
        f"{row.share(ledger.unaccounted):.1e}",
    )


def whole_stage_headings(rows: Sequence[MeasuredWhole]) -> tuple[str, ...]:
    """Return the headings of the table of the stages of whole scenes: s in all, and by stage."""
    return (
        "scene",
        "blocks",
        "processor, s",
        *_in_order(name for row in rows for name in row.seconds),
    )


def whole_stage_cells(rows: Sequence[MeasuredWhole], row: MeasuredWhole) -> tuple[str, ...]:
    """Return the texts of a row of that table: shares of the time in percent."""
    shares = (
        f"{100.0 * row.seconds.get(name, 0.0) / max(row.processor_seconds, 1e-12):.1f} %"
        for name in whole_stage_headings(rows)[3:]
    )
    return (row.scene.name, str(row.blocks), _number(row.processor_seconds), *shares)


def cells(row: Measurement) -> tuple[str, ...]:
    """Return the texts of a row, in the order of the headings."""
    return (
        row.scene.name,
        str(row.blocks),
        str(row.contacts),
        _steps(row),
        _number(row.counted("passes")),
        _number(row.counted("pcg")),
        _number(row.drift),
        _number(row.costs.penetration),
        f"{row.per_simulated_second:.3g} s",
        f"{1e3 * row.milliseconds / row.blocks:.3g}",
    )


def stage_headings(benchmark: Benchmark) -> tuple[str, ...]:
    """Return the headings of the second table: ms per step, and by stage."""
    return ("scene", "blocks", "ms/step", *_stages(benchmark.rows))


def stage_cells(benchmark: Benchmark, row: Measurement) -> tuple[str, ...]:
    """Return the texts of a row of the second table."""
    used = row.stages
    return (
        row.scene.name,
        str(row.blocks),
        f"{row.milliseconds:.3g}",
        *(_number(used.get(name)) for name in _stages(benchmark.rows)),
    )


def memory_cells(benchmark: Benchmark, row: Measurement) -> tuple[str, ...]:
    """Return the texts of a row of the third table: memory and its bandwidth."""
    product = row.product
    rates = (NOTHING, NOTHING, NOTHING)
    if product is not None:
        rates = (
            f"{product.rate / 1e9:.3g}",
            f"{100.0 * product.share:.0f} %",
            f"{100.0 * product.rate / benchmark.triad:.0f} %",
        )
    return (
        row.scene.name,
        str(row.blocks),
        f"{row.build_seconds:.3g}",
        f"{row.footprint.per_block:.0f}",
        f"{row.footprint.per_contact:.0f}",
        f"{row.peak / 2**20:.0f}",
        *rates,
    )


def remarks(benchmark: Benchmark) -> list[str]:
    """Return the remarks below the tables: the machine, units, runs that stopped."""
    said = [str(benchmark.machine)]
    if benchmark.cuts:
        said.append("area error: sum of the areas of the blocks against the domain's, as a share")
    if benchmark.wholes:
        said.append(
            "whole scenes: time of the processor from beginning to end; impacts: their share of "
            "it; overlap and speed: the thickest and the largest at the end; numerical, "
            "unaccounted: energy that the time integration removed or brought in, and that the "
            "ledger does not explain, as shares of the energy turned over"
        )
        said += [
            f"{row.scene.name}, {row.blocks} blocks: {row.report.outcome}"
            for row in benchmark.wholes
            if not row.report.finished
        ]
    return said + (_remarks_of_runs(benchmark) if benchmark.rows else [])


def _remarks_of_runs(benchmark: Benchmark) -> list[str]:
    settings = benchmark.settings
    said = [
        f"h = {settings.step:g} s, p/E = {settings.share:g}, solver {settings.solver}"
        + (f"; {settings.settle} steps before are not counted" if settings.settle else ""),
        "passes, pcg: Newton iterations and iterations of the solver per step; drift: "
        "largest horizontal movement of blocks that should rest (slopes settle along "
        "their joints as well)",
        f"triad in main memory: {_rate(benchmark.triad)} by one thread, "
        f"{_rate(benchmark.triad_by_threads)} by all; 'of triad': over as many bytes as "
        "the product moves, by as many threads",
    ]
    for row in benchmark.rows:
        if not row.report.finished:
            said.append(f"{row.scene.name}, {row.blocks} blocks: {row.report.outcome}")
    return said


def _stages(rows: Sequence[Measurement]) -> tuple[str, ...]:
    """Return all stages that a row has, in the order of a step."""
    named = _in_order(name for row in rows for name in row.stages)
    return (*(name for name in named if name != "other"), "other")


def _in_order(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of stages, each once, in the order of a step."""
    found = dict.fromkeys(names)
    return (*(one for one in STAGES if one in found), *(one for one in found if one not in STAGES))


def _steps(row: Measurement) -> str:
    cut = row.report.cut_steps
    return f"{row.costs.steps} ({cut} cut)" if cut else str(row.costs.steps)


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3g}"


def _rate(rate: float) -> str:
    return f"{rate / 1e9:.3g} GB/s"
