"""Statistics of a study: probability of failure, spread, and the contributions of parameters."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from scipy import special

from clast.errors import CaseError, shortened
from clast.model.distributions import Value
from clast.model.model import Floats
from clast.study.description import MONTECARLO, SWEEP, Description
from clast.study.distributions import Numbered
from clast.study.folder import DONE, StudyFolder
from clast.study.sampling import LatinHypercube, Morris, PointEstimate, Random

CONFIDENCE = 0.95
"""Confidence of intervals."""
TAIL_FRACTION = 0.2
"""Fraction of the runs, with the least and the largest values of a parameter, that are compared."""


@dataclass(frozen=True, kw_only=True)
class Probability:
    """A probability of failure with its interval."""

    value: float
    low: float
    """Lower end of the interval; the known value where there is no interval."""
    high: float
    failed: int
    runs: int
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
    run: Floats
    """Number of each run, shape (k,)."""
    parameters: Mapping[str, Floats]
    """Parameter -> values, shape (k,); those that are texts or places are left out."""
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
    without: tuple[int, ...] = ()
    """Numbers of the runs that were made and have no result."""

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
    without: list[int] = []
    parameters: dict[str, list[Any]] = {one.name: [] for one in study.vary}
    measures: dict[str, list[float]] = {name: [] for name in study.measure}
    fails: list[bool] = []
    blocks, joints, reasons, remarks = (Counter[str]() for _ in range(4))
    for result in folder.results():
        reason = shortened(result.get("reason", ""), 160)
        if result["status"] != DONE:
            reasons[reason] += 1
            without.append(result["run"])
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
    return StudyResults(
        study=study,
        run=np.array(run, np.float64),
        parameters={
            name: np.array(values, np.float64)
            for name, values in parameters.items()
            if values and not any(isinstance(one, str | list) for one in values)
        },
        measures={name: np.array(values) for name, values in measures.items()},
        fails=np.array(fails, np.float64),
        blocks=dict(blocks.most_common()),
        joints=dict(joints.most_common()),
        reasons=dict(reasons.most_common()),
        remarks=dict(remarks.most_common()),
        without=tuple(without),
    )


def probability(columns: StudyResults) -> Probability | None:
    """Return the probability of failure; None where the study has none.

    Independent runs have Wilson's interval (1927), Latin hypercubes that of Student's t of their
    replicates; other samplings have none.
    """
    study, fails, sampling = columns.study, columns.fails, columns.study.sampling
    if study.kind != MONTECARLO or not len(fails) or not sampling.OF_CHANCE:
        return None
    failed = int(fails.sum())
    value, how, ends = failed / len(fails), "", None
    if isinstance(sampling, PointEstimate):
        weights = np.array([study.weight(int(run)) for run in columns.run])
        value = float(weights @ fails / weights.sum())
    elif isinstance(sampling, Random):
        how, ends = "Wilson", interval_of_count(columns, failed)
    elif isinstance(sampling, LatinHypercube) and sampling.replicates > 1:
        how = f"Student's t of {sampling.replicates} Latin hypercubes"
        ends = _of_replicates(columns)
    low, high = ends or (value, value)
    counts = {"failed": failed, "runs": len(fails), "lost": columns.lost}
    return Probability(value=value, low=low, high=high, how=how, **counts)


def interval_of_count(columns: StudyResults, count: int) -> tuple[float, float] | None:
    """Return Wilson's interval of the probability of an event in ``count`` runs with a result.

    So fails a block, or slides a joint.  Runs without a result count as either.  None where runs
    are not independent: Latin hypercubes would need the counts of each.
    """
    study = columns.study
    if study.kind != MONTECARLO or not isinstance(study.sampling, Random) or not len(columns.run):
        return None
    runs = len(columns.run) + columns.lost
    return wilson(count, runs)[0], wilson(count + columns.lost, runs)[1]


def wilson(failed: int, runs: int) -> tuple[float, float]:
    """Return Wilson's interval of a probability, of ``failed`` in so many independent runs."""
    z = float(special.ndtri(0.5 + 0.5 * CONFIDENCE))
    share = failed / runs
    middle = (share + z * z / (2.0 * runs)) / (1.0 + z * z / runs)
    half = z * math.sqrt(share * (1.0 - share) / runs + (z / (2.0 * runs)) ** 2)
    half /= 1.0 + z * z / runs
    # 0 and 1 are ends of their intervals, without rounding
    low = max(0.0, middle - half) if failed else 0.0
    return low, min(1.0, middle + half) if failed < runs else 1.0


def _of_replicates(columns: StudyResults) -> tuple[float, float]:
    """Return the interval of the mean of replicates, runs without a result as either."""
    study = columns.study
    group = np.array([study.replicate(int(run)) for run in columns.run])
    used = np.unique(group)
    shares = np.array([columns.fails[group == one].mean() for one in used])
    if len(used) < 2:
        return 0.0, 1.0
    t = float(special.stdtrit(len(used) - 1, 0.5 + 0.5 * CONFIDENCE))
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
    low: float
    """Mean of the measure where the parameter is least, in the lowest fifth of the runs."""
    high: float
    """The same where it is largest."""
    ends: tuple[float, float]
    """Mean of the parameter in these runs."""
    rank: float
    """Rank correlation (Spearman), -1 to 1; nan where nothing changes."""


def influences(columns: StudyResults, values: Floats) -> list[Influence]:
    """Return how values (k,) of the runs go with each parameter, the strongest first.

    The number of a run orders nothing: a parameter that is one is left out.  Runs on a grid of few
    values have none, and no sweep whose runs lie on one curve, which says more.
    """
    from scipy.stats import spearmanr  # slow to load, and workers do not need it

    study = columns.study
    is_curve = study.kind == SWEEP and (
        study.together or sum(len(one) > 1 for one in study.lists) < 2
    )
    if not study.sampling.OF_CHANCE or is_curve:
        return []
    listed = []
    sound = np.isfinite(values)
    numbers = {one.name for one in study.vary if isinstance(one.drawn, Numbered)}
    for name, given in columns.parameters.items():
        if name in numbers:
            continue
        x, y = given[sound], values[sound]
        if len(x) < 2 or np.ptp(x) == 0.0:
            continue
        low, high = np.quantile(x, (TAIL_FRACTION, 1.0 - TAIL_FRACTION))
        rank = float(spearmanr(x, y).statistic) if np.ptp(y) > 0.0 else math.nan
        listed.append(
            Influence(
                parameter=name,
                low=float(y[x <= low].mean()),
                high=float(y[x >= high].mean()),
                ends=(float(x[x <= low].mean()), float(x[x >= high].mean())),
                rank=rank,
            )
        )
    return sorted(listed, key=lambda one: -abs(one.high - one.low))


@dataclass(frozen=True, kw_only=True)
class Spread:
    """How a measure is spread."""

    mean: float
    sd: float
    least: float
    quantiles: tuple[float, float, float]
    """Values below which 5, 50 and 95 % of the runs lie."""
    largest: float

    HEADS: ClassVar[tuple[str, ...]] = ("mean", "sd", "least", "5 %", "median", "95 %", "largest")

    @property
    def row(self) -> tuple[float, ...]:
        """Its numbers in the order of HEADS."""
        return (self.mean, self.sd, self.least, *self.quantiles, self.largest)


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
    run: int
    """Number of the run; of several the first."""
    parameters: Mapping[str, Value]
    """Parameter -> its value in this run."""


def extremes(columns: StudyResults, values: Floats) -> dict[str, Extreme] | None:
    """Return the "least" and the "largest" value of a measure (k,); None where it has no values.

    They describe a sweep: its mean would tell how the grid was chosen.
    """
    if not np.isfinite(values).any():
        return None

    def at(k: int) -> Extreme:
        study, run = columns.study, int(columns.run[k])
        names = [one.name for one in study.vary]
        parameters = dict(zip(names, study.values(run), strict=True))
        return Extreme(value=float(values[k]), run=run, parameters=parameters)

    sound = np.where(np.isfinite(values), values, np.nan)
    return {"least": at(int(np.nanargmin(sound))), "largest": at(int(np.nanargmax(sound)))}


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


MEANING = {
    "saltelli": "First: share of the variance that the parameter causes alone; total: with all of "
    "its interactions. Plus or minus: 95 %, by bootstrap.",
    "morris": "mu: mean change of the measure where the parameter goes from end to end of its "
    "range (probability 0.01 to 0.99); mu*: mean of its size; sigma: standard deviation, large "
    "where it interacts or is not linear. Plus or minus: 95 %, by bootstrap.",
}
"""Sampling -> meaning of its indices."""


Sensitivities = dict[str, dict[str, float]]
"""Parameter -> name of an index (first, total; or mu, mu*, sigma; "plus or minus ...") -> value."""


def sensitivities(columns: StudyResults, values: Floats) -> Sensitivities:
    """Return the indices of a measure (k,), the strongest parameter first.

    There are none for other samplings, and where the measure does not change.  Groups of runs of
    which one has no result are left out.  Raises CaseError where SALib is not installed, or where
    no two groups are left.
    """
    study = columns.study
    if not study.sampling.INDICES or study.kind != MONTECARLO:
        return {}
    names = [one.name for one in study.vary]
    is_morris = isinstance(study.sampling, Morris)
    size = len(names) + (1 if is_morris else 2)
    sound = dict(zip((columns.run - 1).astype(int).tolist(), values.tolist(), strict=True))
    groups = [range(first, first + size) for first in range(0, study.n, size)]
    rows = [
        row
        for group in groups
        if all(math.isfinite(sound.get(one, math.nan)) for one in group)
        for row in group
    ]
    output = np.array([sound[row] for row in rows])
    if len(output) < 2 * size:
        raise CaseError(
            "too few groups of runs have results",
            where="sampling",
            remedy="continue the study, or look at the reasons it gives",
        )
    if np.ptp(output) == 0.0:
        return {}
    try:
        from SALib.analyze import morris, sobol
    except ImportError:
        raise CaseError(
            "indices of sensitivity need SALib, which is not installed",
            where="sampling",
            remedy="install it: pip install 'clast[salib]', then clast study collect",
        ) from None
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    bootstrap = {"num_resamples": 200, "conf_level": CONFIDENCE, "seed": 1}
    if isinstance(study.sampling, Morris):
        places = np.array([study.sampling.shares(row, len(names)) for row in rows])
        keys = {"mu": "mu", "mu*": "mu_star", "plus or minus": "mu_star_conf", "sigma": "sigma"}
        indices = morris.analyze(problem, places, output, num_levels=Morris.LEVELS, **bootstrap)
    else:
        # Saltelli's estimators lose digits where the mean is large against the spread
        scaled = (output - output.mean()) / output.std()
        keys = {"first": "S1", "plus or minus": "S1_conf"}
        keys |= {"total": "ST", "plus or minus of total": "ST_conf"}
        indices = sobol.analyze(problem, scaled, calc_second_order=False, **bootstrap)
    strength = indices[keys["mu*" if is_morris else "total"]]
    order = np.argsort(-np.asarray(strength), kind="stable")
    return {names[k]: {key: float(indices[one][k]) for key, one in keys.items()} for k in order}
