"""Contact laws: forces between a vertex and its entrance edge."""

from __future__ import annotations

from dataclasses import dataclass

from clast.contact.arrays import ContactResponse, Contacts
from clast.kernels import laws as kernel
from clast.model import Floats


@dataclass(frozen=True)
class Penalty:
    """Linear springs with Coulomb friction, cohesion and tension cut-off.

    N = max(0, -p d_n); the shear force follows its spring from the remembered one and is returned
    to |T| <= N tan(phi) + c L.  A bonded contact bears tension up to sigma_t L.  A step in which it
    slips or reaches that tension is its last as a bonded one: from then on N tan(phi) remains.
    """

    normal_stiffness: float = 1e9
    """p, N/m per m."""
    shear_stiffness: float | None = None
    """Stiffness of the shear spring, N/m per m; equal to ``normal_stiffness`` if not given."""

    def respond(self, contacts: Contacts, gap: Floats, slip: Floats) -> ContactResponse:
        """Return forces and stiffnesses for gaps (m,) and slips (m,) at the end of the step, m."""
        shear_stiffness = self.shear_stiffness
        normal, shear, kn, ks, coupling, mode, bonded, energy, loss = kernel.penalty(
            gap,
            slip,
            self.normal_stiffness,
            self.normal_stiffness if shear_stiffness is None else shear_stiffness,
            contacts.friction,
            contacts.cohesion,
            contacts.tensile_strength,
            contacts.length,
            contacts.bonded,
            contacts.shear_force,
            contacts.multiplier,
            contacts.friction_base,
        )
        return ContactResponse(
            normal_force=normal,
            shear_force=shear,
            normal_stiffness=kn,
            shear_stiffness=ks,
            coupling=coupling,
            mode=mode,
            bonded=bonded,
            energy=energy,
            dissipation=loss,
        )
