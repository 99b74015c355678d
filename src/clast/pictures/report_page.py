"""A report of a run for a client: one HTML file with figures and tables, made to be printed.

Forces are in kN/m, moments in kN m/m, stresses in MPa, displacements in mm, throughout.
"""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable, Iterator, Sequence
from datetime import date
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from clast.model.joints import WELD_STRENGTH
from clast.model.stage_records import BROKEN_OFF, FAILS, MOVING, REACHED, StageRecord
from clast.pictures.figure_options import Look
from clast.pictures.histories import plot_histories
from clast.pictures.linings import plot_interaction
from clast.pictures.page.document import html_path, write_html
from clast.pictures.plot import plot_results
from clast.results import Recording
from clast.results.frames import absent_in_frame
from clast.results.schema import BOLT_STATES

VECTOR_BLOCKS, CURVES_MAX, ROWS_MAX = 2000, 6, 60
"""Blocks from which on figures are images of dots, as drawings of lines are slow to open; measured
points whose curves are drawn; rows of a table."""
STIFFNESSES = ("normal_stiffness", "shear_stiffness")
STYLE = """
body { font: 11pt/1.45 Georgia, serif; color: #222; max-width: 46rem; margin: 2rem auto;
  padding: 0 1rem; }
h1, h2, th, figcaption { font-family: system-ui, sans-serif; }
h1 { font-size: 1.5rem; margin-bottom: .2rem; } h2 { font-size: 1.1rem; margin: 1.6rem 0 .4rem; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums;
  margin: .4rem 0; }
th, td { padding: .15rem .6rem; border-bottom: 1px solid #ccc; text-align: right; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
figure { margin: .8rem 0; break-inside: avoid; } figure img { max-width: 100%; }
figcaption, .small { font-size: .8rem; color: #555; } .fault { color: #a01020; font-weight: 600; }
table, li { break-inside: avoid; } @media print { body { margin: 0; max-width: none; } }
"""


def write_report(results: Recording, path: Path | str) -> Path:
    """Write the report of a run, complete in one file, and return its path.

    It has the section with supports and water, materials, a sentence for each stage, displacements,
    bolts, linings and reactions with their utilisation, curves of measured points, and warnings.
    A browser prints it, or saves it as PDF.  Raises CaseError where it cannot be written.
    """
    path = html_path(path)
    title = results.title or results.name
    with tempfile.TemporaryDirectory() as folder:
        figures = _Figures(results, Path(folder))
        parts = [part for make in PARTS for part in make(results, figures)]
    body = "\n".join(
        [
            f"<h1>{escape(title)}</h1>",
            f'<p class="small">{escape(results.name)}, computed by clast {escape(results.version)};'
            f" report of {date.today():%d %B %Y}</p>",
            *parts,
        ]
    )
    text = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
        "img-src data:; style-src 'unsafe-inline'\">"
        f"<title>{escape(title)} - report</title><style>{STYLE}</style></head>\n"
        f"<body>\n{body}\n</body></html>\n"
    )
    return write_html(text, path)


class _Figures:
    """Figures of a run, drawn into a folder and put into the page."""

    def __init__(self, results: Recording, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        fine = len(results.block_name) >= VECTOR_BLOCKS
        self._ending, self._kind = (".png", "image/png") if fine else (".svg", "image/svg+xml")

    def of(self, caption: str, draw: Callable[[Path], object]) -> str:
        """Return a figure with its caption; ``draw`` writes it to the path that it is given."""
        self._count += 1
        path = self._folder / f"figure{self._count}{self._ending}"
        draw(path)
        data = base64.b64encode(path.read_bytes()).decode()
        return (
            f'<figure><img src="data:{self._kind};base64,{data}" alt="{escape(caption)}">'
            f"<figcaption>Figure {self._count}. {escape(caption)}</figcaption></figure>"
        )


def _table(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Return a table; numbers with four digits, "-" for those that there are none of."""

    def cell(value: Any) -> str:
        if value is None or (isinstance(value, float) and not np.isfinite(value)):
            return "-"
        return f"{value:.4g}" if isinstance(value, float | np.floating) else escape(str(value))

    lines = ["<tr>" + "".join(f"<th>{escape(one)}</th>" for one in head) + "</tr>"]
    for row in rows[:ROWS_MAX]:
        lines.append("<tr>" + "".join(f"<td>{cell(one)}</td>" for one in row) + "</tr>")
    more = len(rows) - ROWS_MAX
    after = f'<p class="small">and {more} more: see the result file</p>' if more > 0 else ""
    return f"<table>{''.join(lines)}</table>{after}"


def _verdict(results: Recording, figures: _Figures) -> Iterator[str]:
    """Yield the outcome, a sentence for each stage, and the section."""
    report = results.report
    yield "<h2>Result</h2>"
    outcome = report.outcome if report else "the run has no report: it was killed, or goes on"
    bad = report is None or not report.finished
    yield f"<p{' class=fault' if bad else ''}>{escape(outcome[:1].upper() + outcome[1:])}.</p>"
    if results.stages:
        yield "<ol>"
        for stage in results.stages:
            fault = stage.outcome in (FAILS, MOVING, BROKEN_OFF)
            sentence = escape(stage_in_words(stage))
            yield f"<li{' class=fault' if fault else ''}>{sentence}</li>"
        yield "</ol>"
    look = Look(layers=("scale", "gravity"))
    yield figures.of(
        "Section at the end: displacement, supports, water and reactions.",
        lambda path: plot_results(results, path, contacts=False, reactions=True, look=look),
    )
    yield figures.of(
        "Principal stresses at the end (blue compression, red tension), by rock.",
        lambda path: plot_results(
            results, path, field="rock", contacts=False, look=Look(layers=("crosses", "scale"))
        ),
    )


def stage_in_words(stage: StageRecord) -> str:
    """Return how a stage ended, in a sentence for somebody who did not make the run."""
    unbalanced = 100.0 * stage.force_ratio
    share = f"forces out of balance {f'{unbalanced:.2g}' if unbalanced > 1e-3 else 'below 0.001'} %"
    bonds = f"; {stage.broken} bonds broke" if stage.broken else ""
    ends = {
        REACHED: f"The model is in equilibrium ({share}{bonds}).",
        FAILS: f"There is {stage.mechanism}." if stage.mechanism else "There is no equilibrium.",
        MOVING: f"Blocks still moved when its time was over: {stage.mover} ({share}{bonds}).",
        BROKEN_OFF: "The run ended within this stage.",
    }
    ended = ends.get(stage.outcome, f"It ended by its time ({share}{bonds}).")
    return f"Stage “{stage.name}”, {stage.start:.4g} to {stage.end:.4g} s. {ended}"


def _materials(results: Recording, _: _Figures) -> Iterator[str]:
    """Yield the tables of rocks and joints."""
    about: dict[str, Any] = getattr(results, "about", {})
    if not about:
        return
    yield "<h2>Materials</h2>"
    rocks = [
        (one["name"], one["young"] / 1e9, one["poisson"], one["density"])
        for one in about.get("rocks", ())
        if one.get("is_ground", True)  # segments of linings have moduli of their own
    ]
    yield _table(("rock", "E, GPa", "Poisson's ratio", "density, kg/m³"), rocks)
    joints = [
        (
            one["name"],
            one["friction_angle"],
            one["cohesion"] / 1e3,
            one["tensile_strength"] / 1e3,
            *(None if one[key] is None else 1e-9 * one[key] for key in STIFFNESSES),
        )
        for one in about.get("joints", ())
        if one["cohesion"] < WELD_STRENGTH
    ]
    head = ("joint", "friction, °", "cohesion, kPa", "tension, kPa", "kn, GPa/m", "ks, GPa/m")
    yield _table(head, joints)


def _displacements(results: Recording, figures: _Figures) -> Iterator[str]:
    """Yield the largest displacement, the measured points and their curves."""
    yield "<h2>Displacements</h2>"
    moved = np.where(absent_in_frame(results, -1)[:, None], 0.0, results.field("displacement", -1))
    worst = int(np.hypot(*moved.T).argmax())
    x, y = 1e3 * moved[worst]
    side, up = "left" if x < 0.0 else "right", "downwards" if y < 0.0 else "upwards"
    yield (
        f"<p>The largest displacement at the end is {np.hypot(x, y):.3g} mm, of block "
        f"{escape(results.block_name[worst])}: {abs(x):.3g} mm to the {side}, {abs(y):.3g} mm "
        f"{up}.</p>"
    )
    rows = []
    for name in results.point_name:
        history = results.history(name)
        last, size = 1e3 * history.displacement[-1], np.hypot(*history.displacement.T)
        rows.append((name, *map(float, last), 1e3 * float(size.max())))
    if rows:
        yield _table(("point", "x, mm", "y, mm", "largest in the run, mm"), rows)
    rows = []
    for name in results.convergence_name:
        approach = 1e3 * np.asarray(results.convergence(name).convergence)
        rows.append((name, float(approach[-1]), float(approach[np.abs(approach).argmax()])))
    if rows:
        yield _table(("convergence", "at the end, mm", "largest in the run, mm"), rows)
        yield figures.of(
            "Convergences over time.",
            partial(plot_histories, results, names=[f"convergence:{one[0]}" for one in rows]),
        )
    for name in results.point_name[:CURVES_MAX]:
        yield figures.of(
            f"Point {name} over time.", partial(plot_histories, results, names=[f"point:{name}"])
        )


def _bolts(results: Recording, figures: _Figures) -> Iterator[str]:
    """Yield the table of bolts."""
    if not results.bolt_name:
        return
    bolts = results.bolts(-1)
    rows = [
        (name, float(force) / 1e3, float(long) * 1e3, BOLT_STATES[int(state)])
        for name, force, long, state in zip(
            bolts.name, bolts.force, bolts.elongation, bolts.state, strict=True
        )
    ]
    yield "<h2>Bolts</h2>"
    yield _table(("bolt", "force, kN/m", "elongation, mm", "state"), rows)


def _linings(results: Recording, figures: _Figures) -> Iterator[str]:
    """Yield the extremes along each lining, and N and M beside the curve of its section."""
    if not results.lining_name:
        return
    yield "<h2>Linings</h2>"
    rows = []
    for name in results.lining_name:
        lining = results.lining(name)
        ends = [
            1e-3 * float(end(getattr(lining, column)[-1]))
            for column in ("normal_force", "shear_force", "moment")
            for end in (np.nanmin, np.nanmax)
        ]
        used = lining.utilisation[-1]
        rows.append((name, *ends, None if np.isnan(used).all() else 100.0 * np.nanmax(used)))
    head = ("lining", "N from, kN/m", "to", "Q from, kN/m", "to", "M from, kN m/m", "to", "used, %")
    yield _table(head, rows)
    for name in results.lining_name:
        if np.isfinite(results.lining(name).utilisation[-1]).any():
            yield figures.of(
                f"N and M of lining {name} and the strength of its section.",
                partial(plot_interaction, results, lining=name),
            )


def _reactions(results: Recording, _: _Figures) -> Iterator[str]:
    """Yield the reactions of supports at the end."""
    rows = []
    for name in results.reaction_name:
        reaction = results.reaction(name)
        x, y = 1e-3 * np.asarray(reaction.force)[-1]
        rows.append((name, float(x), float(y), 1e-3 * float(np.asarray(reaction.moment)[-1])))
    if rows:
        yield "<h2>Reactions of supports</h2>"
        yield _table(("support", "x, kN/m", "y, kN/m", "moment, kN m/m"), rows)


def _water(results: Recording, _: _Figures) -> Iterator[str]:
    """Yield the levels of water."""
    for one in results.water:
        level = np.asarray(one.surface)[:, 1] + np.asarray(results.origin)[1]
        flat = np.ptp(level) == 0.0
        yield "<h2>Water</h2>"
        where = (
            f"at y = {level[0]:.4g} m"
            if flat
            else f"from y = {level.min():.4g} to {level.max():.4g} m"
        )
        yield f"<p>A water level {where}.</p>"


def _notes(results: Recording, _: _Figures) -> Iterator[str]:
    """Yield warnings, and how the run was made."""
    report = results.report
    if report is None:
        return
    if report.warnings:
        yield "<h2>Warnings</h2><ul>"
        yield from (f"<li>{escape(one)}</li>" for one in report.warnings)
        yield "</ul>"
    yield "<h2>Computation</h2>"
    yield (
        f"<p>{report.steps} steps, {report.cut_steps} of them cut; largest penetration "
        f"{1e3 * report.largest_penetration:.3g} mm; {report.ledger.unaccounted:.2g} J/m of energy "
        "are unaccounted for.</p>"
    )


PARTS: tuple[Callable[[Recording, _Figures], Iterator[str]], ...] = (
    _verdict,
    _materials,
    _displacements,
    _bolts,
    _linings,
    _reactions,
    _water,
    _notes,
)
"""Sections of the report, in their order."""
