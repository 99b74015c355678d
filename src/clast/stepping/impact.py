"""Impacts, and why blocks that collide are stepped differently.

The constant acceleration scheme, v+ = (2/h) d - v, reflects an impact whatever the stiffness of
the contact: with w h >> 1 the contact stops the displacement, and the velocity changes its sign.
For a block with a contact that closes faster than a small threshold the step is therefore taken
with theta = 1/(1 + e), e being the restitution: stopped (d = 0), the block leaves with
-(1 - theta)/theta v = -e v.  All other blocks, and this one in its next step, keep the scheme of
the run; momentum is exchanged exactly, because every block receives the same impulse h F.
"""

from __future__ import annotations

import numpy as np

from clast.contact.arrays import Contacts
from clast.contact.multipliers import has_multipliers
from clast.equations.system import gap_rate
from clast.interfaces import ContactLaw, Method
from clast.kernels import approach
from clast.model import Floats, Model

THRESHOLD = 1e-6
"""Closing velocity that counts as an impact, in units of g h, the speed of one step of fall."""


RESETTING = 1.0
"""The same for laws whose multipliers start anew in every step.

Their penetration at rest depends on theta: a block that changes theta is kicked by some hundredths
of g h, which must not count as an impact again.
"""


def threshold_of(law: ContactLaw) -> float:
    """Return the closing velocity that counts as an impact, in units of g h."""
    return RESETTING if has_multipliers(law) and not law.carries else THRESHOLD


def theta_by_block(
    model: Model,
    method: Method,
    contacts: Contacts,
    velocity: Floats,
    restitution: float,
    step: float,
) -> Floats:
    """Return theta of each block (n,) in a step that starts with ``velocity`` (n, 6).

    Only contacts that the step's approach would close, or that are closed, collide.
    """
    rate = gap_rate(contacts, velocity)
    threshold = threshold_of(method.contact_law) * float(np.hypot(*model.gravity)) * step
    theta = np.full(model.block_count, method.integrator.theta)
    stopped = max(method.integrator.theta, 1.0 / (1.0 + restitution))
    ends = contacts.vertex_block, contacts.edge_block
    approach.collide(contacts.gap, rate, threshold, step, ends, stopped, theta)
    return theta
