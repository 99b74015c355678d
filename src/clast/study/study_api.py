"""Studies from Python.

study = clast.Study(
    "slope.toml",
    vary={"joint.bedding.friction_angle": clast.Normal(35, 5, low=15, high=70)},
    measure={"crest": "displacement(A)"},
    fail="crest > 0.05",
)
table = study.run("out", n=500, sampling="latin-hypercube")
clast.factor_of_safety("slope.toml", joints=["bedding"]).value
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from clast.case.api import case_of
from clast.errors import CaseError, shortened
from clast.study import trial_table
from clast.study.collapsing.collapse import Given
from clast.study.collapsing.search import FactorSettings
from clast.study.description import (
    MONTECARLO,
    SEARCHES,
    SWEEP,
    Description,
    parameters_of,
    sampling_of,
)
from clast.study.executors import Driver, ThisProcess, Watch, workers_of
from clast.study.folder import StudyFolder, writing
from clast.study.statistics import columns_of
from clast.study.trial_table import TrialTable
from clast.study.work import Bench, check_run, check_study, keep_worst


@dataclass(frozen=True, kw_only=True)
class HowMade:
    """How the runs of a study are made; none of it changes their results."""

    executor: Any = None
    """Executor of ``concurrent.futures``; None: processes of this machine."""
    workers: int | None = None
    """How many runs are made at a time; None: as many as there are processors."""
    array: tuple[int, int] | None = None
    """(i, n): every n-th run from the i-th on, from 1, in this process."""
    retry: bool = False
    """True makes runs again that have no result."""
    watch: Watch | None = None
    """Called with how far the study is."""
    scheduler: str = ""
    """Address of a Dask scheduler, tcp://host:port; "": none."""

    def __post_init__(self) -> None:
        """Raise CaseError for values that name nobody who could make runs."""
        if self.executor is not None and not callable(getattr(self.executor, "submit", None)):
            raise CaseError(
                f"a {type(self.executor).__name__} is not an executor",
                where="executor",
                remedy="give one of concurrent.futures, e.g. client.get_executor() of Dask",
            )
        if self.workers is not None and not (type(self.workers) is int and self.workers > 0):
            raise CaseError(
                f"{shortened(repr(self.workers))} is not a valid number of workers",
                where="workers",
                remedy="give a whole number from 1 on, or leave it out",
            )
        match self.array:
            case None:
                pass
            case (int(first), int(count)) if 1 <= first <= count:
                pass
            case _:
                raise CaseError(
                    f"{shortened(repr(self.array))} is not part of an array",
                    where="array",
                    remedy="give e.g. (3, 10): every tenth run, from the third on",
                )
        names = ("array", "scheduler", "executor")
        given = [name for name in names if getattr(self, name) not in (None, "")]
        if len(given) > 1:
            what, remedy = (
                f"{' and '.join(given)} exclude each other",
                "leave all but one of them out",
            )
            raise CaseError(what, where=given[-1], remedy=remedy)


USUAL = HowMade()


class Study:
    """A case whose runs differ in some of its keys, and the measures of its runs.

    It is a sweep where ``vary`` has lists alone.  Raises CaseError for invalid arguments, for paths
    that the case does not have, and for measures of nothing that is in it.

    Args:
        case: Name of a case file, ``clast.load(file)``, a ModelBuilder or ``builder.build()``.
        vary: Paths -> distributions (``clast.Normal(35, 5)``), lists, or texts as in case files.
            A place is varied as a whole, {"point_load.1.at": [[1, 5], [2, 5]]}, or by a coordinate,
            "point_load.1.at.1".
        correlate: Pairs of paths with the correlation of their normal scores, -1 to 1.
        measure: Names -> expressions, e.g. {"crest": "displacement(A)"}.
        fail: Expression that is true where a run fails, e.g. "crest > 0.05".
        factor: How the factor of safety of each run is looked for; None: no factor.
        keep: Runs whose results are kept: "none", "all" or "worst N".
        together: True: a sweep takes the values of its lists side by side.
    """

    def __init__(
        self,
        case: Given,
        *,
        vary: Mapping[str, Any],
        correlate: Sequence[tuple[str, str, float]] = (),
        measure: Mapping[str, str] | None = None,
        fail: str = "",
        factor: FactorSettings | None = None,
        keep: str = "none",
        together: bool = False,
    ) -> None:
        self.case = case_of(case)
        parameters = parameters_of(vary)
        if measure is not None and not isinstance(measure, Mapping):
            what = f"{shortened(repr(measure))} has no names with expressions"
            raise CaseError(what, where="measure", remedy='give {"crest": "displacement(A)"}')
        listed = bool(parameters) and all(one.drawn.LISTED for one in parameters)
        self._description = Description(
            kind=SWEEP if listed else MONTECARLO,
            vary=parameters,
            correlate=tuple((str(a), str(b), c) for a, b, c in correlate),
            measure=dict(measure or {}),
            fail=fail,
            factor=factor,
            keep=keep,
            together=together,
        )
        run = "the first run" if listed else "a run with the median of each distribution"
        check_run(self.case, self._description, self._description.typical, run)

    def described(
        self, n: int = 100, sampling: str = "random", kind: str = "", **numbers: int
    ) -> Description:
        """Return the description of the study with so many runs; raises CaseError for none.

        ``kind`` is "sweep" or "montecarlo" where it is not to follow from the parameters.
        """
        chosen, kind = sampling_of(sampling, **numbers), kind or self._description.kind
        return replace(self._description, n=n, sampling=chosen, kind=kind).checked()

    def run(
        self,
        folder: str | Path,
        *,
        n: int = 100,
        sampling: str = "random",
        how: HowMade = USUAL,
        **given: Any,
    ) -> TrialTable:
        """Make all runs that are not done in a folder, and return the table of their results.

        ``n`` is the number of runs, ``sampling`` "random", "latin-hypercube", "sobol" or
        "point-estimate", with the ``seed`` and ``replicates`` of it.  ``how`` says who makes the
        runs; its fields may also be given one by one: ``executor``, ``workers``, ``scheduler``.
        Raises CaseError where the study cannot be made, and where another one is there.
        """
        who = {one.name: given.pop(one.name) for one in fields(HowMade) if one.name in given}
        how = replace(how, **who)
        study = self.described(n, sampling, "", **given)
        check_study(self.case, study)
        return go_on(StudyFolder.made(Path(folder), self.case, study), how)


def go_on(folder: StudyFolder, how: HowMade = USUAL) -> TrialTable:
    """Make the runs of a study that are not done; return its table, also written as CSV."""
    make(folder, how)
    if how.array is None:
        with writing(folder.path):
            trial_table.write_csv(folder, folder.path / trial_table.CSV)
            keep_worst(folder, columns_of(folder))
    return trial_table.table_of(folder)


def make(folder: StudyFolder, how: HowMade = USUAL) -> None:
    """Make the runs of a study that are not done."""
    study = folder.study
    if study.kind in SEARCHES:
        what = "is a search, in which each run depends on those before"
        raise CaseError(what, where=str(folder.path), remedy="use clast study resume")
    if how.array is not None:
        first, count = how.array

        def mine() -> Iterator[int]:
            return folder.missing(lambda run: run % count == first % count, retry=how.retry)

        with writing(folder.path):
            folder.tidy()
            left, total = sum(1 for _ in mine()), len(range(first, study.n + 1, count))
            driver = Driver(folder, ThisProcess(Bench.of(folder)), how.watch)
            driver.make(_forget(folder, mine()), left, total)
        return
    with folder.driven(), workers_of(folder, how.executor, how.workers, how.scheduler) as workers:
        left = max(1, study.n - folder.count())
        runs = folder.missing(lambda run: True, retry=how.retry)
        Driver(folder, workers, how.watch).make(_forget(folder, runs), left, study.n)


def _forget(folder: StudyFolder, runs: Iterator[int]) -> Iterator[int]:
    """Give runs, each of them without the result that it may have."""
    for run in runs:
        folder.forget(run)
        yield run


def resume(folder: str | Path, how: HowMade = USUAL) -> TrialTable:
    """Go on with the study in a folder; return its table."""
    return go_on(StudyFolder.opened(Path(folder)), how)
