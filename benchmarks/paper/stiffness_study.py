"""The paper's stiffness study: the incline with contacts far softer and far stiffer than rock."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.paper.page import Claim, StudySection, listed, percent, series_of, stiffness_table
from benchmarks.paper.runs import EVERY_COMBINATION, PaperResult, PaperResults, PaperRun
from benchmarks.paper.table_1 import error, exact_distance, ranges
from clast.model.model import Floats
from clast.pictures.charts import Chart, draw_charts

STIFFNESSES = (1e7, 1e8, 1e9, 1e10, 3e10, 5e10, 1e11, 1e12, 5e12)
"""Normal stiffnesses, N/m per m."""
YOUNG = 5e10
"""Young's modulus, Pa."""
SOFT = YOUNG / 50.0
"""Contacts up to this are far softer than the rock, N/m per m."""
ANGLE = 20.0
"""Friction angle, degrees."""
CLOSE = 0.01
"""Errors up to this count as sound, -."""
LIMIT = 6.0
"""Largest p h2/m with which a contact settles in one solve a step."""
FIGURE = "paper-stiffness.png"


def jobs(folder: Path) -> Iterable[PaperRun]:
    """Yield the incline at 20 degrees with every stiffness, process and law."""
    for combination in EVERY_COMBINATION:
        for value in STIFFNESSES:
            yield PaperRun(
                study="stiffness",
                file=folder / "incline.toml",
                combination=combination,
                settings=(f"method.contact_law.normal_stiffness={value}",),
                value=value,
            )


def section(results: PaperResults, images: Path) -> StudySection:
    """Return the section of the page; draw its figure."""
    series = results.series("stiffness")
    exact = exact_distance(ANGLE)
    errors = {
        label: np.array([error(one, exact) for one in runs]) for label, runs in series.items()
    }
    depths = {label: np.array([one.depth for one in runs]) for label, runs in series.items()}
    draw_charts(_diagrams(errors, depths), images / FIGURE)
    return StudySection(
        name="stiffness",
        claims=_claims(series, errors),
        tables=[
            stiffness_table(
                series, YOUNG, lambda one: one.text_if_finished(percent(error(one, exact)))
            ),
            stiffness_table(
                series, YOUNG, lambda one: one.text_if_finished(f"{1e3 * one.depth:.2g} mm")
            ),
        ],
    )


def _claims(series: Mapping[str, list[PaperResult]], errors: Mapping[str, Floats]) -> list[Claim]:
    soft = np.array(STIFFNESSES) <= SOFT
    at_soft = {label: each[soft] for label, each in errors.items()}
    stability = [one.stability for one in next(iter(series.values()))]
    one_pass = {label: each for label, each in errors.items() if label.startswith("modified")}
    sound = {label: sound_range(stability, each) for label, each in one_pass.items()}
    return [
        Claim(
            "Contacts far softer than the rock work (the paper)",
            f"p from E/{YOUNG / STIFFNESSES[0]:g} to E/{YOUNG / SOFT:g}: "
            + listed(ranges(at_soft)),
            {label: bool(np.all(each <= CLOSE)) for label, each in at_soft.items()},
        ),
        Claim(
            f"One solve a step tolerates p h²/m up to about {LIMIT:g} (clast)",
            "error of at most 1 %: "
            + listed({label: _words(*each) for label, each in sound.items()}),
            {label: low <= LIMIT <= high for label, (low, high) in sound.items()},
        ),
    ]


def sound_range(stability: Sequence[float], errors: Floats) -> tuple[float, float]:
    """Return the p h2/m up to which errors are small, and the next one, where they are not."""
    good = [each <= CLOSE for each in errors]  # nan is not
    end = good.index(False) if False in good else len(good)
    low = stability[end - 1] if end else 0.0
    return low, stability[end] if end < len(good) else float("inf")


def _words(low: float, high: float) -> str:
    if high == float("inf"):
        return f"everywhere, to p h²/m = {low:.3g}"
    return f"up to p h²/m = {low:.3g}, no longer at {high:.3g}"


def _diagrams(errors: Mapping[str, Floats], depths: Mapping[str, Floats]) -> list[Chart]:
    quantities = {
        "error, %": {label: 100.0 * each for label, each in errors.items()},
        "largest penetration, mm": {label: 1e3 * each for label, each in depths.items()},
    }
    return [
        Chart(
            title=f"Incline at 20 degrees: {name.split(',')[0]}",
            x_label="normal stiffness p, N/m per m (crosses: the run stopped)",
            y_label=name,
            x_scale="log",
            y_scale="log",
            curves=series_of(np.array(STIFFNESSES), quantity),
        )
        for name, quantity in quantities.items()
    ]
