"""Impulses in contacts that strike together: normal ones that only push, shear within friction.

Contact c of blocks i and j has ``rows`` (2, 6), by which the velocities (u, v, r) of these move it
along its normal and its edge, ``effects`` (2, 6), how they are changed by a unit impulse along
these, ``still`` (2,), what it moves by beside that, m/s, and ``ease`` (2,), what a unit impulse
changes along itself.  The four together are ``linear``.

Impulse by impulse is renewed from what it has to come to (projected Gauss-Seidel).  That alone is
slow where impulses run along rows of blocks, so the changes that renewals make are taken as
gradients, and impulses go on along conjugate directions (Silcowitz-Hansen, Niebuhr and Erleben
2010, "A nonsmooth nonlinear conjugate gradient method for interactive contact force problems").
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel(forceinline=True)
def rate_along(c, k, i, j, rows, still, velocity):
    """Return how fast contact c of blocks i and j opens (k = 0) or slips (k = 1), m/s."""
    rate = still[c, k]
    for a in range(3):
        rate += rows[c, k, a] * velocity[i, a] + rows[c, k, 3 + a] * velocity[j, a]
    return rate


@kernel(forceinline=True)
def _change(c, k, i, j, wanted, impulses, effects, velocity):
    """Let the impulse of contact c along k be as wanted: blocks i and j move, and do not strain.

    Return by how much it changes, N s/m.
    """
    change = wanted - impulses[c, k]
    impulses[c, k] = wanted
    for a in range(3):
        velocity[i, a] += change * effects[c, k, a]
        velocity[j, a] += change * effects[c, k, 3 + a]
    return change


@kernel()
def _renew(listed, target, linear, impulses, velocity, contacts, made):
    """Renew the impulses of the contacts listed; return how much that changes a velocity, m/s.

    And by how much all of them changed, in units of energy; ``made`` (k, 2) are the changes, N s/m.
    """
    rows, effects, still, ease = linear
    _, vertex_block, edge_block, _, _, friction = contacts
    most, size = 0.0, 0.0
    for at in range(len(listed)):
        c = listed[at]
        i, j = vertex_block[c], edge_block[c]
        made[at, 0] = made[at, 1] = 0.0
        if ease[c, 0] == 0.0:
            continue
        rate = rate_along(c, 0, i, j, rows, still, velocity)
        normal = max(0.0, impulses[c, 0] + (target[c] - rate) / ease[c, 0])
        made[at, 0] = _change(c, 0, i, j, normal, impulses, effects, velocity)
        bound = friction[c] * normal
        if bound > 0.0 or impulses[c, 1] != 0.0:
            rate = rate_along(c, 1, i, j, rows, still, velocity)
            shear = min(max(impulses[c, 1] - rate / ease[c, 1], -bound), bound)
            made[at, 1] = _change(c, 1, i, j, shear, impulses, effects, velocity)
        for k in range(2):
            speed = abs(made[at, k]) * ease[c, k]
            most, size = max(most, speed), size + speed * abs(made[at, k])
    return most, size


@kernel()
def _go_on(share, listed, impulses, effects, velocity, contacts, made, way):
    """Let impulses go on by a share of the way (k, 2) they went last, and add what was made."""
    _, vertex_block, edge_block, _, _, _ = contacts
    for at in range(len(listed)):
        c = listed[at]
        for k in range(2):
            more = share * way[at, k]
            way[at, k] = more + made[at, k]
            if more != 0.0:
                wanted = impulses[c, k] + more
                _change(c, k, vertex_block[c], edge_block[c], wanted, impulses, effects, velocity)


@kernel()
def find(enough, most, listed, target, linear, impulses, velocity, contacts):
    """Find the impulses of the contacts listed (k,); return how many renewals that took.

    Until velocities change by less than ``enough``, m/s, or ``most`` renewals.  Contacts are to
    open with ``target`` (m,), m/s, at least and not to slip.  ``impulses`` (m, 2), N s/m, and the
    velocities of the blocks (n, 6) are written in place.
    """
    effects = linear[1]
    made, way = np.empty((len(listed), 2)), np.zeros((len(listed), 2))
    before = np.inf
    for renewals in range(1, most + 1):
        changed, size = _renew(listed, target, linear, impulses, velocity, contacts, made)
        if changed <= enough or renewals == most:
            break
        share = size / before if size < before else 0.0
        _go_on(share, listed, impulses, effects, velocity, contacts, made, way)
        before = size
    return renewals
