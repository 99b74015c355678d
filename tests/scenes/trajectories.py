"""Paths of single rocks, for tests of clast.trajectory."""

from collections.abc import Sequence

import numpy as np

from clast.trajectory import ground as grounds
from clast.trajectory import path
from clast.trajectory.rock import Rock, rock_of

SQUARE = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
FLOOR = [(-50.0, 0.0), (50.0, 0.0)]


def surface(
    restitution: float,
    friction: float = 1e9,
    tangential: float = 0.0,
    arm: float = 0.0,
    roughness: float = 0.0,
    spacing: float = 0.0,
) -> list[float]:
    """Rows of the deck of a surface of constants; ``friction`` is tan(phi)."""
    return [restitution, 1.0 - tangential, friction, friction, arm, roughness, np.inf, spacing]


def regular(count: int, radius: float = 0.5) -> list[tuple[float, float]]:
    """A regular polygon, its first edge below and level."""
    angle = -0.5 * np.pi + np.pi * (2.0 * np.arange(count) + 1.0) / count
    return [(float(radius * np.cos(a)), float(radius * np.sin(a))) for a in angle]


def ledger_error(course: path.Course) -> float:
    """What a ledger leaves open, as a share of the energy at the start."""
    taken = course.ledger[:4].sum() + course.ledger[path.KEPT]
    return float(abs(course.ledger[path.HAD] - taken) / max(abs(course.ledger[path.HAD]), 1.0))


def followed(
    state: Sequence[float],
    *,
    profile: Sequence[tuple[float, float]] = FLOOR,
    rows: Sequence[Sequence[float]] = (surface(0.0),),
    corners: Sequence[tuple[float, float]] = SQUARE,
    gravity: tuple[float, float] = (0.0, -9.8),
    limit: float = 300.0,
    faces: Sequence[grounds.Face] = (),
    capacity: Sequence[float] = (),
    stations: Sequence[float] = (),
    seed: int = 1,
) -> tuple[path.Course, np.ndarray, Rock]:
    """Follow a rock; its surfaces are one for all segments, or one for each."""
    count = len(profile) - 1
    decks = np.repeat(np.array(rows, float)[:, :, None], grounds.DECK, axis=2)
    numbers = list(range(count)) if len(rows) >= count else [0] * count
    line = grounds.Face(points=np.array(profile, float), surface=numbers)
    ground = grounds.ground_of(
        line, faces, decks, np.array(capacity, float), np.array(stations, float)
    )
    rock, last = rock_of(np.array(corners, float), 2500.0, 1.0), np.array(state, float)
    course = path.Course(
        records=np.zeros((20000, 14)),
        tally=np.array([0, 0, -1, -1]),
        passed=np.full((len(stations), 5), np.nan),
        hits=np.full((len(capacity), 5), np.nan),
        broken=np.zeros(len(capacity), np.bool_),
        ledger=np.zeros(6),
        largest=np.full(5, np.nan),
        clock=np.array([0.0, limit]),
        counter=np.array([seed, seed], np.uint64),
    )
    path.follow(ground, rock, course, last, np.array(gravity, float))
    return course, last, rock
