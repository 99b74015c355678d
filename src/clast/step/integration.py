"""The theta family of implicit schemes, and where in a step they take their forces.

    M (v+ - v) = h F,   d = h ((1 - theta) v + theta v+)

theta = 1/2 is constant acceleration (Shi 1988), 1 is backward Euler.  Eliminating v+ gives
M/(theta h2) (d - h v) = F.  Every block receives the impulse h F whatever its theta, so blocks with
different theta still exchange momentum exactly.

theta may be 1 for some motions of a block and the scheme's for all others: with Q the projection on
motions that contacts stop, orthogonal in the sense of M, M (1/theta + (1 - 1/theta) Q) stands in
place of M/theta.  Motions free of these contacts go on as if they were not there.

Where impacts change a block's velocity within the step (step/impact.py) v is that after them,
and in place of h v stands how far the block would go, its ``drift``.

F are the forces at the end of the step, which takes energy from vibrations; or those half way (the
implicit midpoint rule; Simo, Tarnow & Wong 1992): a spring stretched by x at the start and by x + d
at the end has its force at x + d/2.  A contact then has

    N = clip(N_0 - p (gap + x_n/2)),    T = clip(T_0 - k x_t/2)

with x_n and x_t by how much it opens and slips, if it carries when the step starts or has a tensile
strength.  Work and stored energy then agree to the last digit where the force goes straight, N x_n
= 1/2 p gap^2 - 1/2 p (gap + x_n)^2; where it is clipped in between, for the contact opens or slips,
energy is lost and never made.  A contact that carries nothing may close, and half of that would
resist too little: it has the forces of the end of the step, which resist too much.  So has one
without tensile strength whose own swing the step leaps over, w h > 2 pi: a block on it would swing
from step to step for ever.  Multipliers are those of the end of the step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np

from clast.contact.clipped_spring import Clipped
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.laws import ContactLaw, has_multipliers, normal_stiffness_of
from clast.model.model import Bools, Floats, Model
from clast.step import inertia_projection


@dataclass(frozen=True, kw_only=True)
class Scheme:
    """How blocks take a step."""

    theta: float
    """Share of the end velocity in the displacement."""
    step: float
    """h, s."""
    stopped: inertia_projection.Stopped | None = None
    """Motions with theta = 1, as kernels take them (step/inertia_projection.py)."""

    @property
    def inertia(self) -> float:
        """1/(theta h2), 1/s2."""
        return 1.0 / (self.theta * self.step**2)

    @property
    def of_stopped(self) -> float:
        """Addition for stopped motions, (1 - 1/theta)/h2, 1/s2."""
        return (1.0 - 1.0 / self.theta) / self.step**2


def end_velocity(scheme: Scheme, displacement: Floats, drift: Floats, velocity: Floats) -> Floats:
    """Return v+ of each block, shape (n, 6), from d, the ``drift``, m, and v, (n, 6) each."""
    change = displacement - drift
    result: Floats = velocity + scheme.inertia * scheme.step * change
    if scheme.stopped is not None:
        inertia_projection.add_velocities(
            scheme.stopped, scheme.of_stopped * scheme.step, change, result
        )
    return result


class Integrator(Protocol):
    """An implicit time scheme of the theta family: d = h ((1 - theta) v + theta v+).

    One that takes its forces elsewhere than at the end of the step says where: ``forces_at``.
    """

    @property
    def theta(self) -> float:
        """Share of the end velocity in the displacement, 1/2 to 1."""
        ...


def forces_at(integrator: Integrator) -> float:
    """Return where in the step a scheme takes the forces of springs and straining, 1/2 to 1."""
    return float(getattr(integrator, "forces_at", 1.0))


@dataclass(frozen=True)
class ConstantAcceleration:
    """(2/h2) M d = (2/h) M v + F at the end of the step; v+ = (2/h) d - v (Shi 1988)."""

    theta: ClassVar[float] = 0.5


@dataclass(frozen=True)
class BackwardEuler:
    """(1/h2) M d = (1/h) M v + F at the end of the step; v+ = d/h; dissipative."""

    theta: ClassVar[float] = 1.0


@dataclass(frozen=True)
class Midpoint:
    """(2/h2) M d = (2/h) M v + F at mid-step; v+ = (2/h) d - v; of second order, no damping."""

    theta: ClassVar[float] = 0.5
    forces_at: ClassVar[float] = 0.5


FOLLOWED = 2.0 * np.pi
"""Largest w h of a contact without tensile strength that is taken half way."""


@dataclass(frozen=True)
class HalfWay:
    """Where in the step the forces of contacts are taken."""

    share: float
    """Place of those that carry when it starts: 0 at the start, 1 at the end."""
    springs_only: Bools
    """Contacts without multipliers, shape (m,)."""
    followed: Bools
    """Contacts whose own swing the step follows, shape (m,)."""

    def bearing(self, contacts: Contacts) -> Bools:
        """Return which contacts are taken there, shape (m,)."""
        carries = self.followed & (contacts.normal_force > 0.0)
        return np.asarray(self.springs_only & (carries | (contacts.tensile_strength > 0.0)))

    def place(self, contacts: Contacts) -> Floats:
        """Return where the forces of each contact are taken, shape (m,)."""
        return np.where(self.bearing(contacts), self.share, 1.0)

    def springs(
        self, springs: tuple[Clipped, Clipped], contacts: Contacts
    ) -> tuple[Clipped, Clipped]:
        """Return normal and shear springs with the forces of these within the step."""
        normal, shear = springs
        place, none = self.place(contacts), np.zeros(len(contacts))
        return normal.taken_at(place, contacts.gap), shear.taken_at(place, none)

    def respond(
        self, law: ContactLaw, contacts: Contacts, gap: Floats, slip: Floats
    ) -> ContactResponse:
        """Return the answer of a law within a step to gaps and slips (m,), m, functions of these.

        The energy is that of the potential whose slopes the forces are.
        """
        place = self.place(contacts)
        answer = law.respond(contacts, contacts.gap + place * (gap - contacts.gap), place * slip)
        return replace(
            answer,
            normal_stiffness=place * answer.normal_stiffness,
            shear_stiffness=place * answer.shear_stiffness,
            energy=answer.energy / place,
            dissipation=answer.dissipation / place,
        )


def answer(
    law: ContactLaw, contacts: Contacts, gap: Floats, slip: Floats, taken: HalfWay | None
) -> ContactResponse:
    """Return the answer of contacts in the equations to gaps and slips (m,) of the end, m."""
    if taken is None:
        return law.respond(contacts, gap, slip)
    return taken.respond(law, contacts, gap, slip)


def half_way(
    model: Model, law: ContactLaw, contacts: Contacts, share: float, step: float
) -> HalfWay | None:
    """Return where in a step of ``step``, s, the forces of the contacts are taken.

    It takes those of springs and straining at ``share`` of it; None: all are those of its end.
    """
    if share == 1.0:
        return None
    mobility = np.where(model.fixed, 0.0, 1.0 / model.mass)
    both = mobility[contacts.vertex_block] + mobility[contacts.edge_block]
    swing = np.sqrt(normal_stiffness_of(contacts, law) * both)
    own = np.isnan(contacts.normal_stiffness) & has_multipliers(law)
    return HalfWay(share, ~own, swing * step <= FOLLOWED)
