"""Statistics of a study: probability of failure, spread, and the contributions of parameters."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import stats

from clast.errors import CaseError, shortened
from clast.model.distributions import Value
from clast.model.model import Floats
from clast.study.description import MONTECARLO, SWEEP, Description
from clast.study.distributions import Numbered
from clast.study.folder import DONE, StudyFolder
from clast.study.sampling import LatinHypercube, Morris, PointEstimate, Random

CONFIDENCE = 0.95
"""Confidence of intervals."""
LONGEST_REASON = 160
"""Most characters by which reasons for a missing result are told apart."""
TAIL = 0.2
"""Share of the runs, with the least and the largest values of a parameter, that are compared."""


@dataclass(frozen=True, kw_only=True)
class Probability:
    """A probability of failure with its interval."""

    value: float
    """Estimate."""
    low: float
    """Lower end of the interval; the known value where there is no interval."""
    high: float
    """Upper end."""
    failed: int
    """Runs that fail."""
    runs: int
    """Runs with a result."""
    lost: int
    """Runs without a result: the interval allows that all of them, or none, fail."""
    how: str
    """The kind of interval; "" where the sampling has none."""

    def __str__(self) -> str:
        text = f"{self.value:.4g}"
        if self.how:
            text += f" ({100 * CONFIDENCE:g} %: {self.low:.4g} to {self.high:.4g}, {self.how})"
        text += f", {self.failed} of {self.runs} runs"
        return f"{text}; {self.lost} runs have no result" if self.lost else text


@dataclass(frozen=True, kw_only=True)
class StudyResults:
    """The results of a study as arrays; k runs with a result."""

    study: Description
    """The study."""
    run: Floats
    """Number of each run, shape (k,)."""
    parameters: Mapping[str, Floats]
    """Parameter -> values, shape (k,); those that are texts are left out."""
    measures: Mapping[str, Floats]
    """Measure -> values, shape (k,)."""
    fails: Floats
    """1 where a run fails, else 0; shape (k,), or (0,) where nothing is said of it."""
    blocks: Mapping[str, int]
    """Block -> in how many runs it fails."""
    joints: Mapping[str, int]
    """Joint -> in how many runs blocks fail by sliding along it."""
    reasons: Mapping[str, int]
    """Why there is no result -> how often."""
    remarks: Mapping[str, int] = field(default_factory=dict)
    """Why a run with a result has no value of a measure -> how often."""

    @property
    def lost(self) -> int:
        """Runs without a result."""
        return sum(self.reasons.values())

    @property
    def gaps(self) -> list[str]:
        """A sentence for each measure that some runs have no finite value of, and why."""
        counts = {name: int((~np.isfinite(values)).sum()) for name, values in self.measures.items()}
        return [
            f"{count} of {len(self.run)} runs have no finite value of {name}, and are left out of "
            "its numbers"
            for name, count in counts.items()
            if count
        ] + [f"{count} of {len(self.run)} runs: {text}" for text, count in self.remarks.items()]


def columns_of(folder: StudyFolder) -> StudyResults:
    """Return the results of a study."""
    study = folder.study
    run: list[int] = []
    parameters: dict[str, list[Any]] = {one.name: [] for one in study.vary}
    measures: dict[str, list[float]] = {name: [] for name in study.measure}
    fails: list[bool] = []
    blocks: Counter[str] = Counter()
    joints: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    remarks: Counter[str] = Counter()
    for result in folder.results():
        reason = shortened(result.get("reason", ""), LONGEST_REASON)
        if result["status"] != DONE:
            reasons[reason] += 1
            continue
        if reason:
            remarks[reason] += 1
        run.append(result["run"])
        for name, value in result["parameters"].items():
            parameters[name].append(value)
        for name, value in result["measures"].items():
            measures[name].append(float(value))
        if study.fail:
            fails.append(result["fails"])
        blocks.update(result.get("blocks", ()))
        joints.update(result.get("joints", ()))
    numeric = {
        name: np.array(values, np.float64)
        for name, values in parameters.items()
        if values and not any(isinstance(one, str) for one in values)
    }
    return StudyResults(
        study=study,
        run=np.array(run, np.float64),
        parameters=numeric,
        measures={name: np.array(values) for name, values in measures.items()},
        fails=np.array(fails, np.float64),
        blocks=dict(blocks.most_common()),
        joints=dict(joints.most_common()),
        reasons=dict(reasons.most_common()),
        remarks=dict(remarks.most_common()),
    )


def probability(columns: StudyResults) -> Probability | None:
    """Return the probability of failure; None where the study has none.

    Independent runs have Wilson's interval (1927), Latin hypercubes that of Student's t of their
    replicates; other samplings have none.
    """
    study, fails = columns.study, columns.fails
    if study.kind != MONTECARLO or not study.fail or not len(fails):
        return None
    if not study.sampling.OF_CHANCE:
        return None
    failed, lost = int(fails.sum()), columns.lost
    known: dict[str, Any] = {"failed": failed, "runs": len(fails), "lost": lost}
    if isinstance(study.sampling, PointEstimate):
        weights = np.array([study.weight(int(run)) for run in columns.run])
        value = float(weights @ fails / weights.sum())
        return Probability(value=value, low=value, high=value, how="", **known)
    value = failed / len(fails)
    if isinstance(study.sampling, Random):
        low, high = _of_independent(columns, failed)
        return Probability(value=value, low=low, high=high, how="Wilson", **known)
    if isinstance(study.sampling, LatinHypercube) and study.sampling.replicates > 1:
        low, high = _of_replicates(columns)
        how = f"Student's t of {study.sampling.replicates} Latin hypercubes"
        return Probability(value=value, low=low, high=high, how=how, **known)
    return Probability(value=value, low=value, high=value, how="", **known)


def interval_of_count(columns: StudyResults, count: int) -> tuple[float, float] | None:
    """Return the interval of the probability of what happens in ``count`` runs with a result.

    So fails a block, or slides a joint.  None where runs are not independent: Latin hypercubes
    would need the counts of each.
    """
    study = columns.study
    if study.kind != MONTECARLO or not isinstance(study.sampling, Random) or not len(columns.run):
        return None
    return _of_independent(columns, count)


def _of_independent(columns: StudyResults, count: int) -> tuple[float, float]:
    """Return Wilson's interval of ``count`` of the runs, those without a result as either."""
    runs = len(columns.run) + columns.lost
    return wilson(count, runs)[0], wilson(count + columns.lost, runs)[1]


def wilson(failed: int, runs: int) -> tuple[float, float]:
    """Return Wilson's interval of a probability, of ``failed`` in so many independent runs."""
    z = float(stats.norm.ppf(0.5 + 0.5 * CONFIDENCE))
    share = failed / runs
    middle = (share + z * z / (2.0 * runs)) / (1.0 + z * z / runs)
    half = z * math.sqrt(share * (1.0 - share) / runs + (z / (2.0 * runs)) ** 2)
    half /= 1.0 + z * z / runs
    # 0 and 1 are ends of their intervals, without rounding
    return (max(0.0, middle - half) if failed else 0.0), (
        min(1.0, middle + half) if failed < runs else 1.0
    )


def _of_replicates(columns: StudyResults) -> tuple[float, float]:
    """Return the interval of the mean of replicates, runs without a result as either."""
    study = columns.study
    group = np.array([study.replicate(int(run)) for run in columns.run])
    used = np.unique(group)
    shares = np.array([columns.fails[group == one].mean() for one in used])
    if len(used) < 2:
        return 0.0, 1.0
    t = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, len(used) - 1))
    half = t * float(shares.std(ddof=1)) / math.sqrt(len(used))
    mean, more = float(shares.mean()), columns.lost / (len(columns.run) + columns.lost)
    if half == 0.0:
        # replicates that agree say nothing of what is rarer than one run
        return wilson(int(columns.fails.sum()), len(columns.run))
    return max(0.0, mean - half - more), min(1.0, mean + half + more)


@dataclass(frozen=True, kw_only=True)
class Influence:
    """How a measure goes with a parameter."""

    parameter: str
    """The parameter."""
    low: float
    """Mean of the measure where the parameter is least, in the lowest fifth of the runs."""
    high: float
    """The same where it is largest."""
    ends: tuple[float, float]
    """Mean of the parameter in these runs."""
    rank: float
    """Rank correlation (Spearman), -1 to 1; nan where nothing changes."""

    @property
    def swing(self) -> float:
        """Difference of the two means."""
        return abs(self.high - self.low)


def influences(columns: StudyResults, values: Floats) -> list[Influence]:
    """Return how values (k,) of the runs go with each parameter, the strongest first.

    The number of a run orders nothing: a parameter that is one is left out.  Runs on a grid of few
    values have none, and no sweep whose runs lie on one curve, which says more.
    """
    study = columns.study
    if not study.sampling.OF_CHANCE or (study.kind == SWEEP and _is_curve(study)):
        return []
    found = []
    sound = np.isfinite(values)
    numbers = {one.name for one in study.vary if isinstance(one.drawn, Numbered)}
    for name, given in columns.parameters.items():
        if name in numbers:
            continue
        x, y = given[sound], values[sound]
        if len(x) < 2 or np.ptp(x) == 0.0:
            continue
        low, high = np.quantile(x, (TAIL, 1.0 - TAIL))
        rank = float(stats.spearmanr(x, y).statistic) if np.ptp(y) > 0.0 else math.nan
        found.append(
            Influence(
                parameter=name,
                low=float(y[x <= low].mean()),
                high=float(y[x >= high].mean()),
                ends=(float(x[x <= low].mean()), float(x[x >= high].mean())),
                rank=rank,
            )
        )
    return sorted(found, key=lambda one: -one.swing)


def _is_curve(study: Description) -> bool:
    """Return whether one parameter of a sweep varies, or several in step."""
    return study.together or sum(len(one) > 1 for one in study.lists) < 2


@dataclass(frozen=True, kw_only=True)
class Spread:
    """How a measure is spread."""

    mean: float
    """Mean."""
    sd: float
    """Standard deviation."""
    least: float
    """Least value."""
    quantiles: tuple[float, float, float]
    """Values below which 5, 50 and 95 % of the runs lie."""
    largest: float
    """Largest value."""


def spread(columns: StudyResults, values: Floats) -> Spread | None:
    """Return the spread of a measure (k,); None where it has no values.

    Of point estimates mean and standard deviation are those of their weights (Rosenblueth 1975).
    """
    sound = np.isfinite(values)
    if not sound.any():
        return None
    study, kept = columns.study, values[sound]
    weights = np.full(len(kept), 1.0 / len(kept))
    if isinstance(study.sampling, PointEstimate) and study.kind == MONTECARLO:
        weights = np.array([study.weight(int(run)) for run in columns.run[sound]])
        weights /= weights.sum()
    mean = float(weights @ kept)
    sd = math.sqrt(max(0.0, float(weights @ (kept - mean) ** 2)))
    low, median, high = np.quantile(kept, (0.05, 0.5, 0.95)).tolist()
    return Spread(
        mean=mean,
        sd=sd,
        least=float(kept.min()),
        quantiles=(low, median, high),
        largest=float(kept.max()),
    )


@dataclass(frozen=True, kw_only=True)
class Extreme:
    """The least or the largest value of a measure, and the run that has it."""

    value: float
    """The value."""
    run: int
    """Number of the run; of several the first."""
    parameters: Mapping[str, Value]
    """Parameter -> its value in this run."""


@dataclass(frozen=True, kw_only=True)
class Extremes:
    """Between which values a measure lies."""

    least: Extreme
    """The least one."""
    largest: Extreme
    """The largest one."""


def extremes(columns: StudyResults, values: Floats) -> Extremes | None:
    """Return the extreme values of a measure (k,); None where it has no values.

    They are what is to say of a sweep: its mean would tell how the grid was chosen.
    """
    if not np.isfinite(values).any():
        return None

    def at(k: int) -> Extreme:
        study, run = columns.study, int(columns.run[k])
        names = [one.name for one in study.vary]
        parameters = dict(zip(names, study.values(run), strict=True))
        return Extreme(value=float(values[k]), run=run, parameters=parameters)

    sound = np.where(np.isfinite(values), values, np.nan)
    return Extremes(least=at(int(np.nanargmin(sound))), largest=at(int(np.nanargmax(sound))))


def cumulative(study: Description, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Return sorted values (k,), the share of runs up to each, and half the width of its band.

    The band of Dvoretzky, Kiefer, Wolfowitz and Massart (1990) holds the whole curve of independent
    runs with the confidence; other samplings have none, and a width of 0.
    """
    ordered = np.sort(values[np.isfinite(values)])
    share = np.arange(1, len(ordered) + 1) / max(1, len(ordered))
    half = math.sqrt(math.log(2.0 / (1.0 - CONFIDENCE)) / (2.0 * max(1, len(ordered))))
    independent = study.kind == MONTECARLO and isinstance(study.sampling, Random)
    return ordered, share, np.full(len(ordered), half if independent else 0.0)


def worst(columns: StudyResults, count: int = 1) -> list[int]:
    """Return the numbers of the worst runs, the worst first; fewer where there are not so many.

    They have the largest first measure, those that fail before others; of factors of safety the
    least.
    """
    if not len(columns.run):
        return []
    values = next(iter(columns.measures.values()), columns.fails)
    name = next(iter(columns.study.measure.values()), "")
    score = -values if name.strip().startswith("factor_of_safety") else values
    score = np.where(np.isfinite(score), score, -math.inf)
    fails = columns.fails if len(columns.fails) else np.zeros(len(score))
    order = np.lexsort((columns.run, -score, -fails))
    return [int(columns.run[k]) for k in order[:count]]


RESAMPLES = 200
"""Bootstrap samples of an interval."""
MEANING = {
    "saltelli": "First: share of the variance that the parameter causes alone; total: with all of "
    "its interactions. Plus or minus: 95 %, by bootstrap.",
    "morris": "mu: mean change of the measure where the parameter goes from end to end of its "
    "range (probability 0.01 to 0.99); mu*: mean of its size; sigma: standard deviation, large "
    "where it interacts or is not linear. Plus or minus: 95 %, by bootstrap.",
}
"""Sampling -> meaning of its indices."""


@dataclass(frozen=True, kw_only=True)
class SensitivityIndex:
    """The indices of one parameter."""

    parameter: str
    """The parameter."""
    index: dict[str, float]
    """Name of an index -> value: first, total; or mu, mu*, sigma; and "plus or minus ..."."""


def sensitivities(columns: StudyResults, values: Floats) -> list[SensitivityIndex]:
    """Return the indices of a measure (k,), the strongest parameter first.

    There are none for other samplings, and where the measure does not change.  Groups of runs of
    which one has no result are left out.  Raises CaseError where SALib is not installed, or where
    no two groups are left.
    """
    study = columns.study
    if not study.sampling.INDICES or study.kind != "montecarlo":
        return []
    names = [one.name for one in study.vary]
    is_morris = isinstance(study.sampling, Morris)
    size = len(names) + (1 if is_morris else 2)
    rows, output = _whole_groups(columns, values, size)
    if len(output) < 2 * size:
        raise CaseError(
            "too few groups of runs have results",
            where="sampling",
            remedy="continue the study, or look at the reasons it gives",
        )
    if np.ptp(output) == 0.0:
        return []
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    found = _of_morris(study, problem, rows, output) if is_morris else _of_sobol(problem, output)
    strength = "mu*" if is_morris else "total"
    listed = [
        SensitivityIndex(
            parameter=name, index={key: float(column[k]) for key, column in found.items()}
        )
        for k, name in enumerate(names)
    ]
    return sorted(listed, key=lambda one: -one.index[strength])


def _whole_groups(columns: StudyResults, values: Floats, size: int) -> tuple[list[int], Floats]:
    """Return the runs of whole groups, from 0, and their values."""
    sound = {
        int(run) - 1: float(value)
        for run, value in zip(columns.run, values, strict=True)
        if np.isfinite(value)
    }
    rows = [
        row
        for group in range(columns.study.n // size)
        for row in range(group * size, (group + 1) * size)
        if all(one in sound for one in range(group * size, (group + 1) * size))
    ]
    return rows, np.array([sound[row] for row in rows])


def _of_sobol(problem: dict[str, Any], output: Floats) -> dict[str, Sequence[float]]:
    """Return first and total indices with their intervals."""
    try:
        from SALib.analyze import sobol
    except ImportError:
        raise _missing() from None
    # Saltelli's estimators lose digits where the mean is large against the spread
    found = sobol.analyze(
        problem,
        (output - output.mean()) / output.std(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=1,
    )
    return {
        "first": found["S1"],
        "plus or minus": found["S1_conf"],
        "total": found["ST"],
        "plus or minus of total": found["ST_conf"],
    }


def _of_morris(
    study: Any, problem: dict[str, Any], rows: list[int], output: Floats
) -> dict[str, Sequence[float]]:
    """Return elementary effects with their interval."""
    try:
        from SALib.analyze import morris
    except ImportError:
        raise _missing() from None
    places = np.array([study.sampling.shares(row, len(study.vary)) for row in rows])
    found = morris.analyze(
        problem,
        places,
        output,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        num_levels=Morris.LEVELS,
        seed=1,
    )
    return {
        "mu": found["mu"],
        "mu*": found["mu_star"],
        "plus or minus": found["mu_star_conf"],
        "sigma": found["sigma"],
    }


def _missing() -> CaseError:
    return CaseError(
        "indices of sensitivity need SALib, which is not installed",
        where="sampling",
        remedy="install it: pip install 'clast[salib]', then clast study collect",
    )
