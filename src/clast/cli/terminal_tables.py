"""Terminal output of runs, cases, verification and comparisons, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from clast.cli.terminal import print_json, print_table, tell

if TYPE_CHECKING:
    from rich.table import Table

    from clast.model.stage_records import StageRecord
    from clast.model.state import Ledger
    from clast.model.surroundings import Repair
    from clast.results import Report, Run
    from clast.run.preflight import CaseSummary
    from clast.studies import ComparedMethods, Deviation
    from clast.verification import Row

STORED = ("kinetic", "elastic", "gravity", "contact", "fixed_points", "bolts", "actions")
BROUGHT = ("loads", "water", "motions")
LOST = (
    "friction",
    "impacts",
    "yielding",
    "damping",
    "boundary",
    "removed",
    "numerical",
)
"""Entries of the energy ledger that lines of the report show."""


def print_run(run: Run, deviations: Sequence[Deviation], *, as_json: bool, quiet: bool) -> None:
    """Print the summary of a run and how far it is from its references, as tables or JSON."""
    points = {name: _last_of(run, name) for name in run.model.measured_points.name}
    if as_json:
        content = {"title": run.model.title, "output": str(run.output), "time": run.state.time}
        known = {"measured_points": points, "references": [one.as_dict() for one in deviations]}
        print_json({**content, **run.report.as_dict(), **known})
    elif not quiet:
        print_table(report_table(run))
        print_stages(run.stages)
        print_points(points)
        for one in deviations:
            source = f" ({one.source})" if one.source else ""
            tell(f"error of {one.point} at t = {one.time:g} s: {one.as_text()}{source}")
        tell(f"results: {run.output}")


def _last_of(run: Run, name: str) -> dict[str, Any]:
    """Return where a measured point is at the end of a run."""
    history = run.history(name)
    return {
        "displacement": history.displacement[-1].tolist(),
        "velocity": history.velocity[-1].tolist(),
        "rotation": float(history.rotation[-1]),
    }


def report_table(run: Run) -> Table:
    """Return how a run went, as a table."""
    report, ledger = run.report, run.report.ledger
    sizes = run.step_sizes
    stages = dict(sorted(report.seconds.items(), key=lambda item: -item[1]))
    compiling = stages.pop("compilation", 0.0)
    speed = run.state.time / report.wall_seconds if report.wall_seconds > 0.0 else 0.0
    rows = {
        "outcome": report.outcome,
        "simulated time": f"{run.state.time:.6g} s, {speed:.3g} s per s of wall time",
        "steps": f"{report.steps}, {report.cut_steps} cut; {_counts_text(report)}",
        "step size": f"{sizes.min():.3g} to {sizes.max():.3g} s" if len(sizes) else "",
        "contacts": f"at most {report.largest_contacts}",
        "penetration": f"at most {report.largest_penetration:.3g} m",
        "energy": _entries_text(ledger, STORED),
        **({"brought in": _entries_text(ledger, BROUGHT)} if ledger.brought else {}),
        "dissipated": _entries_text(ledger, LOST) + f", unaccounted {ledger.unaccounted:.2g} J/m",
        "wall time": f"{report.wall_seconds:.3g} s: "
        + ", ".join(f"{name} {seconds:.2g}" for name, seconds in stages.items()),
        **({"compilation": f"{compiling:.3g} s, once; not in the wall time"} if compiling else {}),
        **_notes_rows(report.notes),
    }
    return two_columns(run.model.title, rows)


def _entries_text(ledger: Ledger, names: Sequence[str]) -> str:
    """Return entries of the ledger: the first always, the others where there is something."""
    texts = [
        f"{name.replace('_', ' ')} {getattr(ledger, name):.4g}"
        for name in names
        if name == names[0] or getattr(ledger, name) != 0.0
    ]
    return ", ".join(texts) + " J/m"


def _counts_text(report: Report) -> str:
    """Return the counts of the process, with the number per step where it is not a whole one."""
    steps = max(1, report.steps)
    texts = []
    for name, number in {"passes": report.passes, **report.counts}.items():
        share = f" ({number / steps:.3g} a step)" if number % steps else ""
        texts.append(f"{number} {COUNTED.get(name, name)}{share}")
    return ", ".join(texts)


COUNTED = {
    "line_search": "steps of the line search",
    "interior": "minimisations by the interior point method",
    "local": "iterations of few blocks by themselves",
}
"""Names of the counts of the report."""


def _notes_rows(notes: Sequence[str]) -> dict[str, str]:
    """Return the choices that clast made by itself as a row of a table, or none."""
    return {"chosen by clast": "\n".join(notes)} if notes else {}


def repair_rows(repairs: Sequence[Repair]) -> dict[str, str]:
    """Return the repairs of blocks as a row of a table, or none."""
    return {"repairs": "\n".join(map(str, repairs))} if repairs else {}


def print_points(points: dict[str, dict[str, Any]]) -> None:
    """Print where the measured points are at the end, if there are any."""
    if not points:
        return
    from rich.table import Table
    from rich.text import Text

    bench_table = Table(title="measured points at the end", title_justify="left")
    bench_table.add_column("point", overflow="fold")
    for head in ("u, m", "v, m", "u', m/s", "v', m/s", "rotation, rad"):
        bench_table.add_column(head, justify="right", no_wrap=True)
    for name, last in points.items():
        numbers = (*last["displacement"], *last["velocity"], last["rotation"])
        bench_table.add_row(Text(name), *(f"{number:.5g}" for number in numbers))
    print_table(bench_table)


def print_stages(stages: Sequence[StageRecord]) -> None:
    """Print how the stages went, if there are any."""
    if not stages:
        return
    from rich.table import Table
    from rich.text import Text

    bench_table = Table(title="stages", title_justify="left")
    bench_table.add_column("stage", overflow="fold")
    for head in ("from, s", "to, s", "steps"):
        bench_table.add_column(head, justify="right", no_wrap=True)
    bench_table.add_column("outcome", no_wrap=True)
    bench_table.add_column("unbalanced", justify="right", no_wrap=True)
    bench_table.add_column("largest mover", overflow="fold")
    bench_table.add_column("wall, s", justify="right", no_wrap=True)
    for one in stages:
        numbers = f"{one.start:.6g}", f"{one.end:.6g}", f"{one.steps}"
        ending = f"{one.force_ratio:.2g}", str(one.mover), f"{one.seconds:.3g}"
        bench_table.add_row(*map(Text, (one.name, *numbers, one.outcome, *ending)))
    print_table(bench_table)


def sanity_table(sanity: CaseSummary) -> Table:
    """Return the contents of a case and the choices that clast made by itself, as a table."""
    left, low, right, high = sanity.box
    names = ", ".join(sanity.unsupported[:5]) + (", ..." if len(sanity.unsupported) > 5 else "")
    rows = {
        "blocks": f"{sanity.blocks} ({sanity.fixed_blocks} fixed)",
        "vertices": f"{sanity.vertices}",
        "rocks": ", ".join(sanity.rocks),
        "joints": ", ".join(sanity.joints),
        "fixed points": f"{sanity.fixed_points}",
        "loads": f"{sanity.loads}",
        "measured points": f"{sanity.measured_points}",
        "mass": f"{sanity.mass:.6g} kg/m",
        "bounding box": f"({left:.6g}, {low:.6g}) to ({right:.6g}, {high:.6g}) m",
        "smallest block": f"{sanity.smallest[0]}, {sanity.smallest[1]:.4g} m2",
        "largest block": f"{sanity.largest[0]}, {sanity.largest[1]:.4g} m2",
        "contacts at the start": f"{sanity.contacts} in {sanity.touching_pairs} pairs",
        "unsupported blocks": f"{len(sanity.unsupported)} {f'({names})' if names else ''}".strip(),
        "steps": f"{sanity.steps}",
        **({"stages": ", ".join(sanity.stages)} if sanity.stages else {}),
        "max_displacement": f"{sanity.max_displacement:.4g} m",
        "critdis": f"{sanity.critdis:.4g} m",
        "p h2/m": f"{sanity.stability_number:.4g} "
        f"(without passes at most {sanity.stability_limit:g})",
        **repair_rows(sanity.repairs),
        **_notes_rows(sanity.notes),
    }
    return two_columns(sanity.title, rows)


def verification_table(title: str, rows: Sequence[Row]) -> Table:
    """Return computed values beside exact ones, and below why some are known to fail."""
    from rich.table import Table
    from rich.text import Text

    from clast.verification import HEADINGS, cells

    reasons = dict.fromkeys(row.known_failure for row in rows if row.known_failure)
    bench_table = Table(
        title=Text(title),
        title_justify="left",
        caption=Text("\n".join(f"known to fail: {reason}" for reason in reasons)),
        caption_justify="left",
    )
    # the title names the problem already
    for heading in HEADINGS[1:]:
        numeric = heading in ("computed", "exact", "error", "tolerance")
        bench_table.add_column(heading, justify="right" if numeric else "left", no_wrap=numeric)
    for row in rows:
        bench_table.add_row(*(Text(cell) for cell in cells(row)[1:]))
    return bench_table


def comparison_table(comparison: ComparedMethods) -> Table:
    """Return the results of each process and law for a case, and the remarks on them."""
    from rich.table import Table
    from rich.text import Text

    from clast.studies.comparison_pages import cells, headings, remarks

    bench_table = Table(
        title=Text(comparison.title),
        title_justify="left",
        caption=Text("\n".join(remarks(comparison))),
        caption_justify="left",
    )
    heads = headings(comparison)
    for heading in heads:
        words = heading in (*heads[:2], heads[-1])
        wraps = heading == heads[-1]
        bench_table.add_column(heading, justify="left" if words else "right", no_wrap=not wraps)
    for row in comparison.rows:
        bench_table.add_row(*(Text(cell) for cell in cells(comparison, row)))
    return bench_table


def two_columns(title: str, rows: dict[str, str]) -> Table:
    """Return names and texts as a table of two columns without headings."""
    from rich.table import Table
    from rich.text import Text

    bench_table = Table(title=Text(title), title_justify="left", show_header=False)
    for key, value in rows.items():
        bench_table.add_row(key, Text(value))
    return bench_table
