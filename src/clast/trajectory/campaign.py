"""Many paths over one profile: sources of rocks, and the path of each by its number.

All that a path is follows from the seed and its number: no digit depends on who follows it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.model.distributions import Distribution
from clast.model.model import Floats, Ints
from clast.trajectory import path as paths
from clast.trajectory.ground import DECK, Ground, height_below
from clast.trajectory.rock import Rock, moments, random_polygon, rock_of
from clast.trajectory.standing import Blocks

RECORDS = 2_000
"""Room for the records of a path; one with more is followed again with four times the room."""
CLEAR = 1e-3
"""Height above the profile to which a rock that would stand in it is raised, in its size."""
ENDS = ("rest", "out", "held", "time")
"""How paths end, in the order of their numbers in ``path``."""


def deck_of(value: Distribution | float) -> Floats:
    """Return the values (DECK,) that are drawn of a distribution, or a constant as often."""
    if not isinstance(value, Distribution):
        return np.full(DECK, float(value))
    shares = (np.arange(DECK) + 0.5) / DECK
    return np.array([float(value.quantile(float(p))) for p in shares])  # type: ignore[arg-type]


@dataclass(frozen=True, kw_only=True)
class Source:
    """Where rocks start, and their properties; decks (DECK,) are the values that are drawn."""

    name: str
    line: Floats
    """Its ends, m, (2, 2): rocks start anywhere between them."""
    count: int
    velocity: tuple[Floats, Floats]
    """Decks of the velocity, m/s."""
    spin: Floats
    """Deck of the spin, counter-clockwise, rad/s."""
    volume: Floats
    """Deck of the volume, m3."""
    density: Floats
    """Deck of the density, kg/m3."""
    thickness: float | None
    """Length out of the plane, m; the cube root of the volume where it is None."""
    corners: Floats
    """Deck of the number of corners."""
    elongation: Floats
    """Deck of the ratio of the axes."""
    shape: Floats | None
    """Polygon of all its rocks, any size, (n, 2); random ones where it is None."""
    blocks: Blocks | None = None
    """Blocks that its rocks are, in turns, as they move; line and decks are then of no use."""


@dataclass(frozen=True, kw_only=True)
class Begun:
    """A rock before it moves."""

    source: str
    rock: Rock
    volume: float
    state: Floats
    """Its state at the start, (6,)."""
    seed: int
    """Seed of the numbers drawn on its way."""


@dataclass(frozen=True, kw_only=True)
class Path:
    """A path that was followed."""

    begun: Begun
    course: paths.Course
    state: Floats
    """Its last state, (6,)."""

    @property
    def rock(self) -> Rock:
        """The rock."""
        return self.begun.rock


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """A profile, its sources and all that is measured of their rocks."""

    ground: Ground
    origin: Floats
    """Place of the ground's origin, m, (2,): coordinates are about it."""
    profile: Floats
    """Points of the profile, m, (k + 1, 2), about the origin."""
    surfaces: tuple[str, ...]
    """Names of surfaces, those of barriers last."""
    barriers: tuple[str, ...]
    barrier_lines: Floats
    """Foot and top of each barrier, m, (b, 2, 2)."""
    stations: tuple[str, ...]
    """Name of each station of the ground: that of a collector or a barrier, or ""."""
    blocks: Blocks | None
    """Blocks that stand; None where there are none."""
    face_block: Ints
    """Which of them each segment of the ground is on, -1 for none, (k,)."""
    sources: tuple[Source, ...]
    gravity: Floats
    """Acceleration of gravity, m/s2, (2,)."""
    seed: int
    time_limit: float
    """Time after which a path ends, s."""

    @property
    def count(self) -> int:
        """How many paths there are."""
        return sum(source.count for source in self.sources)

    def block_of(self, face: int) -> str:
        """Return the block that a segment is on, "" for none; -1 is no segment."""
        number = self.face_block[face] if face >= 0 else -1
        return "" if self.blocks is None or number < 0 else self.blocks.name[number]

    def source_of(self, number: int) -> tuple[Source, int]:
        """Return the source of a path, from 1, and its number there, from 0."""
        for source in self.sources:
            if number <= source.count:
                break
            number -= source.count
        return source, number - 1

    def begin(self, number: int) -> Begun:
        """Return the rock of a path, from 1, before it moves."""
        rng = np.random.Generator(np.random.Philox(key=[self.seed, number]))
        source, among = self.source_of(number)
        if source.blocks is None:
            rock, volume, state = self._drawn(source, rng)
        else:
            rock, volume, state = block_as_rock(source, among % len(source.blocks.name))
        state[1] += lift(self.ground, rock, state[:2])
        seed = int(rng.integers(2**63))
        return Begun(source=source.name, rock=rock, volume=volume, state=state, seed=seed)

    def follow(self, number: int) -> Path:
        """Return the path with a number, from 1."""
        begun, room = self.begin(number), RECORDS
        while True:
            course, last = self._course(begun.seed, room), begun.state.copy()
            paths.follow(self.ground, begun.rock, course, last, self.gravity)
            if course.tally[0] < room:
                return Path(begun=begun, course=course, state=last)
            room *= 4

    @staticmethod
    def _drawn(source: Source, rng: np.random.Generator) -> tuple[Rock, float, Floats]:
        """Return a random rock of a source, its volume, m3, and its state at the start, (6,)."""

        def drawn(deck: Floats) -> float:
            return float(deck[int(rng.random() * DECK)])

        volume, density = drawn(source.volume), drawn(source.density)
        thickness = source.thickness or volume ** (1.0 / 3.0)
        count, elongation = round(drawn(source.corners)), drawn(source.elongation)
        uniforms = rng.random(count + 1)
        shape = random_polygon(uniforms, elongation) if source.shape is None else source.shape
        size = np.sqrt(volume / thickness / moments(shape)[0])
        rock = rock_of(size * shape, density, thickness)
        share = rng.random()
        place = (1.0 - share) * source.line[0] + share * source.line[1]
        state = [*place, 0.0, *map(drawn, source.velocity), drawn(source.spin)]
        return rock, volume, np.array(state)

    def _course(self, seed: int, room: int) -> paths.Course:
        """Return the empty record of a path, before it begins, with room for so many records."""
        barriers, stations = len(self.barriers), len(self.stations)
        return paths.Course(
            records=np.zeros((room, 14)),
            tally=np.array([0, 0, -1, -1]),
            passed=np.full((stations, 5), np.nan),
            hits=np.full((barriers, 5), np.nan),
            broken=np.zeros(barriers, np.bool_),
            ledger=np.zeros(6),
            largest=np.full(5, np.nan),
            clock=np.array([0.0, self.time_limit]),
            counter=np.array([seed, seed], np.uint64),
        )


def block_as_rock(source: Source, number: int) -> tuple[Rock, float, Floats]:
    """Return a block of a source as a rock, its volume, m3, and its state, (6,)."""
    blocks = source.blocks
    assert blocks is not None
    outline = blocks.outline[number]
    area, centroid, _ = moments(outline)
    thickness = source.thickness or np.sqrt(area)
    rock = rock_of(outline, float(blocks.density[number]), thickness)
    return rock, area * thickness, np.array([*centroid, 0.0, *blocks.velocity[number]])


def lift(ground: Ground, rock: Rock, place: Floats) -> float:
    """Return how far a rock at a place (2,) is raised so that it does not stand in the profile, m.

    The profile is the part next below its centre.
    """
    corners, size = rock.corners + place, float(rock.numbers[2])
    under = height_below(ground, *place)
    reference = np.inf if np.isnan(under) else under + size
    need = 0.0
    for x, y in corners.tolist():
        top = height_below(ground, x, max(reference, y))
        if top > y:
            need = max(need, top - y)
    lower = sorted(range(len(corners)), key=lambda k: corners[k, 0])
    for x, y in ground.start.tolist():
        if corners[lower[0], 0] < x < corners[lower[-1], 0] and y <= reference:
            need = max(need, y - _bottom(corners, x))
    return need + CLEAR * size if need > 0.0 else 0.0


def _bottom(corners: Floats, x: float) -> float:
    """Return the height of the lower side of a convex polygon (n, 2) over x, m."""
    heights = []
    for (x0, y0), (x1, y1) in zip(corners.tolist(), np.roll(corners, -1, 0).tolist(), strict=True):
        if x0 <= x <= x1 and x1 > x0:  # counter-clockwise: the lower side goes to the right
            heights.append(y0 + (x - x0) / (x1 - x0) * (y1 - y0))
    return min(heights)


PATH_COLUMNS = (
    *("path", "source", "volume", "mass", "start_x", "start_y", "end", "held_by", "end_x", "end_y"),
    *("time", "blows", "largest_height", "largest_translational", "largest_rotational"),
    *("largest_energy", "largest_speed", "lost_in_blows", "lost_by_friction", "lost_by_rolling"),
    *("lost_in_barriers", "unaccounted"),
)
"""Columns of the table of paths; unaccounted is a share of the energy above the lowest point."""
WIDTHS = {"records": 15, "passed": 7, "hits": 7}
"""Columns of the arrays of a portion: those of ``path.Course``, each behind the path's number, and
of passages and hits behind that of the station or barrier."""


def path_row(campaign: Campaign, number: int, one: Path) -> list[Any]:
    """Return the row of a path in the table, without units of its own: m, s, J, kg."""
    course, start = one.course, one.course.records[0]
    ledger = course.ledger
    scale = one.rock.numbers[0] * np.hypot(*campaign.gravity) * campaign.ground.box[3]
    unaccounted = (ledger[paths.HAD] - ledger[:4].sum() - ledger[paths.KEPT]) / max(scale, 1e-300)
    held = campaign.barriers[course.tally[3]] if course.tally[3] >= 0 else ""
    x, y = campaign.origin
    return [
        *(number, one.begun.source, one.begun.volume, float(one.rock.numbers[0])),
        *(float(start[paths.X] + x), float(start[paths.Y] + y)),
        *(ENDS[course.tally[2]], held, float(one.state[0] + x), float(one.state[1] + y)),
        *(float(course.clock[0]), int(course.tally[1])),
        *(float(value) for value in course.largest),
        *(float(value) for value in ledger[:4]),
        float(unaccounted),
    ]


def portion(campaign: Campaign, numbers: Sequence[int]) -> tuple[list[list[Any]], dict[str, Any]]:
    """Return the rows of some paths, and their arrays.

    They are the records, passages and hits of ``WIDTHS``.
    """
    rows, records, passed, hits = [], list[Floats](), list[Floats](), list[Floats]()
    for number in numbers:
        one = campaign.follow(number)
        rows.append(path_row(campaign, number, one))
        records.append(_numbered(number, one.course.records[: one.course.tally[0]]))
        passed.append(_present(number, one.course.passed))
        hits.append(_present(number, one.course.hits))
    return rows, joined({"records": records, "passed": passed, "hits": hits})


def joined(parts: Mapping[str, Sequence[Floats]]) -> dict[str, Floats]:
    """Return the arrays of ``WIDTHS`` from their parts."""
    return {
        name: np.concatenate([np.empty((0, WIDTHS[name])), *arrays])
        for name, arrays in parts.items()
    }


def _numbered(number: int, values: Floats) -> Floats:
    """Return rows with a number before them."""
    return np.concatenate([np.full((len(values), 1), float(number)), values], axis=1)


def _present(number: int, values: Floats) -> Floats:
    """Return the rows that have values, with the number of the path and their own before them."""
    rows = np.flatnonzero(~np.isnan(values[:, -1]))
    return _numbered(number, np.column_stack([rows, values[rows]]))
