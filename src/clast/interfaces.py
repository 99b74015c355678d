"""Where to plug in: what a displacement function, contact law, corner rule, solver or process is.

Algorithms are frozen dataclasses of their own numbers.  Nothing needs to be inherited or
registered: an object with these methods can be put into a :class:`Method` from a script.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from clast.errors import StepOutcome
from clast.model import Bools, Floats, Ints, Model
from clast.state import State

if TYPE_CHECKING:
    from clast.contact.arrays import ContactResponse, Contacts, SpringLimits
    from clast.contact.detection import Candidates
    from clast.equations.system import BlockSystem


class DisplacementFunction(Protocol):
    """How a block moves and strains with its six unknowns about its centroid."""

    def basis(self, offset: Floats) -> Floats:
        """Return T (m, 2, 6) at offsets (m, 2) from the centroid, m."""
        ...

    def mass_matrix(self, mass: Floats, moments: Floats) -> Floats:
        """Return M (n, 6, 6) from mass (n,) and mass moments (n, 3): int x2, y2, xy dm, kg m2."""
        ...

    def place(self, offset: Floats, displacement: Floats) -> Floats:
        """Return the new offsets (m, 2) from the *old* centroid after displacements d (m, 6)."""
        ...

    def turn(self, displacement: Floats) -> Floats:
        """Return the rotation, rad, of displacements d (n, 6); nan where it is impossible."""
        ...


class Integrator(Protocol):
    """An implicit time scheme of the theta family: d = h ((1 - theta) v + theta v+)."""

    @property
    def theta(self) -> float:
        """Share of the end velocity in the displacement, 1/2 to 1."""
        ...


class ContactLaw(Protocol):
    """Forces between blocks from gap and slip.  Evaluating a law never changes its memory."""

    @property
    def normal_stiffness(self) -> float:
        """Normal contact stiffness p (the penalty), N/m per m."""
        ...

    def respond(self, contacts: Contacts, gap: Floats, slip: Floats) -> ContactResponse:
        """Return forces and stiffnesses for gaps (m,) and slips (m,) at the end of the step, m."""
        ...


class SpringLaw(ContactLaw, Protocol):
    """A contact law that is nothing but linear springs with bounds."""

    def limits(self, contacts: Contacts) -> SpringLimits:
        """Return stiffnesses and bounds, for contacts whose friction bound is given."""
        ...


class CornerRule(Protocol):
    """Chooses entrance edges among the candidate edges of a vertex at a corner of a block."""

    def choose(self, candidates: Candidates, vertices: Floats) -> Bools:
        """Return True for the candidates that become contacts, shape (m,)."""
        ...


class MultiplierLaw(ContactLaw, Protocol):
    """A contact law with Lagrange multipliers that are renewed between solves of one step."""

    @property
    def solves(self) -> int:
        """Solves per step, at most."""
        ...

    @property
    def carries(self) -> bool:
        """True where a step begins with the multipliers of the last."""
        ...

    @property
    def penetration_tolerance(self) -> float:
        """Penetration, m, at which the solves end early."""
        ...

    def begin(self, contacts: Contacts) -> Contacts:
        """Return the contacts with the multipliers of the first solve of a step."""
        ...

    def renew(self, contacts: Contacts, response: ContactResponse) -> Contacts:
        """Return the contacts with the multipliers that follow from the forces of a solve."""
        ...


class Factor(Protocol):
    """A block system made ready to be solved for several right-hand sides."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        ...


class LinearSolver(Protocol):
    """Solves the 6 x 6 block system of a step."""

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        ...


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

    def step(self, model: Model, method: Method, state: State, step: float) -> StepResult:
        """Return the state ``step`` seconds later, or raise StepRejected (a smaller step helps)."""
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


__all__ = [
    "Bools",
    "ContactLaw",
    "CornerRule",
    "DisplacementFunction",
    "Factor",
    "Floats",
    "Integrator",
    "Ints",
    "LinearSolver",
    "Method",
    "MultiplierLaw",
    "SpringLaw",
    "StepProcess",
    "StepResult",
]
