"""Terminal output of runs, cases, cuts, verification and comparisons, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from clast.cli.terminal import print_json, print_table, table_of, tell, two_columns

if TYPE_CHECKING:
    from rich.table import Table

    from clast.inputs.placing.place_rock_mass import CutCase
    from clast.model.stage_records import StageRecord
    from clast.model.state import Ledger
    from clast.results import Run
    from clast.rockmass.cut_report import Finding, Sizes
    from clast.run.preflight import CaseSummary
    from clast.studies import ComparedMethods, Deviation
    from clast.verification import Row

COMPARED_PER_TABLE = 3
STORED = ("kinetic", "elastic", "gravity", "contact", "fixed_points", "bolts", "actions")
BROUGHT = ("loads", "water", "motions")
LOST = ("friction", "impacts", "yielding", "damping", "boundary", "removed", "numerical")
"""Entries of the energy ledger that lines of the report show."""


def print_run(
    run: Run, deviations: Sequence[Deviation], *, as_json: bool, quiet: bool, verbose: bool
) -> None:
    """Print how a run ended and how far it is from its references, as tables or JSON."""
    points = {}
    for name in run.model.measured_points.name:
        history = run.history(name)
        points[name] = {
            "displacement": history.displacement[-1].tolist(),
            "velocity": history.velocity[-1].tolist(),
            "rotation": float(history.rotation[-1]),
        }
    report = run.report
    if as_json:
        content = {"title": run.model.title, "output": str(run.output), "time": run.state.time}
        found = {"measured_points": points, "references": [one.as_dict() for one in deviations]}
        print_json({**content, **report.as_dict(), **found})
        return
    if quiet:
        return
    wall = f"; {report.wall_seconds:.3g} s of wall time"
    # clast check lists those on the model
    known = set() if verbose else {*map(str, run.model.repairs), *run.model.notes}
    notes = [one for one in report.notes if one not in known]
    if left := len(report.notes) - len(notes):
        notes.append(f"notes on the model, which clast check lists: {left}")
    rows = {
        "outcome": report.outcome,
        "simulated time": f"{run.state.time:.6g} s in {report.steps} steps{wall}",
        "chosen by clast": "\n".join(notes),
    }
    print_table(two_columns(run.model.title, rows))
    print_stages(run.stages)
    print_points(points)
    for one in deviations:
        source = f" ({one.source})" if one.source else ""
        tell(f"error of {one.point} at t = {one.time:g} s: {one.as_text()}{source}")
    if verbose:
        print_table(_statistics_table(run))
    tell(f"results: {run.output}")


def _statistics_table(run: Run) -> Table:
    """Return steps, energies and times of the solver, as a table."""
    report, ledger = run.report, run.report.ledger
    sizes = run.step_sizes
    stages = dict(sorted(report.seconds.items(), key=lambda item: -item[1]))
    compiling = stages.pop("compilation", 0.0)
    speed = run.state.time / report.wall_seconds if report.wall_seconds > 0.0 else 0.0
    times = ", ".join(f"{name} {seconds:.2g}" for name, seconds in stages.items())
    count = max(1, report.steps)
    counts = [f"{report.steps}, {report.cut_steps} cut"]
    for name, number in {"passes": report.passes, **report.counts}.items():
        # the number per step where it is not a whole one
        share = f" ({number / count:.3g} a step)" if number % count else ""
        counts.append(f"{number} {COUNTED.get(name, name)}{share}")
    lost = _entries_text(ledger, LOST)
    rows = {
        "speed": f"{speed:.3g} s per s of wall time",
        "steps": "; ".join([counts[0], ", ".join(counts[1:])]),
        "step size": f"{sizes.min():.3g} to {sizes.max():.3g} s" if len(sizes) else "",
        "contacts": f"at most {report.largest_contacts}",
        "penetration": f"at most {report.largest_penetration:.3g} m",
        "energy": _entries_text(ledger, STORED),
        "brought in": _entries_text(ledger, BROUGHT) if ledger.brought else "",
        "dissipated": f"{lost}, unaccounted {ledger.unaccounted:.2g} J/m",
        "wall time": f"{report.wall_seconds:.3g} s: {times}",
        "compilation": f"{compiling:.3g} s, once; not in the wall time" if compiling else "",
    }
    return two_columns("solver", rows)


def _entries_text(ledger: Ledger, names: Sequence[str]) -> str:
    """Return entries of the ledger: the first always, the others where there is something."""
    texts = [
        f"{name.replace('_', ' ')} {getattr(ledger, name):.4g}"
        for name in names
        if name == names[0] or getattr(ledger, name) != 0.0
    ]
    return ", ".join(texts) + " J/m"


COUNTED = {
    "line_search": "steps of the line search",
    "interior": "minimisations by the interior point method",
    "local": "iterations of few blocks by themselves",
}


def print_points(points: dict[str, dict[str, Any]]) -> None:
    """Print where the measured points are at the end, if there are any."""
    rows = [
        (
            name,
            *(f"{one:.5g}" for one in (*last["displacement"], *last["velocity"], last["rotation"])),
        )
        for name, last in points.items()
    ]
    if rows:
        headings = ("point", "u, m", "v, m", "u', m/s", "v', m/s", "rotation, rad")
        print_table(table_of("measured points at the end", headings, rows))


def print_measured(content: dict[str, Any]) -> None:
    """Print convergences, flows and reactions at the end, from the summary of a result file."""
    pairs = [
        (name, f"{one['convergence']:.5g}", f"{100.0 * one['convergence'] / one['distance']:.3g}")
        for name, one in content["convergences"].items()
    ]
    if pairs:
        heads = ("convergence", "m", "% of the distance")
        print_table(table_of("convergences at the end", heads, pairs))
    flows = [
        (name, *(f"{value:.5g}" for value in one.values()))
        for name, one in content["flows"].items()
    ]
    if flows:
        of_flows = ("flow", "into the rock, m2/s", "out of it", "run-off", "pressure, Pa")
        print_table(table_of("water in joints at the end", of_flows, flows))
    supports = [
        (name, *(f"{1e-3 * part:.5g}" for part in (*one["force"], one["moment"])))
        for name, one in content["reactions"].items()
    ]
    if supports:
        of_supports = ("support", "x, kN/m", "y, kN/m", "moment, kN m/m")
        print_table(table_of("reactions at the end", of_supports, supports))


def print_stages(stages: Sequence[StageRecord]) -> None:
    """Print how the stages went, if there are any: verdicts first."""
    rows = [
        (
            *(one.name, one.outcome, f"{one.force_ratio:.2g}", str(one.mover)),
            *(f"{one.start:.6g}", f"{one.end:.6g}", f"{one.steps}", f"{one.seconds:.3g}"),
        )
        for one in stages
    ]
    if rows:
        headings = ("stage", "outcome", "unbalanced", "largest mover")
        numbers = ("from, s", "to, s", "steps", "wall, s")
        print_table(table_of("stages", (*headings, *numbers), rows, words=(0, 1, 3)))


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
        "stages": ", ".join(sanity.stages),
        "max_displacement": f"{sanity.max_displacement:.4g} m",
        "critdis": f"{sanity.critdis:.4g} m",
        "p h2/m": f"{sanity.stability_number:.4g} "
        f"(without passes at most {sanity.stability_limit:g})",
        "repairs": "\n".join(map(str, sanity.repairs)),
        "chosen by clast": "\n".join(sanity.notes),
    }
    return two_columns(sanity.title, rows)


def verification_table(title: str, rows: Sequence[Row]) -> Table:
    """Return computed values beside exact ones, and below why some are known to fail."""
    from clast.verification import HEADINGS, cells

    reasons = dict.fromkeys(row.known_failure for row in rows if row.known_failure)
    # the title names the problem already
    heads, numeric = HEADINGS[1:], ("computed", "exact", "error", "tolerance")
    return table_of(
        title,
        heads,
        [cells(row)[1:] for row in rows],
        words=[k for k, heading in enumerate(heads) if heading not in numeric],
        caption="\n".join(f"known to fail: {reason}" for reason in reasons),
    )


def print_comparison(comparison: ComparedMethods) -> None:
    """Print the results of processes and laws for a case, a few in a table, and remarks on them."""
    from clast.studies.comparison_pages import cells, headings, remarks

    heads = headings(comparison)
    columns = [cells(comparison, row) for row in comparison.rows]
    for first in range(0, len(columns), COMPARED_PER_TABLE):
        some = columns[first : first + COMPARED_PER_TABLE]
        rows = zip(heads[2:], *(column[2:] for column in some), strict=True)
        names = [" ".join(column[:2]) for column in some]
        print_table(table_of("" if first else comparison.title, ("", *names), rows))
    for remark in remarks(comparison):
        tell(remark)


# Cuts ---------------------------------------------------------------------------------------------


FINDINGS = {
    "dangling": "ends taken out",
    "loose": "ends just short of a line",
    "collapsed": "edges collapsed",
    "merged": "blocks merged",
    "rings": "rings split",
    "coincident": "edges of several joints",
    "snapped": "points moved",
}


def cut_content(result: CutCase) -> dict[str, Any]:
    """Return the report of a cut for JSON."""
    return {
        **result.cut.report.as_dict(),
        "fixed_blocks": int(result.fixed.sum()),
        "rocks": {name: result.rocks.count(name) for name in result.cut.rock_names},
        "notes": list(result.notes),
        "warnings": list(result.warnings),
    }


def cut_table(result: CutCase, title: str) -> Table:
    """Return the number of blocks, and changes to lines and blocks with their first places."""
    report = result.cut.report
    rows = {
        "blocks": f"{report.blocks} ({int(result.fixed.sum())} fixed)",
        "rocks": ", ".join(f"{name} {result.rocks.count(name)}" for name in result.cut.rock_names),
        "area": f"{report.area:.6g} m2, of the domain {report.domain_area:.6g} m2: "
        f"relative error {abs(report.area_error):.1e}",
        "areas of blocks": _sizes(report.block_area, "m2"),
        "lengths of edges": _sizes(report.edge_length, "m"),
        "aspect": _sizes(report.aspect, ""),
        "tolerance": f"{report.tolerance:.4g} m; edges from {report.smallest_edge:.4g} m, blocks "
        f"from {report.smallest_block:.4g} m2 on",
        **{
            title: _finding(getattr(report, key), report.tolerance)
            for key, title in FINDINGS.items()
        },
        "edges that stayed short": f"{report.short_edges}",
        "blocks that stayed small": f"{report.small_blocks}",
    }
    return two_columns(title, rows)


def _sizes(sizes: Sizes, unit: str) -> str:
    """Return smallest, median and largest."""
    text = f"{sizes.smallest:.4g}, median {sizes.median:.4g}, largest {sizes.largest:.4g}"
    return f"{text} {unit}".strip()


def _finding(finding: Finding, tolerance: float) -> str:
    """Return how often something was done, over which length, and where first."""
    from clast.rockmass.cut_report import place_text

    text = str(finding.count)
    if finding.length > 0.0:
        text += f", {finding.length:.4g} m"
    places = ", ".join(place_text(at, tolerance) for at in finding.places)
    return f"{text}: {places}" if places else text


def sets_table(result: CutCase) -> Table:
    """Return the statistics of each joint set."""
    rows = [
        (
            *(one.name, one.seen, f"{one.lines}", f"{one.length:.4g}", f"{one.p21:.4g}"),
            "" if one.p21_asked is None else f"{one.p21_asked:.4g}",
            *(f"{one.p10:.4g}", f"{one.persistence:.3g}", f"{one.persistence_asked:.3g}"),
            f"{100.0 * one.kept:.3g} %",
        )
        for one in result.cut.report.sets
    ]
    heads = (
        *("set", "apparent dip", "lines", "length, m", "P21, m/m2", "asked", "P10, 1/m"),
        *("persistence", "asked", "became edges"),
    )
    return table_of("joint sets", heads, rows, words=(0, 1))
