"""Impulses in contacts that strike together: normal ones that only push, shear within friction.

Contact c of blocks i and j has ``rows`` (2, 6), by which the velocities (u, v, r) of these move it
along its normal and its edge, ``effects`` (2, 6), how they are changed by a unit impulse along
these, ``still`` (2,), what it moves by beside that, m/s, and ``ease`` (2,), what a unit impulse
changes along itself.  The four together are ``linear``.

Impulse by impulse is renewed from what it has to come to (Gauss-Seidel).  That tells soon which
contacts part, stick and slide, but is slow where impulses run along rows of blocks: then those that
are left are solved for together, and the next renewal shows whether that was right.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel

ROUNDS = 3
"""Renewals of all impulses before they are solved for together."""
MANY = 96
"""Impulses up to which they are."""
BOUNDS = 8
"""Impulses at most that come to their bound before all are renewed again."""
SINGULAR = 1e-10
"""What is added to the diagonal, as a share of it: more contacts may bear a block than need to."""


@kernel(forceinline=True)
def rate_along(c, k, i, j, rows, still, velocity):
    """Return how fast contact c of blocks i and j opens (k = 0) or slips (k = 1), m/s."""
    rate = still[c, k]
    for a in range(3):
        rate += rows[c, k, a] * velocity[i, a] + rows[c, k, 3 + a] * velocity[j, a]
    return rate


@kernel(forceinline=True)
def _change(c, k, i, j, wanted, impulses, effects, velocity):
    """Let the impulse of contact c along k be as wanted: blocks i and j move, and do not strain."""
    change = wanted - impulses[c, k]
    impulses[c, k] = wanted
    for a in range(3):
        velocity[i, a] += change * effects[c, k, a]
        velocity[j, a] += change * effects[c, k, 3 + a]
    return abs(change)


@kernel()
def _renew(listed, target, linear, impulses, velocity, contacts):
    """Renew the impulses of the contacts listed; return how much that changes a velocity, m/s."""
    rows, effects, still, ease = linear
    _, vertex_block, edge_block, _, _, friction = contacts
    changed = 0.0
    for c in listed:
        i, j = vertex_block[c], edge_block[c]
        if ease[c, 0] == 0.0:
            continue
        rate = rate_along(c, 0, i, j, rows, still, velocity)
        normal = max(0.0, impulses[c, 0] + (target[c] - rate) / ease[c, 0])
        change = _change(c, 0, i, j, normal, impulses, effects, velocity)
        changed, bound = max(changed, change * ease[c, 0]), friction[c] * normal
        if bound > 0.0 or impulses[c, 1] != 0.0:
            rate = rate_along(c, 1, i, j, rows, still, velocity)
            shear = min(max(impulses[c, 1] - rate / ease[c, 1], -bound), bound)
            change = _change(c, 1, i, j, shear, impulses, effects, velocity)
            changed = max(changed, change * ease[c, 1])
    return changed


@kernel()
def _choose(listed, impulses, friction, unknowns):
    """List contact and direction of the impulses that are no bound; return their number.

    With a normal one goes the shear impulse of a contact that slides, as a share of it.
    """
    contact, along, slide = unknowns
    count = 0
    for c in listed:
        if impulses[c, 0] > 0.0 and count + 2 <= len(contact):
            bound = friction[c] * impulses[c, 0]
            sticks = abs(impulses[c, 1]) < bound
            contact[count], along[count] = c, 0
            slide[count] = 0.0 if sticks else impulses[c, 1] / impulses[c, 0]
            count += 1
            if sticks:
                contact[count], along[count], slide[count] = c, 1, 0.0
                count += 1
    return count


@kernel()
def _couple(count, unknowns, linear, contacts, matrix):
    """Write what each of the unknown impulses changes along each other."""
    rows, effects, _, _ = linear
    _, vertex_block, edge_block, _, _, _ = contacts
    contact, along, slide = unknowns
    for b in range(count):
        c, k = contact[b], along[b]
        ends = vertex_block[c], edge_block[c]
        for a in range(count):
            other, value = contact[a], 0.0
            for side in range(2):
                for own in range(2):
                    block = vertex_block[other] if own == 0 else edge_block[other]
                    if ends[side] == block:
                        for x in range(3):
                            effect = effects[c, k, 3 * side + x]
                            effect += slide[b] * effects[c, 1, 3 * side + x]
                            value += rows[other, along[a], 3 * own + x] * effect
            matrix[a, b] = value
        matrix[b, b] *= 1.0 + SINGULAR


@kernel(error_model="numpy")
def _eliminate(count, matrix, values):
    """Solve a system in place (Gauss, with pivots from the column)."""
    for p in range(count):
        best = p
        for a in range(p + 1, count):
            if abs(matrix[a, p]) > abs(matrix[best, p]):
                best = a
        if best != p:
            for b in range(p, count):
                matrix[p, b], matrix[best, b] = matrix[best, b], matrix[p, b]
            values[p], values[best] = values[best], values[p]
        for a in range(p + 1, count):
            factor = matrix[a, p] / matrix[p, p]
            if factor != 0.0:
                for b in range(p + 1, count):
                    matrix[a, b] -= factor * matrix[p, b]
                values[a] -= factor * values[p]
    for p in range(count - 1, -1, -1):
        for b in range(p + 1, count):
            values[p] -= matrix[p, b] * values[b]
        values[p] /= matrix[p, p]


@kernel(error_model="numpy")
def _share(count, unknowns, change, impulses, friction):
    """Return how much of a change impulses allow, and which of them allows no more, or -1.

    They push, and shear is within friction.
    """
    contact, along, _ = unknowns
    share, least, rise = 1.0, -1, 0.0
    for a in range(count):
        c, d = contact[a], change[a]
        if along[a] == 0:
            allowed = -impulses[c, 0] / d if d < 0.0 else np.inf
            rise = friction[c] * d
        else:
            # the normal impulse of the same contact comes just before
            bound, shear = friction[c] * impulses[c, 0], impulses[c, 1]
            above = (bound - shear) / (d - rise) if d > rise else np.inf
            below = (bound + shear) / (-d - rise) if -d > rise else np.inf
            allowed = min(above, below)
        if allowed < share:
            share, least = allowed, a
    return share, least


@kernel()
def _go(share, least, count, unknowns, change, impulses, velocity, effects, contacts):
    """Change impulses by a share; the one that allows no more is then at its bound."""
    _, vertex_block, edge_block, _, _, friction = contacts
    contact, along, slide = unknowns
    for a in range(count):
        c, k = contact[a], along[a]
        i, j, wanted = vertex_block[c], edge_block[c], impulses[c, k] + share * change[a]
        if a == least:
            wanted = np.copysign(friction[c] * impulses[c, 0], wanted) if k == 1 else 0.0
        _change(c, k, i, j, wanted, impulses, effects, velocity)
        if slide[a] != 0.0:
            _change(c, 1, i, j, slide[a] * wanted, impulses, effects, velocity)


@kernel()
def _solve(listed, target, linear, impulses, velocity, contacts):
    """Solve for all impulses together that are no bound, as far as these then stay so."""
    rows, effects, still, _ = linear
    _, vertex_block, edge_block, _, _, friction = contacts
    most = min(MANY, 2 * len(listed))
    unknowns = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most)
    contact, along, _ = unknowns
    for _ in range(BOUNDS):
        count = _choose(listed, impulses, friction, unknowns)
        matrix, change = np.empty((count, count)), np.empty(count)
        for a in range(count):
            c, k = contact[a], along[a]
            rate = rate_along(c, k, vertex_block[c], edge_block[c], rows, still, velocity)
            change[a] = (target[c] if k == 0 else 0.0) - rate
        _couple(count, unknowns, linear, contacts, matrix)
        _eliminate(count, matrix, change)
        share, least = _share(count, unknowns, change, impulses, friction)
        if not share >= 0.0:
            return
        _go(share, least, count, unknowns, change, impulses, velocity, effects, contacts)
        if least < 0:
            return


@kernel()
def find(enough, most, listed, target, linear, impulses, velocity, contacts):
    """Find the impulses of the contacts listed (k,); return how many renewals that took.

    Until velocities change by less than ``enough``, m/s, or ``most`` renewals.  Contacts are to
    open with ``target`` (m,), m/s, at least and not to slip.  ``impulses`` (m, 2), N s/m, and the
    velocities of the blocks (n, 6) are written in place.
    """
    renewals = 0
    while renewals < most:
        for _ in range(ROUNDS):
            changed = _renew(listed, target, linear, impulses, velocity, contacts)
            renewals += 1
            if changed <= enough:
                return renewals
        if len(listed) > 1:
            _solve(listed, target, linear, impulses, velocity, contacts)
    return renewals
