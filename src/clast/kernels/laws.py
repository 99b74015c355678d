"""Contact laws, contact by contact."""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel
from clast.kernels.shares import MANY, PART, parts


@kernel()
def _penalty(first, last, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works):
    """Let contacts ``first`` to ``last`` - 1 answer."""
    normal_stiffness, shear_stiffness = springs
    friction, cohesion, tensile_strength, length = joints
    bonded, shear_force, multiplier, friction_base = memory
    n_force, t_force = forces
    kn, ks, coupling = stiffnesses
    mode, intact = ends
    energy, loss = works
    for c in range(first, last):
        n_force[c] = t_force[c] = kn[c] = ks[c] = coupling[c] = energy[c] = loss[c] = 0.0
        mode[c], intact[c] = 0, bonded[c]
        trial_normal = multiplier[c] - normal_stiffness * gap[c]
        tension = tensile_strength[c] * length[c]
        # in a minimisation (bound given) a contact that just touches counts with its stiffness:
        # at the kink either is a derivative, and it is about to close
        given = not np.isnan(friction_base[c])
        if trial_normal > -tension or (given and trial_normal == -tension):
            n_force[c], kn[c] = trial_normal, normal_stiffness
        else:
            n_force[c] = -tension  # the cut-off; the bond is lost when the step is over
            intact[c] = bonded[c] and tension == 0.0
            if tension == 0.0 and not given:
                continue
        energy[c] = 0.5 * (n_force[c] - multiplier[c]) ** 2 / normal_stiffness
        base = friction_base[c] if given else n_force[c]
        strength = cohesion[c] * length[c]
        bound = max(0.0, base * friction[c] + strength)
        trial = shear_force[c] - shear_stiffness * slip[c]
        if bound == 0.0 and trial == 0.0:
            mode[c] = 1  # no strength: there is nothing to stick to, even at rest
        elif abs(trial) <= bound:
            t_force[c], ks[c], mode[c] = trial, shear_stiffness, 2
        else:
            intact[c] = intact[c] and strength == 0.0 and tension == 0.0
            sign = 1.0 if trial > 0.0 else -1.0
            t_force[c], mode[c] = sign * bound, 1
            if bound > 0.0 and np.isnan(friction_base[c]):
                coupling[c] = sign * friction[c]
            # the part of the slip that the spring did not take up
            loss[c] = bound * (abs(trial) - bound) / shear_stiffness
        energy[c] += 0.5 * t_force[c] ** 2 / shear_stiffness
        if n_force[c] == 0.0 and tension == 0.0:
            mode[c] = 0


@kernel(parallel=True)
def _penalty_shared(gap, slip, springs, joints, memory, forces, stiffnesses, ends, works):
    for part in prange(parts(len(gap))):
        first, last = part * PART, min((part + 1) * PART, len(gap))
        _penalty(first, last, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works)


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
        _penalty(0, count, gap, slip, springs, joints, memory, forces, stiffnesses, ends, works)
    return *forces, *stiffnesses, *ends, *works
