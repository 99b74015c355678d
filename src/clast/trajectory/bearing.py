"""A rock in contact with the profile: it slides, rolls over its corners, or comes to rest.

A step of length h takes the mean velocity w = (v + v')/2 for which contacts do not close, friction
is within Coulomb's bound and rolling resistance within its moment, with contacts as they are half
way.  The arm of a corner is shortened by sin(q/2)/(q/2), q the turn of the step: a corner that
neither closes nor slips is then exactly where it was, and as gravity works on h w, the energy of
the step is kept but for the work of friction (Simo, Tarnow and Wong 1992, energy-momentum methods).
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.trajectory.gaps import ON_SEGMENT, frame, is_before, pairs_within, tolerances
from clast.trajectory.impact import (
    MOMENT,
    NORMAL_TARGET,
    NX,
    NY,
    RX,
    RY,
    SLIP_TARGET,
    STICKS,
    TAN,
    N,
    T,
    contact_speeds,
    solve,
    total_energy,
)

FINE, COARSE = 0.01, 0.1
"""Steps of a rock that turns, and of one that slides flat, in units of (radius/gravity)^1/2."""
STILL = 1e-12
"""Spin of a rock that slides flat, in units of (gravity/radius)^1/2."""
TURNS = 5
"""Iterations for the turn of a step."""
DRIFT = 0.2
"""Share of a gap that a step takes back where an edge rolls over a corner of the profile."""
ROOTS = 60
"""Iterations for the time of a touch, at most."""


@kernel()
def scales(rock, gravity):
    """Return the time (radius/gravity)^1/2, s, and the speed (radius gravity)^1/2, m/s."""
    pull = np.hypot(gravity[0], gravity[1])
    if pull == 0.0:
        return np.inf, 0.0
    return np.sqrt(rock.numbers[2] / pull), np.sqrt(rock.numbers[2] * pull)


@kernel()
def lies_flat(pairs):
    """Return whether two corners of a rock are on one segment."""
    return len(pairs) == 2 and (pairs[:, 0] == ON_SEGMENT).all() and pairs[0, 2] == pairs[1, 2]


@kernel()
def settle(ground, rock, state, pairs, contacts):
    """Let a rock that both its corners carry move along their segment alone; return the loss, J.

    A step holds its mean velocity to the segment; the rest of it would change its sign for ever.
    """
    if not lies_flat(pairs) or contacts[:, N].min() <= 0.0:
        return 0.0
    before, way = total_energy(state[3:], rock), ground.way[pairs[0, 2]]
    along = state[3] * way[0] + state[4] * way[1]
    state[3], state[4], state[5] = along * way[0], along * way[1], 0.0
    return before - total_energy(state[3:], rock)


@kernel()
def step_length(rock, state, gravity, pairs):
    """Return the length of the next step, s."""
    unit, _speed = scales(rock, gravity)
    radius = rock.numbers[2]
    if lies_flat(pairs) and abs(state[5]) * unit <= STILL:
        length = COARSE * unit
    else:
        length = FINE * unit / (1.0 + (abs(state[5]) * unit if np.isfinite(unit) else 0.0))
    speed = np.hypot(state[3], state[4]) + radius * abs(state[5])
    return min(length, 0.5 * radius / speed) if speed > 0.0 else length


@kernel()
def stepped(ground, rock, state, gravity, bearing, length):
    """Return the state (6,) after a step, and the work of friction and of rolling resistance, J.

    ``bearing`` is the pairs (p, 3) in contact, their contacts (p, 13), and which of them slip (p,).
    """
    pairs, contacts, slipping = bearing
    inverse = 1.0 / rock.numbers[:2]
    start = state[3:].copy()
    start[:2] += 0.5 * length * gravity
    mean, half = state[3:].copy(), state.copy()
    for _ in range(TURNS):
        half[:3] = state[:3] + 0.5 * length * mean
        turn = 0.5 * length * mean[2]
        shorter = np.sin(turn) / turn if turn != 0.0 else 1.0
        for j in range(len(pairs)):
            kind, i, k = pairs[j]
            nx, ny, rx, ry, _gap, _margin = frame(ground, rock, half, kind, i, k)
            one = contacts[j]
            one[STICKS] = 1.0
            if kind == ON_SEGMENT:
                rx, ry = shorter * rx, shorter * ry
                one[NORMAL_TARGET] = 0.0
            else:
                gap = frame(ground, rock, state, kind, i, k)[4]
                one[NORMAL_TARGET] = -DRIFT * gap / length if length > 0.0 else 0.0
            one[NX], one[NY], one[RX], one[RY] = nx, ny, rx, ry
            one[SLIP_TARGET] = 0.5 * contact_speeds(one, state[3:])[1] if slipping[j] else 0.0
            one[N], one[T], one[MOMENT] = 0.0, 0.0, 0.0
        before = mean[2]
        mean = start.copy()
        solve(contacts, mean, inverse, 0.5 * state[5])
        if abs(mean[2] - before) <= 1e-15 * abs(before):
            break
    sliding, rolling = 0.0, 0.0
    for j in range(len(pairs)):
        un, ut = contact_speeds(contacts[j], mean)
        sliding -= 2.0 * (contacts[j, N] * un + contacts[j, T] * ut)
        rolling -= 2.0 * contacts[j, MOMENT] * mean[2]
    after = state.copy()
    after[:3] += length * mean
    after[3:] = 2.0 * mean - state[3:]
    return after, sliding, rolling


@kernel()
def open_pairs(ground, rock, state, pairs, broken, reach):
    """Return the pairs (p, 3) that may touch in a step but do not bear."""
    touch = tolerances(ground, rock)[1]
    near = pairs_within(ground, rock, state, broken, reach)
    count = 0
    for p in range(len(near)):
        known = False
        for j in range(len(pairs)):
            known = known or (near[p] == pairs[j]).all()
        if not known and frame(ground, rock, state, near[p, 0], near[p, 1], near[p, 2])[4] > -touch:
            near[count] = near[p]
            count += 1
    return near[:count]


@kernel()
def least_gap(ground, rock, state, pairs):
    """Return the least gap of pairs whose parts are beside each other, m."""
    least = np.inf
    for p in range(len(pairs)):
        kind, i, k = pairs[p]
        seen = frame(ground, rock, state, kind, i, k)
        if seen[5] < 0.0 or seen[4] >= least:
            continue
        if is_before(ground, state, kind, k, seen[0], seen[1]):
            least = seen[4]
    return least


@kernel()
def step_to_touch(ground, rock, state, gravity, bearing, length, others):
    """Return a step as ``stepped`` does, cut where another pair touches, with its length."""
    exact, touch = tolerances(ground, rock)
    after, sliding, rolling = stepped(ground, rock, state, gravity, bearing, length)
    above, below = least_gap(ground, rock, state, others), least_gap(ground, rock, after, others)
    if below >= -touch:
        return after, sliding, rolling, length, False
    # one that opens, but has not left what counts as a touch, touches when it is there again
    level = above if above < -exact else 0.0
    above, below = above - level, below - level
    low, high = 0.0, length
    for _ in range(ROOTS):
        # regula falsi (Illinois), or the middle where parts are not beside each other yet
        way = above / (above - below) if 0.0 < above < np.inf else 0.5
        cut = low + (high - low) * min(max(way, 1e-3), 1.0 - 1e-3)
        after, sliding, rolling = stepped(ground, rock, state, gravity, bearing, cut)
        gap = least_gap(ground, rock, after, others) - level
        if abs(gap) <= exact:
            return after, sliding, rolling, cut, True
        if gap < 0.0:
            high, below, above = cut, gap, 0.5 * above
        else:
            low, above, below = cut, gap, 0.5 * below
    after, sliding, rolling = stepped(ground, rock, state, gravity, bearing, low)
    return after, sliding, rolling, low, True


@kernel()
def which_slip(contacts, was, velocity):
    """Return which contacts slip after a step: those at Coulomb's bound."""
    slips = was.copy()
    for j in range(len(contacts)):
        bound = contacts[j, TAN] * contacts[j, N]
        slips[j] = abs(contacts[j, T]) >= bound * (1.0 - 1e-12) and bound > 0.0
    return slips


@kernel()
def which_bear(ground, rock, state, pairs, contacts):
    """Return which pairs go on to bear after a step: those that neither open nor end."""
    touch = tolerances(ground, rock)[1]
    stay = np.ones(len(pairs), np.bool_)
    for j in range(len(pairs)):
        kind, i, k = pairs[j]
        seen = frame(ground, rock, state, kind, i, k)
        opens = contacts[j, N] <= 0.0 and seen[4] > touch
        stay[j] = seen[5] >= -touch and not opens
    return stay
