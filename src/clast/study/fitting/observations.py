"""Measured displacements, and the table that they are read from."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from keyword import iskeyword
from pathlib import Path
from typing import Any

from clast.errors import CaseError, shortened
from clast.inputs.declaring import text as case_text
from clast.spelling import require_known

COLUMNS = ("point", "time", "x", "y", "sd")
"""Columns of a table of observations; time and sd may be missing or empty, x or y empty."""


@dataclass(frozen=True, kw_only=True)
class Observation:
    """A displacement that was measured."""

    point: str
    part: int
    """0: x, 1: y."""
    value: float
    """Displacement, m."""
    time: float | None = None
    """When, s; None: at the end of the run."""
    sd: float | None = None
    """Standard deviation, m; None: not known."""

    @property
    def measure(self) -> str:
        """The same of a run, as an expression."""
        point, time = self.point, ""
        if not point.isidentifier() or iskeyword(point):
            point = json.dumps(point, ensure_ascii=False)
        if self.time is not None:
            time = f", {float(self.time)!r}"
        return f"displacement({point}, {'xy'[self.part]}{time})"

    def row(self) -> dict[str, Any]:
        """Return it as a row of a table: values by column."""
        part = "xy"[self.part]
        cells = {"point": self.point, "time": self.time, part: self.value, "sd": self.sd}
        return {key: value for key, value in cells.items() if value is not None}


def of_rows(rows: Sequence[Mapping[str, Any]]) -> tuple[Observation, ...]:
    """Return the observations that ``Observation.row`` gave."""
    return tuple(
        Observation(
            point=str(one["point"]),
            part=0 if "x" in one else 1,
            value=float(one["x" if "x" in one else "y"]),
            time=one.get("time"),
            sd=one.get("sd"),
        )
        for one in rows
    )


def read_observations(path: Path, points: Sequence[str]) -> list[Observation]:
    """Return the observations of a table (CSV); raises CaseError naming row and column."""
    text = case_text.read_text(path, "name a table with the columns point, x, y")
    # spreadsheets put a byte order mark before the first column
    reader = csv.DictReader(text.removeprefix("\ufeff").splitlines())
    heads = [head.strip() for head in reader.fieldnames or ()]
    for head in heads:
        if ";" in head:
            remedy = "put commas between columns, and points into numbers"
            what = "has semicolons between its columns"
            raise CaseError(what, where=str(path), remedy=remedy)
        if heads.count(head) > 1:
            what = f"has the column '{shortened(head)}' twice"
            raise CaseError(what, where=str(path), remedy="keep one of them")
        what = f"has a column '{shortened(head)}'"
        require_known(head, COLUMNS, kind="column", where=str(path), what=what)
    if "point" not in heads or not {"x", "y"} & set(heads):
        raise CaseError(
            "lacks the columns point and x or y", where=str(path), remedy="e.g. point,time,x,y,sd"
        )
    observations = []
    for number, line in enumerate(reader, start=2):
        cells = {str(key).strip(): (value or "").strip() for key, value in line.items() if key}
        where = f"{path}, line {number}"
        require_known(cells["point"], points, kind="measured point", where=where)
        time, sd = (_number(cells.get(key, ""), where, key) for key in ("time", "sd"))
        if time is not None and time < 0.0:
            raise CaseError(
                "lies before the start of the run", where=where, remedy="give a time from 0 on"
            )
        if sd is not None and sd <= 0.0:
            raise CaseError("has no positive sd", where=where, remedy="leave it empty, or give one")
        for part, key in enumerate(("x", "y")):
            value = _number(cells.get(key, ""), where, key)
            if value is not None:
                one = Observation(point=cells["point"], part=part, value=value, time=time, sd=sd)
                observations.append(one)
    if not observations:
        raise CaseError("has no observation", where=str(path), remedy="give at least one row")
    if len({one.sd is None for one in observations}) > 1:
        raise CaseError("has an sd in some rows only", where=str(path), remedy="give all, or none")
    return observations


def _number(text: str, where: str, column: str) -> float | None:
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= 1e9:
        remedy = "write a number, or leave it empty"
        raise CaseError(f"'{shortened(text)}' is not a valid {column}", where=where, remedy=remedy)
    return value


LEAST_SQUARES, ENSEMBLE = "least-squares", "es-mda"
PLACES_MAX = 60
"""Most places that least squares look at, each with the derivatives there."""


@dataclass(frozen=True, kw_only=True)
class FitSettings:
    """How a back-analysis is made."""

    method: str = LEAST_SQUARES
    """"least-squares", or "es-mda": an ensemble, for many parameters."""
    members: int = 100
    rounds: int = 4
    """How often the ensemble takes in the observations, each time a part of them."""
    seed: int = 1

    def checked(self) -> FitSettings:
        """Return itself; raises CaseError for wrong numbers."""
        require_known(self.method, (LEAST_SQUARES, ENSEMBLE), kind="method", where="method")
        for name, least, most in (
            ("members", 10, 100_000),
            ("rounds", 1, 50),
            ("seed", 0, 2**63 - 1),
        ):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
                what = "seed" if name == "seed" else f"number of {name}"
                remedy = f"give a whole number from {least} to {most:,}"
                raise CaseError(f"{value!r} is not a valid {what}", where=name, remedy=remedy)
        return self

    def most_runs(self, parameters: int) -> int:
        """Return how many runs it takes at most."""
        if self.method == ENSEMBLE:
            return self.members * (self.rounds + 1)
        return PLACES_MAX * (parameters + 2)
