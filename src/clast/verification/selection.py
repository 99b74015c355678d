"""Which problems are run, with which processes and laws, and how much of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from clast import spelling
from clast.errors import CaseError
from clast.inputs.method import CONTACT_LAWS, PROCESSES
from clast.verification.catalogue import GROUPS, PROBLEMS
from clast.verification.problem import Problem

Choose = Callable[[Problem], Problem]
"""Returns a problem with the variants to run."""


def every(problem: Problem) -> Problem:
    """Choose all of a problem."""
    return problem


def quick(problem: Problem) -> Problem:
    """Choose the part of all problems that together takes less than a minute."""
    return problem.brief()


def problems(names: Iterable[str] = ()) -> list[Problem]:
    """Return the named problems, and those of named groups; all if none is named.

    Raises CaseError for a name unknown.
    """
    known = {**GROUPS, **{problem.name: (problem,) for problem in PROBLEMS}}
    wanted = list(names)
    for name in wanted:
        if name not in known:
            raise CaseError(
                f"there is no verification problem '{name}'",
                remedy=spelling.advice(name, known, kind="problem"),
            )
    found = dict.fromkeys(problem for name in wanted for problem in known[name])
    return list(found) if wanted else list(PROBLEMS)


def narrowed(choose: Choose, processes: Sequence[str] = (), laws: Sequence[str] = ()) -> Choose:
    """Restrict a selector to the variants with these processes and laws.

    Nothing named means any.  Raises CaseError for an unknown name.
    """
    _check("process", processes, PROCESSES)
    _check("contact law", laws, CONTACT_LAWS)

    def chosen(problem: Problem) -> Problem:
        whole = choose(problem)
        kept = tuple(
            variant
            for variant in whole.variants
            if (not processes or variant.process["name"] in processes)
            and (not laws or variant.contact_law["name"] in laws)
        )
        return replace(whole, variants=kept)

    return chosen


def _check(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    listed = list(known)
    for name in names:
        if name not in listed:
            raise CaseError(
                f"there is no {kind} '{name}'", remedy=spelling.advice(name, listed, kind=kind)
            )
