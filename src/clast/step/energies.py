"""Works and energies of a step, summed up chunk by chunk (step/energy_balance.py).

Sums of many numbers keep their digits where parts of them are summed up first.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, PART, chunks, parts
from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus_product, row, total, zeros


@kernel()
def _kinetic(b, mass_matrix, v):
    """Return 1/2 v.M v of block b, J/m."""
    return 0.5 * total(plus_product(zeros(), times(mass_matrix, b, v, b), row(v, b)))


@kernel()
def _strain_energy(b, area, compliance, stress):
    """Return 1/2 A sigma.E'^-1 sigma of block b, J/m."""
    energy = 0.0
    for i in range(3):
        for j in range(3):
            energy += stress[b, i] * compliance[b, i, j] * stress[b, j]
    return 0.5 * area[b] * energy


@kernel()
def _of_chunk(first, last, motion, inertia, stresses, elastic, mass, accelerations, s):
    """Add up the energies and works of blocks ``first`` to ``last`` - 1 in s (8,)."""
    d, entering, leaving = motion
    mass_matrix, step = inertia
    before, after = stresses
    area, compliance = elastic
    gravity, inertial = accelerations
    force = np.empty((1, 6))
    for b in range(first, last):
        s[0] += _kinetic(b, mass_matrix, entering)
        s[1] += _kinetic(b, mass_matrix, leaving)
        for k in range(6):
            force[0, k] = (leaving[b, k] - entering[b, k]) / step
        s[2] += total(plus_product(zeros(), times(mass_matrix, b, force, 0), row(d, b)))
        s[3] += _strain_energy(b, area, compliance, before)
        s[4] += _strain_energy(b, area, compliance, after)
        for k in range(3):
            s[5] -= area[b] * after[b, k] * d[b, 3 + k]
        s[6] += mass[b] * (gravity[0] * d[b, 0] + gravity[1] * d[b, 1])
        s[7] += mass[b] * (inertial[0] * d[b, 0] + inertial[1] * d[b, 1])


@kernel(parallel=True)
def _of_chunks(motion, inertia, stresses, elastic, mass, accelerations, sums):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(sums)):
            last = min((c + 1) * CHUNK, len(mass))
            _of_chunk(
                c * CHUNK, last, motion, inertia, stresses, elastic, mass, accelerations, sums[c]
            )


@kernel()
def of_blocks(motion, inertia, stresses, elastic, weights):
    """Return energies and works of the blocks in a step, J/m, shape (8,).

    Kinetic energy that entered and that left, work on inertia; elastic energy before and after,
    work on the elastic terms; work of gravity, work of the inertial force.

    ``motion``: d and the velocities that entered and left, (n, 6) each.  ``inertia``: mass matrix
    (n, 6, 6) and h.  ``stresses``: before and after the step, unturned, Pa, (n, 3) each.
    ``elastic``: area (n,) and compliance (n, 3, 3).  ``weights``: mass (n,), gravity and the
    acceleration of the inertial force, m/s2, (2,) each.
    """
    mass, gravity, inertial = weights
    sums = np.zeros((chunks(len(mass)), 8))
    _of_chunks(motion, inertia, stresses, elastic, mass, (gravity, inertial), sums)
    result = np.zeros(8)
    for part in sums:
        result += part
    return result


@kernel()
def of_contacts(forces, gaps, slip, stored):
    """Return the work of contact forces, J/m, and the sums of what is ``stored``, shape (3,).

    ``forces``: normal and shear, N/m; ``gaps``: at the start and the end, m; ``slip``, m;
    ``stored``: energy and dissipation, J/m; (m,) each.
    """
    normal, shear = forces
    start, end = gaps
    energy, dissipation = stored
    sums = np.zeros((parts(len(slip)), 3))
    for c in range(len(slip)):
        s = sums[c // PART]
        s[0] += normal[c] * (end[c] - start[c]) + shear[c] * slip[c]
        s[1] += energy[c]
        s[2] += dissipation[c]
    result = np.zeros(3)
    for part in sums:
        result += part
    return result
