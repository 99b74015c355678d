"""The incremental potential energy of a step and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.contact.arrays import ContactResponse, Contacts
from clast.equations.reuse import FactorOfStep
from clast.equations.system import contact_forces, gap_at_end, newton_system, slip_in_step
from clast.equations.terms import DiagonalTerms
from clast.interfaces import ContactLaw
from clast.model import Bools, Floats
from clast.stepping.stages import Stages


@dataclass(frozen=True, kw_only=True)
class Point:
    """The potential's derivatives at unknowns d."""

    unknowns: Floats
    """d, shape (n, 6)."""
    gap: Floats
    """Gap of each contact, m, shape (m,)."""
    slip: Floats
    """Slip of each contact, m, shape (m,)."""
    response: ContactResponse
    """Answer of the law."""
    residual: Floats
    """F - K d + contact forces, minus the gradient of the potential, shape (n, 6)."""


@dataclass(frozen=True, kw_only=True)
class Potential:
    """1/2 d.K d - F.d + sum of phi_n(gap + n.d) + phi_t(t.d); see stepping/convex.py."""

    base: DiagonalTerms
    """K and F without contacts."""
    inverse: Floats
    """Inverse of the blocks of K, shape (n, 6, 6)."""
    law: ContactLaw
    """Contact law, with the friction bound given by the contacts."""
    contacts: Contacts
    """Contacts of the step."""
    fixed: Bools
    """Blocks that cannot move, shape (n,)."""
    momentum: Floats
    """The part of F that is momentum, M v/(theta h), shape (n, 6)."""

    def at(self, unknowns: Floats) -> Point:
        """Return the derivatives at ``unknowns`` (n, 6)."""
        gap = gap_at_end(self.contacts, unknowns)
        slip = slip_in_step(self.contacts, unknowns)
        response = self.law.respond(self.contacts, gap, slip)
        force = contact_forces(
            len(unknowns),
            self.contacts,
            response.normal_force,
            response.shear_force,
        )
        elastic = np.einsum("nij,nj->ni", self.base.diagonal, unknowns)
        residual = self.base.force - elastic + force
        residual[self.fixed] = 0.0
        return Point(unknowns=unknowns, gap=gap, slip=slip, response=response, residual=residual)

    def distance(self, point: Point) -> float:
        """Return a bound on twice the potential above its minimum, J/m.

        Contacts only add curvature to K, so r.H^-1 r <= r.K^-1 r, which costs no system.
        """
        return float(np.einsum("ni,nij,nj->", point.residual, self.inverse, point.residual))

    def yardstick(self) -> float:
        """Return the energy, J/m, that tolerances refer to: 1/2 f.K^-1 f of the step's forces.

        f are weight, loads and stress; momentum counts with MOMENTUM_SHARE of its energy, so that
        fast blocks are not solved more coarsely than those at rest.
        """

        def half(force: Floats) -> float:
            held = np.where(self.fixed[:, None], 0.0, force)
            return 0.5 * float(np.einsum("ni,nij,nj->", held, self.inverse, held))

        return half(self.base.force - self.momentum) + MOMENTUM_SHARE * half(self.momentum)

    def direction(self, point: Point, factor: FactorOfStep, stages: Stages) -> Floats:
        """Return the Newton direction (n, 6): H dd = residual."""
        with stages("assembly"):
            system = newton_system(
                self.base, self.contacts, point.response, point.residual, self.fixed
            )
        with stages("solve"):
            return factor.solve(system, point.response)

    def line_search(self, point: Point, direction: Floats) -> tuple[float, int]:
        """Return the length along ``direction`` where the potential is least, and evaluations.

        The derivative along the line rises monotonically and, for a piecewise linear law, is
        piecewise linear: Newton's method on it, kept inside a bracket, ends on the exact root.
        """
        contacts = self.contacts
        d_gap = gap_at_end(contacts, direction) - contacts.gap
        d_slip = slip_in_step(contacts, direction)
        curvature = float(np.einsum("ni,nij,nj->", direction, self.base.diagonal, direction))
        before = point.response
        start = -float(np.sum(point.residual * direction))
        held = before.normal_force * d_gap + before.shear_force * d_slip
        smooth = start + float(np.sum(held))
        low, high, length = 0.0, np.inf, 1.0
        for evaluations in range(1, LINE_SEARCH_LIMIT + 1):
            answer = self.law.respond(
                contacts, point.gap + length * d_gap, point.slip + length * d_slip
            )
            work = answer.normal_force * d_gap + answer.shear_force * d_slip
            slope = smooth + length * curvature - float(np.sum(work))
            if abs(slope) <= LINE_TOLERANCE * abs(start):
                return length, evaluations
            low, high = (length, high) if slope < 0.0 else (low, length)
            bend = answer.normal_stiffness * d_gap**2 + answer.shear_stiffness * d_slip**2
            trial = length - slope / (curvature + float(np.sum(bend)))
            inside = low < trial < high
            length = trial if inside else 0.5 * (low + min(high, 2.0 * low + 1.0))
        return length, LINE_SEARCH_LIMIT


MOMENTUM_SHARE = 1e-4
"""Weight of the energy of motion among the forces that tolerances refer to."""
LINE_SEARCH_LIMIT = 40
"""Evaluations along a line at most."""
LINE_TOLERANCE = 1e-9
"""The line's minimum is found where the slope has fallen to this share of its start."""
