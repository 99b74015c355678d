"""Contact laws, contact by contact."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def penalty(
    gap,
    slip,
    normal_stiffness,
    shear_stiffness,
    friction,
    cohesion,
    tensile_strength,
    length,
    bonded,
    shear_force,
):
    """Return N, T, -dN/dgap, -dT/dslip, dT/dN, mode, bond, energy, loss (see laws.Penalty)."""
    count = len(gap)
    n_force, t_force = np.zeros(count), np.zeros(count)
    kn, ks, coupling = np.zeros(count), np.zeros(count), np.zeros(count)
    mode = np.zeros(count, np.int64)
    intact = bonded.copy()
    energy, loss = np.zeros(count), np.zeros(count)
    for c in range(count):
        elastic = -normal_stiffness * gap[c]
        tension = tensile_strength[c] * length[c]
        if elastic <= 0.0 and elastic <= -tension:
            if tension > 0.0:
                intact[c] = False
            continue
        n_force[c], kn[c] = elastic, normal_stiffness
        strength = cohesion[c] * length[c]
        bound = max(0.0, elastic * friction[c] + strength)
        trial = shear_force[c] - shear_stiffness * slip[c]
        if abs(trial) <= bound:
            t_force[c], ks[c], mode[c] = trial, shear_stiffness, 2
            energy[c] = 0.5 * (elastic**2 / normal_stiffness + trial**2 / shear_stiffness)
            continue
        if strength > 0.0 or tension > 0.0:  # the bond is lost: residual friction alone
            intact[c] = False
            if elastic <= 0.0:
                n_force[c], kn[c] = 0.0, 0.0
                continue
            bound = elastic * friction[c]
        sign = 1.0 if trial > 0.0 else -1.0
        t_force[c], coupling[c], mode[c] = sign * bound, sign * friction[c], 1
        energy[c] = 0.5 * (elastic**2 / normal_stiffness + bound**2 / shear_stiffness)
        # the part of the slip that the spring did not take up
        loss[c] = bound * (abs(trial) - bound) / shear_stiffness
    return n_force, t_force, kn, ks, coupling, mode, intact, energy, loss
