"""Table 1 of the paper: a block on an incline of 45 degrees at ten friction angles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from benchmarks.paper.page import Claim, StudySection, listed, percent, series_of
from benchmarks.paper.runs import EVERY_COMBINATION, PaperResult, PaperResults, PaperRun
from benchmarks.tables import markdown_table
from clast.model.model import Floats
from clast.pictures.charts import Chart, draw_charts, exact_curve

ANGLES = (0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0)
"""Friction angles of the table, degrees."""
PAPER_ERRORS = (0.0006, 0.0066)
"""Smallest and largest error that the paper reports, -."""
GRAVITY, STEP, DURATION = 9.8, 1e-3, 1.0
"""Acceleration of gravity, m/s2, step, s, and duration, s."""
STAYS = 0.01
"""A slider that moves less than this at 45 degrees has stayed, m."""
FIGURE = "paper-table-1.png"


def jobs(folder: Path) -> Iterable[PaperRun]:
    """Yield the incline at all angles with every process and law."""
    for combination in EVERY_COMBINATION:
        for angle in ANGLES:
            yield PaperRun(
                study="table 1",
                file=folder / "incline.toml",
                combination=combination,
                settings=(f"joint.default.friction_angle={angle}",),
                value=angle,
            )


def exact_distance(friction_angle: float) -> float:
    """Return the distance that the slider moves to the right, and down, in the duration, m."""
    downhill = GRAVITY * np.sin(np.radians(45.0)) * max(0.0, 1.0 - tangent(friction_angle))
    return float(0.5 * downhill * np.cos(np.radians(45.0)) * DURATION**2)


def miss(result: PaperResult, exact: float) -> float:
    """Return the distance of the slider from its exact place, m; nan where the run stopped."""
    if not result.finished:
        return float("nan")
    u, v = result.row.displacement["A"]
    return float(np.hypot(u - exact, v + exact))


def error(result: PaperResult, exact: float) -> float:
    """Return the miss over the exact distance, -."""
    return miss(result, exact) / (np.sqrt(2.0) * exact)


def lag(friction_angle: float) -> float:
    """Return the error of friction that is one step old: (2h/t) tan(phi)/(1 - tan(phi)), -."""
    return 2.0 * STEP / DURATION * tangent(friction_angle) / (1.0 - tangent(friction_angle))


def tangent(degrees: float) -> float:
    """Return the tangent of an angle in degrees."""
    return float(np.tan(np.radians(degrees)))


def section(results: PaperResults, images: Path) -> StudySection:
    """Return the section of the page; draw its figure."""
    series = results.series("table 1")
    moving = np.array(ANGLES[:-1])
    errors = {
        label: np.array([error(one, exact_distance(one.job.value)) for one in runs[:-1]])
        for label, runs in series.items()
    }
    stays = {label: miss(runs[-1], 0.0) for label, runs in series.items()}
    draw_charts([_diagram(moving, errors)], images / FIGURE)
    return StudySection(
        name="table 1",
        claims=_claims(series, errors, stays),
        tables=[_table(errors, stays)],
    )


def _claims(
    series: Mapping[str, list[PaperResult]],
    errors: Mapping[str, Floats],
    stays: Mapping[str, float],
) -> list[Claim]:
    flat = {label: each[:-1] for label, each in errors.items()}
    last = {label: float(each[-1]) for label, each in errors.items()}
    largest = PAPER_ERRORS[1]
    cut = {k: sum(one.row.report.cut_steps for one in runs) for k, runs in series.items()}
    return [
        Claim(
            "Errors are 0.06 to 0.66 % (the paper): not larger up to 35 degrees",
            listed(ranges(flat)),
            {label: bool(each.max() <= largest) for label, each in flat.items()},
        ),
        Claim(
            "Errors are 0.06 to 0.66 % (the paper): not larger at 40 degrees",
            listed({label: percent(each) for label, each in last.items()}),
            {label: each <= largest for label, each in last.items()},
        ),
        Claim(
            "At 45 degrees the block moves less than 1 cm in 1 s (it stays: closed form)",
            listed({label: f"{1e3 * each:.2g} mm" for label, each in stays.items()}),
            {label: each < STAYS for label, each in stays.items()},
        ),
        Claim(
            "The limit of 0.01 m on the displacement in a step (the paper's input) is not reached",
            "steps that were cut: " + listed({label: str(number) for label, number in cut.items()}),
            {label: number == 0 for label, number in cut.items()},
        ),
    ]


def ranges(errors: Mapping[str, Floats]) -> dict[str, str]:
    """Return the smallest and the largest error of each label, %, and how many runs stopped."""
    texts = {}
    for label, each in errors.items():
        reached = each[np.isfinite(each)]
        stopped = len(each) - len(reached)
        low_high = [percent(reached.min()), percent(reached.max())] if len(reached) else ["none"]
        texts[label] = " to ".join(low_high) + (f" ({stopped} stopped)" if stopped else "")
    return texts


def _table(errors: Mapping[str, Floats], stays: Mapping[str, float]) -> list[str]:
    rows = [
        (
            f"{angle:g}",
            f"{exact_distance(angle):.6f}",
            f"{100.0 * lag(angle):.3f}",
            *(f"{100.0 * each[k]:.3f}" for each in errors.values()),
        )
        for k, angle in enumerate(ANGLES[:-1])
    ]
    rows.append(("45", "0", "-", *(f"{1e3 * each:.3g} mm" for each in stays.values())))
    return markdown_table(("φ, degrees", "exact u = -v, m", "friction lag, %", *errors), rows)


def _diagram(angles: Floats, errors: Mapping[str, Floats]) -> Chart:
    lags = np.array([100.0 * lag(angle) for angle in angles[1:]])
    low, high = (100.0 * each for each in PAPER_ERRORS)
    # there and back: a frame around what the paper reports
    quoted = exact_curve(
        f"the paper: {low:g} to {high:g} %",
        np.concatenate([angles, angles[::-1], angles[:1]]),
        np.repeat([low, high, low], [len(angles), len(angles), 1]),
    )
    return Chart(
        title="Table 1",
        x_label="friction angle φ, degrees",
        y_label="error, %",
        y_scale="log",
        curves=[
            *series_of(angles, {label: 100.0 * each for label, each in errors.items()}),
            exact_curve("cost of friction lag", angles[1:], lags),
            quoted,
        ],
    )
