"""Tables of what was measured, for the terminal and docs/performance.md, from rows of JSON."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

Row = Mapping[str, Any]

WHOLE_HEADINGS = (
    "scene",
    "blocks",
    "simulated, s",
    "steps",
    "processor",
    "µs per block and step",
    "passes",
    "detection",
    "impacts",
    "minimisation",
    "overlap, mm",
    "speed, m/s",
    "numerical",
    "unaccounted",
)
MINIMISATION = ("law", "small islands", "assembly", "solve", "line search")
PEER_HEADINGS = ("program", "processor per simulated second", "drift", "overlap", "remark")
BENCH_HEADINGS = (
    "scene",
    "blocks",
    "contacts",
    "ms per step",
    "µs per block and step",
    "passes",
    "pcg",
    "drift, mm",
    "penetration, mm",
    "peak, MiB",
    "solves",
    "small islands",
)


CUT_HEADINGS = (
    "network",
    "blocks",
    "wall, s",
    "processor, s",
    "µs per block",
    "peak, MiB",
    "error",
)
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


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a Markdown table: words to the left, numbers to the right."""
    columns = zip(*rows, strict=True)
    numbers = (all(text[:1] in "-0123456789" for text in column) for column in columns)
    under = ["---:" if is_number else "---" for is_number in numbers]
    return [
        "| " + " | ".join(text.replace("|", "\\|") for text in line) + " |"
        for line in (heads, under, *rows)
    ]


def printed(content: Row) -> str:
    """Return the tables of a benchmark and the remarks on it, as text."""
    lines: list[str] = []

    def add(title: str, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        lines.extend(["", title, "", *markdown_table(headings, list(rows))])

    cuts, wholes, rows = content["cuts"], content["wholes"], content["rows"]
    if cuts:
        add("cutting; error: of the sum of areas", CUT_HEADINGS, map(cut_cells, cuts))
        add("wall time by stage, s", *stage_table(cuts, lambda row: row["seconds_by_stage"]))
    if wholes:
        add("from beginning to end, processor time", WHOLE_HEADINGS, map(whole_cells, wholes))
        add("shares of the processor time, %", *stage_table(wholes, shares_of_stages))
    if rows:
        add("first steps", BENCH_HEADINGS, map(bench_cells, rows))
        add("ms per step", *stage_table(rows, lambda row: row["ms_per_step_by_stage"]))
    lines += ["", machine_text(content["machine"])]
    lines += [
        f"{row['scene']}, {row['blocks']} blocks: {row['outcome']}"
        for row in (*wholes, *rows)
        if not row["finished"]
    ]
    return "\n".join(lines[1:]) + "\n"


def shares_of_stages(row: Row) -> dict[str, float]:
    """Return the percentage of the processor time that each stage takes."""
    used = max(row["processor_seconds"], 1e-12)
    return {name: 100.0 * each / used for name, each in row["processor_seconds_by_stage"].items()}


def stage_table(
    rows: Sequence[Row], values: Callable[[Row], Mapping[str, float]]
) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Return headings and cells of a value for each stage, in the order of a step."""
    used = dict.fromkeys(name for row in rows for name in values(row))
    names = [name for name in STAGES if name in used]
    names += [name for name in used if name not in STAGES]
    cells: list[Sequence[str]] = []
    for row in rows:
        each = values(row)
        texts = (f"{each[name]:.3g}" if name in each else "-" for name in names)
        cells.append((row["scene"], str(row["blocks"]), *texts))
    return ("scene", "blocks", *names), cells


def cut_cells(row: Row) -> Sequence[str]:
    """Return the texts of a row of the table of networks that were cut."""
    return (
        row["scene"],
        str(row["blocks"]),
        f"{row['wall_seconds']:.3g}",
        f"{row['processor_seconds']:.3g}",
        f"{1e6 * row['wall_seconds'] / row['blocks']:.3g}",
        f"{row['peak_memory'] / 2**20:.0f}",
        f"{row['area_error']:.1e}",
    )


def machine_text(machine: Mapping[str, Any]) -> str:
    """Return a machine in words."""
    versions = ", ".join(f"{name} {number}" for name, number in machine["versions"].items())
    memory = machine["memory"] / 2**30
    return f"{machine['cpu']}, {machine['cores']} cores, {memory:.3g} GiB; {versions}"


def peer_cells(row: Mapping[str, Any]) -> Sequence[str]:
    """Return the texts of a row of the first tables."""
    return (
        row["program"],
        f"{row['per_simulated_second']:.3g} s",
        _millimetres(row["drift"]),
        _millimetres(row["overlap"]),
        row["remark"],
    )


def bench_cells(row: Mapping[str, Any]) -> Sequence[str]:
    """Return the texts of a row of the last table."""
    counts = row["counts_per_step"]
    return (
        row["scene"],
        str(row["blocks"]),
        str(row["contacts"]),
        f"{row['ms_per_step']:.3g}",
        f"{1e3 * row['ms_per_step'] / row['blocks']:.3g}",
        f"{counts['passes']:.3g}",
        f"{counts['pcg']:.3g}" if "pcg" in counts else "-",
        "-" if row["drift"] is None else f"{1e3 * row['drift']:.3g}",
        f"{1e3 * row['largest_penetration']:.3g}",
        f"{row['peak_memory'] / 2**20:.0f}",
        _share(row, "solve"),
        _share(row, "small islands"),
    )


def whole_cells(row: Mapping[str, Any]) -> Sequence[str]:
    """Return the texts of a row of the table of scenes from beginning to end."""
    used, counts = row["processor_seconds"], row["counts_per_step"]
    turned = row["energy_turned_over"]
    stages = row["processor_seconds_by_stage"]
    minimised = sum(stages.get(name, 0.0) for name in MINIMISATION)
    return (
        row["scene"],
        str(row["blocks"]),
        f"{row['simulated']:.3g}",
        str(row["steps"]),
        f"{used:.3g} s",
        f"{1e6 * used / row['steps'] / row['blocks']:.3g}",
        f"{counts.get('passes', 0.0):.3g}",
        f"{100.0 * stages.get('contacts', 0.0) / used:.0f} %",
        f"{100.0 * row['share_of_impacts']:.0f} %",
        f"{100.0 * minimised / used:.0f} %",
        f"{1e3 * row['overlap_at_end']:.3g}",
        f"{row['speed_at_end']:.1e}",
        f"{abs(row['energy_lost_by_integration']) / turned:.1e}" if turned else "-",
        f"{abs(row['energy_unaccounted']) / turned:.1e}" if turned else "-",
    )


def _share(row: Mapping[str, Any], stage: str) -> str:
    """Return which share of a step a stage takes."""
    return f"{100.0 * row['ms_per_step_by_stage'].get(stage, 0.0) / row['ms_per_step']:.0f} %"


def _millimetres(value: float | None) -> str:
    return "-" if value is None else f"{1e3 * value:.3g} mm"


def put_tables(page: Path, tables: Mapping[str, Sequence[str]]) -> None:
    """Replace the named parts of a page, from ``<!-- name -->`` to ``<!-- end -->``."""
    text = page.read_text(encoding="utf-8")
    for name, lines in tables.items():
        part = "\n".join([f"<!-- {name} -->", "", *lines, "", "<!-- end -->"])
        pattern = rf"<!-- {re.escape(name)} -->.*?<!-- end -->"
        text = re.sub(pattern, lambda _, part=part: part, text, flags=re.DOTALL)
    page.write_text(text, encoding="utf-8")
