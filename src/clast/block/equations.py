"""Contributions of one block to the equations: inertia, elasticity, stress and weight."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import line, plus_scaled, put_line, put_row, row, zeros


@kernel()
def strained(stress, elasticity, unknowns):
    """Return sigma + E' e, Pa, (n, 3), for the strains e of d (n, 6); E' (n, 3, 3) in Pa."""
    result = np.empty_like(stress)
    _strain(len(stress), stress, elasticity, unknowns, result)
    return result


@shared(BLOCKS)
def _strain(low, high, stress, elasticity, unknowns, result):
    """Write the stress of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        for i in range(3):
            gained = 0.0
            for j in range(3):
                gained += elasticity[b, i, j] * unknowns[b, 3 + j]
            result[b, i] = stress[b, i] + gained


@kernel()
def strains(compliance, stress):
    """Return the strains E'^-1 sigma, (n, 3), of stresses (n, 3), Pa; E'^-1 (n, 3, 3) in 1/Pa."""
    result = np.empty_like(stress)
    _strains(len(stress), compliance, stress, result)
    return result


@shared(BLOCKS)
def _strains(low, high, compliance, stress, result):
    """Write the strains of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        for i in range(3):
            strain = 0.0
            for j in range(3):
                strain += compliance[b, i, j] * stress[b, j]
            result[b, i] = strain


@kernel()
def turned(tensor, first, angle, shear_factor):
    """Return a copy with columns ``first`` to first + 2, xx, yy and xy, turned by angles (n,), rad.

    The shear is xy times ``shear_factor``: 1 for stress, 2 for strain with engineering shear.
    """
    result = np.empty_like(tensor)
    _turn(len(tensor), tensor, first, angle, shear_factor, result)
    return result


@shared(BLOCKS)
def _turn(low, high, tensor, first, angle, shear_factor, result):
    """Write the turned tensors, R S R^T, of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        for k in range(tensor.shape[1]):
            result[b, k] = tensor[b, k]
        cosine, sine = np.cos(angle[b]), np.sin(angle[b])
        xx, yy = tensor[b, first], tensor[b, first + 1]
        xy = tensor[b, first + 2] / shear_factor
        both = 2.0 * cosine * sine * xy
        result[b, first] = cosine**2 * xx + sine**2 * yy - both
        result[b, first + 1] = sine**2 * xx + cosine**2 * yy + both
        mixed = cosine * sine * (xx - yy) + (cosine**2 - sine**2) * xy
        result[b, first + 2] = shear_factor * mixed


@kernel()
def terms(inertia, elastic, stress, mass, acceleration):
    """Return K (n, 6, 6), F and its part that is momentum, M/(theta h2) drift, (n, 6) each.

    ``inertia``: mass matrix (n, 6, 6), 1/(theta h2) in 1/s2 and the drift h v (n, 6), m;
    ``elastic``: area (n,), m2, and E' (n, 3, 3), Pa, times the share of the step after which stress
    is taken; ``stress`` (n, 3) in Pa, ``mass`` (n,) in
    kg/m, ``acceleration`` (2,) of every mass, m/s2 (Shi 1988).
    """
    matrix, drift = np.empty_like(inertia[0]), inertia[2]
    parts = matrix, np.empty_like(drift), np.empty_like(drift)
    _terms(len(mass), inertia, elastic, stress, mass, acceleration, parts)
    return parts


@shared(BLOCKS)
def _terms(first, last, inertia, elastic, stress, mass, acceleration, parts):
    """Write the terms of blocks ``first`` to ``last`` - 1."""
    mass_matrix, factor, drift = inertia
    area, elasticity = elastic
    matrix, force, momentum = parts
    for b in range(first, last):
        for a in range(6):
            put_line(matrix, b, a, plus_scaled(zeros(), factor, line(mass_matrix, b, a)))
        for i in range(3):
            for j in range(3):
                matrix[b, 3 + i, 3 + j] += area[b] * elasticity[b, i, j]
        md = times(mass_matrix, b, drift, b)
        put_row(momentum, b, plus_scaled(zeros(), factor, md))
        put_row(force, b, row(momentum, b))
        for i in range(3):  # the stress at the start of the step
            force[b, 3 + i] -= area[b] * stress[b, i]
        force[b, 0] += mass[b] * acceleration[0]
        force[b, 1] += mass[b] * acceleration[1]
