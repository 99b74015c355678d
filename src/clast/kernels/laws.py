"""Contact laws, contact by contact."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
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
    multiplier,
    friction_base,
):
    """Return N, T, -dN/dgap, -dT/dslip, dT/dN, mode, bond, energy, loss (see contact.laws)."""
    count = len(gap)
    n_force, t_force = np.zeros(count), np.zeros(count)
    kn, ks, coupling = np.zeros(count), np.zeros(count), np.zeros(count)
    mode = np.zeros(count, np.int64)
    intact = bonded.copy()
    energy, loss = np.zeros(count), np.zeros(count)
    for c in range(count):
        trial_normal = multiplier[c] - normal_stiffness * gap[c]
        tension = tensile_strength[c] * length[c]
        # in a minimisation (bound given) a contact that just touches counts with its stiffness:
        # at the kink either is a derivative, and it is about to close
        given = not np.isnan(friction_base[c])
        if trial_normal > -tension or (given and trial_normal == -tension):
            n_force[c], kn[c] = trial_normal, normal_stiffness
        else:
            n_force[c] = -tension  # the cut-off; the bond is lost when the step is over
            intact[c] = intact[c] and tension == 0.0
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
    return n_force, t_force, kn, ks, coupling, mode, intact, energy, loss
