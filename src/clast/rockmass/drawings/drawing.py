"""A drawing of a rock mass: outlines, lines and points, in metres, and the place of each.

Every reader of drawings gives a ``Drawing`` (or the parts of one).  Parts of a file that a drawing
cannot hold are not dropped: they stand in ``left_out`` with place and reason; changes stand in
``notes``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clast.model.arrays import Floats

DEFAULT_JOINT = "default"
"""Joint of lines that name none: the strength [joint.default] of a case."""
DEFAULT_ROCK = "rock"
"""Rock of outlines that name none."""


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """Something in a file that was not taken over."""

    what: str
    """The thing, with its values."""
    place: str
    """Where it stands: handle of an entity, line of a text."""
    reason: str
    """Why it was left out, and the remedy."""

    def __str__(self) -> str:
        return f"{self.place}: {self.what}: {self.reason}"


@dataclass(frozen=True, kw_only=True, eq=False)
class InFile:
    """A thing in a file."""

    place: str = ""
    """Where it stands in the file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Polyline(InFile):
    """A drawn joint."""

    points: Floats
    """Its points in order, m, shape (n, 2), n at least 2."""
    joint: str = DEFAULT_JOINT
    """Name of its joint: [joint.NAME]."""
    joint_set: str = ""
    """Name of the set that it was counted with; empty if none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnOutline(InFile):
    """A closed line round an opening or a region of one rock."""

    name: str
    """Name of the opening, or of the region's rock."""
    points: Floats
    """Corners, m, counter-clockwise, the first not repeated, shape (n, 2)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segment(InFile):
    """A straight line: a bolt, a line of fixed points, or a line through blocks of one rock."""

    name: str
    """Kind of the bolt, or rock of the line; empty for fixed lines."""
    ends: Floats
    """First and second end, m, shape (2, 2)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spot(InFile):
    """A point: fixed, loaded, measured, or inside a block that is to be removed."""

    name: str
    """Its name, unique among those of its kind."""
    at: Floats
    """Coordinates, m, shape (2,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Orientations:
    """A survey of joints in space."""

    dip: Floats
    """Steepest slope below the horizontal, degrees from 0 to 90, shape (n,)."""
    dip_direction: Floats
    """Direction of the steepest slope, degrees clockwise from north, shape (n,)."""
    length: Floats
    """Length of the trace, m, NaN where it was not measured, shape (n,)."""
    joint: tuple[str, ...]
    """Name of the joint of each."""
    joint_set: tuple[str, ...]
    """Name of the set of each; empty if none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnBoltKind:
    """Stiffness and strength of bolts, per metre of thickness."""

    name: str
    """Name: [bolt_kind.NAME]."""
    stiffness: float
    """Force per elongation, N/m per metre of thickness."""
    yield_force: float
    """Largest force, N per metre of thickness; infinity if there is none."""
    pretension: float
    """Force at the start, N per metre of thickness, tension positive."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnRock(InFile):
    """A rock as a legacy file describes it."""

    name: str
    """Name: [rock.NAME]."""
    density: float
    """kg/m3."""
    weight: float
    """Weight of a volume, N/m3, downwards positive."""
    young: float
    """Young's modulus, Pa."""
    poisson: float
    """Poisson's ratio."""
    initial_stress: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) at the start, Pa, tension positive."""
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Velocity (u, v, omega) of its blocks at the start, m/s and rad/s."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnJoint(InFile):
    """The strength of a joint as a legacy file describes it."""

    name: str
    """Name: [joint.NAME]."""
    friction_angle: float
    """Degrees."""
    cohesion: float
    """Pa."""
    tensile_strength: float
    """Pa."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PointForce(InFile):
    """The force at a load point at one instant."""

    point: int
    """Number of the load point, from 1."""
    time: float
    """Instant, s."""
    force: tuple[float, float]
    """Force (x, y), N per metre of thickness."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Analysis:
    """Materials, loads and time in a legacy file."""

    rocks: tuple[DrawnRock, ...] = ()
    joints: tuple[DrawnJoint, ...] = ()
    dynamic_ratio: float | None = None
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    steps: int | None = None
    step: float | None = None
    """Length of a step, s."""
    displacement_ratio: float | None = None
    """Largest displacement of a step as a share of half the height of the domain (Shi's g2)."""
    plane: str | None = None
    """"stress" or "strain"."""
    gravity: float | None = None
    """Acceleration of gravity, m/s2, downwards positive."""
    rotation: str | None = None
    """How points follow the rotation of their block: "linear", "exact"."""
    frame_steps: int | None = None
    """Steps between frames."""
    penalty_factor: float | None = None
    """Contact stiffness as a multiple of Young's modulus."""
    forces: tuple[PointForce, ...] = ()
    notes: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawing:
    """The drawn parts, in metres, and notes on the rest of the file."""

    file: str
    boundary: Floats | None = None
    """Outline of the domain, m, counter-clockwise, the first corner not repeated, (n, 2)."""
    boundary_rock: str = DEFAULT_ROCK
    """Rock of all blocks that no region names."""
    traces: tuple[Polyline, ...] = ()
    openings: tuple[DrawnOutline, ...] = ()
    regions: tuple[DrawnOutline, ...] = ()
    bolts: tuple[Segment, ...] = ()
    bolt_kinds: tuple[DrawnBoltKind, ...] = ()
    fixed_points: tuple[Spot, ...] = ()
    fixed_lines: tuple[Segment, ...] = ()
    """Every block that such a line crosses is held at one point of it."""
    material_lines: tuple[Segment, ...] = ()
    """Every block that such a line crosses is of its rock."""
    load_points: tuple[Spot, ...] = ()
    measured_points: tuple[Spot, ...] = ()
    hole_points: tuple[Spot, ...] = ()
    """The block with such a point in it is removed."""
    orientations: Orientations | None = None
    analysis: Analysis = field(default_factory=Analysis)
    """Strengths by number: type-1 of the drawing has that of the first joint material."""
    unit: float = 1.0
    """Metres in a unit of the file."""
    unit_source: str = "the file's coordinates are metres"
    """Where the unit came from."""
    node_distance: float | None = None
    """Distance below which nodes of a legacy file are one, as a share of half the height (e00)."""
    notes: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()

    @property
    def half_height(self) -> float | None:
        """Return half the height of the boundary, m (Shi's w0), or None where there is none."""
        if self.boundary is None:
            return None
        return 0.5 * float(np.ptp(self.boundary[:, 1]))
