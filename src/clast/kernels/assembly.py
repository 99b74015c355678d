"""Contact contributions to the block system, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def add_contacts(
    diagonal,
    upper,
    lower,
    force,
    pair,
    vertex_block,
    edge_block,
    normal_vertex,
    normal_edge,
    tangent_vertex,
    tangent_edge,
    normal_stiffness,
    shear_stiffness,
    coupling,
    normal_load,
    shear_load,
):
    """Add contact springs and forces to K and F in place.

    With rows n = (n_i, n_j) and t = (t_i, t_j) of a contact, K gets
    k_n n n^T + k_s t t^T - c k_n ... (friction solved inside the step): the normal force is
    N = N0 - k_n n.d, the shear force T = T0 - k_s t.d + c (N - N0), and F gets N0 n + T0 t.
    ``upper`` holds K_ij of each pair (lower index first), ``lower`` K_ji.
    """
    n = np.empty((2, 6))
    t = np.empty((2, 6))
    for c in range(len(pair)):
        i, j, q = vertex_block[c], edge_block[c], pair[c]
        first = 0 if i < j else 1
        for k in range(6):
            n[first, k], n[1 - first, k] = normal_vertex[c, k], normal_edge[c, k]
            t[first, k], t[1 - first, k] = tangent_vertex[c, k], tangent_edge[c, k]
        low, high = min(i, j), max(i, j)
        kn, ks, cross = normal_stiffness[c], shear_stiffness[c], coupling[c]
        for a in range(6):
            force[low, a] += normal_load[c] * n[0, a] + shear_load[c] * t[0, a]
            force[high, a] += normal_load[c] * n[1, a] + shear_load[c] * t[1, a]
            left0 = kn * (n[0, a] + cross * t[0, a])
            left1 = kn * (n[1, a] + cross * t[1, a])
            for b in range(6):
                diagonal[low, a, b] += left0 * n[0, b] + ks * t[0, a] * t[0, b]
                diagonal[high, a, b] += left1 * n[1, b] + ks * t[1, a] * t[1, b]
                value = left0 * n[1, b] + ks * t[0, a] * t[1, b]
                upper[q, a, b] += value
                if cross == 0.0:  # the same to the last bit, so that K is symmetric
                    lower[q, b, a] += value
                else:
                    lower[q, b, a] += kn * (n[1, b] + cross * t[1, b]) * n[0, a]
                    lower[q, b, a] += ks * t[1, b] * t[0, a]


@kernel()
def add_springs(
    diagonal,
    upper,
    pair,
    vertex_block,
    edge_block,
    normal_vertex,
    normal_edge,
    tangent_vertex,
    tangent_edge,
    normal_stiffness,
    shear_stiffness,
):
    """Add k_n n n^T + k_s t t^T of every contact to a symmetric K in place; ``upper`` is K_ij."""
    for c in range(len(pair)):
        kn, ks = normal_stiffness[c], shear_stiffness[c]
        if kn == 0.0 and ks == 0.0:
            continue
        i, j, q = vertex_block[c], edge_block[c], pair[c]
        for a in range(6):
            n_i, t_i = kn * normal_vertex[c, a], ks * tangent_vertex[c, a]
            n_j, t_j = kn * normal_edge[c, a], ks * tangent_edge[c, a]
            for b in range(6):
                diagonal[i, a, b] += n_i * normal_vertex[c, b] + t_i * tangent_vertex[c, b]
                diagonal[j, a, b] += n_j * normal_edge[c, b] + t_j * tangent_edge[c, b]
            if i < j:
                for b in range(6):
                    upper[q, a, b] += n_i * normal_edge[c, b] + t_i * tangent_edge[c, b]
            else:
                for b in range(6):
                    upper[q, a, b] += n_j * normal_vertex[c, b] + t_j * tangent_vertex[c, b]


@kernel()
def hold_blocks(diagonal, upper, lower, force, pairs, fixed):
    """Remove the degrees of freedom of fixed blocks: their equations become d = 0, in place."""
    for b in range(len(fixed)):
        if fixed[b]:
            scale = 0.0
            for a in range(6):
                scale = max(scale, diagonal[b, a, a])
            for a in range(6):
                force[b, a] = 0.0
                for c in range(6):
                    diagonal[b, a, c] = 0.0
                diagonal[b, a, a] = scale
    for q in range(len(pairs)):
        if fixed[pairs[q, 0]] or fixed[pairs[q, 1]]:
            for a in range(6):
                for c in range(6):
                    upper[q, a, c] = 0.0
                    lower[q, a, c] = 0.0


@kernel()
def contact_motion(vertex_block, edge_block, row_vertex, row_edge, displacement):
    """Return row_i . d_i + row_j . d_j of every contact, m, shape (m,)."""
    result = np.empty(len(vertex_block))
    for c in range(len(vertex_block)):
        total = 0.0
        i, j = vertex_block[c], edge_block[c]
        for k in range(6):
            total += row_vertex[c, k] * displacement[i, k] + row_edge[c, k] * displacement[j, k]
        result[c] = total
    return result


@kernel()
def add_forces(
    force,
    vertex_block,
    edge_block,
    normal_vertex,
    normal_edge,
    tangent_vertex,
    tangent_edge,
    normal_force,
    shear_force,
):
    """Add N n + T t of every contact to the generalised forces (n, 6), in place."""
    for c in range(len(vertex_block)):
        i, j = vertex_block[c], edge_block[c]
        normal, shear = normal_force[c], shear_force[c]
        if normal == 0.0 and shear == 0.0:
            continue
        for k in range(6):
            force[i, k] += normal * normal_vertex[c, k] + shear * tangent_vertex[c, k]
            force[j, k] += normal * normal_edge[c, k] + shear * tangent_edge[c, k]
