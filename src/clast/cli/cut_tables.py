"""Terminal output of a cut, as tables and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from clast.cli.terminal_tables import two_columns

if TYPE_CHECKING:
    from rich.table import Table

    from clast.inputs.placing.place_rock_mass import CutCase
    from clast.rockmass.cut_report import Finding, Sizes

FINDINGS = {
    "dangling": "ends taken out",
    "loose": "ends just short of a line",
    "collapsed": "edges collapsed",
    "merged": "blocks merged",
    "rings": "rings split",
    "coincident": "edges of several joints",
    "snapped": "points moved",
}
"""Finding of the report -> its name in the table."""


def cut_content(found: CutCase) -> dict[str, Any]:
    """Return the report of a cut for JSON."""
    return {
        **found.cut.report.as_dict(),
        "fixed_blocks": int(found.fixed.sum()),
        "rocks": {name: found.rocks.count(name) for name in found.cut.rock_names},
        "notes": list(found.notes),
        "warnings": list(found.warnings),
    }


def cut_table(found: CutCase, title: str) -> Table:
    """Return the number of blocks, and changes to lines and blocks with their first places."""
    report = found.cut.report
    rows = {
        "blocks": f"{report.blocks} ({int(found.fixed.sum())} fixed)",
        "rocks": ", ".join(f"{name} {found.rocks.count(name)}" for name in found.cut.rock_names),
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


HEADINGS = ("set", "lines", "length, m", "P21, m/m2", "asked", "P10, 1/m", "persistence", "asked")


def sets_table(found: CutCase) -> Table:
    """Return the statistics of each joint set."""
    from rich.table import Table
    from rich.text import Text

    table = Table(title="joint sets", title_justify="left")
    for number, heading in enumerate((*HEADINGS, "became edges")):
        table.add_column(heading, justify="right" if number else "left", no_wrap=bool(number))
    for one in found.cut.report.sets:
        asked = "" if one.p21_asked is None else f"{one.p21_asked:.4g}"
        table.add_row(
            Text(one.name),
            f"{one.lines}",
            f"{one.length:.4g}",
            f"{one.p21:.4g}",
            asked,
            f"{one.p10:.4g}",
            f"{one.persistence:.3g}",
            f"{one.persistence_asked:.3g}",
            f"{100.0 * one.kept:.3g} %",
        )
    return table
