"""The path of a rock: flights, blows and stretches on the ground, to rest or out of the profile."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.model.model import Bools, Floats, Ints
from clast.trajectory.bearing import (
    open_pairs,
    scales,
    settle,
    step_length,
    step_to_touch,
    which_bear,
    which_slip,
)
from clast.trajectory.flight import flown, next_touch, window
from clast.trajectory.gaps import ON_SEGMENT, barrier_of, face_of, frame, touching
from clast.trajectory.ground import height_below
from clast.trajectory.impact import SLIDE, TAN, blow, contact_speeds, energy_of, total_energy

REST, LEFT, HELD, TIME = range(4)
"""How a path ends: at rest, out of the profile, held by a barrier, at the time limit."""
FLIES, BEARS, STOPS = range(3)
"""Next motion of a rock: it flies, moves in contact with the profile, or stops."""
START, BLOW, ON_GROUND, END = range(4)
"""Kinds of records; a start is that of the path, or of a flight off the ground."""
KIND, CLOCK, X, Y, ANGLE, BEFORE, AFTER, FACE, BARRIER, LOST = 0, 1, 2, 3, 4, 5, 8, 11, 12, 13
"""Columns of records (14): time, s, centroid, m, angle, rad, velocity and spin before and after (3
each), m/s and rad/s, segment, barrier, and energy lost in a blow, J."""
HEIGHT, TRANSLATION, ROTATION, TOTAL, FAST = range(5)
"""Columns of stations: height of the centroid above the profile, m, energies, J, speed, m/s."""
BY_BLOWS, BY_FRICTION, BY_ROLLING, BY_BARRIERS, HAD, KEPT = range(6)
"""Columns of the ledger: taken by blows, sliding, rolling, barriers, and kinetic plus potential
energy at the start and at the end, J."""
HIT_TIME, HIT_HEIGHT, HIT_ENERGY, HIT_SPEED, HIT_HELD = range(5)
"""Columns of hits of a barrier: first time, s, height above its foot, m, energy, J, speed, m/s,
whether it held the rock."""
GENTLE, BEARING = 1e-4, 1e-6
"""Speed up to which a rebound is none, and speed after a blow up to which a contact lasts, in units
of (radius gravity)^1/2."""
SLOW = 1e-6
"""Speed below which a rock in contact is at rest, in the same unit."""
STUCK = 1e-2
"""Speed, in the same unit, and movement, in units of speed and step, of a rock that is stuck."""
CALM = 10
"""Steps for which a rock is that slow before it is at rest."""
CREEP, LONG = 1e-3, 10.0
"""Speed, in the same unit, of a rock that creeps, and the time after which it counts as at rest, in
units of (radius/gravity)^1/2: one that is jammed between faces has forces that are found slowly."""


class Course(NamedTuple):
    """Records of a path while it goes on."""

    records: Floats
    """Starts, blows, stretches on the ground, ends, (most, 14)."""
    tally: Ints
    """Records, blows, way it ended, barrier that held it or -1, (4,)."""
    passed: Floats
    """Largest values at stations, nan where it never passed, (stations, 5)."""
    hits: Floats
    """First hit of each barrier, nan for none, (barriers, 5)."""
    broken: Bools
    """Barriers that it has gone through, (barriers,)."""
    ledger: Floats
    """Energies, (6,)."""
    largest: Floats
    """Largest values of the path, as at stations, (5,)."""
    clock: Floats
    """Time, and the limit of it, s, (2,)."""
    counter: Ints
    """Counter of random numbers, and the path's seed, (2,)."""


@kernel()
def measures_of(ground, rock, state):
    """Return the measured quantities of a rock: height above the profile, energies, speed."""
    moving, turning = energy_of(state[3:], rock)
    height = state[1] - height_below(ground, state[0], state[1])
    return height, moving, turning, moving + turning, np.hypot(state[3], state[4])


@kernel()
def keep_largest(largest, values):
    """Raise the largest values (5,) to others where these are more."""
    for j in range(len(values)):
        if not largest[j] >= values[j] and not np.isnan(values[j]):
            largest[j] = values[j]


@kernel()
def write(course, kind, state, before, face, barrier, lost):
    """Write a record, if there is room."""
    n = course.tally[0]
    if n < len(course.records):
        one = course.records[n]
        one[KIND], one[CLOCK] = kind, course.clock[0]
        one[X:BEFORE] = state[:3]
        one[BEFORE:AFTER], one[AFTER:FACE] = before[3:], state[3:]
        one[FACE], one[BARRIER], one[LOST] = face, barrier, lost
        course.tally[0] += 1


@kernel()
def pass_stations(ground, rock, course, state, after, gravity, span):
    """Record the measured quantities of a rock at the stations that it passes in a time span, s."""
    low, high = min(state[0], after[0]), max(state[0], after[0])
    first = np.searchsorted(ground.stations, low)
    for s in range(first, len(ground.stations)):
        place = ground.stations[s]
        if place > high:
            break
        if high == low:
            continue
        way, curve = place - state[0], 0.5 * gravity[0]
        root = np.sqrt(max(0.0, state[3] ** 2 + 4.0 * curve * way))
        below = state[3] + (root if after[0] > state[0] else -root)
        time = min(max(2.0 * way / below, 0.0), span) if below != 0.0 else 0.0
        keep_largest(course.passed[s], measures_of(ground, rock, flown(state, gravity, time)))


@kernel()
def is_out(ground, rock, state):
    """Return whether a rock has left the profile."""
    beside = state[0] < ground.box[0] or state[0] > ground.box[1]
    return beside or state[1] < ground.box[2] - 2.0 * rock.numbers[2]


@kernel()
def end_at(course, how):
    """Say how a path ends; return that it stops."""
    course.tally[2] = how
    return STOPS


@kernel()
def fly(ground, rock, course, state, gravity):
    """Fly to the next touch; return the next motion (a blow counts as flight)."""
    pull = np.hypot(gravity[0], gravity[1])
    while True:
        left = course.clock[1] - course.clock[0]
        span, pairs = window(ground, rock, state, pull, course.broken)
        span = min(span, left)
        time = next_touch(ground, rock, state, gravity, span, pairs)
        after = flown(state, gravity, min(time, span))
        if is_out(ground, rock, after) and not is_out(ground, rock, state):
            edge = ground.box[0] if after[0] < ground.box[0] else ground.box[1]
            if ground.box[0] <= after[0] <= ground.box[1]:
                edge = after[0]
            share = abs(edge - state[0]) / max(abs(state[3]), 1e-300)
            time = min(share, time, span) if edge != after[0] else min(time, span)
            after = flown(state, gravity, time)
            pass_stations(ground, rock, course, state, after, gravity, time)
            state[:] = after
            course.clock[0] += time
            return end_at(course, LEFT)
        course.clock[0] += min(time, span)
        pass_stations(ground, rock, course, state, after, gravity, min(time, span))
        if gravity[1] < 0.0 and state[4] > 0.0 > after[4]:  # the top of the parabola
            top = flown(state, gravity, -state[4] / gravity[1])
            keep_largest(course.largest, measures_of(ground, rock, top))
        state[:] = after
        if time <= span:
            return FLIES
        if span >= left:
            return end_at(course, TIME)


@kernel()
def meet_barrier(ground, rock, course, state, pairs):
    """Write down a hit; return whether the path stops, or goes on through the barrier."""
    for j in range(len(pairs)):
        kind, i, k = pairs[j]
        b = barrier_of(ground, kind, k)
        if b < 0:
            continue
        nx, ny, rx, ry, _gap, _margin = frame(ground, rock, state, kind, i, k)
        if nx * (state[3] - state[5] * ry) + ny * (state[4] + state[5] * rx) >= 0.0:
            continue
        energy, speed = total_energy(state[3:], rock), np.hypot(state[3], state[4])
        holds = energy <= ground.capacity[b]
        if np.isnan(course.hits[b, HIT_TIME]):
            face = k if kind == ON_SEGMENT else ground.beside[k, 0]
            rise = ground.way[face, 1] * ground.length[face]
            foot = ground.start[face, 1] + min(0.0, rise)
            above, held = state[1] + ry - foot, 1.0 if holds else 0.0
            course.hits[b] = course.clock[0], above, energy, speed, held
        if np.isinf(ground.capacity[b]):
            continue
        before = state.copy()
        taken = energy if holds else ground.capacity[b]
        course.ledger[BY_BARRIERS] += taken
        state[3:] *= 0.0 if holds else np.sqrt(1.0 - taken / energy)
        write(course, BLOW, state, before, -1, b, taken)
        if holds:
            course.tally[3] = b
            return end_at(course, HELD), True
        course.broken[b] = True
        return FLIES, True
    return FLIES, False


@kernel()
def strike(ground, rock, course, state, pairs, gentle):
    """Strike a rock where it touches; return its contacts (p, 13)."""
    before = state.copy()
    contacts, lost = blow(ground, rock, state, pairs, course.counter, gentle)
    course.ledger[BY_BLOWS] += lost
    course.tally[1] += 1
    kind, _i, k = pairs[0]
    seen = frame(ground, rock, state, kind, pairs[0, 1], k)
    face = face_of(ground, kind, k, seen[0], seen[1])
    write(course, BLOW, state, before, face, barrier_of(ground, kind, k), lost)
    keep_largest(course.largest, measures_of(ground, rock, before))
    keep_largest(course.largest, measures_of(ground, rock, state))
    return contacts


@kernel()
def is_stuck(rock, before, after, length, speed):
    """Return whether a step has moved a slow rock nowhere: its velocity was only turned round."""
    radius = rock.numbers[2]
    fast = np.hypot(before[3], before[4]) + radius * abs(before[5])
    moved = np.hypot(after[0] - before[0], after[1] - before[1]) + radius * abs(
        after[2] - before[2]
    )
    return fast <= STUCK * speed and moved <= STUCK * length * fast


@kernel()
def rests(rock, course, state, gravity, calm):
    """Return whether a rock in contact has come to rest, or creeps on: then it is stopped.

    ``calm`` counts slow steps, and says since when it is slow and since when it creeps, s.
    """
    unit, speed = scales(rock, gravity)
    fast = np.hypot(state[3], state[4]) + rock.numbers[2] * abs(state[5])
    calm[0] += 1.0
    if fast > SLOW * speed:
        calm[0], calm[1] = 0.0, course.clock[0]
    if fast > CREEP * speed:
        calm[2] = course.clock[0]
    if calm[0] >= CALM:
        course.clock[0] = calm[1]
        return True
    if course.clock[0] - calm[2] > LONG * unit:
        course.ledger[BY_FRICTION] += total_energy(state[3:], rock)
        state[3:] = 0.0
        return True
    return False


@kernel()
def bear(ground, rock, course, state, gravity, pairs, contacts):
    """Slide and roll with contacts that last; return the next motion."""
    _unit, speed = scales(rock, gravity)
    contacts[:, TAN] = contacts[:, SLIDE]
    slipping = np.zeros(len(pairs), np.bool_)
    for j in range(len(pairs)):
        slipping[j] = abs(contact_speeds(contacts[j], state[3:])[1]) > BEARING * speed
    calm, way = np.array([0.0, course.clock[0], course.clock[0]]), 0.0
    write(course, ON_GROUND, state, state, -1, -1, 0.0)
    while len(pairs):
        if course.clock[0] >= course.clock[1]:
            return end_at(course, TIME)
        length = step_length(rock, state, gravity, pairs)
        reach = length * (np.hypot(state[3], state[4]) + length * np.hypot(gravity[0], gravity[1]))
        others = open_pairs(ground, rock, state, pairs, course.broken, reach)
        after, sliding, rolling, length, touches = step_to_touch(
            ground, rock, state, gravity, (pairs, contacts, slipping), length, others
        )
        slipping = which_slip(contacts, slipping, after)
        course.ledger[BY_FRICTION] += sliding + settle(ground, rock, after, pairs, contacts)
        course.ledger[BY_ROLLING] += rolling
        pull = (after[3:5] - state[3:5]) / length if length > 0.0 else 0.0 * gravity
        pass_stations(ground, rock, course, state, after, pull, length)
        way += np.hypot(after[0] - state[0], after[1] - state[1])
        if is_stuck(rock, state, after, length, speed):
            course.ledger[BY_FRICTION] += total_energy(after[3:], rock)
            after[3:] = 0.0
        state[:] = after
        course.clock[0] += length
        keep_largest(course.largest, measures_of(ground, rock, state))
        if is_out(ground, rock, state):
            return end_at(course, LEFT)
        if way > rock.numbers[2]:
            write(course, ON_GROUND, state, state, -1, -1, 0.0)
            way = 0.0
        if touches:
            return FLIES
        if rests(rock, course, state, gravity, calm):
            return end_at(course, REST)
        stay = which_bear(ground, rock, state, pairs, contacts)
        if not stay.all():
            pairs, contacts, slipping = pairs[stay], contacts[stay], slipping[stay]
    write(course, START, state, state, -1, -1, 0.0)
    return FLIES


@kernel()
def potential(rock, state, gravity):
    """Return the energy of a rock in the field of gravity, J."""
    return -rock.numbers[0] * (gravity[0] * state[0] + gravity[1] * state[1])


@kernel()
def follow(ground, rock, course, state, gravity):
    """Follow a rock from a state (6,), which becomes its last, to the end of its path."""
    speed = scales(rock, gravity)[1]
    course.ledger[HAD] = potential(rock, state, gravity) + total_energy(state[3:], rock)
    keep_largest(course.largest, measures_of(ground, rock, state))
    write(course, START, state, state, -1, -1, 0.0)
    onward = FLIES
    while onward != STOPS:
        onward = fly(ground, rock, course, state, gravity)
        while onward == FLIES:
            pairs = touching(ground, rock, state, course.broken)
            if not len(pairs):
                break
            onward, met = meet_barrier(ground, rock, course, state, pairs)
            if met:
                break
            contacts = strike(ground, rock, course, state, pairs, GENTLE * speed)
            rates = np.empty(len(pairs))
            for j in range(len(pairs)):
                rates[j] = contact_speeds(contacts[j], state[3:])[0]
            # without gravity, the rounding of the speed is what is left of a contact that lasts
            fast = np.hypot(state[3], state[4]) + rock.numbers[2] * abs(state[5])
            lasting = BEARING * max(speed, SLOW * fast)
            if rates.min() < -lasting:
                continue  # the contacts go on striking each other
            bears = rates <= lasting
            if not bears.any():
                break
            onward = bear(ground, rock, course, state, gravity, pairs[bears], contacts[bears])
    before = state.copy()
    write(course, END, state, before, -1, -1, 0.0)
    course.ledger[KEPT] = potential(rock, state, gravity) + total_energy(state[3:], rock)
