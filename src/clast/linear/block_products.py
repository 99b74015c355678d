"""Products of 6 x 6 blocks, as eliminations need them."""

from __future__ import annotations

from clast.compute.jit import kernel
from clast.compute.mat6 import lines
from clast.compute.vec6 import line, plus, plus_scaled, put_line, zeros


@kernel(forceinline=True)
def subtract_product(left, q, right, f, target, t):
    """Subtract left_q^T right_f from block t of ``target``, in place."""
    r0, r1, r2, r3, r4, r5 = lines(right, f)
    for a in range(6):
        s0 = plus_scaled(line(target, t, a), -left[q, 0, a], r0)
        s1 = plus_scaled(zeros(), -left[q, 1, a], r1)
        s0 = plus_scaled(s0, -left[q, 2, a], r2)
        s1 = plus_scaled(s1, -left[q, 3, a], r3)
        s0 = plus_scaled(s0, -left[q, 4, a], r4)
        s1 = plus_scaled(s1, -left[q, 5, a], r5)
        put_line(target, t, a, plus(s0, s1))


@kernel(forceinline=True)
def multiply_into(inverse, i, upper, q, product, p):
    """Write inverse_i upper_q into block p of ``product``."""
    r0, r1, r2, r3, r4, r5 = lines(upper, q)
    for a in range(6):
        s0 = plus_scaled(zeros(), inverse[i, a, 0], r0)
        s1 = plus_scaled(zeros(), inverse[i, a, 1], r1)
        s0 = plus_scaled(s0, inverse[i, a, 2], r2)
        s1 = plus_scaled(s1, inverse[i, a, 3], r3)
        s0 = plus_scaled(s0, inverse[i, a, 4], r4)
        s1 = plus_scaled(s1, inverse[i, a, 5], r5)
        put_line(product, p, a, plus(s0, s1))
