"""The page of the paper's studies: each claim beside our result, tables and figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.paper.runs import PaperResult
from benchmarks.tables import markdown_table, put_tables
from clast.model.model import Floats
from clast.pictures.charts import Curve

PASSES = 6
"""Passes of the modified process where it repeats its solves."""
GROUPS = ("modified", "open-close", "convex", f"modified with {PASSES} passes")
"""Processes in the order of their colours."""


@dataclass(frozen=True)
class Claim:
    """A claim beside our result."""

    text: str
    """The claim, and its source."""
    found: str
    """Our result."""
    holds: Mapping[str, bool]
    """Whether it holds, for each process and law or whatever else it was tried with."""

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        yes = [name for name, holds in self.holds.items() if holds]
        no = [name for name, holds in self.holds.items() if not holds]
        if not no:
            return "holds"
        if not yes:
            return "does not hold"
        return f"holds for {'; '.join(yes)}. Does not for {'; '.join(no)}"


@dataclass(frozen=True)
class StudySection:
    """A study on the page: what its runs put into it, beside its figure."""

    name: str
    """Name of its part of the page."""
    claims: Sequence[Claim]
    """Claims that it is about."""
    tables: Sequence[Sequence[str]]
    """Tables in Markdown, as lines."""


def put_into_page(sections: Sequence[StudySection], page: Path) -> None:
    """Put verdicts and tables into the page; its figures are in ``images`` beside it."""
    claims = [claim for section in sections for claim in section.claims]
    rows = [(one.text, one.verdict) for one in claims]
    parts = {"claims": markdown_table(("claim", "verdict"), rows)}
    for section in sections:
        lines = [f"- {one.text}: **{one.verdict}**. Found: {one.found}." for one in section.claims]
        for table in section.tables:
            lines += ["", *table]
        parts[section.name] = lines
    put_tables(page, parts)


def series_of(x: Floats, values: Mapping[str, Floats]) -> list[Curve]:
    """Return series by label: a colour for each process, dashed for the second law."""
    return [
        Curve(
            label=label,
            group=GROUPS.index(label.split(", ")[0]),
            line="--" if label.endswith("ALM") else "-",
            x=x,
            y=each,
        )
        for label, each in values.items()
    ]


def percent(share: float) -> str:
    """Return a share in %, three digits."""
    return f"{100.0 * share:.3g} %"


def listed(texts: Mapping[str, str]) -> str:
    """Return texts with their labels, in one line."""
    return "; ".join(f"{label}: {text}" for label, text in texts.items())


def stiffness_table(
    series: Mapping[str, list[PaperResult]], young: float, text: Callable[[PaperResult], str]
) -> list[str]:
    """Return a table of runs over the normal stiffness, a column for each label."""
    first = next(iter(series.values()))
    rows = [
        (
            f"{one.job.value:.0e}",
            f"{one.job.value / young:g}",
            f"{one.stability:.2g}",
            *(text(runs[k]) for runs in series.values()),
        )
        for k, one in enumerate(first)
    ]
    return markdown_table(("p, N/m per m", "p/E", "p h²/m", *series), rows)
