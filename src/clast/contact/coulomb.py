"""Contact laws, contact by contact."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, in_part, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


@kernel(error_model="numpy")
def _bear(gap, p, joints, memory, normal):
    """Write N, its stiffness and energy, and whether the contact bears anything or may bear shear.

    In a minimisation (bound given) a contact that just touches counts with its stiffness: at the
    kink either is a derivative, and it is about to close.
    """
    _, _, tensile_strength, length = joints
    _, _, multiplier, friction_base = memory
    force, stiffness, energy, bears, counts = normal
    for c in range(len(gap)):
        given = not np.isnan(friction_base[c])
        trial = multiplier[c] - p * gap[c]
        tension = tensile_strength[c] * length[c]
        bearing = (trial > -tension) | (given & (trial == -tension))
        counting = bearing | given | (tension != 0.0)
        # -tension is the cut-off; the bond is lost when the step is over
        n = trial if bearing else -tension
        force[c] = n if counting else 0.0
        stiffness[c] = p if bearing else 0.0
        energy[c] = 0.5 * (n - max(0.0, multiplier[c])) ** 2 / p if counting else 0.0
        bears[c], counts[c] = bearing, counting


@kernel(error_model="numpy")
def _resist(slip, k, joints, memory, normal, shear, works):
    """Write T, its stiffness, its coupling to N, the trial force and its bound; add to the works.

    What the spring does not take up of a slip is lost.
    """
    friction, cohesion, _, length = joints
    _, shear_force, _, friction_base = memory
    force, _, _, _, counts = normal
    t_force, ks, coupling, trials, bounds_of = shear
    energy, loss = works
    for c in range(len(slip)):
        given = not np.isnan(friction_base[c])
        base = friction_base[c] if given else force[c]
        bound = max(0.0, base * friction[c] + cohesion[c] * length[c])
        bound = bound if counts[c] else 0.0
        trial = shear_force[c] - k * slip[c] if counts[c] else 0.0
        sign = 1.0 if trial > 0.0 else -1.0
        size = sign * trial
        sticks = (size <= bound) & (bound > 0.0)
        t = trial if sticks else sign * bound
        t_force[c] = t if bound > 0.0 else 0.0
        ks[c] = k if sticks else 0.0
        coupling[c] = sign * friction[c] if (size > bound) & (bound > 0.0) & (not given) else 0.0
        loss[c] = bound * (size - bound) / k if size > bound else 0.0
        energy[c] += 0.5 * t * t / k
        trials[c], bounds_of[c] = size, bound


@kernel()
def _end(joints, memory, normal, shear, ends):
    """Write the modes and which bonds are intact.

    Without any strength there is nothing to stick to, even at rest.
    """
    _, cohesion, tensile_strength, length = joints
    bonded = memory[0]
    force, _, _, bears, counts = normal
    _, _, _, trials, bounds_of = shear
    mode, intact = ends
    for c in range(len(mode)):
        tension, strength = tensile_strength[c] * length[c], cohesion[c] * length[c]
        slips = trials[c] > bounds_of[c]
        locked = (not slips) & (bounds_of[c] > 0.0)
        away = (not counts[c]) | ((force[c] == 0.0) & (tension == 0.0))
        mode[c] = 0 if away else 2 if locked else 1
        held = bears[c] | (tension == 0.0)
        intact[c] = bonded[c] & held & ((not slips) | ((strength == 0.0) & (tension == 0.0)))


@kernel()
def _of_four(four, first, last):
    """Return of four arrays (m,) what belongs to the contacts ``first`` to ``last`` - 1."""
    a, b, c, d = four
    return a[first:last], b[first:last], c[first:last], d[first:last]


@kernel()
def _penalty(first, last, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works):
    """Let contacts ``first`` to ``last`` - 1 answer."""
    joints, memory = _of_four(joints, first, last), _of_four(memory, first, last)
    n, t = in_part(forces, first, last)
    ends, works = in_part(ends, first, last), in_part(works, first, last)
    kn, ks, coupling = stiffnesses
    count = last - first
    normal = n, kn[first:last], works[0], np.empty(count, np.bool_), np.empty(count, np.bool_)
    shear = t, ks[first:last], coupling[first:last], np.empty(count), np.empty(count)
    _bear(gap[first:last], springs[0], joints, memory, normal)
    _resist(slip[first:last], springs[1], joints, memory, normal, shear, works)
    _end(joints, memory, normal, shear, ends)


@kernel(parallel=True)
def _penalty_shared(gap, slip, springs, joints, memory, forces, stiffnesses, ends, works):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(gap))):
            first, last = bounds(part, len(gap))
            _penalty(
                first, last, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works
            )


@kernel()
def penalty(gap, slip, springs, joints, memory):
    """Return N, T, -dN/dgap, -dT/dslip, dT/dN, mode, bond, energy, loss (see contact.laws).

    ``springs`` are p and k, ``joints`` friction, cohesion, tensile strength and length (m,),
    ``memory`` bonds, old shear force, multiplier and the normal force that bounds friction (m,).
    """
    count = len(gap)
    forces = np.empty(count), np.empty(count)
    stiffnesses = np.empty(count), np.empty(count), np.empty(count)
    ends = np.empty(count, np.int64), np.empty(count, np.bool_)
    works = np.empty(count), np.empty(count)
    if count >= MANY:
        _penalty_shared(gap, slip, springs, joints, memory, forces, stiffnesses, ends, works)
    else:
        for part in range(parts(count)):
            first, last = bounds(part, count)
            _penalty(
                first, last, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works
            )
    return *forces, *stiffnesses, *ends, *works


@kernel()
def _bounds(first, last, joints, base, tension, strength):
    friction, cohesion, tensile_strength, length = _of_four(joints, first, last)
    tension, strength = in_part((tension, strength), first, last)
    base = base[first:last]
    for c in range(len(base)):
        bound = base[c] * friction[c] + cohesion[c] * length[c]
        strength[c] = 0.0 if bound < 0.0 else bound  # what is no number stays none
        tension[c] = tensile_strength[c] * length[c]


@kernel(parallel=True)
def _bounds_shared(joints, base, tension, strength):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(base))):
            first, last = bounds(part, len(base))
            _bounds(first, last, joints, base, tension, strength)


@kernel()
def most(joints, base):
    """Return the tension and the shear force that contacts bear at most, N/m, (m,) each.

    ``joints`` are friction, cohesion, tensile strength and length (m,), ``base`` (m,) the normal
    forces that bound friction, N/m.
    """
    tension, strength = np.empty(len(base)), np.empty(len(base))
    if len(base) >= MANY:
        _bounds_shared(joints, base, tension, strength)
    else:
        _bounds(0, len(base), joints, base, tension, strength)
    return tension, strength


@kernel()
def coulomb(slip, k, joints, memory, force):
    """Return T, -dT/dslip, dT/dN, mode, bond, energy, loss for the normal forces of another law.

    ``force`` (m,) are these, N/m, and ``k`` the stiffness of the shear spring; ``joints`` and
    ``memory`` are those of ``penalty``, the energy is that of the shear spring alone.
    """
    count = len(slip)
    _, _, tensile_strength, length = joints
    bears, counts = np.empty(count, np.bool_), np.empty(count, np.bool_)
    for c in range(count):
        bears[c] = force[c] != 0.0
        given = not np.isnan(memory[3][c])
        counts[c] = bears[c] | given | (tensile_strength[c] * length[c] != 0.0)
    normal = force, force, force, bears, counts
    shear = np.empty(count), np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    ends = np.empty(count, np.int64), np.empty(count, np.bool_)
    works = np.zeros(count), np.empty(count)
    _resist(slip, k, joints, memory, normal, shear, works)
    _end(joints, memory, normal, shear, ends)
    return shear[0], shear[1], shear[2], *ends, *works
