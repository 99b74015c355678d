"""Vertices against edges: candidate edges, contact lengths, tunnelling.

The signed gap of a vertex to an edge's line is (P - A) . n with n the outward normal; with
counter-clockwise polygons and edge direction t = (tx, ty), n = (ty, -tx).
"""

from __future__ import annotations

import numpy as np

from clast.block.edge_lists import FEW, edges_near, edges_within, left_to_right
from clast.block.polygon import ROUND_OFF, SMALL_ANGLE, turn_at, vertex_after, vertex_before
from clast.compute.chunks import PART, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.contact.seams import is_covered


@kernel()
def _foot_allowance(ax, ay, bx, by, nx, ny, tx, ty, beyond_end, critdis, tip_reach):
    """Return how far beyond the edge's end the foot may lie, m.

    critdis where the vertex's own edge runs back along the candidate edge within 3 degrees (face
    to face: the corners coincide, as in walls and arches); else ``tip_reach``.  Without this
    distinction a tip that passes beside a corner would be held by air.
    """
    back = -1.0 if beyond_end else 1.0
    for ux, uy in ((ax, ay), (bx, by)):
        runs_back = back * (ux * tx + uy * ty) > 0.0
        if runs_back and abs(ux * nx + uy * ny) <= SMALL_ANGLE:
            return critdis
    return tip_reach


@kernel()
def _is_behind_next(px, py, gap, e, at_end, vertices, direction, first, last):
    """Return True if the point lies behind the next edge at one end of e too.

    It is inside the corner then, so that e counts although the foot lies beyond its end: at an
    obtuse corner, and at a re-entrant one, where both feet can lie beyond their ends.
    """
    if gap >= 0.0 and turn_at(e, at_end, direction, first, last) >= 0.0:
        return False
    k = vertex_after(e, first, last) if at_end else vertex_before(e, first, last)
    nx, ny = direction[k, 1], -direction[k, 0]
    return (px - vertices[k, 0]) * nx + (py - vertices[k, 1]) * ny < 0.0


@kernel()
def _is_hidden(px, py, e, along, critdis, vertices, direction, length, first, last):
    """Return True if another edge of the block lies between the point and its foot on edge e.

    Such a point is in front of that edge, or nearer to it: between the prongs of a fork, beside
    the tip of a wedge.  Near a corner of e the choice is left to the corner rule.
    """
    share = min(max(along, 0.0), length[e])
    fx = vertices[e, 0] + share * direction[e, 0] - px
    fy = vertices[e, 1] + share * direction[e, 1] - py
    following = vertex_after(e, first, last)
    for k in range(first, last):
        if k == e:
            continue
        after = vertex_after(k, first, last)
        ax, ay = vertices[k, 0] - px, vertices[k, 1] - py
        bx, by = vertices[after, 0] - px, vertices[after, 1] - py
        if (fx * ay - fy * ax > 0.0) == (fx * by - fy * bx > 0.0):
            continue
        here = ax * by - ay * bx
        there = (ax - fx) * (by - fy) - (ay - fy) * (bx - fx)
        if (here > 0.0) == (there > 0.0):
            continue
        if k != following and after != e:
            return True
        in_front = ay * direction[k, 0] - ax * direction[k, 1]
        if in_front > critdis and 0.0 < along < length[e]:
            return True
    return False


@kernel()
def _moves_into(p, e, e_end, share, shift, nx, ny):
    """Return how far the step's motion takes vertex p towards the point at ``share`` of edge e, m.

    ``shift`` (nv, 2) is how far the velocities would carry each vertex in the step, m.
    """
    mx = shift[p, 0] - (1.0 - share) * shift[e, 0] - share * shift[e_end, 0]
    my = shift[p, 1] - (1.0 - share) * shift[e, 1] - share * shift[e_end, 1]
    return -(mx * nx + my * ny)


@kernel()
def _passes_by(p, e, gap, at_end, ax, ay, bx, by, vertices, shift, direction, length, first, last):
    """Return True if vertex p stands at the very end of edge e, flush with the next edge there.

    (ax, ay) and (bx, by) are its own two edges.  Its block lies beyond that end then, as two blocks
    do that meet corner to corner across a joint: moving towards e it would slide along the next
    edge and not come to bear on this one, unless the step's motion takes it in.
    """
    if gap < -ROUND_OFF * length[e] or turn_at(e, at_end, direction, first, last) <= SMALL_ANGLE:
        return False
    f = vertex_after(e, first, last) if at_end else vertex_before(e, first, last)
    nx, ny = direction[f, 1], -direction[f, 0]
    flush = ROUND_OFF * length[f]
    if abs((vertices[p, 0] - vertices[f, 0]) * nx + (vertices[p, 1] - vertices[f, 1]) * ny) > flush:
        return False
    if ax * nx + ay * ny < -SMALL_ANGLE or bx * nx + by * ny < -SMALL_ANGLE:
        return False
    share = 0.0 if at_end else 1.0
    return _moves_into(p, f, vertex_after(f, first, last), share, shift, nx, ny) <= flush


@kernel()
def _meeting_point(p, e, e_end, gap, along, shift, tx, ty, length):
    """Return where the step's motion takes vertex p across the line of edge e, m along it.

    ``shift`` (nv, 2) is how far the velocities would carry each vertex in the step, m.  Infinity
    where it does not come there.
    """
    share = along / length
    mx = shift[p, 0] - (1.0 - share) * shift[e, 0] - share * shift[e_end, 0]
    my = shift[p, 1] - (1.0 - share) * shift[e, 1] - share * shift[e_end, 1]
    closing = -(mx * ty - my * tx)
    if closing <= gap:
        return np.inf
    return along + (gap / closing) * (mx * tx + my * ty)


@kernel(inline="always")
def _vertex_candidates(
    p,
    i,
    j,
    first_edge,
    last_edge,
    vertices,
    shift,
    block_start,
    direction,
    length,
    reach,
    depth,
    critdis,
    tip_reach,
    out_edge,
    out_gap,
    out_along,
    found,
    outlines,
    bearing,
):
    """Append the candidate edges of block j for vertex p of block i; return the new count.

    Of the edges ``first_edge`` to ``last_edge`` - 1.
    """
    first_i, last_i = block_start[i], block_start[i + 1]
    first_j, last_j = block_start[j], block_start[j + 1]
    before = vertex_before(p, first_i, last_i)
    # the vertex's own two edges, pointing away from it
    ax, ay = -direction[before, 0], -direction[before, 1]
    bx, by = direction[p, 0], direction[p, 1]
    if bx * ay - by * ax < -SMALL_ANGLE:  # a re-entrant vertex cannot enter an edge
        return found
    # into its own block: the sum of the two edges' inward normals
    inward_x, inward_y = ay - by, bx - ax
    px, py = vertices[p, 0], vertices[p, 1]
    for e in range(first_edge, last_edge):
        tx, ty = direction[e, 0], direction[e, 1]
        nx, ny = ty, -tx
        rx, ry = px - vertices[e, 0], py - vertices[e, 1]
        gap = rx * nx + ry * ny
        if gap > reach or gap < -depth:
            continue
        along = rx * tx + ry * ty
        beyond = max(-along, along - length[e])
        if beyond > max(critdis, depth, reach):
            continue
        if ax * nx + ay * ny < -SMALL_ANGLE or bx * nx + by * ny < -SMALL_ANGLE:
            continue
        if inward_x * nx + inward_y * ny <= 0.0:  # a flat vertex on the wrong side
            continue
        at_end = along > 0.5 * length[e]
        allowance = _foot_allowance(ax, ay, bx, by, nx, ny, tx, ty, at_end, critdis, tip_reach)
        if (
            abs(beyond) <= ROUND_OFF * length[e]
            and allowance == tip_reach
            and _passes_by(
                p,
                e,
                gap,
                at_end,
                ax,
                ay,
                bx,
                by,
                vertices,
                shift,
                direction,
                length,
                first_j,
                last_j,
            )
        ):
            continue
        if beyond > ROUND_OFF * length[e]:
            if _is_behind_next(px, py, gap, e, at_end, vertices, direction, first_j, last_j):
                allowance = depth
            e_end = vertex_after(e, first_j, last_j)
            if beyond > allowance:
                if gap < 0.0:
                    continue
                meets = _meeting_point(p, e, e_end, gap, along, shift, tx, ty, length[e])
                # one that is pressed in a little meets the line before the seam where it bends
                over = length[e] if at_end else 0.0
                behind = vertex_after(e, first_j, last_j)
                if not at_end:
                    behind = vertex_before(e, first_j, last_j)
                if not 0.0 <= meets <= length[e] and not (
                    abs(meets - over) <= depth
                    and is_covered(p, i, j, behind, not at_end, ax, ay, bx, by, outlines, bearing)
                ):
                    continue
        if gap < 0.0 and _is_hidden(
            px, py, e, along, critdis, vertices, direction, length, first_j, last_j
        ):
            continue
        at_corner = -beyond <= max(critdis, depth, reach)
        if at_corner and is_covered(p, i, j, e, at_end, ax, ay, bx, by, outlines, bearing):
            continue
        if found < len(out_edge):
            out_edge[found] = e
            out_gap[found] = gap
            out_along[found] = along
        found += 1
    return found


@kernel()
def _is_around(p, vertices, box, j, distance):
    """Return True if vertex p is within ``distance``, m, of the box of block j."""
    return (
        box[j, 0] - distance <= vertices[p, 0] <= box[j, 2] + distance
        and box[j, 1] - distance <= vertices[p, 1] <= box[j, 3] + distance
    )


@kernel()
def _edges_around(window, reach, vertices, first, last):
    """Return the edges of a block within ``reach``, m, of a window, as ``left_to_right`` does."""
    found = np.empty(last - first, np.int64)
    count = edges_within(window, reach, vertices, first, last, found)
    return left_to_right(found[:count], vertices, first, last)


@kernel()
def _of_pairs(low, high, outlines, blocks, pairs, pair_depth, travel, reach, bearing, room):
    """Write the candidates of pairs ``low`` to ``high`` - 1 into ``room``; return their number.

    And the number of their groups; valid where as many fit.
    """
    vertices, shift, direction, length = outlines
    block_start, box, vertex_block = blocks
    outlined = vertices, direction, length, vertex_block, block_start
    front, depth_reach, critdis, tip_reach = reach
    group_start, vertex, edge, pair, gap, along = room
    group_start[0] = 0
    groups, found = 0, 0
    left, listed, widest = np.empty(0), np.empty(0, np.int64), 0.0
    near, first, last = np.empty(0, np.int64), 0, 0
    for q in range(low, high):
        moves = travel[pairs[q, 0]] + travel[pairs[q, 1]]
        depth, before = depth_reach + pair_depth[q] + moves, front + moves
        around = before + max(critdis, tip_reach)  # in front of an edge and beyond its end
        # an edge behind or beyond whose end a vertex lies further counts for nothing
        far = 1.5 * max(before, depth, critdis, tip_reach)
        for side in range(2):
            i, j = pairs[q, side], pairs[q, 1 - side]
            few = block_start[j + 1] - block_start[j] <= FEW
            if not few:
                first, last = block_start[j], block_start[j + 1]
                left, listed, widest = _edges_around(box[i], far, vertices, first, last)
            for p in range(block_start[i], block_start[i + 1]):
                if not _is_around(p, vertices, box, j, around):
                    continue
                start = found
                ranges = 1
                if not few:
                    px, py = vertices[p, 0], vertices[p, 1]
                    if len(near) < len(listed):
                        near = np.empty(len(listed), np.int64)
                    ranges = edges_near(
                        px, py, far, left, listed, widest, vertices, first, last, near
                    )
                for k in range(ranges):
                    found = _vertex_candidates(
                        p,
                        i,
                        j,
                        block_start[j] if few else near[k],
                        block_start[j + 1] if few else near[k] + 1,
                        vertices,
                        shift,
                        block_start,
                        direction,
                        length,
                        before,
                        depth,
                        critdis,
                        tip_reach,
                        edge,
                        gap,
                        along,
                        found,
                        outlined,
                        bearing,
                    )
                if found > start and found <= len(edge):
                    vertex[start:found] = p
                    pair[start:found] = q
                    groups += 1
                    group_start[groups] = found
    return found, groups


@kernel()
def _room_for(number):
    """Return arrays for so many candidates."""
    return (
        np.empty(number + 1, np.int64),
        np.empty(number, np.int64),
        np.empty(number, np.int64),
        np.empty(number, np.int64),
        np.empty(number),
        np.empty(number),
    )


@kernel()
def _part_of(room, first, last):
    """Return the arrays from ``first`` to ``last`` - 1."""
    group_start, vertex, edge, pair, gap, along = room
    return (
        group_start[first : last + 1],
        vertex[first:last],
        edge[first:last],
        pair[first:last],
        gap[first:last],
        along[first:last],
    )


@kernel(parallel=True)
def _of_parts(outlines, blocks, pairs, pair_depth, travel, reach, bearing, room, most, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(found)):
            low, high = part * PART, min((part + 1) * PART, len(pairs))
            begin = part * (most + 1)
            own = _part_of(room, begin, begin + most)
            found[part, 0], found[part, 1] = _of_pairs(
                low, high, outlines, blocks, pairs, pair_depth, travel, reach, bearing, own
            )


@kernel(parallel=True)
def _join(room, most, found, joined):
    """Copy what the parts have found, one behind the other."""
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(found)):
            at, group = found[:part, 0].sum(), found[:part, 1].sum()
            begin = part * (most + 1)
            count, groups = found[part]
            for k in range(groups):
                joined[0][group + k + 1] = at + room[0][begin + k + 1]
            for k in range(count):
                joined[1][at + k] = room[1][begin + k]
                joined[2][at + k] = room[2][begin + k]
                joined[3][at + k] = room[3][begin + k]
                joined[4][at + k] = room[4][begin + k]
                joined[5][at + k] = room[5][begin + k]


@kernel()
def candidates(outlines, blocks, pairs, pair_depth, travel, reach, bearing):
    """Return candidate (vertex, edge) couples of all pairs, grouped by (vertex, block of edge).

    ``outlines`` are the vertices (nv, 2), how far the velocities would carry each in the step
    (nv, 2), m, and directions and lengths of the edges that start there; ``blocks`` the first
    vertex of each block, the boxes (n, 4), not widened, and the block of each vertex.  ``reach`` is
    how far to look, m, in front of an edge and behind it (beside the ``travel`` (n,) of the two
    blocks, and behind it beyond the penetration ``pair_depth`` (q,) that the pair had at the end of
    the last step), beyond an end where corners coincide, and for a tip.  ``bearing`` is what blocks
    stand on (contact/seams.py).  Result: group starts, and per candidate vertex, edge, pair, gap,
    distance along the edge.
    """
    found = np.zeros((max(parts(len(pairs)), 1), 2), np.int64)
    most = 64 + 6 * min(PART, len(pairs))
    while True:
        room = _room_for(len(found) * (most + 1))
        _of_parts(outlines, blocks, pairs, pair_depth, travel, reach, bearing, room, most, found)
        if found[:, 0].max() <= most:
            break
        most = found[:, 0].max()
    number, groups = found[:, 0].sum(), found[:, 1].sum()
    joined = _room_for(number)
    joined[0][0] = 0
    _join(room, most, found, joined)
    return joined[0][: groups + 1], joined[1], joined[2], joined[3], joined[4], joined[5]


@kernel(inline="always")
def _overlap(p, w, e, first, last, vertex, start, stop, vertices, direction, length, critdis):
    """Return the length that own edge from p to w shares with edge e, m, as seen by vertex p.

    Each shared piece has two ends, and each end is a vertex of one block, or a vertex of both
    (coinciding corners, which then count half each where both are among the contacts of the two
    blocks, ``start`` to ``stop`` - 1); every end stands for half of the piece.
    """
    tx, ty = direction[e, 0], direction[e, 1]
    here = (vertices[p, 0] - vertices[e, 0]) * tx + (vertices[p, 1] - vertices[e, 1]) * ty
    there = (vertices[w, 0] - vertices[e, 0]) * tx + (vertices[w, 1] - vertices[e, 1]) * ty
    low, high = max(0.0, min(here, there)), min(length[e], max(here, there))
    if high <= low:
        return 0.0
    at_end = here > there
    coincide = abs(here - (length[e] if at_end else 0.0)) <= critdis
    if coincide:
        corner = vertex_after(e, first, last) if at_end else e
        for c in range(start, stop):
            if vertex[c] == corner:
                return 0.25 * (high - low)
    return 0.5 * (high - low)


@kernel(inline="always")
def _edge_along(p, w, e, first, last, vertices, direction, length, critdis):
    """Return the edge that own edge from p to w runs along: e, or the next one at a flat corner."""
    tx, ty = direction[e, 0], direction[e, 1]
    here = (vertices[p, 0] - vertices[e, 0]) * tx + (vertices[p, 1] - vertices[e, 1]) * ty
    at_end = (vertices[w, 0] - vertices[p, 0]) * tx + (vertices[w, 1] - vertices[p, 1]) * ty > 0.0
    left = length[e] - here if at_end else here
    if left > critdis or abs(turn_at(e, at_end, direction, first, last)) > SMALL_ANGLE:
        return e
    return vertex_after(e, first, last) if at_end else vertex_before(e, first, last)


@kernel()
def _lengths(low, high, contacts, vertices, block_start, direction, length, critdis, result):
    """Write the lengths of joint of contacts ``low`` to ``high`` - 1."""
    vertex, edge, vertex_block, edge_block, pair = contacts
    start = low
    while start > 0 and start < len(pair) and pair[start - 1] == pair[start]:
        start -= 1
    stop = start
    for c in range(low, high):
        while stop <= c:  # the contacts of the next pair of blocks
            start = stop
            while stop < len(vertex) and pair[stop] == pair[start]:
                stop += 1
        result[c] = 0.0
        p, e, i, j = vertex[c], edge[c], vertex_block[c], edge_block[c]
        before = vertex_before(p, block_start[i], block_start[i + 1])
        after = vertex_after(p, block_start[i], block_start[i + 1])
        first, last = block_start[j], block_start[j + 1]
        nx, ny = direction[e, 1], -direction[e, 0]
        for side in range(2):
            own, w = (before, before) if side == 0 else (p, after)
            if abs(direction[own, 0] * nx + direction[own, 1] * ny) > SMALL_ANGLE:
                continue
            along = _edge_along(p, w, e, first, last, vertices, direction, length, critdis)
            result[c] += _overlap(
                p, w, along, first, last, vertex, start, stop, vertices, direction, length, critdis
            )


@kernel(parallel=True)
def _lengths_of_parts(contacts, vertices, block_start, direction, length, critdis, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(result))):
            low, high = part * PART, min((part + 1) * PART, len(result))
            _lengths(low, high, contacts, vertices, block_start, direction, length, critdis, result)


@kernel()
def contact_lengths(
    vertex, edge, vertex_block, edge_block, pair, vertices, block_start, direction, length, critdis
):
    """Return the length of joint that each contact stands for, m, shape (m,).

    Where a vertex's own edge lies along the entrance edge (within 3 degrees) the two share a
    piece of joint, and each of its ends takes half; the sum over the contacts of two faces is
    their common length.  A vertex that touches with its tip alone stands for none.
    """
    contacts = vertex, edge, vertex_block, edge_block, pair
    result = np.empty(len(vertex))
    _lengths_of_parts(contacts, vertices, block_start, direction, length, critdis, result)
    return result


@kernel()
def depth_inside(px, py, vertices, first, last):
    """Return the distance to the outline of a point inside the polygon, m; 0 outside."""
    inside = False
    nearest = np.inf
    for k in range(first, last):
        following = vertex_after(k, first, last)
        x1, y1 = vertices[k, 0] - px, vertices[k, 1] - py
        x2, y2 = vertices[following, 0] - px, vertices[following, 1] - py
        if (y1 > 0.0) != (y2 > 0.0) and x1 + (x2 - x1) * (-y1) / (y2 - y1) > 0.0:
            inside = not inside
        dx, dy = x2 - x1, y2 - y1
        share = min(1.0, max(0.0, -(x1 * dx + y1 * dy) / (dx * dx + dy * dy)))
        fx, fy = x1 + share * dx, y1 + share * dy
        nearest = min(nearest, fx * fx + fy * fy)
    return np.sqrt(nearest) if inside else 0.0


@kernel()
def _is_inside(px, py, left, edges, widest, vertices, first, last):
    """Return whether a point lies inside a polygon, by its edges from left to right."""
    inside = False
    for k in range(np.searchsorted(left, px - widest), len(left)):
        if left[k] > px:
            break
        e = edges[k]
        f = vertex_after(e, first, last)
        x1, y1 = vertices[e, 0] - px, vertices[e, 1] - py
        x2, y2 = vertices[f, 0] - px, vertices[f, 1] - py
        if (x1 > 0.0) != (x2 > 0.0) and y1 + (y2 - y1) * (-x1) / (x2 - x1) > 0.0:
            inside = not inside
    return inside


@kernel()
def _deepest(low, high, before, vertices, block_start, box, pairs, pair_depth):
    """Return the deepest jump among pairs ``low`` to ``high`` - 1."""
    worst, worst_vertex, worst_block = 0.0, -1, -1
    left, listed, widest = np.empty(0), np.empty(0, np.int64), 0.0
    for q in range(low, high):
        for side in range(2):
            i, j = pairs[q, side], pairs[q, 1 - side]
            few = block_start[j + 1] - block_start[j] <= FEW
            if not few:
                window = (box[i, 0], box[j, 1], box[i, 2], box[j, 3])
                first, last = block_start[j], block_start[j + 1]
                left, listed, widest = _edges_around(window, 0.0, vertices, first, last)
            for p in range(block_start[i], block_start[i + 1]):
                px, py = vertices[p, 0], vertices[p, 1]
                # the outline is nearer than the sides of the box around it
                most = min(px - box[j, 0], box[j, 2] - px, py - box[j, 1], box[j, 3] - py)
                if most - 2.0 * pair_depth[q] <= worst:
                    continue
                if not few and not _is_inside(
                    px, py, left, listed, widest, vertices, block_start[j], block_start[j + 1]
                ):
                    continue
                depth = depth_inside(px, py, vertices, block_start[j], block_start[j + 1])
                depth -= 2.0 * pair_depth[q]
                if depth <= worst:
                    continue
                first, last = block_start[j], block_start[j + 1]
                depth -= depth_inside(before[p, 0], before[p, 1], before, first, last)
                if depth > worst:
                    worst, worst_vertex, worst_block = depth, p, j
    return worst, worst_vertex, worst_block


@kernel(parallel=True)
def _deepest_of_parts(before, vertices, block_start, box, pairs, pair_depth, depth, which):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(depth)):
            low, high = part * PART, min((part + 1) * PART, len(pairs))
            depth[part], which[part, 0], which[part, 1] = _deepest(
                low, high, before, vertices, block_start, box, pairs, pair_depth
            )


@kernel()
def deepest_jump(before, vertices, block_start, box, pairs, pair_depth):
    """Return how much deeper than its pair's penetration a vertex has got into a block, and which.

    ``pair_depth`` (q,) is the penetration of each pair that the contacts know of, m.  A vertex
    that is much deeper, and was not as deep ``before`` the step, has jumped there within it.
    (0, -1, -1) where none is deeper.
    """
    if len(pairs) == 0:
        return 0.0, -1, -1
    depth, which = np.empty(parts(len(pairs))), np.empty((parts(len(pairs)), 2), np.int64)
    _deepest_of_parts(before, vertices, block_start, box, pairs, pair_depth, depth, which)
    at = np.argmax(depth)
    return depth[at], which[at, 0], which[at, 1]
