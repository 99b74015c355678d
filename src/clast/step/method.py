"""What a step is done with, the process of a step, and what a step leaves.

Algorithms are frozen dataclasses of their own numbers.  Nothing needs to be inherited or
registered: an object with these methods can be put into a :class:`Method` from a script.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from clast.block.displacement import DisplacementFunction
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.corner_rules import CornerRule
from clast.contact.laws import ContactLaw
from clast.errors import StepOutcome
from clast.linear.factor import LinearSolver
from clast.model.model import Model
from clast.model.state import State
from clast.step.integration import Integrator
from clast.step.workspace import Workspace


@dataclass(frozen=True, kw_only=True)
class StepResult:
    """What one accepted step leaves."""

    state: State
    """State at the end of the step."""
    contacts: Contacts
    """Contacts of the step."""
    response: ContactResponse
    """Contact forces at the end of the step."""
    counts: dict[str, int]
    """What the process counted: "passes" (assemblies and solves) and more."""
    travel: float
    """Largest movement of a vertex, m."""
    penetration: float
    """Largest penetration at the end of the step, m, >= 0."""
    seconds: dict[str, float]
    """Wall time of each stage of the step, s."""
    outcome: StepOutcome = StepOutcome.ACCEPTED
    """How the step ended."""
    approach: float = 0.0
    """Largest movement of a vertex against a block that it might touch in the step, m."""

    @property
    def passes(self) -> int:
        """Assemblies and solves in the step."""
        return self.counts["passes"]


class StepProcess(Protocol):
    """Carries the state over one step."""

    def step(
        self, model: Model, method: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        """Return the state ``step`` seconds later, or raise StepRejected (a smaller step helps).

        ``workspace`` is what the run keeps to save time; a process need not use it.
        """
        ...

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Return what a user should know before the first step of length ``step``, s."""
        ...

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return the normal stiffness that suits the process, N/m per m, and the reason."""
        ...


@dataclass(frozen=True, kw_only=True)
class Method:
    """How the system is simulated: one choice of each kind, and the numbers that they share."""

    process: StepProcess
    """Process of a step."""
    contact_law: ContactLaw
    """Contact law."""
    corner_rule: CornerRule
    """Rule that picks the entrance edge at corners."""
    displacement: DisplacementFunction
    """Displacement function of a block, with its rotation rule."""
    integrator: Integrator
    """Time integration scheme."""
    solver: LinearSolver
    """Solver of the block system."""
    fixed_point_stiffness: float
    """Stiffness of the springs that hold fixed points, N/m per m."""
    critdis: float
    """Critical distance: edges are lengthened by it in contact detection, m."""
    max_displacement: float
    """Largest vertex movement allowed in a step against blocks that may be touched, m."""
    dynamic_ratio: float = 1.0
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    notes: tuple[str, ...] = ()
    """What was chosen automatically, and why."""
