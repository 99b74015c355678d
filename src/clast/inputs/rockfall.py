"""[rockfall], [surface.NAME], [[source]], [[barrier]], [[collector]]: paths of rocks on a profile.

Numbers may be distributions, as texts: "normal(0.35, 0.04)".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar, Self

import numpy as np
from pydantic import AfterValidator, Field, StrictInt, StrictStr, model_validator

from clast.errors import CaseError, Fault, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, Extends
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
from clast.inputs.declaring.validation_messages import refusal, refusals
from clast.model import ranges
from clast.model.distribution_texts import DRAWN, read
from clast.model.distributions import Distribution, Values
from clast.model.model import Floats
from clast.trajectory.campaign import Source, deck_of
from clast.trajectory.ground import (
    ARM,
    FRICTION,
    RESTITUTION,
    ROUGH,
    ROUGHEST,
    ROUGHNESS,
    SLIDING,
    SPACING,
    SPEED,
    STICKING,
)
from clast.trajectory.rock import is_convex, moments
from clast.trajectory.standing import Blocks


def quantity(value: float | str) -> Distribution | float:
    """Return a number, or the distribution of a text; raises CaseError for no valid one."""
    if not isinstance(value, str):
        return value
    made = read(value, "", DRAWN)
    if isinstance(made, Values):
        what = f"'{shortened(value)}' is not a distribution"
        raise CaseError(what, remedy='write a number without quotes, or "normal(0.35, 0.04)"')
    return made


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
    """Points [x, y] of the profile from left to right, m; overhangs are allowed.  Blocks of the
    case stand on it; alone they are the profile."""
    surface: list[StrictStr] = Field([])
    """Surface of each segment of the profile, or one for all: [surface.NAME]."""
    file: StrictStr | None = None
    """Table (.csv) with x, y and the surface from each point on, or drawing (.dxf) of lines whose
    layers are named like surfaces, in place of profile and surface; or track (.gpx) down the slope,
    with one surface."""
    seed: Annotated[StrictInt, Field(ge=0, lt=2**63)] = 1
    """Seed of all random numbers."""
    time_limit: Annotated[Number, Field(gt=0.0)] = 300.0
    """Time after which a path ends, s."""
    stations: Annotated[StrictInt, Field(ge=1, le=10_000)] = 100
    """Places along the profile, at equal distances, at which passing rocks are measured."""

    @model_validator(mode="after")
    def _has_a_profile(self) -> Self:
        if self.profile is not None and self.file is not None:
            raise refusal("has profile and file, of which one is needed", "leave one of them out")
        if self.profile is not None:
            faults = list(profile_faults(self.profile))
            count = len(self.profile) - 1
            if len(self.surface) not in (1, count) and not faults:
                what = f"names {len(self.surface)} surface(s) for {count} segment(s)"
                faults = [Fault(what, "name one for all, or one for each", ("surface",))]
            if faults:
                raise refusals(faults)
        elif self.file is not None and self.is_track:
            if len(self.surface) != 1:
                what = f"names {len(self.surface)} surface(s) for a track"
                raise refusal(what, "name one for all; a table (.csv) has more", "surface")
        elif self.surface and self.file is not None:
            raise refusal("is given, but the file names the surfaces", "leave it out", "surface")
        elif self.surface:
            remedy = "give points [[x, y], ...] as profile, or the name of a file"
            raise refusal("is given without a profile", remedy, "surface")
        return self

    @property
    def is_track(self) -> bool:
        """Whether the file is a track, which has no surfaces."""
        return (self.file or "").lower().endswith(".gpx")

    def line(self, folder: Path) -> tuple[Floats | None, list[str]]:
        """Return points (k + 1, 2), m, and the surface of each segment, from left to right.

        None where no profile is given: there is one of blocks, or none.
        """
        if self.profile is None and self.file is None:
            return None, []
        if self.profile is not None:
            count = len(self.profile) - 1
            points = np.array(self.profile, np.float64)
            names = self.surface * count if len(self.surface) == 1 else list(self.surface)
        else:
            assert self.file is not None
            points, names = read_profile(folder / self.file)
            names = names or list(self.surface) * (len(points) - 1)
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

    A track has no surfaces.  Raises CaseError for a file that holds no profile.
    """
    if path.suffix.lower() == ".dxf":
        return _drawn_profile(path)
    if path.suffix.lower() == ".gpx":
        from clast.rockmass.drawings.gpx import section_of

        return section_of(path), []
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
    roughness_spacing: Length | None = None
    """Length along the profile of facets that have one angle in all blows of a path, m; each blow
    has an angle of its own if absent."""
    speed_scaling: Annotated[Varied, between(1e-3, 1e6)] | None = None
    """Normal speed K at which R_n halves, m/s: R_n/(1 + (v/K)^2), Pfeiffer and Bowen 1989."""

    @model_validator(mode="after")
    def _stops_slip(self) -> Self:
        if self.tangential_restitution is None and self.friction_angle is None:
            what = "has neither tangential_restitution nor friction_angle"
            raise refusal(what, "give one of them, or both")
        if self.roughness_spacing is not None and "roughness" not in self.model_fields_set:
            what, remedy = "is given without roughness", "give the roughness, or leave it out"
            raise refusal(what, remedy, "roughness_spacing")
        return self

    def decks(self) -> Floats:
        """Return the values that are drawn of each property, (8, DECK)."""
        rows = np.zeros((8, len(deck_of(0.0))))

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
        rows[SPACING] = self.roughness_spacing or 0.0
        rows[SPEED] = np.inf if self.speed_scaling is None else deck(self.speed_scaling)
        return rows


DRAWN_KEYS = ("volume", "corners", "elongation", "shape", "velocity", "spin")
"""Keys of rocks that blocks of a run have by themselves."""
OF_BLOCKS = "is given, but rocks are blocks of a run, which have theirs"
OF_SHAPE = "is given, but all rocks have the shape"
NO_RUN = "is given, but no file of a run"


class SourceTable(Table):
    """Rocks that start at a point or anywhere on a line."""

    name: StrictStr
    """Name."""
    at: Point | None = None
    """Point [x, y] of their centroids, m; rocks that would stand in the profile are raised."""
    line: Ends | None = None
    """Ends [[x, y], [x, y]] of the line on which they start, m."""
    file: StrictStr | None = None
    """Result file of a run: its blocks that move at its end are the rocks, the others stand."""
    faster_than: Annotated[Number, Field(gt=0.0)] = 0.1
    """Speed above which a block of that run is a rock, m/s."""
    rocks: Annotated[StrictInt, Field(ge=1, le=1_000_000)] | None = None
    """Number of rocks; as many as blocks if absent, which take turns if there are fewer."""
    volume: Annotated[Varied, between(1e-9, 1e9)] | None = None
    """Volume of a rock, m3; a number or a distribution."""
    density: Annotated[Varied, between(100.0, 1e5)] = 2700.0
    """Density, kg/m3."""
    length: Length | None = None
    """Length of rocks out of the plane, m; the cube root of the volume if absent."""
    corners: Annotated[Varied, between(3.0, 60.0)] = 6.0
    """Number of corners of random rocks."""
    elongation: Annotated[Varied, between(1.0, 20.0)] = 1.2
    """Ratio of the axes of the ellipse that the corners of random rocks lie on."""
    shape: list[Shift] | None = None
    """Convex polygon [x, y] of all its rocks, -, counter-clockwise, scaled to their volume."""
    velocity: tuple[VariedSpeed, VariedSpeed] = (0.0, 0.0)
    """Velocity [x, y], m/s; numbers or distributions."""
    spin: VariedSpeed = 0.0
    """Spin, counter-clockwise, rad/s."""

    ONE_OF: ClassVar = {
        "give a point [x, y], a line [[x, y], [x, y]], or the result file of a run": (
            "at",
            "line",
            "file",
        )
    }
    WHEN: ClassVar = {"file": {ANY: ("faster_than",)}}
    BASIC: ClassVar = ("rocks", "volume")

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        given = self.model_fields_set
        if self.file is None:
            faults = [
                Fault("is missing", f"e.g. {key} = {example}", (key,))
                for key, example in (("rocks", 1000), ("volume", 0.5))
                if getattr(self, key) is None
            ]
            faults += [Fault(NO_RUN, "leave it out", (key,)) for key in given & {"faster_than"}]
            if self.shape is not None:
                of_shape = [key for key in ("corners", "elongation") if key in given]
                faults += [Fault(OF_SHAPE, "leave it out", (key,)) for key in of_shape]
        else:
            faults = [
                Fault(OF_BLOCKS, "leave it out", (key,)) for key in DRAWN_KEYS if key in given
            ]
        if faults:
            raise refusals(faults)
        if self.shape is not None:
            points = np.array(self.shape, np.float64)
            if len(points) < 3 or not is_convex(points):
                remedy = "give its corners counter-clockwise; leave re-entrant ones out"
                raise refusal("is not a convex polygon", remedy, "shape")
        return self

    @property
    def largest_volume(self) -> float:
        """The largest volume that is drawn, m3."""
        return float(deck_of(quantity(self.volume or 1.0)).max())

    def source(self, origin: Floats, blocks: Blocks | None) -> Source:
        """Return the source, about an origin (2,), m; ``blocks`` are those of a run that move."""

        def deck(value: float | str) -> Floats:
            return deck_of(quantity(value))

        if blocks is not None:
            known = np.where(np.isnan(blocks.density), deck(self.density)[0], blocks.density)
            blocks = replace(blocks.about(origin), density=known)
        ends = self.line or (self.at or origin.tolist(),) * 2
        shape = None if self.shape is None else np.array(self.shape, np.float64)
        return Source(
            name=self.name,
            line=np.array(ends, np.float64) - origin,
            count=self.rocks or (len(blocks.name) if blocks else 1),
            velocity=(deck(self.velocity[0]), deck(self.velocity[1])),
            spin=deck(self.spin),
            volume=deck(self.volume or 1.0),
            density=deck(self.density),
            thickness=self.length,
            corners=deck(self.corners),
            elongation=deck(self.elongation),
            shape=None if shape is None else shape / np.sqrt(moments(shape)[0]),
            blocks=blocks,
        )


class BarrierTable(Table):
    """A barrier on the profile: a fence that takes energy up to its capacity, or a wall."""

    name: StrictStr
    """Name."""
    x: Annotated[Coordinate, Extends("station")]
    """Its foot, on the profile, m."""
    height: Annotated[Number, Field(gt=0.0, le=1e3)]
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

    @model_validator(mode="after")
    def _is_a_fence_or_a_wall(self) -> Self:
        if self.capacity is not None:
            what, remedy = "is given, but only walls have it", "leave it, or the capacity, out"
            given = [k for k in ("restitution", "friction_angle") if k in self.model_fields_set]
            if given:
                raise refusals([Fault(what, remedy, (key,)) for key in given])
        return self

    @property
    def wall(self) -> Surface:
        """The surface of its faces."""
        angle = min(self.friction_angle, 89.9)
        return Surface(normal_restitution=self.restitution, friction_angle=angle)


class CollectorTable(Table):
    """A place along the profile at which passing rocks are measured."""

    name: StrictStr
    """Name."""
    x: Annotated[Number, within(ranges.COORDINATE), Extends("station")]
    """Its place, m."""
