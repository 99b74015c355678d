"""The protocol of actions: forces on blocks beside those of their contacts.

In each step an action contributes to the equations K d = F, with forces as they are at the end of
the step, and afterwards reports the work of its forces and the change of energy.  Gravity, loads,
supports and the ground's motion are actions; an object of one's own with the same methods, handed
to ``ModelBuilder.actions``, is one more (see the how-to page on actions).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from clast.block import polygon
from clast.block.displacement import basis, movements
from clast.block.inertia import BlockFrames
from clast.block.rotation import Exact, RotationRule
from clast.contact.clipped_spring import Springs
from clast.linear.opening_joints import OpeningJoints
from clast.linear.system import stretches
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger, State


@dataclass(frozen=True, kw_only=True)
class StepStart:
    """The start of a step, as far as actions may know it."""

    model: Model
    state: State
    frames: BlockFrames
    """Areas, centroids and mass matrices of the blocks."""
    step: float
    """h, s."""
    ahead: Floats | None = None
    """Displacement (1 - theta) h v of blocks to where forces that follow them are to be taken,
    shape (n, 6); None: where the blocks are."""
    rotation: RotationRule = field(default_factory=Exact)
    """How blocks are placed with it."""
    forces_at: float = 1.0
    """Where in the step its forces are taken: 1 at the end, 1/2 half way."""
    support_stiffness: float = 1e12
    """Stiffness of rigid supports, fixed points among them, N/m per m."""
    clock: float | None = None
    """By how much time goes on in a static step, s; None: by h."""

    @property
    def end(self) -> float:
        """Time at the end of the step, s."""
        return self.state.time + (self.step if self.clock is None else self.clock)

    @property
    def span(self) -> tuple[float, float]:
        """Start and end of the time over which loads are averaged, s; of a static step, its end."""
        if self.clock is None:
            return self.state.time, self.end
        # Time over which a mean is taken as the value of an instant, s
        return self.end - 1e-5, self.end

    @property
    def time_of_forces(self) -> float:
        """Time at which loads act as they do then, s."""
        return self.state.time + self.forces_at * (self.end - self.state.time)

    @cached_property
    def midway(self) -> Placed:
        """Where the blocks will be halfway through the step at the velocities they have.

        A force that depends on where blocks are, taken at x + (1 - theta) h v, brings no energy
        and takes none: with s = omega h the step of an oscillator has the determinant
        1 + s^2 (1 - theta - c) if the force is that at x + c h v, so that at the start of the step
        (c = 0) constant acceleration makes the motion grow as exp(omega^2 h t/4).  With
        theta = 1/2 this is the position Verlet scheme, of second order, stable for s < 2.
        """
        state, model, centroid, ahead = self.state, self.model, self.frames.centroid, self.ahead
        if ahead is None:
            return Placed(vertices=state.vertices, points=state.points, centroid=centroid)

        def placed(at: Floats, block: Ints) -> Floats:
            offset = polygon.offsets(at, block, centroid)
            return np.asarray(at + movements(self.rotation, offset, ahead, block))

        return Placed(
            vertices=placed(state.vertices, model.vertex_block),
            points=placed(state.points, model.material_points.block),
            centroid=centroid + ahead[:, :2],
        )


@dataclass(frozen=True, kw_only=True)
class Placed:
    """Where blocks are at one instant."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    points: Floats
    """Material points in the order of ``Model.material_points``, m, shape (np, 2)."""
    centroid: Floats
    """Centroids, m, shape (n, 2)."""


def _no_forces() -> Floats:
    return np.zeros((0, 6))


@dataclass(frozen=True, kw_only=True)
class Prescribed:
    """Motions of k blocks that are known before the step is solved."""

    block: Ints
    """Block of each, shape (k,)."""
    components: Bools
    """Which unknowns (u, v, r, ex, ey, gxy) are prescribed, shape (k, 6)."""
    displacement: Floats
    """Displacements in the step, d, shape (k, 6)."""
    velocity: Floats
    """Their velocities at its end, shape (k, 6)."""


@dataclass(frozen=True, kw_only=True)
class Contribution:
    """The contribution of an action to the equations of a step."""

    acceleration: Floats | None = None
    """Acceleration that acts on every mass, m/s2, shape (2,)."""
    block: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Block of each of k generalised forces, shape (k,)."""
    force: Floats = field(default_factory=_no_forces)
    """Generalised forces T^T f at d = 0, N/m and N, shape (k, 6)."""
    stiffness: Floats | None = None
    """How these fall with the displacement of their block, -df/dd, shape (k, 6, 6).

    Of springs it is ``forces_at`` of the step times that; of dashpots C/h.
    """
    forces_at: float = 1.0
    """That of the step, where the stiffness is one of springs that are taken there."""
    springs: Springs | None = None
    """Clipped springs between points of two blocks."""
    opening: OpeningJoints | None = None
    """Water in joints that lets itself be pressed, and presses, as blocks move in the step."""
    carried: float = 1.0
    """Fraction of the velocities of the last step with which the blocks enter this one."""
    prescribed: Prescribed | None = None
    """Motions of blocks, regardless of the forces on them."""


NO_CONTRIBUTION = Contribution()
"""That of an action that adds nothing."""


@dataclass(frozen=True, kw_only=True)
class Solution:
    """The solution of a step, as far as actions need to know it."""

    displacement: Floats
    """d, shape (n, 6)."""
    points: Floats
    """Material points at the end, in the order of ``Model.material_points``, m, shape (np, 2)."""
    linearised_at: Floats | None = None
    """Displacements about which the equations held the springs linear, shape (n, 6); None: at d."""
    velocity: Floats = field(default_factory=_no_forces)
    """Velocity that entered the step, shape (n, 6)."""
    gained: Floats = field(default_factory=_no_forces)
    """Velocity that the forces of the step have given each block, shape (n, 6)."""
    holding: Floats = field(default_factory=_no_forces)
    """Force (x, y), N/m, and moment, N, that prescribed motions took, 0 for others; (n, 3) or
    (0, 6) where none is prescribed."""

    def spring_forces(self, springs: Springs) -> tuple[Floats, Floats]:
        """Return N and T (m,), N/m, that the equations held in springs at the end of the step."""
        gap, slip = stretches(springs, self.displacement)
        if self.linearised_at is None:
            of_springs = springs.at(gap, slip)
            return of_springs.normal_force, of_springs.shear_force
        before = stretches(springs, self.linearised_at)
        of_springs = springs.at(*before)
        return (
            of_springs.normal_force - of_springs.normal_stiffness * (gap - before[0]),
            of_springs.shear_force - of_springs.shear_stiffness * (slip - before[1]),
        )


@dataclass(frozen=True, kw_only=True)
class ActionResult:
    """The result of an action in a step: work, energy and its state."""

    work: float
    """Work of the forces that the equations held on the blocks, J/m."""
    ledger: Ledger
    """By how much the entries of the energy ledger have changed by it, J/m.

    Stored and lost energy count as they are, and energy brought in from outside as ``loads`` or
    ``water``.
    """
    state: Any = None
    """State of the action at the end of the step."""


NOTHING = ActionResult(work=0.0, ledger=Ledger())
"""The result of an action that does nothing."""


def energy_of_linear(contribution: Contribution, displacement: Floats) -> tuple[float, float]:
    """Return work and stored energy of forces f - K d of a contribution over d (n, 6), J/m.

    The work is that of the forces in the equations, (f - K d).d; the stored energy grows by -f.d
    and by 1/2 d.K d of the whole stiffness, if they store it.
    """
    if not len(contribution.block):
        return 0.0, -0.0
    moved = displacement[contribution.block]
    # no BLAS: its threads would cost more than these sums, and add up in an order of their own
    pushed = float(np.add.reduce(contribution.force * moved, axis=None))
    if contribution.stiffness is None:
        return pushed, -pushed
    along = np.add.reduce(contribution.stiffness * moved[:, None], axis=2) * moved
    stretched = float(np.add.reduce(along, axis=None))
    return pushed - stretched, 0.5 / contribution.forces_at * stretched - pushed


def energy_of_springs(springs: Springs, solution: Solution) -> tuple[float, float]:
    """Return the work of clipped springs in a step and the change of their potential, J/m.

    The work is that of the forces which the equations held.  The potential grows by the energy that
    a spring stores, and by the energy that it loses where its force has reached a bound.
    """
    normal, shear = solution.spring_forces(springs)
    gap, slip = stretches(springs, solution.displacement)
    work = float(normal @ (gap - springs.gap) + shear @ (slip - springs.slip))
    return work, springs.energy(gap, slip) - springs.energy(springs.gap, springs.slip)


def forces_at_points(block: Ints, offset: Floats, force: Floats) -> Contribution:
    """Return forces (k, 2), N/m, on blocks (k,) at offsets (k, 2), m, from their centroids."""
    return Contribution(block=block, force=np.einsum("kxi,kx->ki", basis(offset), force))


class Action(Protocol):
    """An action on the blocks: forces beside those of contacts.

    A class that inherits from it needs ``contribution`` alone: it has no state then, and the work
    of its forces comes from outside.
    """

    entries: ClassVar[Mapping[str, float]] = {"loads": 1.0}
    """Entries of the ledger that the work of its forces goes to, with their signs."""

    def begin(self, model: Model) -> Any:
        """Return the state of the action at the start of a run: any frozen data, or None."""
        return None

    def contribution(self, start: StepStart, state: Any) -> Contribution:
        """Return the contribution to the equations of a step, from the state of the action."""
        ...

    def finish(
        self, start: StepStart, state: Any, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the result of the forces in a step that is solved."""
        work, _ = energy_of_linear(contribution, solution.displacement)
        if contribution.acceleration is not None:
            # strain and rotation move no centroid, so that m a.(u0, v0) is all of it
            moved = start.model.mass @ solution.displacement[:, :2]
            work += float(contribution.acceleration @ moved)
        ledger = Ledger(**{name: sign * work for name, sign in self.entries.items()})
        return ActionResult(work=work, ledger=ledger, state=state)


@runtime_checkable
class ReportsEvents(Protocol):
    """Optional: an action that reports events, such as a bolt yielding."""

    def events(self, model: Model, before: Any, after: Any) -> Iterable[tuple[str, str, str]]:
        """Return kind, name and sentence of each event of a step.

        An example is ("yielded", "bolt 3", "bolt 3 yields").  ``before`` and ``after`` are
        states of the action.
        """
        ...
