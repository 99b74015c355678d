"""Free flight: a parabola and a constant spin, to the next touch.

The gap of a pair is a sum of a parabola and a sine.  Within a window of time its second derivative
is at most M, so from a gap g and its rate r it cannot reach zero before the positive root of
g + r s - M s^2/2: a step of this length never passes a touch, and such steps converge to it
quadratically (a Newton's method from one side), linearly to one that grazes.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.trajectory.gaps import ON_SEGMENT, frame, is_before, pairs_within, tolerances
from clast.trajectory.ground import distance_to

STEPS = 10_000
"""Steps to a touch, at most: a bound that only a gap of no size could meet."""


@kernel()
def flown(state, gravity, time):
    """Return the state (6,) of a rock that has flown for a time, s."""
    moved = state.copy()
    for axis in range(2):
        moved[axis] += time * (state[3 + axis] + 0.5 * time * gravity[axis])
        moved[3 + axis] += time * gravity[axis]
    moved[2] += time * state[5]
    return moved


@kernel()
def time_for(way, speed, pull):
    """Return the time in which nothing moves farther than ``way``, m; pull is |g|, m/s2."""
    if pull > 0.0:
        return 2.0 * way / (speed + np.sqrt(speed * speed + 2.0 * pull * way))
    return way / speed if speed > 0.0 else np.inf


@kernel()
def rate_of(ground, state, kind, k, seen):
    """Return the rate of a gap, m/s; ``seen`` is the pair's frame."""
    nx, ny, rx, ry, _gap, _margin = seen
    return nx * (state[3] - state[5] * ry) + ny * (state[4] + state[5] * rx)


@kernel()
def bend_of(ground, rock, state, gravity, pair, span):
    """Return the largest second derivative of a gap within a span of time, m/s2."""
    kind, i, k = pair
    spin = abs(state[5])
    if kind == ON_SEGMENT:
        pull = abs(ground.normal[k, 0] * gravity[0] + ground.normal[k, 1] * gravity[1])
        return pull + spin * spin * np.hypot(rock.corners[i, 0], rock.corners[i, 1])
    pull = np.hypot(gravity[0], gravity[1])
    speed = np.hypot(state[3], state[4]) + pull * span
    apart = np.hypot(ground.corner[k, 0] - state[0], ground.corner[k, 1] - state[1])
    return pull + spin * spin * (apart + speed * span) + 2.0 * spin * speed


@kernel()
def first_touch(ground, rock, state, gravity, pair, span):
    """Return the time until a pair touches, s; infinity where it does not within the span."""
    kind, i, k = pair
    exact, touch = tolerances(ground, rock)
    bend = bend_of(ground, rock, state, gravity, pair, span)
    if bend == 0.0:
        bend = 1e-300
    time = 0.0
    for _ in range(STEPS):
        there = flown(state, gravity, time)
        seen = frame(ground, rock, there, kind, i, k)
        gap, rate = seen[4], rate_of(ground, there, kind, k, seen)
        if gap <= exact and gap > -touch and rate < 0.0:
            if seen[5] >= -touch and is_before(ground, there, kind, k, seen[0], seen[1]):
                # a last step of Newton's method; not back to where a gap that closes again opened
                return time - gap / rate if gap > -exact else time
        closing = gap > exact and rate < 0.0
        if gap < -exact:
            rate = -rate
        elif gap <= exact:
            rate = abs(rate)
        size = abs(gap) if abs(gap) > exact else 0.0
        root = np.sqrt(rate * rate + 2.0 * bend * size)
        # the same root of both forms, each without cancellation
        step = 2.0 * size / (root - rate) if rate < 0.0 else (rate + root) / bend
        if not closing:
            step = max(step, np.sqrt(2.0 * exact / bend))
        time += step
        if time > span:
            return np.inf
    return time


@kernel()
def window(ground, rock, state, pull, broken):
    """Return a span of time, s, and the pairs (p, 3) that may touch within it."""
    radius, near = rock.numbers[2], np.inf
    speed = np.hypot(state[3], state[4])
    for k in range(len(ground.length)):
        b = ground.barrier[k]
        if b < 0 or not broken[b]:
            near = min(near, distance_to(ground, k, state[0], state[1]))
    if near - radius > radius:
        return time_for(near - radius, speed, pull), np.empty((0, 3), np.int64)
    reach = 2.0 * radius
    return time_for(reach, speed, pull), pairs_within(ground, rock, state, broken, reach)


@kernel()
def next_touch(ground, rock, state, gravity, span, pairs):
    """Return the time of the first touch of any pair within a span, s; infinity for none."""
    first = np.inf
    for p in range(len(pairs)):
        time = first_touch(ground, rock, state, gravity, pairs[p], min(span, first))
        first = min(first, time)
    return first
