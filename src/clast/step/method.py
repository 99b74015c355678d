"""Method, StepProcess and StepResult.

Algorithms are frozen dataclasses of their own numbers.  Nothing needs to be inherited or
registered: an object with these methods can be put into a ``Method`` from a script.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from clast.actions.action import Action
from clast.actions.active import ActiveActions
from clast.actions.damping import Undamped
from clast.block.rotation import RotationRule
from clast.compute.compilation import Clock
from clast.contact.broad_phase import VerletList
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.corner_rules import CornerRule
from clast.contact.joints.asperities import Asperities
from clast.contact.laws import ContactLaw
from clast.errors import StepOutcome
from clast.linear.pattern import Patterns
from clast.linear.solvers import DIRECTION_TOLERANCE, LinearSolver, inexact
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import State
from clast.step.integration import Integrator, Scheme


def _no_contacts() -> Ints:
    return np.zeros(0, np.int64)


@dataclass(kw_only=True)
class Workspace:
    """Data found once that serve several steps; a run has its own.

    It may be thrown away before any step without changing a digit, and so is no part of the data of
    a run.
    """

    near: VerletList = field(default_factory=VerletList)
    """Pairs of blocks near each other."""
    patterns: Patterns = field(default_factory=Patterns)
    """Orders and fill of the last factors, and the aggregates of the last coarse space."""
    active: ActiveActions = field(default_factory=ActiveActions)
    """The actions on the blocks beside contacts."""
    _inexact: tuple[Any, Any] = (None, None)
    clock: Clock | None = None
    """Clock by which the time of the stages of a step is taken; None: wall time."""

    def inexact(self, solver: LinearSolver) -> LinearSolver:
        """Return the solver for directions of Newton's method, which need not be accurate."""
        if self._inexact[0] is not solver:
            self._inexact = solver, inexact(solver, DIRECTION_TOLERANCE)
        kept: LinearSolver = self._inexact[1]
        return kept


@dataclass(frozen=True, kw_only=True)
class StepResult:
    """The result of one accepted step."""

    state: State
    """State at the end of the step."""
    contacts: Contacts
    """Contacts of the step."""
    response: ContactResponse
    """Contact forces at the end of the step."""
    counts: dict[str, int]
    """Counts of the process: "passes" (assemblies and solves) and more."""
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
    broken: Ints = field(default_factory=_no_contacts)
    """Which of the contacts have lost their bonds in the step, shape (b,)."""
    worn: Ints = field(default_factory=_no_contacts)
    """First contacts of a joint that slide down to residual strength in the step, shape (r,)."""

    @property
    def passes(self) -> int:
        """Assemblies and solves in the step."""
        return self.counts["passes"]


@dataclass(frozen=True, kw_only=True)
class StepSolution:
    """Displacements and contact forces that solve the equations of a step."""

    velocity: Floats
    """Velocity that entered the equations, shape (n, 6)."""
    drift: Floats
    """Displacements that it would bring, m, shape (n, 6)."""
    scheme: Scheme
    """How the blocks took the step."""
    unknowns: Floats
    """Displacements d, shape (n, 6)."""
    contacts: Contacts
    """Contacts of the step."""
    response: ContactResponse
    """The law's answer at the end of the step."""
    applied: tuple[Floats, Floats]
    """Normal and shear forces (m,) that the equations held at the end of the step, N/m."""
    bearing: Floats
    """Normal forces that contacts go on with, N/m, shape (m,)."""
    linearised_at: Floats | None = None
    """Displacements about which springs of actions were linearised, (n, 6); None: at the end."""
    lost: float = 0.0
    """Kinetic energy that impacts took before it entered, J/m."""
    driven: Floats | None = None
    """Impulses of bodies with a prescribed motion on bodies they struck, N s/m, (n, 6)."""
    bonded: Bools | None = None
    """Which contacts had their bonds when the step began, shape (m,); None: as the contacts say."""
    asperities: Asperities | None = None
    """Law of contacts that open as they slip within the step; None: they open after it."""
    counts: dict[str, int] = field(default_factory=dict)
    """Counts of the process: "passes" and whatever else it counts."""


def is_stable_for_any_step(process: object) -> bool:
    """Return whether the contacts of a process settle whatever the length of a step.

    A process of which that holds says so by ``any_step = True``.
    """
    return bool(getattr(process, "any_step", False))


class StepProcess(Protocol):
    """Carries the state over one step."""

    def step(
        self, model: Model, method: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        """Return the state ``step`` seconds later, or raise StepRejected (a smaller step helps).

        ``workspace`` holds data that the run keeps to save time; a process need not use it.
        """
        ...

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Return advice for a user before the first step of length ``step``, s."""
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
    rotation: RotationRule
    """Rotation rule: the meaning of the third unknown of a block."""
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
    clock: float | None = None
    """By how much time goes on in a step, s; None: by the length of the step.  A static step's
    length is that of its mass term only (run/stages/static_path.py)."""
    balance: float | None = None
    """Unbalanced force that the process may leave each block, as a share of the forces on it; None:
    a tolerance of all blocks together is enough."""
    damping: Action = field(default_factory=Undamped)
    """Energy taken from all blocks:  Undamped, Rayleigh, Adaptive, Kinetic."""
    notes: tuple[str, ...] = ()
    """Automatic choices, and their reasons."""
