"""Impacts one after the other within a step, each at the moment at which a contact closes.

An impact changes velocities and no position.  From there on a block goes on as if it had begun the
step with its new velocity, ``shift`` away from where it was: by -t dv for a change dv at time t.

Arguments of kernels are named tuples (step/impulses.py): ``bodies`` are Bodies, ``contacts``
Closing, ``live`` Strikes, ``around`` ContactsOfBlocks, ``group`` an ImpactGroup.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.vec6 import plus_product, row, total, zeros
from clast.contact.jacobian import relative_motion
from clast.step.impulses import (
    Bodies,
    Closing,
    ContactsOfBlocks,
    ImpactGroup,
    ImpactLimits,
    Strikes,
    describe,
    find,
    renew,
    room_for,
)

SAME = 1e-9
"""Time between impacts that are one, in units of the step."""
OFTEN = 8
"""Impacts of a contact within a step after which it gives nothing back, and carries."""
NEVER = 16
"""Impacts of a contact within a step after which it is left to its spring."""
FELT = 1e-2
"""Closing velocity that makes a bearing contact take part, in units of that of the impact."""
SLOW = 0.5
"""The same in units of the closing velocity from which contacts strike."""
EXACT, FEW = 1e-10, 12
"""Change of velocity at which the impulses of few contacts are found, and how many are few.

In units of the velocity of the impact.
"""
ROUGH, CLOSE = 0.3, 1e-2
"""The same while others may join, and of many contacts, in units of the velocity that is felt."""
RENEWED, TIMES = 500, 8
"""Impulses that are renewed at most before others join, beside so many times all."""
WORK, SOME = 500, 200
"""Impulses that are renewed in a step at most for each of its contacts, of which it has some.

Later strikes are left to the springs.
"""


@kernel(forceinline=True)
def _accelerations(c, acceleration, contacts):
    """Return the accelerations of contact c along its normal and its edge, m/s2."""
    vertex_block, edge_block, arms = contacts.vertex_block, contacts.edge_block, contacts.arms
    i, j = vertex_block[c], edge_block[c]
    nx, ny = arms[c, 0], arms[c, 1]
    x, y = acceleration[i, 0] - acceleration[j, 0], acceleration[i, 1] - acceleration[j, 1]
    return nx * x + ny * y, nx * y - ny * x


@kernel(forceinline=True)
def _rates(c, time, velocity, acceleration, contacts):
    """Return how fast contact c opens and slips at a time in the step, m/s."""
    vertex_block, edge_block, arms = contacts.vertex_block, contacts.edge_block, contacts.arms
    opening, slip = relative_motion(arms, c, velocity, vertex_block[c], edge_block[c])
    along_normal, along_edge = _accelerations(c, acceleration, contacts)
    return opening + time * along_normal, slip + time * along_edge


@kernel()
def _moment(c, bodies, contacts, limits):
    """Return when contact c closes faster than the threshold, s; infinity: not in this step."""
    velocity, shift, last = bodies.velocity, bodies.shift, bodies.last
    acceleration = bodies.acceleration
    gap, vertex_block, edge_block = contacts.gap, contacts.vertex_block, contacts.edge_block
    arms = contacts.arms
    step, threshold = limits.step, limits.threshold
    i, j = vertex_block[c], edge_block[c]
    start = max(last[i], last[j])
    bend, _ = _accelerations(c, acceleration, contacts)
    rate, _ = _rates(c, start, velocity, acceleration, contacts)
    shifted, _ = relative_motion(arms, c, shift, i, j)
    here = gap[c] + shifted + start * (rate - 0.5 * start * bend)
    if here <= 0.0:
        return start if rate < -threshold else np.inf
    square = rate * rate - 2.0 * bend * here
    if not square > threshold * threshold:
        return np.inf
    closing = np.sqrt(square)
    if not closing - rate > 0.0:
        return np.inf
    moment = start + 2.0 * here / (closing - rate)
    return moment if moment <= step else np.inf


@kernel(forceinline=True)
def _moves(b, mobility):
    """Return whether an impulse can move block b."""
    return mobility[b, 0, 0] + mobility[b, 1, 1] + mobility[b, 2, 2] > 0.0


@kernel()
def _look_ahead(listed, bodies, contacts, live, limits):
    """Write when the contacts listed (k,) strike; no impulse moves two blocks that cannot move."""
    moment, carries, hits = live.moment, live.carries, live.hits
    waiting, waits, number = live.waiting, live.waits, live.number
    mobility, vertex_block, edge_block = bodies.mobility, contacts.vertex_block, contacts.edge_block
    for c in listed:
        strikes = not carries[c] and hits[c] < NEVER
        strikes &= _moves(vertex_block[c], mobility) or _moves(edge_block[c], mobility)
        moment[c] = _moment(c, bodies, contacts, limits) if strikes else np.inf
        if moment[c] < np.inf and not waits[c]:
            waiting[number[0]], waits[c] = c, True
            number[0] += 1


@kernel()
def _add_block(b, mobility, group):
    """Put block b among those of the group, if it moves."""
    blocks, among, counts = group.blocks, group.among, group.counts
    if not among[b] and _moves(b, mobility):
        blocks[counts[1]], among[b] = b, True
        counts[1] += 1


@kernel()
def _join(c, time, target, bodies, contacts, group):
    """Let contact c take part, and its blocks."""
    velocity, acceleration, mobility = bodies.velocity, bodies.acceleration, bodies.mobility
    members, place, targets = group.members, group.place, group.targets
    linear, course, counts = group.linear, group.course, group.counts
    at = counts[0]
    members[at], place[c], targets[at] = c, at, target
    counts[0] += 1
    rates = _rates(c, time, velocity, acceleration, contacts)
    describe(at, c, rates, target, velocity, mobility, contacts, linear)
    course.impulses[at, 0] = course.impulses[at, 1] = 0.0
    _add_block(contacts.vertex_block[c], mobility, group)
    _add_block(contacts.edge_block[c], mobility, group)


@kernel()
def _let_strike(c, time, bodies, contacts, hits, group):
    """Let contact c take part and rebound; return how fast it closes, m/s."""
    before, acceleration, restitution = bodies.before, bodies.acceleration, contacts.restitution
    rate, _ = _rates(c, time, before, acceleration, contacts)
    back = restitution[c] if hits[c] < OFTEN else 0.0
    _join(c, time, max(0.0, -rate) * back, bodies, contacts, group)
    return -rate


@kernel()
def _moment_of_all(first, bodies, contacts, live, around, limits, group):
    """Return when contact ``first`` strikes, s, with those that strike before it is pressed in.

    A block that turns about a corner which is pressed in lands flat a little later on its far
    corner than on the ground between.  So the impact is that of the last contact which closes
    before any other of these blocks is as deep as faces are uneven.
    """
    before, acceleration, mobility = bodies.before, bodies.acceleration, bodies.mobility
    vertex_block, edge_block = contacts.vertex_block, contacts.edge_block
    moment, start, listed = live.moment, around.start, around.listed
    blocks, among, counts = group.blocks, group.among, group.counts
    latest, at = np.inf, 0
    _add_block(vertex_block[first], mobility, group)
    _add_block(edge_block[first], mobility, group)
    while at < counts[1]:
        b = blocks[at]
        for c in listed[start[b] : start[b + 1]]:
            if moment[c] < np.inf and moment[c] <= latest:
                rate, _ = _rates(c, moment[c], before, acceleration, contacts)
                latest = min(latest, moment[c] + limits.even / -rate)
                _add_block(vertex_block[c], mobility, group)
                _add_block(edge_block[c], mobility, group)
        at += 1
    last = moment[first]
    for b in blocks[: counts[1]]:
        among[b] = False
        for c in listed[start[b] : start[b + 1]]:
            if moment[c] <= latest:
                last = max(last, moment[c])
    counts[1] = 0
    return last


@kernel()
def _gather(first, time, bodies, contacts, live, around, limits, group):
    """Let all contacts take part that strike with the ``first``; return the fastest approach, m/s.

    Those that strike as it does wherever they are: it should not depend on the order of the blocks.
    Where it waits for others of its blocks, until ``time``, all of these that have closed then.
    """
    before, acceleration = bodies.before, bodies.acceleration
    start, listed = around.start, around.listed
    moment, hits, waiting = live.moment, live.hits, live.waiting
    number = live.number
    place, blocks, counts = group.place, group.blocks, group.counts
    fastest, at = 0.0, 0
    waits = time > moment[first] + SAME * limits.step
    for c in waiting[: number[0]]:
        if c == first or (not waits and moment[c] <= time + SAME * limits.step):
            fastest = max(fastest, _let_strike(c, time, bodies, contacts, hits, group))
    while at < counts[1]:
        b = blocks[at]
        for c in listed[start[b] : start[b + 1]]:
            if place[c] < 0 and moment[c] < np.inf:
                rate, _ = _rates(c, time, before, acceleration, contacts)
                if moment[c] <= time or -rate * (moment[c] - time) <= limits.even:
                    fastest = max(fastest, _let_strike(c, time, bodies, contacts, hits, group))
        at += 1
    return fastest


@kernel()
def _pass_on(time, felt, bodies, contacts, live, around, group):
    """Let contacts under load take part that close by more than the limit; return whether any.

    Each takes its first impulse at once: a blow runs on from block to block before all are renewed.
    """
    velocity, before, acceleration = bodies.velocity, bodies.before, bodies.acceleration
    first, listed = around.start, around.listed
    carries = live.carries
    place, linear, course = group.place, group.linear, group.course
    blocks, counts = group.blocks, group.counts
    known, at = counts[0], 0
    while at < counts[1]:
        b = blocks[at]
        for k in listed[first[b] : first[b + 1]]:
            if place[k] < 0 and carries[k]:
                rate, _ = _rates(k, time, before, acceleration, contacts)
                target = min(0.0, rate)
                rate, _ = _rates(k, time, velocity, acceleration, contacts)
                if rate < target - felt:
                    _join(k, time, target, bodies, contacts, group)
                    renew(counts[0] - 1, counts[0], linear, course, velocity)
        at += 1
    return counts[0] > known


@kernel()
def _impulses(time, fastest, bodies, contacts, live, around, limits, group):
    """Find the impulses of all that take part, and let all that feel them take part."""
    linear, course, blocks = group.linear, group.course, group.blocks
    counts = group.counts
    felt, velocity = max(FELT * fastest, SLOW * limits.threshold), bodies.velocity
    enough, more, is_rough = ROUGH * felt, True, True
    while more:
        count = counts[0]
        most = TIMES + RENEWED // count
        taken = find(enough, most, count, blocks[: counts[1]], linear, course, velocity)
        counts[2] -= taken * count
        more = _pass_on(time, felt, bodies, contacts, live, around, group)
        if not more and is_rough:
            enough = EXACT * fastest if counts[0] <= FEW else CLOSE * felt
            more, is_rough = True, False


@kernel()
def _gained(time, velocity, bodies, group):
    """Return by how much the kinetic energy is above that before the impact, J/m."""
    before, acceleration, mass_matrix = bodies.before, bodies.acceleration, bodies.mass_matrix
    blocks, counts = group.blocks, group.counts
    change, mean = np.empty((1, 6)), np.empty((1, 6))
    gained = 0.0
    for b in blocks[: counts[1]]:
        for a in range(6):
            change[0, a] = velocity[b, a] - before[b, a]
            mean[0, a] = 0.5 * (velocity[b, a] + before[b, a])
        mean[0, 0] += time * acceleration[b, 0]
        mean[0, 1] += time * acceleration[b, 1]
        gained += total(plus_product(zeros(), times(mass_matrix, b, change, 0), row(mean, 0)))
    return gained


@kernel()
def _mix(time, other, bodies, group):
    """Bring velocities so near to others that gain energy that none is gained, on a line.

    The velocities gain none by themselves.
    """
    velocity, mass_matrix = bodies.velocity, bodies.mass_matrix
    blocks, counts = group.blocks, group.counts
    least, most = _gained(time, velocity, bodies, group), _gained(time, other, bodies, group)
    bend, change = 0.0, np.empty((1, 6))
    for b in blocks[: counts[1]]:
        for a in range(6):
            change[0, a] = other[b, a] - velocity[b, a]
        bend += 0.5 * total(plus_product(zeros(), times(mass_matrix, b, change, 0), row(change, 0)))
    # least + (most - least - bend) s + bend s^2 = 0
    half = 0.5 * (most - least - bend)
    share = (np.sqrt(half * half - bend * least) - half) / bend if bend > 0.0 else 0.0
    for b in blocks[: counts[1]]:
        for a in range(3):
            velocity[b, a] += share * (other[b, a] - velocity[b, a])


@kernel()
def _put(other, bodies, group):
    """Write other velocities for the blocks that take part."""
    velocity = bodies.velocity
    for b in group.blocks[: group.counts[1]]:
        for a in range(3):
            velocity[b, a] = other[b, a]


@kernel()
def _give_no_more(time, fastest, bodies, contacts, live, around, limits, group):
    """Blend with the plastic impact so that no energy is created.

    Of several contacts that rub each other a rebound of each with its own restitution may need more
    energy than there is (Kane 1984); so may a plastic one that turns a slip round, and that is then
    blended with the velocities before.
    """
    velocity, before = bodies.velocity, bodies.before
    target, linear, course = group.targets, group.linear, group.course
    counts = group.counts
    impulses, goal, ease = course.impulses, linear.goal, linear.ease
    rebound = velocity.copy()
    _put(before, bodies, group)
    for at in range(counts[0]):
        if target[at] > 0.0 and ease[at, 0] > 0.0:
            goal[at, 0] -= target[at] / ease[at, 0]
        target[at], impulses[at, 0], impulses[at, 1] = min(0.0, target[at]), 0.0, 0.0
    _impulses(time, fastest, bodies, contacts, live, around, limits, group)
    if _gained(time, velocity, bodies, group) > 0.0:
        rebound = velocity.copy()
        _put(before, bodies, group)
    _mix(time, rebound, bodies, group)


@kernel()
def _end(time, bodies, contacts, live, around, limits, group):
    """Write the result of the impact: contacts under load, the shifts, and the next strike."""
    velocity, before, shift = bodies.velocity, bodies.before, bodies.shift
    last, acceleration = bodies.last, bodies.acceleration
    moment, carries, hits = live.moment, live.carries, live.hits
    members, place, blocks = group.members, group.place, group.blocks
    among, counts = group.among, group.counts
    for c in members[: counts[0]]:
        rate, _ = _rates(c, time, velocity, acceleration, contacts)
        if moment[c] < np.inf:
            hits[c] += 1
        carries[c] = rate <= limits.threshold
        place[c] = -1
    for b in blocks[: counts[1]]:
        for a in range(3):
            shift[b, a] -= time * (velocity[b, a] - before[b, a])
            before[b, a] = velocity[b, a]
        last[b], among[b] = time, False
    start, listed = around.start, around.listed
    for b in blocks[: counts[1]]:
        _look_ahead(listed[start[b] : start[b + 1]], bodies, contacts, live, limits)


@kernel()
def _strike(first, bodies, contacts, live, around, limits, group):
    """Let a contact strike, and all that do with it; return the energy lost, J/m."""
    counts = group.counts
    counts[:2] = 0
    time = _moment_of_all(first, bodies, contacts, live, around, limits, group)
    fastest = _gather(first, time, bodies, contacts, live, around, limits, group)
    _impulses(time, fastest, bodies, contacts, live, around, limits, group)
    gained = _gained(time, bodies.velocity, bodies, group)
    if gained > 0.0:
        _give_no_more(time, fastest, bodies, contacts, live, around, limits, group)
        gained = _gained(time, bodies.velocity, bodies, group)
    _end(time, bodies, contacts, live, around, limits, group)
    return -gained


@kernel()
def _earliest(live):
    """Return the contact that strikes first, -1 if none; drop those that can no longer strike."""
    moment, waiting, waits = live.moment, live.waiting, live.waits
    number = live.number
    found, at = -1, 0
    while at < number[0]:
        c = waiting[at]
        if moment[c] == np.inf:
            number[0] -= 1
            waiting[at], waits[c] = waiting[number[0]], False
        else:
            if found < 0 or moment[c] < moment[found]:
                found = c
            at += 1
    return found


@kernel()
def _contacts_of_blocks(contacts, mobility):
    """Return where the contacts of each block that can move begin (n + 1,), and these."""
    vertex_block, edge_block = contacts.vertex_block, contacts.edge_block
    count = len(mobility)
    free = np.empty(count, np.bool_)
    for b in range(count):
        free[b] = _moves(b, mobility)
    first = np.zeros(count + 1, np.int64)
    for ends in (vertex_block, edge_block):
        for b in ends:
            first[b + 1] += free[b]
    for b in range(count):
        first[b + 1] += first[b]
    at, listed = first[:-1].copy(), np.empty(first[count], np.int64)
    for c in range(len(vertex_block)):
        for b in (vertex_block[c], edge_block[c]):
            if free[b]:
                listed[at[b]] = c
                at[b] += 1
    return ContactsOfBlocks(first, listed)


@kernel()
def flying(force, mass, fixed, acceleration):
    """Return the accelerations of blocks between impacts, m/s2, (n, 2): the part without support.

    Contacts carry blocks with ``force`` (n, 6), N/m; of ``acceleration``, m/s2, that leaves between
    nothing and all.
    """
    found = np.zeros((len(fixed), 2))
    square = acceleration[0] ** 2 + acceleration[1] ** 2
    for b in range(len(fixed)):
        if not fixed[b] and square > 0.0:
            along = force[b, 0] * acceleration[0] + force[b, 1] * acceleration[1]
            left = min(max(1.0 + along / (mass[b] * square), 0.0), 1.0)
            found[b, 0], found[b, 1] = left * acceleration[0], left * acceleration[1]
    return found


@kernel()
def mobilities(mass_matrix, fixed):
    """Return the change of (u, v, r) of each block by an impulse, (n, 3, 3); 0 where ``fixed``."""
    found = np.zeros((len(fixed), 3, 3))
    for b in range(len(fixed)):
        if not fixed[b]:
            for a in range(3):
                found[b, a, a] = 1.0 / mass_matrix[b, a, a]
    return found


@kernel()
def any_strikes(velocity, acceleration, closing, carries, limit):
    """Return whether any contact strikes in the step, when it comes to it.

    ``closing`` are the contacts and ``limit`` the limits, in the order of Closing, ImpactLimits.
    """
    contacts, limits = Closing(*closing), ImpactLimits(*limit)
    shift, last = np.zeros_like(velocity), np.zeros(len(velocity))
    of_none = np.empty((0, 3, 3)), np.empty((0, 6, 6))
    bodies = Bodies(velocity, velocity, shift, last, acceleration, *of_none)
    for c in range(len(carries)):
        if not carries[c] and _moment(c, bodies, contacts, limits) < np.inf:
            return True
    return False


@kernel()
def strike(velocity, acceleration, mobility, mass_matrix, closing, carries, limit):
    """Return velocities (n, 6) and shifts (n, 6), m, after the impacts of a step, and their loss.

    The loss is the kinetic energy, J/m, at the moments of impact.  ``carries`` (m,) says which
    contacts carry already: they do not strike, but pass impulses on.  ``closing`` and ``limit``
    are those of ``any_strikes``.
    """
    contacts, limits = Closing(*closing), ImpactLimits(*limit)
    count, blocks = len(carries), len(velocity)
    after, shift = velocity.copy(), np.zeros_like(velocity)
    last = np.zeros(blocks)
    bodies = Bodies(after, velocity.copy(), shift, last, acceleration, mobility, mass_matrix)
    live = Strikes(
        np.full(count, np.inf),
        carries.copy(),
        np.zeros(count, np.int64),
        np.empty(count, np.int64),
        np.zeros(count, np.bool_),
        np.zeros(1, np.int64),
    )
    around = _contacts_of_blocks(contacts, mobility)
    linear, course = room_for(count)
    group = ImpactGroup(
        np.empty(count, np.int64),
        np.full(count, -1),
        np.empty(count),
        linear,
        course,
        np.empty(blocks, np.int64),
        np.zeros(blocks, np.bool_),
        np.array([0, 0, WORK * max(count, SOME)]),
    )
    _look_ahead(np.arange(count), bodies, contacts, live, limits)
    lost, first = 0.0, _earliest(live)
    while first >= 0 and group.counts[2] > 0:
        lost += _strike(first, bodies, contacts, live, around, limits, group)
        first = _earliest(live)
    return after, shift, lost
