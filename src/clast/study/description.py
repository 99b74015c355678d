"""The parts of a study, and its file ``study.toml``: everything that its results depend on.

    schema = 1
    kind = "montecarlo"
    case = "base/3f2a.../case.toml"
    n = 500
    sampling = "latin-hypercube"
    seed = 1
    fail = "crest > 0.05"

    [measure]
    crest = "displacement(A)"

    [[vary]]
    name = "joint.bedding.friction_angle"
    paths = ["joint.bedding.friction_angle"]
    is = "normal(35, 5, low=15, high=70)"

    [[correlate]]
    of = ["joint.bedding.cohesion", "joint.bedding.friction_angle"]
    value = -0.4

Its hash is the study: results that name another one are of another study.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from hashlib import sha256
from typing import Any

import numpy as np

from clast.errors import CaseError, shortened
from clast.inputs.declaring import text as case_text
from clast.model.distributions import Distribution, Value, Values
from clast.model.model import Floats
from clast.spelling import advice, require_known
from clast.study import sampling as samplings
from clast.study.collapsing.search import FactorSettings
from clast.study.distributions import Between, Numbered, Range, parsed
from clast.study.expressions import Expression, read
from clast.study.fitting.observations import FitSettings, Observation, of_rows
from clast.study.measures import CONDITIONS, MEASURES, unit_of
from clast.study.parameters import Parameter
from clast.study.sampling import SAMPLINGS, LatinHypercube, PointEstimate, Sampling
from clast.study.targeting.goal import TargetSettings

SWEEP, MONTECARLO, COLLAPSE, FIT, TARGET = "sweep", "montecarlo", "fos", "fit", "target"
ROCKFALL = "rockfall"
KINDS = (SWEEP, MONTECARLO, COLLAPSE, FIT, TARGET, ROCKFALL)
SEARCHES = (COLLAPSE, FIT, TARGET)
"""Studies in which each run depends on those before."""
KEEPS = ("none", "failed", "all", "worst N")
"""Of which runs the result files are kept."""
WORST = re.compile(r"worst [1-9][0-9]{0,4}")
TRIALS_MAX = 1000
"""Most trials of a study of collapse."""
COLUMNS = ("run", "status", "fails", "reason")
"""Columns of a table beside parameters and measures."""


@dataclass(frozen=True, kw_only=True)
class Description:
    """A study, but for its case; m parameters."""

    kind: str
    """"sweep", "montecarlo", "fos", "fit", "target" or "rockfall", whose runs are portions of
    paths."""
    case: str = ""
    """Case file, beside study.toml."""
    vary: tuple[Parameter, ...] = ()
    correlate: tuple[tuple[str, str, float], ...] = ()
    """Names of two parameters and the correlation of their normal scores."""
    sampling: Sampling = field(default_factory=samplings.Random)
    """How runs are drawn; of no account for a sweep."""
    n: int = 1
    together: bool = False
    """Of a sweep: True takes the lists in step, False all combinations."""
    measure: Mapping[str, str] = field(default_factory=dict)
    fail: str = ""
    """Expression that is true where a run fails; "": none is asked for."""
    factor: FactorSettings | None = None
    """How factors are looked for where the study, or a measure, asks for one."""
    keep: str = "none"
    """Of which runs the result files are kept: "none", "failed", "worst N" or "all"."""
    observe: tuple[Observation, ...] = ()
    fit: FitSettings | None = None
    target: TargetSettings | None = None

    # Runs ----------------------------------------------------------------------------------------

    def values(self, run: int) -> tuple[Value, ...]:
        """Return the parameters of a run, from 1, in their order.

        Of a back-analysis the medians, of a target the middle: they ask for runs as they go.
        """
        if self.kind == SWEEP:
            return self._listed(run - 1)
        if self.kind == ROCKFALL:
            return ()
        if self.kind in (FIT, TARGET):
            return tuple(one.drawn.quantile(0.5) for one in self.vary)
        if isinstance(self.sampling, PointEstimate):
            signs = self.sampling.signs(run - 1, len(self._drawn)).tolist()
            moments = [one.drawn.moments for one in self.vary]
            return tuple(mean + sign * sd for sign, (mean, sd) in zip(signs, moments, strict=True))
        chances = self.sampling.probabilities(run - 1, self.n, len(self._drawn))
        chances = samplings.correlated(chances, self._copula[1])
        drawn = iter(chances.tolist())
        return tuple(
            run - 1 + one.drawn.first
            if isinstance(one.drawn, Numbered)
            else one.drawn.quantile(next(drawn))
            for one in self.vary
        )

    def weight(self, run: int) -> float:
        """Return the weight of a run in sums over all: 1/n but for point estimates."""
        if isinstance(self.sampling, PointEstimate):
            return self.sampling.weight(run - 1, self._copula[0])
        return 1.0 / self.n

    def replicate(self, run: int) -> int:
        """Return the number of the Latin hypercube that a run belongs to, from 0."""
        one = self.sampling
        return one.replicate(run - 1, self.n) if isinstance(one, LatinHypercube) else 0

    @property
    def _drawn(self) -> list[Parameter]:
        """The parameters that are drawn."""
        return [one for one in self.vary if not isinstance(one.drawn, Numbered)]

    @cached_property
    def _copula(self) -> tuple[Floats, Floats]:
        """Correlations of normal scores of random parameters, and their Cholesky factor, (m, m)."""
        names = [one.name for one in self._drawn]
        pairs = [(names.index(a), names.index(b), value) for a, b, value in self.correlate]
        return samplings.copula(pairs, len(names))

    def _listed(self, number: int) -> tuple[Value, ...]:
        """Return the values of a combination of lists, the last one changing fastest."""
        lists = [_list_of(one) for one in self.vary]
        if self.together:
            return tuple(one.at(number) for one in lists)
        values: list[Value] = []
        for one in reversed(lists):
            number, position = divmod(number, len(one))
            values.append(one.at(position))
        return tuple(reversed(values))

    @property
    def lists(self) -> list[tuple[Value, ...]]:
        """The values of each parameter of a sweep; raises CaseError where one is no list."""
        return [tuple(one.at(k) for k in range(len(one))) for one in map(_list_of, self.vary)]

    @property
    def typical(self) -> tuple[Value, ...]:
        """The first value of each list, the median of each distribution."""
        return tuple(
            one.drawn.at(0)
            if isinstance(one.drawn, Values | Range)
            else one.drawn.first
            if isinstance(one.drawn, Numbered)
            else one.drawn.quantile(0.5)
            for one in self.vary
        )

    # Measures ------------------------------------------------------------------------------------

    @cached_property
    def measures(self) -> dict[str, Expression]:
        """The measures by name."""
        measures: dict[str, Expression] = {}
        for name, text in self.measure.items():
            where = f"measure {shortened(name)}"
            measures[name] = read(text, where, list(measures), list(MEASURES))
        return measures

    @cached_property
    def units(self) -> dict[str, str]:
        """The units of the measures by name; "" where one has none, or where none is known."""
        units: dict[str, str] = {}
        for name, one in self.measures.items():
            units[name] = one.unit(units, unit_of)
        return units

    @cached_property
    def condition(self) -> Expression | None:
        """The failure condition; None where none is asked for."""
        if not self.fail:
            return None
        condition = read(self.fail, "fail", list(self.measure), list(MEASURES))
        known = [*CONDITIONS]
        for name, one in self.measures.items():
            known += [name] if one.is_condition(known) else []
        if not condition.is_condition(known):
            raise CaseError(
                f"'{shortened(self.fail)}' is a number, not a failure condition",
                where="fail",
                remedy=f'compare it with a limit, e.g. "{shortened(self.fail)} > 0.05"',
            )
        return condition

    @property
    def how_of_factor(self) -> FactorSettings:
        """How factors are looked for."""
        return self.factor or FactorSettings()

    @property
    def expressions(self) -> list[Expression]:
        """The measures and the failure condition."""
        return [*self.measures.values(), *([] if self.condition is None else [self.condition])]

    # Text ----------------------------------------------------------------------------------------

    @cached_property
    def text(self) -> str:
        """The file ``study.toml``."""
        content: dict[str, Any] = {"schema": 1, "kind": self.kind, "case": self.case}
        if self.kind not in SEARCHES:
            content["n"] = self.n
        if self.kind == MONTECARLO:
            content |= {"sampling": type(self.sampling).WORD, **vars(self.sampling)}
        if self.kind == SWEEP:
            content["together"] = self.together
        content |= {"keep": self.keep, "fail": self.fail, "measure": dict(self.measure)}
        if self.factor is not None:
            given = {**vars(self.factor), "joints": list(self.factor.joints)}
            content["factor"] = {key: value for key, value in given.items() if value is not None}
        content["vary"] = [
            {"name": one.name, "paths": list(one.paths), "is": str(one.distribution)}
            for one in self.vary
        ]
        content["correlate"] = [{"of": [a, b], "value": c} for a, b, c in self.correlate]
        if self.fit is not None:
            content["fit"] = vars(self.fit)
            content["observe"] = [one.row() for one in self.observe]
        if self.target is not None:
            content["target"] = vars(self.target)
        empty: tuple[Any, ...] = ("", {}, [])
        return case_text.to_toml({key: one for key, one in content.items() if one not in empty})

    @cached_property
    def hash(self) -> str:
        """Name of the study in results."""
        return sha256(self.text.encode("utf-8")).hexdigest()[:16]

    # Checks --------------------------------------------------------------------------------------

    def checked(self) -> Description:
        """Return the study with its number of runs; raises CaseError for an invalid one."""
        require_known(self.kind, KINDS, kind="kind", where="kind")
        if self.keep not in KEEPS[:3] and not WORST.fullmatch(str(self.keep)):
            remedy = advice(str(self.keep), KEEPS, kind="choice")
            raise CaseError(f"cannot keep '{self.keep}'", where="keep", remedy=remedy)
        if self.kind == COLLAPSE:
            return replace(self, n=TRIALS_MAX)
        if self.kind == ROCKFALL:
            return self
        if not self.vary:
            raise CaseError(
                "no parameter varies",
                where="vary",
                remedy='e.g. joint.bedding.friction_angle="..."',
            )
        names = [one.name for one in self.vary]
        for name in (*names, *self.measure):
            if names.count(name) > 1:
                remedy = "give each parameter a name of its own"
                raise CaseError(f"'{shortened(name)}' is varied twice", where="vary", remedy=remedy)
            if name in COLUMNS:
                what, remedy = f"'{name}' is a column that every table has", "choose another name"
                raise CaseError(what, where="vary, measure", remedy=remedy)
        if not any(any(one.calls()) for one in self.expressions):
            raise CaseError(
                "the study measures nothing",
                where="measure",
                remedy='give a measure, e.g. crest = "displacement(A)", or a failure condition',
            )
        self._check_correlations(names)
        if self.kind == FIT:
            return replace(self, n=(self.fit or FitSettings()).checked().most_runs(len(names)))
        if self.kind == TARGET:
            return replace(self, n=self._checked_target())
        return self._counted_sweep() if self.kind == SWEEP else self._counted()

    def _checked_target(self) -> int:
        """Return the most runs of a search for a target; raises CaseError for an invalid one."""
        if len(self.vary) > 1 or not isinstance(self.vary[0].drawn, Between):
            raise CaseError(
                "a target is sought over the range of one parameter",
                where="vary",
                remedy='write PATH="between(0, 500e3)", or NAME: PATH, PATH for several keys',
            )
        return (self.target or TargetSettings()).checked().most_runs

    def _counted_sweep(self) -> Description:
        """Return a sweep with its number of runs."""
        lengths = [len(_list_of(one)) for one in self.vary]
        if self.together and len(set(lengths)) > 1:
            raise CaseError(
                f"lists of {', '.join(map(str, lengths))} values cannot be run together",
                where="together",
                remedy="make all lists equally long, or run all combinations",
            )
        runs = lengths[0] if self.together else int(np.prod(lengths, dtype=object))
        return replace(self, n=_check_count(runs))

    def _counted(self) -> Description:
        """Return a study by chance with its number of runs."""
        word = type(self.sampling).WORD
        if self.sampling.INDICES and self.correlate:
            raise CaseError(
                f"sampling '{word}' changes one parameter at a time: none can be correlated",
                where="correlate",
                remedy="leave correlations out, or choose another sampling",
            )
        for one in self.vary:
            where, is_number = f"vary {shortened(one.name)}", isinstance(one.drawn, Numbered)
            if isinstance(one.drawn, Between):
                what, remedy = f"'{one.name}' has a range, no distribution", "e.g. uniform(20, 40)"
                raise CaseError(what, where=where, remedy=remedy)
            if one.drawn.LISTED:
                raise CaseError(
                    f"'{one.name}' is a list of values, not a distribution",
                    where=where,
                    remedy="give a distribution, e.g. discrete([...]), or make it a sweep",
                )
            if is_number and self.sampling.INDICES:
                raise CaseError(
                    f"sampling '{word}' would confuse the effect of the run number with that of "
                    "the others",
                    where=where,
                    remedy="draw it: discrete([1, 2, 3, 4]), or choose another sampling",
                )
            if isinstance(self.sampling, PointEstimate):
                if is_number:
                    what, remedy = "the number of the run has no mean", "choose another sampling"
                    raise CaseError(what, where=where, remedy=remedy)
                _ = one.drawn.moments
        drawn = len(self._drawn)
        if not drawn and not isinstance(self.sampling, samplings.Random):
            return replace(self, sampling=samplings.Random()).checked()
        return replace(self, n=self.sampling.checked(_check_count(self.n), drawn))

    def _check_correlations(self, names: Sequence[str]) -> None:
        """Raise CaseError for correlations of constant parameters, or of unsuitable ones."""
        seen = set()
        for first, second, value in self.correlate:
            for name in (first, second):
                what = f"'{shortened(name)}' does not vary"
                require_known(name, names, kind="parameter", where="correlate", what=what)
                if not self.vary[names.index(name)].drawn.CONTINUOUS or self.kind == SWEEP:
                    raise CaseError(
                        f"'{shortened(name)}' is not a continuous variable",
                        where="correlate",
                        remedy="correlate parameters with continuous distributions",
                    )
            pair = frozenset((first, second))
            if len(pair) < 2 or pair in seen:
                raise CaseError(
                    f"'{shortened(first)}' with '{shortened(second)}' is given twice, or is one "
                    "parameter",
                    where="correlate",
                    remedy="give each pair of two parameters once",
                )
            seen.add(pair)
            if not (isinstance(value, int | float) and -1.0 < value < 1.0):
                raise CaseError(
                    f"{value!r} is not a valid correlation",
                    where="correlate",
                    remedy="give a number between -1 and 1",
                )
        _ = self._copula


def _list_of(one: Parameter) -> Values | Range:
    """Return the list of a parameter of a sweep; raises CaseError where it has none."""
    drawn = one.drawn
    if not isinstance(drawn, Values | Range):
        raise CaseError(
            f"'{one.name}' is a distribution, not a list of values",
            where=f"vary {shortened(one.name)}",
            remedy="give e.g. [20, 30, 40] or range(20, 40, 5), or make it a Monte Carlo study",
        )
    return drawn


def _check_count(count: Any) -> int:
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count:
        raise CaseError(
            f"{count!r} is not a valid number of runs", where="n", remedy="e.g. n = 500"
        )
    if count > samplings.RUNS_MAX:
        raise CaseError(
            f"{count} runs are more than {samplings.RUNS_MAX:,}", where="n", remedy="lower it"
        )
    return count


# Reading -----------------------------------------------------------------------------------------


WORDS = {
    int: "a whole number",
    str: "a text",
    bool: "true or false",
    dict: "a table",
    list: "a list",
}
KINDS_OF_KEYS = {
    int: ("schema", "n", "seed", "replicates"),
    str: ("kind", "case", "sampling", "keep", "fail"),
    bool: ("together",),
    dict: ("measure", "factor", "fit", "target"),
    list: ("vary", "correlate", "observe"),
}
KEYS = {key: kind for kind, keys in KINDS_OF_KEYS.items() for key in keys}
"""Keys of ``study.toml`` -> the kinds of their values."""
KEYS_OF_PARAMETER = {"name": str, "paths": list, "is": str}
KEYS_OF_FACTOR = {"by": str, "joints": list}
"""Keys of how a factor is looked for that are no numbers, which are checked where they are used."""
REMADE = "clast study writes this file: restore it, or start the study in another folder"


def described(text: str, file: str) -> Description:
    """Return the study of the text of a ``study.toml``; raises CaseError naming the fault."""
    content = case_text.parse(text, file)
    _check_kinds(content, KEYS, file)
    for row in content.get("vary", ()):
        _check_kinds(row, KEYS_OF_PARAMETER, f"{file}, vary")
    factor = content.get("factor", {})
    _check_kinds(
        {key: factor[key] for key in KEYS_OF_FACTOR if key in factor},
        KEYS_OF_FACTOR,
        f"{file}, factor",
    )
    for key in ("kind", "case"):
        if key not in content:
            raise CaseError(f"lacks the key '{key}'", where=file, remedy=REMADE)
    if content.get("schema", 1) != 1:
        raise CaseError(
            f"is of schema {content['schema']}, but this version of clast reads schema 1",
            where=file,
            remedy="continue the study with the version that created it",
        )
    try:
        plain = {key: content[key] for key in ("n", "together", "keep", "fail") if key in content}
        numbers = {key: content[key] for key in ("seed", "replicates") if key in content}
        return Description(
            kind=content["kind"],
            case=content["case"],
            vary=tuple(
                Parameter(
                    name=str(one["name"]),
                    paths=tuple(map(str, one["paths"])),
                    distribution=parsed(one["is"], f"{file}: {one['name']}"),
                )
                for one in content.get("vary", [])
            ),
            correlate=tuple((*one["of"], one["value"]) for one in content.get("correlate", [])),
            sampling=sampling_of(content.get("sampling", "random"), **numbers),
            measure=dict(content.get("measure", {})),
            factor=FactorSettings(**{**factor, "joints": tuple(factor.get("joints", ()))})
            if "factor" in content
            else None,
            observe=of_rows(content.get("observe", [])),
            fit=FitSettings(**content["fit"]) if "fit" in content else None,
            target=TargetSettings(**content["target"]) if "target" in content else None,
            **plain,
        ).checked()
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        what = f"is not a study: {type(error).__name__} {error}"
        raise CaseError(what, where=file, remedy=REMADE) from None


def _check_kinds(content: Any, kinds: Mapping[str, type], where: str) -> None:
    """Raise CaseError for keys that are not known, and for values of another kind than theirs."""
    if not isinstance(content, Mapping):
        raise CaseError("is not a table", where=where, remedy=REMADE)
    for key, value in content.items():
        require_known(key, kinds, kind="key", where=where)
        if type(value) is not kinds[key]:
            what = f"{key} has to be {WORDS[kinds[key]]}, not {shortened(repr(value))}"
            raise CaseError(what, where=where, remedy=REMADE)


def sampling_of(word: str, **numbers: Any) -> Sampling:
    """Return a sampling by its name; numbers that it does not have are refused."""
    require_known(word, SAMPLINGS, kind="sampling", where="sampling")
    kind = SAMPLINGS[word]
    known = {one.name for one in fields(kind)}  # type: ignore[arg-type]
    for name, value in numbers.items():
        if name not in known:
            what = f"sampling '{word}' has no {name}"
            raise CaseError(what, where=name, remedy=f"leave {name} out")
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
            remedy = "give a whole number, not negative"
            raise CaseError(f"{value!r} is not a valid {name}", where=name, remedy=remedy)
    return kind(**numbers)


def parameters_of(vary: Mapping[str, Any]) -> tuple[Parameter, ...]:
    """Return the parameters, from paths -> distribution, list, text or single value.

    A key may be several paths, separated by commas, and begin with a name: "phi: joint.a.x, ...".
    """
    if not isinstance(vary, Mapping):
        what = f"{shortened(repr(vary))} has no paths with values"
        raise CaseError(what, where="vary", remedy='give {"time.end": [1.0, 2.0]}')
    parameters = []
    for key, value in vary.items():
        head, colon, tail = key.partition(":")
        name, paths = (head.strip(), tail) if colon else (key.strip(), key)
        where = f"vary {shortened(name)}"
        parts = tuple(part.strip() for part in paths.split(",") if part.strip())
        if not name or not parts:
            what = f"'{shortened(key)}' is not a path"
            raise CaseError(what, where="vary", remedy="e.g. time.end")
        parameters.append(
            Parameter(name=name, paths=parts, distribution=_distribution(value, where))
        )
    return tuple(parameters)


def _distribution(value: Any, where: str) -> Distribution:
    if isinstance(value, str):
        return parsed(value, where)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, Distribution):
        value = Values(tuple(value) if isinstance(value, list | tuple) else (value,))
    try:
        value.validate()
    except CaseError as error:
        raise CaseError(error.what, where=error.where or where, remedy=error.remedy) from None
    return value
