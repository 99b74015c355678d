"""Blows of a rigid rock: Newton's restitution, Coulomb's friction, tangential restitution.

At a contact with the velocity (u_n, u_t) and the impulse (N, T), of an arm (r_n, r_t) about the
centroid,

    u_n' = u_n + a N + b T,     u_t' = u_t + b N + c T
    u_n' >= -R_n u_n,  N >= 0;  T = (1 - R_t) T_s within +- N tan(phi)

with T_s the impulse that stops the slip (Routh 1905, Dynamics of a system of rigid bodies).
Newton's law may create energy where friction turns a slip round; the impulse is then mixed with the
plastic one without friction so far that none is (Stronge 2000, Impact mechanics, chapter 3).
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.trajectory.gaps import barrier_of, face_of, frame, place_along
from clast.trajectory.ground import (
    ARM,
    FRICTION,
    RESTITUTION,
    ROUGHNESS,
    SLIDING,
    SPACING,
    SPEED,
    STICKING,
)
from clast.trajectory.random_numbers import drawn, normal, stream, uniform

NX, NY, RX, RY, NORMAL_TARGET, SLIP_TARGET, STICKS, TAN, SLIDE, ROLL, N, T, MOMENT = range(13)
"""Columns of contacts: normal, arm, m, velocities to be reached, m/s, share of the sticking
impulse, tan(phi), that of sliding, moment arm of rolling resistance, m, impulses, N s, and its
moment, N m s."""
SWEEPS = 400
"""Sweeps over contacts that touch at a time, at most."""
REDRAWN = 8
"""Faces of a rough surface that a corner may strike at a time before it strikes the mean one."""
FLATTEST = 0.02
"""Share of the speed that approaches a turned face, at least: the others are not struck."""


@kernel()
def one_contact(gain, slip, a, b, c, sticks, tan):
    """Return N and T that change the velocities of a contact by gain (at least) and slip, m/s."""
    if gain <= 0.0:
        return 0.0, 0.0
    n = (gain - sticks * b * slip / c) / (a - sticks * b * b / c)
    t = sticks * (slip - b * n) / c
    if n >= 0.0 and abs(t) <= tan * n:
        return n, t
    for sign in (1.0, -1.0):
        along = a + sign * tan * b
        if along > 0.0:
            n = gain / along
            if sign * sticks * (slip - b * n) / c >= tan * n:
                return n, sign * tan * n
    n = gain / a
    return n, min(max(sticks * (slip - b * n) / c, -tan * n), tan * n)


@kernel()
def solve(contacts, velocity, inverse, spin_target):
    """Set the impulses of contacts (p, 13) and add the change that they cause to the velocity (3,).

    ``inverse`` is 1/m and 1/I.  Contacts take turns until none changes (block Gauss-Seidel);
    return whether they came to that.
    """
    change, size = 0.0, 0.0
    for _ in range(SWEEPS):
        change, size = 0.0, np.abs(velocity[:2]).sum() * 1e-15
        for j in range(len(contacts)):
            one = contacts[j]
            nx, ny = one[NX], one[NY]
            jn, jt = one[RX] * ny - one[RY] * nx, -one[RX] * nx - one[RY] * ny
            a = inverse[0] + inverse[1] * jn * jn
            b, c = inverse[1] * jn * jt, inverse[0] + inverse[1] * jt * jt
            un = nx * velocity[0] + ny * velocity[1] + jn * velocity[2]
            ut = ny * velocity[0] - nx * velocity[1] + jt * velocity[2]
            free_n = un - a * one[N] - b * one[T]
            free_t = ut - b * one[N] - c * one[T]
            n, t = one_contact(
                one[NORMAL_TARGET] - free_n,
                one[SLIP_TARGET] - free_t,
                a,
                b,
                c,
                one[STICKS],
                one[TAN],
            )
            dn, dt = n - one[N], t - one[T]
            one[N], one[T] = n, t
            velocity[0] += inverse[0] * (nx * dn + ny * dt)
            velocity[1] += inverse[0] * (ny * dn - nx * dt)
            velocity[2] += inverse[1] * (jn * dn + jt * dt)
            bound = one[ROLL] * n
            moment = one[MOMENT] + (spin_target - velocity[2]) / inverse[1]
            moment = min(max(moment, -bound), bound)
            velocity[2] += inverse[1] * (moment - one[MOMENT])
            change += (abs(dn) + abs(dt)) * inverse[0] + abs(moment - one[MOMENT]) * inverse[1]
            one[MOMENT] = moment
        if change <= size or (len(contacts) == 1 and contacts[0, ROLL] == 0.0):
            return True
    return change <= 1e6 * size


@kernel()
def contact_speeds(one, velocity):
    """Return the velocity of a contact (13,) along its normal and its tangent, m/s."""
    nx, ny = one[NX], one[NY]
    un = nx * velocity[0] + ny * velocity[1] + (one[RX] * ny - one[RY] * nx) * velocity[2]
    ut = ny * velocity[0] - nx * velocity[1] - (one[RX] * nx + one[RY] * ny) * velocity[2]
    return un, ut


@kernel()
def energy_of(velocity, rock):
    """Return the kinetic energy of a velocity (3,): translation and rotation, J."""
    mass, inertia = rock.numbers[0], rock.numbers[1]
    return (
        0.5 * mass * (velocity[0] ** 2 + velocity[1] ** 2),
        0.5 * inertia * velocity[2] ** 2,
    )


@kernel()
def total_energy(velocity, rock):
    """Return the kinetic energy of a velocity (3,), J."""
    moving, turning = energy_of(velocity, rock)
    return moving + turning


@kernel()
def face_turn(decks, place, counter):
    """Return the angle by which a rough face is turned at a place along the profile, rad.

    ``decks`` (8, DECK) are those of its surface.  Facets have one angle in all blows of a path; the
    first begins at random, so blows at a distance d strike the same one with the chance 1 - d/s.
    """
    spacing = decks[SPACING, 0]
    if spacing > 0.0:
        seed, kind = counter[1], 1e6 * spacing  # other facets for each length
        facet = np.floor(place / spacing + uniform(stream(seed, kind, 0)))
        counter = stream(seed, kind, 1 + facet)
    return drawn(decks[ROUGHNESS], counter) * normal(counter)


@kernel()
def drawn_contacts(ground, rock, state, pairs, counter, rough, gentle):
    """Return the contacts (p, 13) of pairs that touch, with properties of their surfaces, drawn.

    ``rough`` multiplies the angles of rough faces.  Rebounds slower than ``gentle``, m/s, are none:
    they would follow each other ever faster without end.
    """
    contacts = np.zeros((len(pairs), 13))
    for j in range(len(pairs)):
        kind, i, k = pairs[j]
        nx, ny, rx, ry, _gap, _margin = frame(ground, rock, state, kind, i, k)
        decks = ground.decks[ground.surface[face_of(ground, kind, k, nx, ny)]]
        one = contacts[j]
        one[NX], one[NY], one[RX], one[RY] = nx, ny, rx, ry
        if len(pairs) == 1 and barrier_of(ground, kind, k) < 0 and decks[ROUGHNESS, -1] > 0.0:
            turn = rough * face_turn(decks, place_along(ground, state, pairs[j], rx, ry), counter)
            c, s = np.cos(turn), np.sin(turn)
            one[NX], one[NY] = c * nx - s * ny, s * nx + c * ny
            un, ut = contact_speeds(one, state[3:])
            if not -un > FLATTEST * abs(ut):
                one[NX], one[NY] = nx, ny
        un, _ut = contact_speeds(one, state[3:])
        fast = un / drawn(decks[SPEED], counter)
        restitution = drawn(decks[RESTITUTION], counter) / (1.0 + fast * fast)
        one[NORMAL_TARGET] = -restitution * un if -restitution * un > gentle else 0.0
        one[STICKS] = drawn(decks[STICKING], counter)
        one[TAN] = drawn(decks[FRICTION], counter)
        one[SLIDE] = drawn(decks[SLIDING], counter)
        one[ROLL] = drawn(decks[ARM], counter)
    return contacts


@kernel()
def without_gain(rock, contacts, before, after, inverse, solved):
    """Return a velocity (3,) of at most the energy of that before the blow, mixed if it must be.

    Contacts that were not ``solved`` strike without friction and rebound, which always has an end.
    """
    had, has = total_energy(before, rock), total_energy(after, rock)
    if has <= had and solved:
        return after
    plastic, velocity = contacts.copy(), before.copy()
    plastic[:, N:] = 0.0
    plastic[:, NORMAL_TARGET] = np.minimum(0.0, plastic[:, NORMAL_TARGET])
    plastic[:, TAN] = 0.0
    plastic[:, ROLL] = 0.0
    solve(plastic, velocity, inverse, 0.0)
    least = total_energy(velocity, rock)
    way = after - velocity
    square = total_energy(way, rock)
    if square <= 1e-24 * had or not solved:
        contacts[:, N:] = plastic[:, N:]
        return velocity
    half = 0.5 * (has - least - square)
    share = (np.sqrt(half * half + square * max(0.0, had - least)) - half) / square
    contacts[:, N:] = plastic[:, N:] + share * (contacts[:, N:] - plastic[:, N:])
    return velocity + share * way


@kernel()
def blow(ground, rock, state, pairs, counter, gentle):
    """Strike a rock at the pairs that touch: change its velocity, return contacts and loss, J."""
    inverse = 1.0 / rock.numbers[:2]
    lost = 0.0
    contacts = drawn_contacts(ground, rock, state, pairs, counter, 1.0, gentle)
    for again in range(REDRAWN):
        before = state[3:].copy()
        velocity = before.copy()
        solved = solve(contacts, velocity, inverse, 0.0)
        velocity = without_gain(rock, contacts, before, velocity, inverse, solved)
        mean = 0.5 * (before + velocity)
        closing = False
        for j in range(len(contacts)):
            un, ut = contact_speeds(contacts[j], mean)
            lost -= contacts[j, N] * un + contacts[j, T] * ut + contacts[j, MOMENT] * mean[2]
        state[3:] = velocity
        for j in range(len(contacts)):
            kind, i, k = pairs[j]
            nx, ny, _rx, _ry, _gap, _margin = frame(ground, rock, state, kind, i, k)
            turned = nx != contacts[j, NX] or ny != contacts[j, NY]
            contacts[j, NX], contacts[j, NY] = nx, ny
            closing = closing or (turned and contact_speeds(contacts[j], velocity)[0] < 0.0)
        if not closing:
            break
        last = again + 2 >= REDRAWN
        rough = 0.0 if last else 1.0
        contacts = drawn_contacts(ground, rock, state, pairs, counter, rough, gentle)
    return contacts, lost
