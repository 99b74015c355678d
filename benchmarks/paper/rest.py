"""Penalty against augmented Lagrangian: penetration and contact force of a block at rest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.paper.page import Claim, StudySection, listed, percent, series_of
from benchmarks.paper.runs import EVERY_COMBINATION, PROCESSES, PaperResult, PaperResults, PaperRun
from benchmarks.tables import markdown_table
from clast.model.model import Floats
from clast.pictures.charts import Chart, Curve, draw_charts, exact_curve
from clast.studies.comparing import Combination

STIFFNESSES = (1e8, 1e9, 1e10)
"""Normal stiffnesses, N/m per m."""
COUNTS = (1, 2, 4, 8)
"""Multiplier solves at the lowest stiffness."""
PAPER_SOLVES = 4
"""Multiplier solves of the paper."""
STEP = 1e-3
"""Step, s."""
MASS, CORNERS = 2700.0, 2
"""Mass of the block, kg/m, and corners that carry it."""
WEIGHT = MASS * 9.8
"""Weight of the block, N/m."""
QUARTER = 0.1
"""Shares of the penetration within this of 1/4 count as 1/4, relative."""
AGREES = 0.02
"""Shares within this of the formula agree with it, relative."""
IN_BALANCE = 1e-4
"""Contact forces within this of the weight are the weight, relative."""
LAW = "augmented-lagrangian"
FIGURE = "paper-rest.png"


def jobs(folder: Path) -> Iterable[PaperRun]:
    """Yield the block at rest over the stiffness with both laws, and over the number of solves."""
    file = folder / "rest.toml"
    for combination in EVERY_COMBINATION:
        for value in STIFFNESSES:
            settings = (f"method.contact_law.normal_stiffness={value}",)
            yield PaperRun(
                study="rest", file=file, combination=combination, settings=settings, value=value
            )
    for process in PROCESSES:
        for count in COUNTS:
            law = f'{{name="{LAW}", normal_stiffness={STIFFNESSES[0]}, solves={count}}}'
            yield PaperRun(
                study="solves",
                file=file,
                combination=Combination(process, LAW),
                settings=(f"method.contact_law={law}",),
                value=float(count),
            )


def beta(stiffness: float) -> float:
    """Return p h2/(2 m), m being the mass per corner."""
    return stiffness * STEP**2 * CORNERS / (2.0 * MASS)


def share(stiffness: float, solves: float) -> float:
    """Return the share of the penalty's penetration that multiplier solves leave, -."""
    return beta(stiffness) / ((1.0 + beta(stiffness)) ** solves - 1.0)


def section(results: PaperResults, images: Path) -> StudySection:
    """Return the section of the page; draw its figure."""
    series, counted = results.series("rest"), results.series("solves")
    plain = {process: _penetrations(series[f"{process}, penalty"]) for process in PROCESSES}
    over_p = {p: _penetrations(series[f"{p}, ALM"]) / plain[p] for p in PROCESSES}
    over_n = {p: _penetrations(counted[f"{p}, ALM"]) / plain[p][0] for p in PROCESSES}
    draw_charts(_diagrams(over_n, over_p), images / FIGURE)
    return StudySection(
        name="rest",
        claims=_claims(series, over_p),
        tables=[_table_over_p(plain, over_p), _table_over_n(over_n)],
    )


def _penetrations(runs: list[PaperResult]) -> Floats:
    """Return the penetrations at the end, m, shape (k,); nan where a run stopped."""
    return np.array([one.row.penetration if one.finished else np.nan for one in runs])


def _left(share: float) -> str:
    """Return a share of the penetration, or that the run stopped."""
    return f"{share:.4f}" if np.isfinite(share) else "stopped"


def _claims(series: Mapping[str, list[PaperResult]], over_p: Mapping[str, Floats]) -> list[Claim]:
    exact = np.array([share(value, PAPER_SOLVES) for value in STIFFNESSES])
    off = np.abs(np.array(list(over_p.values())) / exact - 1.0).max(axis=0)
    unbalanced = {
        label: max(abs(one.row.normal_force / WEIGHT - 1.0) for one in runs)
        for label, runs in series.items()
    }
    return [
        Claim(
            "Augmented Lagrangian with 4 solves leaves 1/4 of the penetration (the paper)",
            f"at p = {', '.join(f'{value:.0e}' for value in STIFFNESSES)}: "
            + listed({p: ", ".join(f"{x:.3g}" for x in each) for p, each in over_p.items()}),
            {
                f"p = {value:.0e}": all(abs(4.0 * r[k] - 1.0) < QUARTER for r in over_p.values())
                for k, value in enumerate(STIFFNESSES)
            },
        ),
        Claim(
            "n solves leave β/((1 + β)ⁿ - 1) of it (clast, for a rigid block)",
            "with 4 solves, within "
            + listed({f"p = {p:.0e}": percent(off[k]) for k, p in enumerate(STIFFNESSES)})
            + "; stiffer contacts strain the block in each step as well",
            {f"p = {p:.0e}": bool(off[k] < AGREES) for k, p in enumerate(STIFFNESSES)},
        ),
        Claim(
            "The contact force is the weight with both laws (equilibrium)",
            "within " + listed({k: f"{100.0 * each:.1g} %" for k, each in unbalanced.items()}),
            {label: each < IN_BALANCE for label, each in unbalanced.items()},
        ),
    ]


def _table_over_p(plain: Mapping[str, Floats], over_p: Mapping[str, Floats]) -> list[str]:
    """Return penetrations of the penalty law, mm, and the share that multipliers leave."""
    rows = [
        (
            f"{value:.0e}",
            f"{beta(value):.3g}",
            f"{1e3 * WEIGHT / (CORNERS * value):.5g}",
            *(f"{1e3 * each[k]:.5g}" for each in plain.values()),
            f"{share(value, PAPER_SOLVES):.4f}",
            *(_left(each[k]) for each in over_p.values()),
        )
        for k, value in enumerate(STIFFNESSES)
    ]
    penetrations = ("W/(2p), mm", *(f"{name}, mm" for name in plain))
    shares = ("exact share left", *(f"{name}, share left" for name in over_p))
    return markdown_table(("p, N/m per m", "β", *penetrations, *shares), rows)


def _table_over_n(over_n: Mapping[str, Floats]) -> list[str]:
    rows = [
        (
            str(count),
            f"{1.0 / count:.4f}",
            f"{share(STIFFNESSES[0], count):.4f}",
            *(_left(each[k]) for each in over_n.values()),
        )
        for k, count in enumerate(COUNTS)
    ]
    shares = (f"{name}, share left" for name in over_n)
    return markdown_table(("solves n", "1/n", "exact share left", *shares), rows)


def _marks(x: Floats, values: Mapping[str, Floats]) -> list[Curve]:
    """Return series without lines: the exact curve is drawn between them."""
    return [replace(one, line="") for one in series_of(x, values)]


def _diagrams(over_n: Mapping[str, Floats], over_p: Mapping[str, Floats]) -> list[Chart]:
    fine, dense = np.linspace(1.0, 8.0, 50), np.geomspace(STIFFNESSES[0], STIFFNESSES[-1], 50)
    at_counts = np.array([share(STIFFNESSES[0], n) for n in fine])
    at_stiffnesses = np.array([share(value, PAPER_SOLVES) for value in dense])
    exact = "β/((1 + β)ⁿ - 1)"
    return [
        Chart(
            title=f"p = {STIFFNESSES[0]:.0e} N/m per m",
            x_label="multiplier solves n in a step",
            y_label="share of the penetration left",
            curves=[*_marks(np.array(COUNTS, float), over_n), exact_curve(exact, fine, at_counts)],
        ),
        Chart(
            title="4 solves",
            x_label="normal stiffness p, N/m per m",
            y_label="share of the penetration left",
            x_scale="log",
            curves=[
                *_marks(np.array(STIFFNESSES), over_p),
                exact_curve(exact, dense, at_stiffnesses),
            ],
        ),
    ]
