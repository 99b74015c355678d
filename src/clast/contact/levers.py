"""What a contact does in the equations: how two blocks move it, and how it acts on them.

Vertex P of block i moves by u_i = T_i d_i, the point Q of block j that it touches by u_j; the
contact opens by n.(u_i - u_j) and slips by t.(u_i - u_j), t = (-ny, nx).  Forces act by T^T, and
springs stiffen by T^T (k_n n n^T + k_s t t^T) T.

With Shi's first-order displacements T follows from the offset (x, y) of the point from the centroid
of its block.  A contact then is six numbers, its ``levers`` (nx, ny, x_i, y_i, x_j, y_j), and
contacts (m, 6).  Other displacement functions bring the rows T_i^T n, -T_j^T n, T_i^T t, -T_j^T t,
contacts (m, 4, 6).  Kernels are compiled for what they are given.
"""

from __future__ import annotations

from clast.compute.jit import overload, types
from clast.compute.mat6 import lines, put_lines
from clast.compute.vec6 import (
    line,
    numbers,
    plus,
    plus_product,
    plus_scaled,
    put_line,
    row,
    six,
    total,
    zeros,
)

ROWS = 3
"""Dimensions of levers that are rows."""


def relative_motion(levers, c, d, i, j):
    """Return n.d and t.d of contact c of vertex block i and edge block j, m, for d (n, 6)."""


def force_on(levers, c, of_vertex, normal, shear):
    """Return N n + T t, six numbers, for the vertex's block or the edge's."""


def normal_of(levers, c):
    """Return nx and ny of contact c."""


def gather_own(levers, i, first, last, vertex_block, kn, ks, moments, own):
    """Take up what contacts ``first`` to ``last`` - 1 stiffen block i, before ``finish_own``."""


def finish_own(levers, moments, own, i):
    """Add to block i of ``own`` what has been taken up in ``moments`` (1, 3, 6)."""


def couple(levers, i, q, first, last, vertex_block, kn, ks, upper):
    """Add to block q of ``upper`` how contacts ``first`` to ``last`` - 1 couple i to the other."""


def _is_array(levers):
    return isinstance(levers, types.Array)


@overload(relative_motion)
def _relative_motion(levers, c, d, i, j):
    def by_offsets(levers, c, d, i, j):
        nx, ny, x_i, y_i, x_j, y_j = numbers(row(levers, c))
        u0, v0, r0, ex, ey, gxy = numbers(row(d, i))
        u = u0 - y_i * r0 + x_i * ex + 0.5 * y_i * gxy
        v = v0 + x_i * r0 + y_i * ey + 0.5 * x_i * gxy
        u0, v0, r0, ex, ey, gxy = numbers(row(d, j))
        u -= u0 - y_j * r0 + x_j * ex + 0.5 * y_j * gxy
        v -= v0 + x_j * r0 + y_j * ey + 0.5 * x_j * gxy
        return nx * u + ny * v, nx * v - ny * u

    def by_rows(levers, c, d, i, j):
        own, other = row(d, i), row(d, j)
        n = plus_product(plus_product(zeros(), line(levers, c, 0), own), line(levers, c, 1), other)
        t = plus_product(plus_product(zeros(), line(levers, c, 2), own), line(levers, c, 3), other)
        return total(n), total(t)

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None


@overload(force_on)
def _force_on(levers, c, of_vertex, normal, shear):
    def by_offsets(levers, c, of_vertex, normal, shear):
        nx, ny = levers[c, 0], levers[c, 1]
        fx, fy = normal * nx - shear * ny, normal * ny + shear * nx
        if of_vertex:
            x, y = levers[c, 2], levers[c, 3]
        else:
            fx, fy = -fx, -fy
            x, y = levers[c, 4], levers[c, 5]
        return six(fx, fy, x * fy - y * fx, x * fx, y * fy, 0.5 * (y * fx + x * fy))

    def by_rows(levers, c, of_vertex, normal, shear):
        side = 0 if of_vertex else 1
        n, t = line(levers, c, side), line(levers, c, 2 + side)
        return plus_scaled(plus_scaled(zeros(), normal, n), shear, t)

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None


@overload(normal_of)
def _normal_of(levers, c):
    def by_offsets(levers, c):
        return levers[c, 0], levers[c, 1]

    def by_rows(levers, c):
        return levers[c, 0, 0], levers[c, 0, 1]

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None


@overload(gather_own)
def _gather_own(levers, i, first, last, vertex_block, kn, ks, moments, own):
    def by_offsets(levers, i, first, last, vertex_block, kn, ks, moments, own):
        """Sums of the stiffnesses xx, xy, yy times 1, x, y, x2, xy, y2."""
        xx, xy, yy = line(moments, 0, 0), line(moments, 0, 1), line(moments, 0, 2)
        for c in range(first, last):
            nx, ny = levers[c, 0], levers[c, 1]
            at = 2 if vertex_block[c] == i else 4
            x, y = levers[c, at], levers[c, at + 1]
            powers = six(1.0, x, y, x * x, x * y, y * y)
            xx = plus_scaled(xx, kn[c] * nx * nx + ks[c] * ny * ny, powers)
            xy = plus_scaled(xy, (kn[c] - ks[c]) * nx * ny, powers)
            yy = plus_scaled(yy, kn[c] * ny * ny + ks[c] * nx * nx, powers)
        put_line(moments, 0, 0, xx)
        put_line(moments, 0, 1, xy)
        put_line(moments, 0, 2, yy)

    def by_rows(levers, i, first, last, vertex_block, kn, ks, moments, own):
        for c in range(first, last):
            side = 0 if vertex_block[c] == i else 1
            n, t = line(levers, c, side), line(levers, c, 2 + side)
            for a in range(6):
                s = plus_scaled(line(own, i, a), kn[c] * levers[c, side, a], n)
                put_line(own, i, a, plus_scaled(s, ks[c] * levers[c, 2 + side, a], t))

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None


@overload(finish_own)
def _finish_own(levers, moments, own, i):
    def by_offsets(levers, moments, own, i):
        """T^T C T with T_x = (1, 0, -y, x, 0, y/2) and T_y = (0, 1, x, 0, y, x/2)."""
        a1, ax, ay = moments[0, 0, 0], moments[0, 0, 1], moments[0, 0, 2]
        axx, axy, ayy = moments[0, 0, 3], moments[0, 0, 4], moments[0, 0, 5]
        b1, bx, by = moments[0, 1, 0], moments[0, 1, 1], moments[0, 1, 2]
        bxx, bxy, byy = moments[0, 1, 3], moments[0, 1, 4], moments[0, 1, 5]
        c1, cx, cy = moments[0, 2, 0], moments[0, 2, 1], moments[0, 2, 2]
        cxx, cxy, cyy = moments[0, 2, 3], moments[0, 2, 4], moments[0, 2, 5]
        ur, us, vr, vs = bx - ay, 0.5 * (ay + bx), cx - by, 0.5 * (by + cx)
        re, rf, rs = bxx - axy, cxy - byy, 0.5 * (cxx - ayy)
        es, fs = 0.5 * (axy + bxx), 0.5 * (byy + cxy)
        rr, ss = ayy - 2.0 * bxy + cxx, 0.25 * (ayy + 2.0 * bxy + cxx)
        put_line(own, i, 0, plus(line(own, i, 0), six(a1, b1, ur, ax, by, us)))
        put_line(own, i, 1, plus(line(own, i, 1), six(b1, c1, vr, bx, cy, vs)))
        put_line(own, i, 2, plus(line(own, i, 2), six(ur, vr, rr, re, rf, rs)))
        put_line(own, i, 3, plus(line(own, i, 3), six(ax, bx, re, axx, bxy, es)))
        put_line(own, i, 4, plus(line(own, i, 4), six(by, cy, rf, bxy, cyy, fs)))
        put_line(own, i, 5, plus(line(own, i, 5), six(us, vs, rs, es, fs, ss)))

    def by_rows(levers, moments, own, i):
        pass

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None


@overload(couple)
def _couple(levers, i, q, first, last, vertex_block, kn, ks, upper):
    def by_offsets(levers, i, q, first, last, vertex_block, kn, ks, upper):
        """-T_i^T C T_j, line by line, from the two lines of C T_j."""
        k0, k1, k2, k3, k4, k5 = lines(upper, q)
        for c in range(first, last):
            nx, ny = levers[c, 0], levers[c, 1]
            cxx, cyy = kn[c] * nx * nx + ks[c] * ny * ny, kn[c] * ny * ny + ks[c] * nx * nx
            cxy = (kn[c] - ks[c]) * nx * ny
            own, other = (2, 4) if vertex_block[c] == i else (4, 2)
            x, y = levers[c, other], levers[c, other + 1]
            u = six(cxx, cxy, x * cxy - y * cxx, x * cxx, y * cxy, 0.5 * (y * cxx + x * cxy))
            v = six(cxy, cyy, x * cyy - y * cxy, x * cxy, y * cyy, 0.5 * (y * cxy + x * cyy))
            x, y = levers[c, own], levers[c, own + 1]
            k0, k1 = plus_scaled(k0, -1.0, u), plus_scaled(k1, -1.0, v)
            k2 = plus_scaled(plus_scaled(k2, y, u), -x, v)
            k3, k4 = plus_scaled(k3, -x, u), plus_scaled(k4, -y, v)
            k5 = plus_scaled(plus_scaled(k5, -0.5 * y, u), -0.5 * x, v)
        put_lines(upper, q, k0, k1, k2, k3, k4, k5)

    def by_rows(levers, i, q, first, last, vertex_block, kn, ks, upper):
        for c in range(first, last):
            own, other = (0, 1) if vertex_block[c] == i else (1, 0)
            n, t = line(levers, c, other), line(levers, c, 2 + other)
            for a in range(6):
                s = plus_scaled(line(upper, q, a), kn[c] * levers[c, own, a], n)
                put_line(upper, q, a, plus_scaled(s, ks[c] * levers[c, 2 + own, a], t))

    if _is_array(levers):
        return by_rows if levers.ndim == ROWS else by_offsets
    return None
