"""With and without open-close iteration: a wall of many contacts from E/100 to 10 E."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from benchmarks.paper.page import PASSES, Claim, StudySection, listed, stiffness_table
from benchmarks.paper.runs import LAWS, PROCESSES, PaperResult, PaperResults, PaperRun
from benchmarks.paper.stiffness_study import LIMIT
from clast.case.case_file import Case
from clast.pictures.comparison import Panel, SideBySide, draw_side_by_side
from clast.studies.comparing import Combination

STIFFNESSES = (5e7, 2e8, 5e8, 5e9, 5e10)
"""Normal stiffnesses, N/m per m."""
YOUNG = 5e9
"""Young's modulus, Pa."""
STILL = 1e-3
"""A wall whose vertices move sideways by less than this has stood, m."""
FIGURE = "paper-wall.png"

Stood = Mapping[str, list[bool]]
"""Label -> whether the wall stood, by stiffness."""


def jobs(folder: Path) -> Iterable[PaperRun]:
    """Yield the wall: one solve a step, open-close iteration, convex, repeated solves."""
    repeated = (f'method.process={{name="modified", passes={PASSES}}}',)
    ways: list[tuple[str, str, tuple[str, ...]]] = [(name, "", ()) for name in PROCESSES]
    ways.append(("modified", f" with {PASSES} passes", repeated))
    for law in LAWS:
        for process, variant, settings in ways:
            for value in STIFFNESSES:
                yield PaperRun(
                    study="iteration",
                    file=folder / "wall.toml",
                    combination=Combination(process, law),
                    settings=(f"method.contact_law.normal_stiffness={value}", *settings),
                    value=value,
                    variant=variant,
                )


def section(results: PaperResults, images: Path) -> StudySection:
    """Return the section of the page; draw its figure."""
    series = results.series("iteration")
    _draw({label: runs[STIFFNESSES.index(YOUNG)] for label, runs in series.items()}, images)
    return StudySection(
        name="walls",
        claims=_claims(series),
        tables=[stiffness_table(series, YOUNG, _text)],
    )


def stood(result: PaperResult) -> bool:
    """Return True for a wall that has stood."""
    return result.finished and result.drift < STILL


def _claims(series: Mapping[str, list[PaperResult]]) -> list[Claim]:
    stands = {label: [stood(one) for one in runs] for label, runs in series.items()}
    stable = [one.stability <= LIMIT for one in next(iter(series.values()))]

    def of(*starts: str) -> dict[str, list[bool]]:
        return {label: each for label, each in stands.items() if label.startswith(starts)}

    single, repeated, convex = of("modified,"), of("open-close", "modified with"), of("convex")
    return [
        Claim(
            "One solve a step suffices, without open-close iteration (the paper)",
            _stood_at(single),
            {
                f"{label} {'up to' if below else 'above'} p h²/m = {LIMIT:g}": all(
                    ok for ok, is_below in zip(each, stable, strict=True) if is_below is below
                )
                for below in (True, False)
                for label, each in single.items()
            },
        ),
        Claim(
            "Open-close iteration (Shi), or repeated passes (the paper), tolerate stiffer contacts",
            _stood_at(repeated),
            {
                label: sum(each) > sum(single[f"modified, {label.split(', ')[1]}"])
                for label, each in repeated.items()
            },
        ),
        Claim(
            "The convex process tolerates any stiffness (clast)",
            _stood_at(convex),
            {label: all(each) for label, each in convex.items()},
        ),
    ]


def _stood_at(stands: Stood) -> str:
    """Return at which p/E each wall stands."""
    texts = {}
    for label, each in stands.items():
        held = [f"{p / YOUNG:g}" for p, ok in zip(STIFFNESSES, each, strict=True) if ok]
        texts[label] = ", ".join(held) or "nowhere"
    return "the wall stands at p/E = " + listed(texts)


def _text(result: PaperResult) -> str:
    """Return how far the wall moved sideways, mm, and the passes, or when the run stopped."""
    return result.text_if_finished(
        f"{1e3 * result.drift:.2g} mm, passes: {result.row.passes_per_step:.2g}"
    )


def _draw(results: Mapping[str, PaperResult], images: Path) -> None:
    """Draw the walls at one stiffness side by side, a row for each law."""
    model = Case.from_toml(next(iter(results.values())).job.file).model()
    panels = [
        Panel(
            title=label,
            remark=one.text_if_finished(f"t = {one.row.time:.3g} s"),
            finished=one.finished,
            vertices=one.row.vertices,
        )
        for label, one in results.items()
    ]
    scene = SideBySide(
        title="Wall of bricks at p = E",
        start=model.vertices + model.origin,
        block_start=model.block_start,
        fixed=model.fixed,
        panels=panels,
        columns=len(panels) // len(LAWS),
    )
    draw_side_by_side(scene, images / FIGURE)
