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
from clast.compute.parallel import borrowed
from clast.compute.vec6 import inner, row
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

SAME_MOMENT_STEPS = 1e-9
"""Time between impacts that are one, in units of the step."""
REBOUNDS_PER_STEP_MAX = 8
"""Impacts of a contact within a step after which it gives nothing back, and carries."""
IMPACTS_PER_STEP_MAX = 16
"""Impacts of a contact within a step after which it is left to its spring."""
FELT_IMPACTS = 1e-2
"""Closing velocity that makes a bearing contact take part, in units of that of the impact."""
FELT_THRESHOLDS = 0.5
"""The same in units of the closing velocity from which contacts strike."""
IMPULSE_TOLERANCE, EXACT_CONTACTS_MAX = 1e-10, 12
"""Change of velocity at which the impulses of few contacts are found, and how many are few.

In units of the velocity of the impact.
"""
ROUGH_TOLERANCE, FINAL_TOLERANCE = 0.3, 1e-2
"""The same while others may join, and of many contacts, in units of the velocity that is felt."""
RENEWAL_ROUNDS, RENEWALS_EXTRA = 8, 500
"""Times that all impulses are renewed at most before others join, and how many impulses beside that
once none does."""
RENEWALS_PER_CONTACT_MAX, CONTACTS_COUNTED_MIN = 500, 200
"""Impulses that are renewed in a step at most for each of its contacts, of which it has some.

Later strikes are left to the springs.
"""


@kernel(forceinline=True)
def _accelerations(c, acceleration, contacts):
    """Return the accelerations of contact c along its normal and its edge, m/s2."""
    i, j = contacts.vertex_block[c], contacts.edge_block[c]
    nx, ny = contacts.arms[c, 0], contacts.arms[c, 1]
    x, y = acceleration[i, 0] - acceleration[j, 0], acceleration[i, 1] - acceleration[j, 1]
    return nx * x + ny * y, nx * y - ny * x


@kernel(forceinline=True)
def _rates(c, time, velocity, acceleration, contacts):
    """Return how fast contact c opens and slips at a time in the step, m/s."""
    vertex_block, edge_block, arms = contacts.vertex_block, contacts.edge_block, contacts.arms
    opening, slip = relative_motion(arms, c, velocity, vertex_block[c], edge_block[c])
    along_normal, along_edge = _accelerations(c, acceleration, contacts)
    return opening + time * along_normal, slip + time * along_edge


@kernel(forceinline=True)
def _moment(c, bodies, contacts, limits):
    """Return when contact c closes faster than the threshold, s; infinity: not in this step."""
    i, j = contacts.vertex_block[c], contacts.edge_block[c]
    start = max(bodies.last[i], bodies.last[j])
    bend, _ = _accelerations(c, bodies.acceleration, contacts)
    rate, _ = _rates(c, start, bodies.velocity, bodies.acceleration, contacts)
    shifted, _ = relative_motion(contacts.arms, c, bodies.shift, i, j)
    here = contacts.gap[c] + shifted + start * (rate - 0.5 * start * bend)
    if here <= 0.0:
        return start if rate < -limits.threshold else np.inf
    square = rate * rate - 2.0 * bend * here
    if not square > limits.threshold * limits.threshold:
        return np.inf
    closing = np.sqrt(square)
    if not closing - rate > 0.0:
        return np.inf
    moment = start + 2.0 * here / (closing - rate)
    return moment if moment <= limits.step else np.inf


@kernel(forceinline=True)
def _moves(b, mobility):
    """Return whether an impulse can move block b."""
    return mobility[b, 0, 0] + mobility[b, 1, 1] + mobility[b, 2, 2] > 0.0


@kernel()
def _look_ahead(listed, bodies, contacts, live, limits):
    """Write when the contacts listed (k,) strike; no impulse moves two blocks that cannot move."""
    mobility, vertex_block, edge_block = bodies.mobility, contacts.vertex_block, contacts.edge_block
    for c in listed:
        strikes = not live.carries[c] and live.hits[c] < IMPACTS_PER_STEP_MAX
        strikes &= _moves(vertex_block[c], mobility) or _moves(edge_block[c], mobility)
        live.moment[c] = _moment(c, bodies, contacts, limits) if strikes else np.inf
        if live.moment[c] < np.inf and not live.waits[c]:
            live.waiting[live.number[0]], live.waits[c] = c, True
            live.number[0] += 1


@kernel()
def _add_block(b, mobility, group):
    """Put block b among those of the group, if it moves."""
    if not group.among[b] and _moves(b, mobility):
        group.blocks[group.counts[1]], group.among[b] = b, True
        group.counts[1] += 1


@kernel()
def _join(c, time, target, bodies, contacts, group):
    """Let contact c take part, and its blocks."""
    at = group.counts[0]
    group.members[at], group.place[c], group.targets[at] = c, at, target
    group.counts[0] += 1
    rates = _rates(c, time, bodies.velocity, bodies.acceleration, contacts)
    describe(at, c, rates, target, bodies.velocity, bodies.mobility, contacts, group.linear)
    group.course.impulses[at, 0] = group.course.impulses[at, 1] = 0.0
    _add_block(contacts.vertex_block[c], bodies.mobility, group)
    _add_block(contacts.edge_block[c], bodies.mobility, group)


@kernel()
def _let_strike(c, time, bodies, contacts, hits, group):
    """Let contact c take part and rebound; return how fast it closes, m/s."""
    rate, _ = _rates(c, time, bodies.before, bodies.acceleration, contacts)
    back = contacts.restitution[c] if hits[c] < REBOUNDS_PER_STEP_MAX else 0.0
    _join(c, time, max(0.0, -rate) * back, bodies, contacts, group)
    return -rate


@kernel()
def _moment_of_all(first, bodies, contacts, live, around, limits, group):
    """Return when contact ``first`` strikes, s, with those that strike before it is pressed in.

    A block that turns about a corner which is pressed in lands flat a little later on its far
    corner than on the ground between.  So the impact is that of the last contact which closes
    before any other of these blocks is as deep as faces are uneven.
    """
    latest, at = np.inf, 0
    _add_block(contacts.vertex_block[first], bodies.mobility, group)
    _add_block(contacts.edge_block[first], bodies.mobility, group)
    while at < group.counts[1]:
        b = group.blocks[at]
        for c in around.listed[around.start[b] : around.start[b + 1]]:
            if live.moment[c] < np.inf and live.moment[c] <= latest:
                rate, _ = _rates(c, live.moment[c], bodies.before, bodies.acceleration, contacts)
                latest = min(latest, live.moment[c] + limits.even / -rate)
                _add_block(contacts.vertex_block[c], bodies.mobility, group)
                _add_block(contacts.edge_block[c], bodies.mobility, group)
        at += 1
    last = live.moment[first]
    for b in group.blocks[: group.counts[1]]:
        group.among[b] = False
        for c in around.listed[around.start[b] : around.start[b + 1]]:
            if live.moment[c] <= latest:
                last = max(last, live.moment[c])
    group.counts[1] = 0
    return last


@kernel()
def _gather(first, time, bodies, contacts, live, around, limits, group):
    """Let all contacts take part that strike with the ``first``; return the fastest approach, m/s.

    Those that strike as it does wherever they are: it should not depend on the order of the blocks.
    Where it waits for others of its blocks, until ``time``, all of these that have closed then.
    """
    fastest, at = 0.0, 0
    waits = time > live.moment[first] + SAME_MOMENT_STEPS * limits.step
    for c in live.waiting[: live.number[0]]:
        if c == first or (not waits and live.moment[c] <= time + SAME_MOMENT_STEPS * limits.step):
            fastest = max(fastest, _let_strike(c, time, bodies, contacts, live.hits, group))
    while at < group.counts[1]:
        b = group.blocks[at]
        for c in around.listed[around.start[b] : around.start[b + 1]]:
            if group.place[c] < 0 and live.moment[c] < np.inf:
                rate, _ = _rates(c, time, bodies.before, bodies.acceleration, contacts)
                if live.moment[c] <= time or -rate * (live.moment[c] - time) <= limits.even:
                    fastest = max(fastest, _let_strike(c, time, bodies, contacts, live.hits, group))
        at += 1
    return fastest


@kernel()
def _pass_on(time, felt, bodies, contacts, live, around, group):
    """Let contacts under load take part that close by more than the limit; return whether any.

    Each takes its first impulse at once: a blow runs on from block to block before all are renewed.
    """
    blocks, counts = group.blocks, group.counts
    known, at = counts[0], 0
    while at < counts[1]:
        b = blocks[at]
        for k in around.listed[around.start[b] : around.start[b + 1]]:
            if group.place[k] < 0 and live.carries[k]:
                rate, _ = _rates(k, time, bodies.before, bodies.acceleration, contacts)
                target = min(0.0, rate)
                rate, _ = _rates(k, time, bodies.velocity, bodies.acceleration, contacts)
                if rate < target - felt:
                    _join(k, time, target, bodies, contacts, group)
                    renew(counts[0] - 1, counts[0], group.linear, group.course, bodies.velocity)
        at += 1
    return counts[0] > known


@kernel()
def _impulses(time, fastest, bodies, contacts, live, around, limits, group):
    """Find the impulses of all that take part, and let all that feel them take part."""
    linear, course, blocks = group.linear, group.course, group.blocks
    felt, velocity = (
        max(FELT_IMPACTS * fastest, FELT_THRESHOLDS * limits.threshold),
        bodies.velocity,
    )
    enough, more, is_rough = ROUGH_TOLERANCE * felt, True, True
    while more:
        count = group.counts[0]
        most = RENEWAL_ROUNDS + (0 if is_rough else RENEWALS_EXTRA // count)
        taken = find(enough, most, count, blocks[: group.counts[1]], linear, course, velocity)
        group.counts[2] -= taken * count
        more = _pass_on(time, felt, bodies, contacts, live, around, group)
        if not more and is_rough:
            enough = (
                IMPULSE_TOLERANCE * fastest
                if group.counts[0] <= EXACT_CONTACTS_MAX
                else FINAL_TOLERANCE * felt
            )
            more, is_rough = True, False


@kernel()
def _gained(time, velocity, bodies, group):
    """Return by how much the kinetic energy is above that before the impact, J/m."""
    before, acceleration, mass_matrix = bodies.before, bodies.acceleration, bodies.mass_matrix
    change, mean = np.empty((1, 6)), np.empty((1, 6))
    gained = 0.0
    for b in group.blocks[: group.counts[1]]:
        for a in range(6):
            change[0, a] = velocity[b, a] - before[b, a]
            mean[0, a] = 0.5 * (velocity[b, a] + before[b, a])
        mean[0, 0] += time * acceleration[b, 0]
        mean[0, 1] += time * acceleration[b, 1]
        gained += inner(times(mass_matrix, b, change, 0), row(mean, 0))
    return gained


@kernel()
def _mix(time, other, bodies, group):
    """Bring velocities so near to others that gain energy that none is gained, on a line.

    The velocities gain none by themselves.
    """
    velocity, mass_matrix = bodies.velocity, bodies.mass_matrix
    least, most = _gained(time, velocity, bodies, group), _gained(time, other, bodies, group)
    bend, change = 0.0, np.empty((1, 6))
    for b in group.blocks[: group.counts[1]]:
        for a in range(6):
            change[0, a] = other[b, a] - velocity[b, a]
        bend += 0.5 * inner(times(mass_matrix, b, change, 0), row(change, 0))
    # least + (most - least - bend) s + bend s^2 = 0
    half = 0.5 * (most - least - bend)
    share = (np.sqrt(half * half - bend * least) - half) / bend if bend > 0.0 else 0.0
    for b in group.blocks[: group.counts[1]]:
        for a in range(3):
            velocity[b, a] += share * (other[b, a] - velocity[b, a])


@kernel()
def _put(other, bodies, group):
    """Write other velocities for the blocks that take part."""
    for b in group.blocks[: group.counts[1]]:
        for a in range(3):
            bodies.velocity[b, a] = other[b, a]


@kernel()
def _give_no_more(time, fastest, bodies, contacts, live, around, limits, group):
    """Blend with the plastic impact so that no energy is created.

    Of several contacts that rub each other a rebound of each with its own restitution may need more
    energy than there is (Kane 1984); so may a plastic one that turns a slip round, and that is then
    blended with the velocities before.
    """
    impulses, goal, ease = group.course.impulses, group.linear.goal, group.linear.ease
    rebound = bodies.velocity.copy()
    _put(bodies.before, bodies, group)
    for at in range(group.counts[0]):
        if group.targets[at] > 0.0 and ease[at, 0] > 0.0:
            goal[at, 0] -= group.targets[at] / ease[at, 0]
        group.targets[at], impulses[at, 0], impulses[at, 1] = min(0.0, group.targets[at]), 0.0, 0.0
    _impulses(time, fastest, bodies, contacts, live, around, limits, group)
    if _gained(time, bodies.velocity, bodies, group) > 0.0:
        rebound = bodies.velocity.copy()
        _put(bodies.before, bodies, group)
    _mix(time, rebound, bodies, group)


@kernel()
def _end(time, bodies, contacts, live, around, limits, group):
    """Write the result of the impact: contacts under load, the shifts, and the next strike."""
    for c in group.members[: group.counts[0]]:
        rate, _ = _rates(c, time, bodies.velocity, bodies.acceleration, contacts)
        if live.moment[c] < np.inf:
            live.hits[c] += 1
        live.carries[c] = rate <= limits.threshold
        group.place[c] = -1
    for b in group.blocks[: group.counts[1]]:
        for a in range(3):
            bodies.shift[b, a] -= time * (bodies.velocity[b, a] - bodies.before[b, a])
            bodies.before[b, a] = bodies.velocity[b, a]
        bodies.last[b], group.among[b] = time, False
    start, listed = around.start, around.listed
    for b in group.blocks[: group.counts[1]]:
        _look_ahead(listed[start[b] : start[b + 1]], bodies, contacts, live, limits)


@kernel()
def _strike(first, bodies, contacts, live, around, limits, group):
    """Let a contact strike, and all that do with it; return the energy lost, J/m."""
    group.counts[:2] = 0
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
    first, at = -1, 0
    while at < live.number[0]:
        c = live.waiting[at]
        if live.moment[c] == np.inf:
            live.number[0] -= 1
            live.waiting[at], live.waits[c] = live.waiting[live.number[0]], False
        else:
            if first < 0 or live.moment[c] < live.moment[first]:
                first = c
            at += 1
    return first


@kernel()
def _contacts_of_blocks(contacts, mobility):
    """Return where the contacts of each block that can move begin (n + 1,), and these."""
    count = len(mobility)
    free = np.empty(count, np.bool_)
    for b in range(count):
        free[b] = _moves(b, mobility)
    first = np.zeros(count + 1, np.int64)
    for ends in (contacts.vertex_block, contacts.edge_block):
        for b in ends:
            first[b + 1] += free[b]
    for b in range(count):
        first[b + 1] += first[b]
    at, listed = first[:-1].copy(), np.empty(first[count], np.int64)
    for c in range(len(contacts.vertex_block)):
        for b in (contacts.vertex_block[c], contacts.edge_block[c]):
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
    accelerations = np.zeros((len(fixed), 2))
    square = acceleration[0] ** 2 + acceleration[1] ** 2
    for b in range(len(fixed)):
        if not fixed[b] and square > 0.0:
            along = force[b, 0] * acceleration[0] + force[b, 1] * acceleration[1]
            left = min(max(1.0 + along / (mass[b] * square), 0.0), 1.0)
            accelerations[b, 0], accelerations[b, 1] = (
                left * acceleration[0],
                left * acceleration[1],
            )
    return accelerations


@kernel()
def mobilities(mass_matrix, fixed):
    """Return the change of (u, v, r) of each block by an impulse, (n, 3, 3); 0 where ``fixed``."""
    mobility = np.zeros((len(fixed), 3, 3))
    for b in range(len(fixed)):
        if not fixed[b]:
            for a in range(3):
                mobility[b, a, a] = 1.0 / mass_matrix[b, a, a]
    return mobility


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
        np.array([0, 0, RENEWALS_PER_CONTACT_MAX * max(count, CONTACTS_COUNTED_MIN)]),
    )
    return after, shift, _strike_all(bodies, contacts, live, around, limits, group)


@kernel()
def _strike_all(bodies, contacts, live, around, limits, group):
    """Let all contacts strike that do, one after the other; return the energy lost, J/m."""
    bodies, live, around = borrowed(bodies), borrowed(live), borrowed(around)
    group = borrowed(group)
    _look_ahead(np.arange(len(live.carries)), bodies, contacts, live, limits)
    lost, first = 0.0, _earliest(live)
    while first >= 0 and group.counts[2] > 0:
        lost += _strike(first, bodies, contacts, live, around, limits, group)
        first = _earliest(live)
    return lost
