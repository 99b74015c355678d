"""One step, by whatever process: begin, look for contacts, solve, look again, finish."""

from __future__ import annotations

from typing import Protocol

from clast.contact.contacts import Contacts
from clast.model.model import Model
from clast.model.state import State
from clast.step.finish import finish
from clast.step.method import Method, StepResult, StepSolution, Workspace
from clast.step.search_distance import ContactSearch, searched_again
from clast.step.start import StepContext, again, begin, repeats


class StepSolver(Protocol):
    """Solves the equations of a step; with ``step = take_step`` in its class it is a process."""

    def search(self, context: StepContext) -> ContactSearch:
        """Return how far the contacts of the step are looked for."""
        ...

    def solve(
        self, context: StepContext, contacts: Contacts, before: StepSolution | None = None
    ) -> StepSolution:
        """Return the solution with these contacts, or raise StepRejected (a smaller step helps).

        ``before`` is the solution with fewer contacts, where a wider search has found more.
        """
        ...


def take_step(
    process: StepSolver,
    model: Model,
    method: Method,
    state: State,
    step: float,
    workspace: Workspace | None = None,
) -> StepResult:
    """Return the state ``step`` seconds later, or raise StepRejected (a smaller step helps).

    ``workspace`` holds data that the run keeps to save time; None: nothing is kept.
    """
    context = begin(model, method, state, step, workspace)
    search = process.search(context)
    contacts = search.contacts(context)
    solution = process.solve(context, contacts)
    while wider := searched_again(context, search, contacts, solution.unknowns):
        search, contacts = wider
        solution = process.solve(context, contacts, solution)
    repeated = 0
    while renewed := again(context, solution.unknowns):
        context, repeated = renewed, repeated + 1
        solution = process.solve(context, contacts, solution)
        if repeated >= repeats(context):
            break
    return finish(context, solution, search.depth)
