"""[rockfall], [surface.NAME], [[source]], [[barrier]], [[collector]]: paths of rocks on a profile.

Numbers may be distributions, as texts: "normal(0.35, 0.04)".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, ClassVar, Self

import numpy as np
from pydantic import AfterValidator, Field, StrictInt, StrictStr, model_validator

from clast import spelling
from clast.errors import CaseError, Fault, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.builder_methods import ByKeys
from clast.inputs.declaring.table import (
    OR_TEXT,
    Coordinate,
    Ends,
    Fraction,
    Length,
    Line,
    Point,
    Shift,
    Table,
)
from clast.inputs.declaring.validation_messages import check_one, refusal, refusals
from clast.model import ranges
from clast.model.distribution_texts import DRAWN, read
from clast.model.distributions import Distribution
from clast.model.model import Floats
from clast.trajectory.campaign import Campaign, Source, deck_of
from clast.trajectory.ground import (
    ARM,
    FRICTION,
    RESTITUTION,
    ROUGH,
    ROUGHEST,
    ROUGHNESS,
    SLIDING,
    SPEED,
    STICKING,
    Face,
    ground_of,
    height_below,
)
from clast.trajectory.rock import is_convex, moments


def quantity(value: float | str) -> Distribution | float:
    """Return a number, or the distribution of a text; raises CaseError for no valid one."""
    return read(value, "", DRAWN) if isinstance(value, str) else value


def between(low: float, high: float) -> AfterValidator:
    """Return the annotation of a number or a distribution whose values lie between limits."""

    def validate(value: float | str | None) -> float | str | None:
        if value is None:
            return None
        try:
            made = quantity(value)
            deck = deck_of(made)
        except (CaseError, TypeError, ValueError) as error:
            what = getattr(error, "what", "has values that are not numbers")
            example = 'e.g. 0.35, or "normal(0.35, 0.04)"'
            raise refusal(what, getattr(error, "remedy", "") or example) from None
        outside = deck[(deck < low) | (deck > high)]
        if len(outside):
            what = f"has the value {outside[0]:g}, which is not from {low:g} to {high:g}"
            remedy = "truncate it with low=... and high=..." if isinstance(value, str) else ""
            raise refusal(what, remedy)
        return value

    return AfterValidator(validate)


Varied = Annotated[Number | StrictStr, OR_TEXT]
VariedSpeed = Annotated[Varied, between(-1e4, 1e4)]


class RockfallTable(ByKeys):
    """The profile that rocks fall on, and how many places along it are measured."""

    profile: Line | None = None
    """Points [x, y] of the profile from left to right, m; overhangs are allowed."""
    surface: list[StrictStr] = Field([])
    """Surface of each segment of the profile, or one for all: [surface.NAME]."""
    file: StrictStr | None = None
    """Table (.csv) with x, y and the surface from each point on, or drawing (.dxf) of lines whose
    layers are named like surfaces, in place of profile and surface."""
    seed: Annotated[StrictInt, Field(ge=0, lt=2**63)] = 1
    """Seed of all random numbers."""
    time_limit: Annotated[Number, Field(gt=0.0)] = 300.0
    """Time after which a path ends, s."""
    stations: Annotated[StrictInt, Field(ge=1, le=10_000)] = 100
    """Places along the profile, at equal distances, at which passing rocks are measured."""

    @model_validator(mode="after")
    def _has_a_profile(self) -> Self:
        check_one(self, ("profile", "file"), "give points [[x, y], ...], or the name of a file")
        if self.profile is not None:
            faults = list(profile_faults(self.profile))
            count = len(self.profile) - 1
            if len(self.surface) not in (1, count) and not faults:
                what = f"names {len(self.surface)} surface(s) for {count} segment(s)"
                faults = [Fault(what, "name one for all, or one for each", ("surface",))]
            if faults:
                raise refusals(faults)
        elif self.surface:
            raise refusal("is given, but the file names the surfaces", "leave it out", "surface")
        return self

    def line(self, folder: Path) -> tuple[Floats, list[str]]:
        """Return points (k + 1, 2), m, and the surface of each segment, from left to right."""
        if self.profile is not None:
            count = len(self.profile) - 1
            points = np.array(self.profile, np.float64)
            names = self.surface * count if len(self.surface) == 1 else list(self.surface)
        else:
            assert self.file is not None
            points, names = read_profile(folder / self.file)
            for fault in profile_faults(points.tolist()):
                raise ModelError(fault.what, where=self.file, remedy=fault.remedy)
        if points[0, 0] > points[-1, 0]:
            return points[::-1].copy(), names[::-1]
        return points, names


def profile_faults(points: Sequence[Sequence[float]]) -> Iterator[Fault]:
    """Report a line that is no profile: too short, with points that coincide, or that crosses."""
    import shapely

    if len(points) < 2:
        yield Fault(f"has {len(points)} point(s)", "give at least 2", ("profile",))
        return
    same = [k for k in range(1, len(points)) if tuple(points[k]) == tuple(points[k - 1])]
    if same:
        what = f"has point {same[0] + 1} at the place of the one before"
        yield Fault(what, "leave one of them out", ("profile",))
    elif points[0][0] == points[-1][0]:
        yield Fault("begins and ends at the same x", "let it lead from side to side", ("profile",))
    elif not shapely.LineString(points).is_simple:
        what = "crosses or touches itself"
        yield Fault(what, "give its points in their order along the ground", ("profile",))


def read_profile(path: Path) -> tuple[Floats, list[str]]:
    """Return the points of the profile in a file, m, (k + 1, 2), and the surface of each segment.

    Raises CaseError for a file that holds none.
    """
    if path.suffix.lower() == ".dxf":
        return _drawn_profile(path)
    from clast.rockmass.drawings.csv_lines import table_of

    table = table_of(path)
    name = next((c for c in ("surface", "material") if c in table.columns), None)
    if not {"x", "y"} <= set(table.columns) or name is None:
        remedy = "a profile has the heading x,y,surface and a row for each point, from side to side"
        raise CaseError("is not a profile", where=table.heading, remedy=remedy)
    names = [row.text(name) for row in table.rows]
    for row, surface in zip(table.rows[:-1], names, strict=False):
        if not surface:
            raise row.fault("is empty", "name the surface from this point to the next", name)
    return np.array([row.point() for row in table.rows]), names[:-1]


def _drawn_profile(path: Path) -> tuple[Floats, list[str]]:
    """Return points and surfaces of the lines of a drawing, joined end to end."""
    from clast.rockmass.drawings.dxf_entities import dxf_content

    content = dxf_content(path, lambda layer: True)
    pieces = [(content.flat(one), one.layer) for one in content.pieces if len(one.points) > 1]
    if not pieces:
        remedy = "draw the profile as lines, on layers named like the surfaces"
        raise CaseError("has no lines", where=str(path), remedy=remedy)
    pieces = [(line if line[0, 0] <= line[-1, 0] else line[::-1], name) for line, name in pieces]
    pieces.sort(key=lambda one: float(one[0][:, 0].min()))
    points, names = [pieces[0][0][0]], list[str]()
    for line, name in pieces:
        apart = float(np.hypot(*(line[0] - points[-1])))
        if apart > 1e-6 * float(np.ptp(np.concatenate([one for one, _ in pieces]))):
            x, y = points[-1]
            what = f"has lines that do not meet: {apart:.3g} m from [{x:g}, {y:g}] to the next"
            raise CaseError(
                what, where=str(path), remedy="draw the profile as one line after another"
            )
        points += list(line[1:])
        names += [name] * (len(line) - 1)
    return np.array(points), names


class Surface(Table):
    """A surface of the profile, as rocks bounce, slide and roll on it."""

    NAMED: ClassVar[bool] = True
    normal_restitution: Annotated[Varied, between(0.0, 1.0)]
    """Share R_n of the normal velocity that a blow gives back."""
    tangential_restitution: Annotated[Varied, between(0.0, 1.0)] | None = None
    """Share R_t of the tangential velocity of the contact that a blow leaves."""
    friction_angle: Annotated[Varied, between(0.0, 89.9)] | None = None
    """Friction angle, degrees, which bounds the tangential impulse; arctan((1 - R_t)/R_t) for
    sliding, and 84 for blows, if absent."""
    rolling_resistance: Annotated[Varied, between(0.0, 1e3)] = 0.0
    """Moment arm of the normal force, m."""
    roughness: Annotated[Varied, between(0.0, 60.0)] = 0.0
    """Standard deviation of the angle of the face that a corner strikes, degrees."""
    speed_scaling: Annotated[Varied, between(1e-3, 1e6)] | None = None
    """Normal speed K at which R_n halves, m/s: R_n/(1 + (v/K)^2), Pfeiffer and Bowen 1989."""

    @model_validator(mode="after")
    def _stops_slip(self) -> Self:
        if self.tangential_restitution is None and self.friction_angle is None:
            what = "has neither tangential_restitution nor friction_angle"
            raise refusal(what, "give one of them, or both")
        return self

    def decks(self) -> Floats:
        """Return the values that are drawn of each property, (7, DECK)."""
        rows = np.zeros((7, len(deck_of(0.0))))

        def deck(value: float | str) -> Floats:
            return deck_of(quantity(value))

        rows[RESTITUTION] = deck(self.normal_restitution)
        rows[STICKING], rows[FRICTION] = 1.0, ROUGH
        if self.tangential_restitution is not None:
            rows[STICKING] = 1.0 - deck(self.tangential_restitution)
        if self.friction_angle is None:
            rows[SLIDING] = np.minimum(
                ROUGHEST, rows[STICKING] / np.maximum(1.0 - rows[STICKING], 1.0 / ROUGHEST)
            )
        else:
            rows[FRICTION] = rows[SLIDING] = np.tan(np.radians(deck(self.friction_angle)))
        rows[ARM] = deck(self.rolling_resistance)
        rows[ROUGHNESS] = np.radians(deck(self.roughness))
        rows[SPEED] = np.inf if self.speed_scaling is None else deck(self.speed_scaling)
        return rows


class SourceTable(Table):
    """Rocks that start at a point or anywhere on a line."""

    name: StrictStr
    """Name."""
    at: Point | None = None
    """Point [x, y] of their centroids, m; rocks that would stand in the profile are raised."""
    line: Ends | None = None
    """Ends [[x, y], [x, y]] of the line on which they start, m."""
    rocks: Annotated[StrictInt, Field(ge=1, le=1_000_000)]
    """Number of rocks."""
    volume: Annotated[Varied, between(1e-9, 1e9)]
    """Volume of a rock, m3; a number or a distribution."""
    density: Annotated[Varied, between(1.0, 1e5)] = 2700.0
    """Density, kg/m3."""
    length: Length | None = None
    """Length of rocks out of the plane, m; the cube root of the volume if absent."""
    corners: Annotated[Varied, between(3.0, 60.0)] = 6.0
    """Number of corners of random rocks."""
    elongation: Annotated[Varied, between(1.0, 20.0)] = 1.2
    """Ratio of the axes of the ellipse that the corners of random rocks lie on."""
    shape: list[Shift] | None = None
    """Convex polygon [x, y] of all its rocks, counter-clockwise, scaled to their volume."""
    velocity: tuple[VariedSpeed, VariedSpeed] = (0.0, 0.0)
    """Velocity [x, y], m/s; numbers or distributions."""
    spin: VariedSpeed = 0.0
    """Spin, counter-clockwise, rad/s."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        check_one(self, ("at", "line"), "give a point [x, y], or a line [[x, y], [x, y]]")
        if self.shape is not None:
            points = np.array(self.shape, np.float64)
            if len(points) < 3 or not is_convex(points):
                remedy = "give its corners counter-clockwise; leave re-entrant ones out"
                raise refusal("is not a convex polygon", remedy, "shape")
        return self

    def source(self, origin: Floats) -> Source:
        """Return the source, about an origin (2,), m."""

        def deck(value: float | str) -> Floats:
            return deck_of(quantity(value))

        ends = self.line or (self.at, self.at)
        shape = None if self.shape is None else np.array(self.shape, np.float64)
        return Source(
            name=self.name,
            line=np.array(ends, np.float64) - origin,
            count=self.rocks,
            velocity=(deck(self.velocity[0]), deck(self.velocity[1])),
            spin=deck(self.spin),
            volume=deck(self.volume),
            density=deck(self.density),
            thickness=self.length,
            corners=deck(self.corners),
            elongation=deck(self.elongation),
            shape=None if shape is None else shape / np.sqrt(moments(shape)[0]),
        )


class BarrierTable(Table):
    """A barrier on the profile: a fence that takes energy up to its capacity, or a wall."""

    name: StrictStr
    """Name."""
    x: Coordinate
    """Its foot, on the profile, m."""
    height: Length
    """Height along it, m."""
    inclination: Annotated[Number, Field(gt=-89.0, lt=89.0)] = 0.0
    """Angle from the vertical, positive towards +x, degrees."""
    capacity: Annotated[Number, Field(gt=0.0)] | None = None
    """Kinetic energy that it takes, J: a rock with less is held, one with more goes on with the
    rest; a wall, which rocks bounce off, if absent."""
    restitution: Fraction = 0.0
    """Share of the normal velocity that a wall gives back."""
    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 30.0
    """Friction angle of a wall, degrees."""


class CollectorTable(Table):
    """A place along the profile at which passing rocks are measured."""

    name: StrictStr
    """Name."""
    x: Annotated[Number, within(ranges.COORDINATE)]
    """Its place, m."""


@dataclass(frozen=True, kw_only=True)
class RockfallInputs:
    """The tables of a case about rockfall."""

    table: RockfallTable
    surfaces: Mapping[str, Surface]
    sources: Sequence[SourceTable]
    barriers: Sequence[BarrierTable]
    collectors: Sequence[CollectorTable]
    gravity: tuple[float, float]
    folder: Path

    def campaign(self) -> Campaign:
        """Return the profile and all that falls on it; raises ModelError with the remedy."""
        points, names = self.table.line(self.folder)
        self._check(points, names)
        origin = 0.5 * (points.min(axis=0) + points.max(axis=0))
        line = points - origin
        known = list(self.surfaces)
        profile = Face(points=line, surface=[known.index(name) for name in names])
        decks = [one.decks() for one in self.surfaces.values()]
        bare = ground_of(profile, (), np.array(decks), np.empty(0), np.empty(0))
        lines, faces = [], []
        for number, one in enumerate(self.barriers):
            wall = Surface(
                normal_restitution=one.restitution, friction_angle=min(one.friction_angle, 89.9)
            )
            lean = np.radians(one.inclination)
            top = line[:, 1].max() + 1.0
            foot = np.array([one.x - origin[0], height_below(bare, one.x - origin[0], top)])
            end = foot + one.height * np.array([np.sin(lean), np.cos(lean)])
            surface = len(decks)
            decks.append(wall.decks())
            faces.append(
                Face(points=np.array([foot, end, foot]), surface=[surface] * 2, barrier=number)
            )
            lines.append((foot, end))
        low, high = line[0, 0], line[-1, 0]
        equal = low + (high - low) * (np.arange(self.table.stations) + 0.5) / self.table.stations
        places = [(float(x), "") for x in equal]
        places += [(one.x - float(origin[0]), one.name) for one in self.collectors]
        places += [(one.x - float(origin[0]), one.name) for one in self.barriers]
        places.sort()
        capacity = [one.capacity or np.inf for one in self.barriers]
        stations = np.array([x for x, _ in places])
        return Campaign(
            ground=ground_of(profile, faces, np.array(decks), np.array(capacity), stations),
            origin=origin,
            profile=line,
            surfaces=(*known, *(one.name for one in self.barriers)),
            barriers=tuple(one.name for one in self.barriers),
            barrier_lines=np.array(lines).reshape(-1, 2, 2),
            stations=tuple(name for _, name in places),
            sources=tuple(one.source(origin) for one in self.sources),
            gravity=np.array(self.gravity, np.float64),
            seed=self.table.seed,
            time_limit=self.table.time_limit,
        )

    def _check(self, points: Floats, names: Sequence[str]) -> None:
        """Raise ModelError for names that do not exist or are there twice, and odd places."""
        if not self.sources:
            raise ModelError("is missing, so nothing falls", where="[[source]]", remedy=SOURCE)
        for name in names:
            if name not in self.surfaces:
                what = f"there is no surface '{shortened(name)}'"
                remedy = spelling.advice(name, list(self.surfaces), kind="surface")
                raise ModelError(what, where="[rockfall], surface", remedy=remedy)
        low, high = points[0, 0], points[-1, 0]
        ranges.check_names("source", [one.name for one in self.sources])
        given = partial(_beside, low, high)
        placed = [("barrier", one.name, one.x) for one in self.barriers]
        placed += [("collector", one.name, one.x) for one in self.collectors]
        ranges.check_names("collector or barrier", [name for _, name, _ in placed])
        for kind, name, x in placed:
            given(f"{kind} '{shortened(name)}'", [x])
        for source in self.sources:
            ends = source.line or (source.at,)
            given(f"source '{shortened(source.name)}'", [end[0] for end in ends if end])


SOURCE = "give one: name, at = [x, y], rocks = 1000, volume = 0.5"


def _beside(low: float, high: float, where: str, places: Sequence[float]) -> None:
    """Raise ModelError for a place beside the profile."""
    for x in places:
        if not low < x < high:
            what = f"is at x = {x:g}, beside the profile, which reaches from {low:g} to {high:g}"
            raise ModelError(what, where=where, remedy="move it, or lengthen the profile")
