"""A target: the value of a parameter with which a factor or a measure reaches a limit.

    clast study target CASE --vary "bolt_kind.anchor.pretension=between(0, 500e3)"
        --reach "factor_of_safety() >= 1.3"

Bisection over the range: both ends are run, one of which has to reach the target and the other
not; then the middle, until value and tolerance are known.  A run without a result is undecided, and
the bracket closes in from both sides of it.  The number that F is compared with is one trial a
run, with the strengths divided by it: whether blocks stand with 1.3 says on which side of 1.3 their
factor is.
"""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from clast.case.api import case_of
from clast.case.case_file import Case
from clast.model.distributions import Value
from clast.study import trial_table
from clast.study.collapsing.search import FactorSettings, next_between
from clast.study.collapsing.support_forces import SupportForce, supports_of, write_supports
from clast.study.description import TARGET, Description, parameters_of
from clast.study.distributions import Between, value_text
from clast.study.folder import DONE, StudyFolder, write_whole
from clast.study.parameters import units_of
from clast.study.targeting.goal import REACHED, TargetSettings, measures_of
from clast.study.work import Bench, check_study


@dataclass(frozen=True, kw_only=True)
class TargetRun:
    """A run of a search for a target."""

    number: int
    share: float
    """Where in the range it lies, 0 to 1."""
    value: Value
    """Value of the parameter."""
    reached: bool | None
    """Whether the target is met; None: undecided, it has no result."""
    measures: Mapping[str, Any]
    """Other measures by name."""
    reason: str = ""
    """Why it has no result; "" where it has one."""
    supports: tuple[SupportForce, ...] = ()
    """Forces of anchors, linings and links at its end; with a factor, in the trial that stands."""


Watch = Callable[[TargetRun], None]


@dataclass(frozen=True, kw_only=True)
class Target:
    """The value of a parameter with which a target is met, as a bracket of runs."""

    parameter: str
    unit: str
    """Unit of the parameter; "" of a factor, and where it has none."""
    reach: str
    tolerance: float
    """Width of the bracket that was asked for, as a share of the range."""
    runs: tuple[TargetRun, ...]
    folder: Path | None = None
    """Where the study is kept; None: nowhere."""

    @property
    def ends(self) -> tuple[TargetRun, TargetRun] | None:
        """The run that meets the target and lies nearest to one that does not, and that one.

        None where all runs meet it, or none.
        """
        known = sorted((one for one in self.runs if one.reached is not None), key=_share)
        if not known or known[0].reached is known[-1].reached:
            return None
        first, last = known[0], known[-1]
        high = min((one for one in self.runs if one.reached is last.reached), key=_share)
        before = (one for one in self.runs if one.reached is first.reached)
        low = max((one for one in before if one.share < high.share), key=_share)
        return (low, high) if first.reached else (high, low)

    @property
    def supported(self) -> TargetRun | None:
        """The end of the bracket whose forces of supports are known, if any: the answer's first."""
        return next((one for one in self.ends or () if one.supports), None)

    @property
    def undecided(self) -> tuple[TargetRun, ...]:
        """Runs without a result between the two ends, or at an end of the range."""
        shares = sorted(one.share for one in self.ends) if self.ends else [0.0, 1.0]
        return tuple(
            sorted(
                (r for r in self.runs if r.reached is None and shares[0] <= r.share <= shares[1]),
                key=_share,
            )
        )

    @property
    def value(self) -> Value:
        """The answer: the last value with which the target is met; NaN where there is none."""
        return self.ends[0].value if self.ends else math.nan

    @property
    def is_settled(self) -> bool:
        """Whether the bracket is closed and as narrow as was asked for."""
        width = abs(self.ends[0].share - self.ends[1].share) if self.ends else math.inf
        return width <= self.tolerance * (1.0 + 1e-9)

    @property
    def sentence(self) -> str:
        """The answer in words, with its reservations."""
        if self.ends is None:
            return self._open()
        yes, no = (value_text(one.value) for one in self.ends)
        answer = f"{self.parameter} = {self._written(self.value)}"
        text = f"{answer}: {self.reach} is reached with {yes}, not with {no}"
        if self.undecided:
            listed = ", ".join(self._written(one.value) for one in self.undecided)
            text += f"; undecided with {listed}: {self.undecided[0].reason}"
        return text

    def _open(self) -> str:
        """Say why there is no answer: an end of the range has no result, or both are alike."""
        ends = " and ".join(self._written(one.value) for one in self.runs[:2])
        for one in self.runs[:2]:
            if one.reached is None:
                where = f"{self.parameter} = {self._written(one.value)}"
                return f"{self.reach}: nothing is known of it with {where}: {one.reason}"
        word = "at both ends" if self.runs[0].reached else "at neither end"
        return f"{self.reach} is reached {word} of the range of {self.parameter}: {ends}"

    def _written(self, value: Value) -> str:
        unit = "" if not self.unit else self.unit if self.unit == "°" else f" {self.unit}"
        return f"{value_text(value)}{unit}"

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        (yes, no), of = self.ends or (None, None), self.supported
        return {
            "parameter": self.parameter,
            "unit": self.unit,
            "reach": self.reach,
            "value": yes and yes.value,
            "not_reached": no and no.value,
            "undecided": [one.value for one in self.undecided],
            "settled": self.is_settled,
            "sentence": self.sentence,
            "supports": [] if of is None else [dict(vars(one)) for one in of.supports],
            "supports_of": of and of.number,
            "runs": [_listed(one) for one in self.runs],
            "folder": None if self.folder is None else str(self.folder),
        }

    def __repr__(self) -> str:
        return f"Target({self.sentence}; {len(self.runs)} runs)"


def target(
    case: Any,
    vary: Mapping[str, Any],
    reach: str,
    *,
    tolerance: float = 0.002,
    measure: Mapping[str, str] | None = None,
    folder: str | Path | None = None,
    watch: Watch | None = None,
    **factor: Any,
) -> Target:
    """Return the value of a parameter, in the unit of its key, with which a target is met.

    ``vary`` has one path -> the range, ``(0, 500e3)`` or ``clast.Between``; ``reach`` is a
    condition, "factor_of_safety() >= 1.3".  ``tolerance`` is a share of the range.  ``measure`` are
    further columns, ``factor`` how factors are looked for: ``by``, ``joints``.  ``folder`` keeps
    all runs, and goes on with those that are there.  Raises CaseError for invalid input.
    """
    loaded = case_of(case)
    how = TargetSettings(reach=reach, tolerance=tolerance)
    how_factor = FactorSettings(**{**factor, "joints": tuple(factor.get("joints", ()))})
    study = described(loaded, vary, how, measure or {}, how_factor)
    with ExitStack() as stack:
        place = folder or stack.enter_context(tempfile.TemporaryDirectory(prefix="clast-target-"))
        found = go_on(StudyFolder.made(Path(place), loaded, study), watch)
    return found if folder is not None else replace(found, folder=None)


def described(
    case: Case,
    vary: Mapping[str, Any],
    how: TargetSettings,
    measure: Mapping[str, str],
    factor: FactorSettings,
) -> Description:
    """Return the description of a search for a target; raises CaseError for an invalid one."""
    ranges = {
        key: Between(*v) if isinstance(v, tuple) and len(v) == 2 else v for key, v in vary.items()
    }
    study = Description(
        kind=TARGET,
        vary=parameters_of(ranges),
        measure=measures_of(how.reach, measure),
        factor=None if factor == FactorSettings() else factor,
        target=how,
    ).checked()
    check_study(case, study)
    return study


def go_on(folder: StudyFolder, watch: Watch | None = None) -> Target:
    """Go on with the search in a folder; return its result, also written there."""
    study, bench = folder.study, Bench.of(folder)
    how = study.target or TargetSettings()
    runs: list[TargetRun] = []
    with folder.driven():
        while (share := next_share(runs, how)) is not None:
            runs.append(_run(bench, len(runs) + 1, share))
            if watch is not None:
                watch(runs[-1])
        (parameter,) = study.vary
        found = Target(
            parameter=parameter.name,
            unit=units_of(bench.settings)[parameter.name],
            reach=how.reach,
            tolerance=how.tolerance,
            runs=tuple(runs),
            folder=folder.path,
        )
        text = json.dumps(found.as_dict(), indent=1, ensure_ascii=False)
        write_whole(folder.path / "target.json", f"{text}\n".encode())
        if found.supported:
            write_supports(folder.path, found.supported.supports)
        trial_table.write_csv(folder, folder.path / trial_table.CSV)
        if found.ends:
            content = bench.settings.case((found.ends[0].value,))
            write_whole(folder.path / "answer.toml", folder.case_text(content, ""))
    return found


def next_share(runs: Sequence[TargetRun], how: TargetSettings) -> float | None:
    """Return where in the range, 0 to 1, to run next; None where enough is known."""
    if len(runs) < 2:
        return float(len(runs))
    so_far = Target(parameter="", unit="", reach="", tolerance=how.tolerance, runs=tuple(runs))
    if len(runs) >= how.most_runs:
        return None
    if so_far.ends is None:
        return _inwards(runs, how.tolerance)
    low, high = sorted(one.share for one in so_far.ends)
    return next_between([low, *(one.share for one in so_far.undecided), high], how.tolerance)


def _inwards(runs: Sequence[TargetRun], tolerance: float) -> float | None:
    """Return where to run next, from an end of the range without a result towards the other.

    None where no end, or both, are without one, or where enough is known.
    """
    lost = [one for one in runs[:2] if one.reached is None]
    if len(lost) != 1:
        return None
    end = lost[0].share
    known = min(abs(one.share - end) for one in runs if one.reached is not None)
    unknown = max(abs(r.share - end) for r in runs if r.reached is None)
    return abs(end - 0.5 * (known + unknown)) if known - unknown > tolerance else None


def _run(bench: Bench, number: int, share: float) -> TargetRun:
    """Return a run of the search: the one in the folder, or a new one."""
    folder = bench.folder
    asked = folder.asked()
    if asked[number - 1 : number] != [(share,)]:
        asked[number - 1 :] = [(share,)]
        lines = "".join(json.dumps(one) + "\n" for one in asked)
        write_whole(folder.asked_file, lines.encode("ascii"))
    result = folder.result(number)
    if result is None:
        folder.forget(number)
        result = bench.make(number)
    measures = dict(result.get("measures", {}))
    reached = measures.pop(REACHED, None) if result["status"] == DONE else None
    is_known = isinstance(reached, bool)
    return TargetRun(
        number=number,
        share=share,
        value=folder.values(number)[0],
        reached=reached if is_known else None,
        measures=measures,
        reason=result.get("reason", ""),
        supports=_supports(result),
    )


def _supports(result: Mapping[str, Any]) -> tuple[SupportForce, ...]:
    """Return the forces in the result of a run; none where it holds something else."""
    try:
        return supports_of(result)
    except (TypeError, AttributeError):
        return ()


def _listed(run: TargetRun) -> dict[str, Any]:
    """Return a run ready for JSON; forces are those of the answer alone."""
    listed = {**vars(run), "measures": dict(run.measures)}
    del listed["supports"]
    return listed


def _share(run: TargetRun) -> float:
    return run.share
