"""The constant parts of a simulation: blocks, rock, joints, supports, loads.

Lengths in m, forces in N per metre of thickness, stresses in Pa (tension positive, order xx, yy,
xy), angles in degrees at this boundary. Polygons are counter-clockwise. Coordinates inside a
``Model`` are relative to ``origin``, so that a case surveyed at coordinates near 1e6 m loses
no digits.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import Any, ClassVar, Protocol

import numpy as np

from clast import thumbnails
from clast.model.arrays import Bools as Bools
from clast.model.arrays import Floats as Floats
from clast.model.arrays import Ints as Ints
from clast.model.arrays import following, no_floats, no_ints, owners
from clast.model.bodies import Outlines, joined_outlines
from clast.model.drawpoints import Drawpoint
from clast.model.factors import NO_FACTOR, Factor
from clast.model.flow.given import Flow
from clast.model.ground_motion import GroundMotion, Still
from clast.model.joints import JointTable
from clast.model.supports import Bolts, LiningJoints, LinkLines, Reactions, numbered
from clast.model.surcharge import Surcharge
from clast.model.surroundings import (
    InSituStress,
    OpeningBlocks,
    Repair,
    ViscousEdges,
    blocks_called,
)
from clast.model.water import Water
from clast.read_only import kept_property, seal


class Plane(Protocol):
    """The plane assumption: gives the elasticity matrix of a rock."""

    @property
    def name(self) -> str:
        """Return the name in case files, "stress" or "strain"."""
        ...

    def elasticity(self, young: float, poisson: float) -> Floats:
        """Return E' (3, 3) in Pa, from strain (exx, eyy, gxy) to stress."""
        ...


@dataclass(frozen=True)
class PlaneStress:
    """Plane stress: sigma_zz = 0 (thin slices, model tests)."""

    name: str = "stress"

    def elasticity(self, young: float, poisson: float) -> Floats:
        """Return E' (3, 3) in Pa for plane stress."""
        factor = young / (1.0 - poisson**2)
        return factor * np.array(
            [[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, (1.0 - poisson) / 2.0]]
        )


@dataclass(frozen=True)
class PlaneStrain:
    """Plane strain: eps_zz = 0 (long slopes, tunnels)."""

    name: str = "strain"

    def elasticity(self, young: float, poisson: float) -> Floats:
        """Return E' (3, 3) in Pa for plane strain; poisson must be below 0.5."""
        factor = young / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        return factor * np.array(
            [
                [1.0 - poisson, poisson, 0.0],
                [poisson, 1.0 - poisson, 0.0],
                [0.0, 0.0, (1.0 - 2.0 * poisson) / 2.0],
            ]
        )


PLANES: dict[str, Plane] = {"stress": PlaneStress(), "strain": PlaneStrain()}
"""The plane assumptions by their names in case files; the first is the usual one."""


@dataclass(frozen=True, kw_only=True)
class Rock:
    """A linear elastic rock."""

    name: str = "rock"
    """Name by which blocks refer to it."""
    young: float
    """Young's modulus, Pa."""
    poisson: float
    """Poisson's ratio, -."""
    density: float
    """Density, kg/m3."""
    initial_stress: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""
    is_ground: bool = True
    """False for linings, from which the stiffness of other contacts does not follow."""


@dataclass(frozen=True, kw_only=True)
class MaterialPoints:
    """Points that move with the block they belong to."""

    block: Ints = no_ints()
    """Block index of each point, shape (k,)."""
    at: Floats = no_floats(2)
    """Coordinates at the start, m, shape (k, 2), relative to the model's origin."""


@dataclass(frozen=True, kw_only=True)
class PointLoads(MaterialPoints):
    """Forces at material points."""

    force: Floats = no_floats(2)
    """Force (x, y), N per metre of thickness, shape (k, 2)."""
    factor: Ints = no_ints()
    """Which of ``Model.factors`` each is multiplied by, NO_FACTOR: none, shape (k,)."""
    name: tuple[str, ...] = ()
    """Name of each, by which stages refer to it, "" for none; empty where none has one."""


@dataclass(frozen=True, kw_only=True)
class LineLoads:
    """Tractions along straight lines that move with a block (usually its edges)."""

    block: Ints = no_ints()
    """Block index of each line, shape (k,)."""
    start: Floats = no_floats(2)
    """First end at the start, m, shape (k, 2)."""
    end: Floats = no_floats(2)
    """Second end at the start, m, shape (k, 2)."""
    traction: Floats = no_floats(2)
    """Force per length of the line (x, y), N/m per metre of thickness, shape (k, 2)."""
    factor: Ints = no_ints()
    """Which of ``Model.factors`` each is multiplied by, NO_FACTOR: none, shape (k,)."""
    name: tuple[str, ...] = ()
    """Name of each, by which stages refer to it, "" for none; empty where none has one."""


@dataclass(frozen=True, kw_only=True)
class EdgePressures:
    """Pressures on parts of edges, linear along them and normal to them as they turn."""

    block: Ints = no_ints()
    """Block index of each part, shape (k,)."""
    edge: Ints = no_ints()
    """Its edge: the index of the edge's first vertex, shape (k,)."""
    share: Floats = no_floats(2)
    """Where it begins and ends, 0 at the first vertex of the edge and 1 at the next, (k, 2)."""
    pressure: Floats = no_floats(2)
    """Pressure where it begins and ends, Pa, positive into the block, shape (k, 2)."""
    factor: Ints = no_ints()
    """Which of ``Model.factors`` each is multiplied by, NO_FACTOR: none, shape (k,)."""
    name: tuple[str, ...] = ()
    """Name of each, by which stages refer to it, "" for none; empty where none has one."""


@dataclass(frozen=True, kw_only=True)
class MeasuredPoints(MaterialPoints):
    """Points whose displacement, velocity and rotation are recorded every step."""

    name: tuple[str, ...] = ()
    """Name of each point."""


@dataclass(frozen=True, kw_only=True)
class MeasuredContacts:
    """Places and joints whose contacts are recorded every step; k of them."""

    name: tuple[str, ...] = ()
    """Name of each."""
    at: Floats = no_floats(2)
    """Place whose nearest contact is recorded, m, relative to the origin; nan: a joint, (k, 2)."""
    joint: Ints = no_ints()
    """Joint whose contacts are recorded together: index into those of the model; -1, (k,)."""


@dataclass(frozen=True, kw_only=True)
class Convergences:
    """Pairs of measured points whose approach is recorded every step; k of them."""

    name: tuple[str, ...] = ()
    """Name of each."""
    point: Ints = no_ints(2)
    """Its two measured points, by their numbers, shape (k, 2)."""


@dataclass(frozen=True)
class PointSlices:
    """Rows of ``Model.material_points``, and of ``State.points``, by kind."""

    fixed: slice
    loaded: slice
    line_start: slice
    line_end: slice
    bolts: slice
    measured: slice


@dataclass(frozen=True, kw_only=True)
class StartOverlaps:
    """Pairs of blocks that lie in each other at the start, by more than round-off."""

    pair: Ints = no_ints(2)
    """Blocks of each pair, the lower first, shape (k, 2)."""
    depth: Floats = no_floats()
    """Width of their common area, m, shape (k,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Model:
    """A system of blocks with its materials, supports and loads."""

    made_by: ClassVar[Any] = None
    """Builder or case of a script that has made this very object; None: none is known."""
    title: str
    """Title of the case."""
    plane: Plane
    """Plane stress or plane strain."""
    gravity: Floats
    """Acceleration of gravity and of a push that lasts (x, y), m/s2, shape (2,)."""
    origin: Floats
    """Point that all coordinates of the model and the state are relative to, m, shape (2,)."""
    rocks: tuple[Rock, ...]
    """All rocks."""
    joint_table: JointTable
    """Joints and which contacts they belong to."""
    edge_joint: Ints
    """Joint index of the edge from each vertex to the next; -1: none of its own, shape (nv,)."""
    block_name: tuple[str, ...]
    """Name of each block."""
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    block_rock: Ints
    """Rock index of each block, shape (n,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,); those that are ``absent`` included."""
    vertices: Floats
    """Vertices at the start, counter-clockwise by block, m, shape (nv, 2)."""
    velocity: Floats
    """Initial velocity (u, v, r, ex, ey, gxy) of each block, m/s, rad/s, 1/s, shape (n, 6)."""
    initial_stress: Floats
    """Initial stress (xx, yy, xy) of each block, Pa, shape (n, 3)."""
    area: Floats
    """Area of each block at the start, m2, shape (n,); with density it gives the constant mass."""
    fixed_points: MaterialPoints
    """Points held in place by stiff springs."""
    point_loads: PointLoads
    """Forces at points."""
    line_loads: LineLoads
    """Tractions along lines."""
    measured_points: MeasuredPoints
    """Points recorded every step."""
    measured_contacts: MeasuredContacts = field(default_factory=MeasuredContacts)
    convergences: Convergences = field(default_factory=Convergences)
    """Contacts recorded every step."""
    pressures: EdgePressures = field(default_factory=EdgePressures)
    """Pressures on edges."""
    surcharge: Surcharge = field(default_factory=Surcharge)
    """Fill and axles, whose forces are among the point loads, as pictures show them."""
    bolts: Bolts = field(default_factory=Bolts)
    """Rock bolts."""
    water: tuple[Water, ...] = ()
    """Water that presses on outer faces and in joints."""
    flow: Flow | None = None
    """Water that flows in joints; None: it does not."""
    factors: tuple[Factor, ...] = ()
    """Tables of time by which loads are multiplied."""
    gravity_factor: int = NO_FACTOR
    """Number of the table by which gravity is multiplied; NO_FACTOR: it is constant."""
    reactions: Reactions = field(default_factory=Reactions)
    """Reactions of supports that are recorded."""
    drawpoints: tuple[Drawpoint, ...] = ()
    """Lines past which blocks leave while the run goes on."""
    begun: tuple[tuple[str, float], ...] = ()
    """Name of each stage that has begun, and when, s."""
    actions: tuple[Any, ...] = ()
    """Further actions on blocks: objects with the methods of ``clast.actions.action.Action``."""
    ground_motion: GroundMotion = field(default_factory=Still)
    """Motion of the ground: none, a body force, or a motion of the fixed points."""
    viscous_edges: ViscousEdges = field(default_factory=ViscousEdges)
    """Edges behind which rock goes on that takes up waves."""
    in_situ: InSituStress | None = None
    """Stress in the rock before anything is dug; None where there is none."""
    openings: tuple[OpeningBlocks, ...] = ()
    """Blocks that stages may excavate together."""
    absent: Bools
    """True where a block is not there: excavated, or the segment of a lining to come; shape (n,).

    Nothing meets it or acts on it.

    It keeps its place in all arrays, and is ``fixed``, too.
    """
    overlaps: StartOverlaps = field(default_factory=StartOverlaps)
    """Blocks that overlap at the start, as contacts in penetration do."""
    repairs: tuple[Repair, ...] = ()
    """Repairs to blocks so that they touch, where that was asked for."""
    notes: tuple[str, ...] = ()
    """Changes to the input, e.g. loops that were turned round."""

    def __post_init__(self) -> None:
        """Make the arrays read-only, but for actions of a script."""
        seal(self, but=("actions",))

    @property
    def block_count(self) -> int:
        """Number of blocks n."""
        return len(self.block_rock)

    @kept_property
    def vertex_block(self) -> Ints:
        """Block index of each vertex, shape (nv,)."""
        return owners(self.block_start)

    @kept_property
    def vertex_before(self) -> Ints:
        """Vertex before each one in its block, shape (nv,)."""
        return np.argsort(self.vertex_after)

    @kept_property
    def vertex_after(self) -> Ints:
        """Vertex after each one in its block, shape (nv,)."""
        return following(self.block_start)

    @kept_property
    def density(self) -> Floats:
        """Density of each block, kg/m3, shape (n,)."""
        return np.array([rock.density for rock in self.rocks])[self.block_rock]

    @kept_property
    def mass(self) -> Floats:
        """Mass of each block, kg per metre of thickness, shape (n,); constant."""
        return self.density * self.area

    @kept_property
    def lightest(self) -> float:
        """Mass of the lightest block that can move, kg/m, inf where none can."""
        return float(self.mass[~self.fixed].min(initial=np.inf))

    @kept_property
    def size_of_gravity(self) -> float:
        """Size of the acceleration of gravity, m/s2."""
        return float(np.hypot(*self.gravity))

    @property
    def usual_gravity(self) -> float:
        """Acceleration by which falls and speeds are judged, m/s2: 9.8 where there is none."""
        return self.size_of_gravity or 9.8

    @kept_property
    def edges_name_joints(self) -> bool:
        """Whether any edge says which joint it is."""
        return bool(self.edge_joint.max(initial=-1) >= 0)

    @kept_property
    def smallest(self) -> float:
        """Area of the smallest body that is there, m2: a block, or fixed ones that are one."""
        area = self.area if self.outlines is None else self.outlines.area
        return float(area[~self.absent].min())

    @kept_property
    def rank(self) -> Ints:
        """Place of each block in an order that no numbering, turn, mirror or shift changes, (n,).

        Larger blocks come first, and of equal ones those nearer to the middle of all rock.  Only
        blocks that nothing tells apart, on either side of a line of symmetry, go by number.
        """
        away, start = self._from_the_middle, self.block_start
        mean = np.add.reduceat(away, start[:-1]) / np.diff(start)
        order = np.lexsort((_alike(mean, mean.max()), -_alike(np.log(self.area), 1.0)))
        return _places(order)

    @kept_property
    def vertex_rank(self) -> Ints:
        """The same of vertices, (nv,): those nearer to the middle of all rock come first.

        Of vertices at one place that of the block which comes first.
        """
        away = self._from_the_middle
        return _places(np.lexsort((self.rank[self.vertex_block], _alike(away, away.max()))))

    @kept_property
    def _from_the_middle(self) -> Floats:
        """Distance of each vertex from the middle of all rock at the start, m, (nv,)."""
        start = self.block_start
        mean = np.add.reduceat(self.vertices, start[:-1], axis=0) / np.diff(start)[:, None]
        ground = np.array([rock.is_ground for rock in self.rocks], np.bool_)[self.block_rock]
        weight = np.where(ground | ~ground.any(), self.area, 0.0)
        return np.hypot(*(self.vertices - np.average(mean, axis=0, weights=weight)).T)

    @kept_property
    def body(self) -> Ints:
        """Body of each block, shape (n,): a number that fixed blocks which are one share."""
        return np.arange(self.block_count) if self.outlines is None else self.outlines.body

    @kept_property
    def is_driven(self) -> bool:
        """True where an action prescribes motions."""
        return any(hasattr(action, "moves") for action in self.actions)

    @kept_property
    def apart(self) -> Ints:
        """Numbers lower x n + higher of pairs of blocks that never meet, by links, (p,)."""
        pairs = [action.apart for action in self.actions if hasattr(action, "apart")]
        apart = np.concatenate([np.zeros((0, 2), np.int64), *pairs])
        return apart[:, 0] * self.block_count + apart[:, 1]

    def meeting(self, pairs: Ints, block: Ints | slice = slice(None)) -> Ints:
        """Return the pairs (q, 2) that may meet, of blocks or of numbers with a ``block`` (o,)."""
        if not len(self.apart):
            return pairs
        of_blocks = np.sort(np.arange(self.block_count)[block][pairs], axis=1)
        key = of_blocks[:, 0] * self.block_count + of_blocks[:, 1]
        return np.ascontiguousarray(pairs[~np.isin(key, self.apart)])

    @kept_property
    def reacting(self) -> tuple[Ints, Ints]:
        """Blocks whose reactions are recorded, (s,), and the number of each or -1, (n,)."""
        asked = np.zeros(self.block_count, np.bool_)
        asked[self.reactions.of_block[:, 1]] = True
        return numbered(asked)

    @kept_property
    def links(self) -> tuple[str, ...]:
        """Names of the links."""
        return tuple(name for action in self.actions for name in getattr(action, "links", ()))

    @property
    def lining_joints(self) -> LiningJoints:
        """The joints of linings."""
        joints = [one.joints_in(self) for one in self.actions if hasattr(one, "joints_in")]
        return joints[0] if joints else LiningJoints()

    @kept_property
    def link_lines(self) -> LinkLines:
        """The links that stand at a point, in coordinates of the user."""
        links = [action.lines for action in self.actions if hasattr(action, "lines")]
        if not links:
            return LinkLines()
        return LinkLines(
            name=tuple(name for one in links for name in one.name),
            block=np.concatenate([one.block for one in links]),
            at=np.concatenate([one.at for one in links]) + self.origin,
            along=np.concatenate([one.along for one in links]),
            holds=np.concatenate([one.holds for one in links]),
        )

    @kept_property
    def moved(self) -> Bools:
        """True where an action may prescribe a motion of a block (``moves``), shape (n,)."""
        moved = np.zeros(self.block_count, np.bool_)
        for action in self.actions:
            moved[getattr(action, "moves", ())] = True
        return moved

    @kept_property
    def lined(self) -> Bools:
        """True for segments of linings, which stages may add, shape (n,)."""
        lined = np.zeros(self.block_count, np.bool_)
        for action in self.actions:
            lined[np.asarray(getattr(action, "segments", ()), np.int64)] = True
        return lined

    @kept_property
    def outlines(self) -> Outlines | None:
        """Outlines on which contacts are looked for, None where they are those of the blocks.

        Where joints have neither stiffness nor bond, and carry nothing from the start.
        """
        _, cohesion, tensile_strength = self.joint_table.strengths
        own = [*cohesion, *tensile_strength, *np.nan_to_num(self.joint_table.stiffnesses).ravel()]
        if any(own) or self.in_situ is not None:
            return None
        still = self.fixed & ~self.moved
        joined = joined_outlines(self.vertices, self.block_start, self.area, still, self.absent)
        return None if joined is None else replace(joined, fixed=self.fixed[joined.block])

    @kept_property
    def elasticity(self) -> Floats:
        """Elasticity matrix E' of each block, Pa, shape (n, 3, 3)."""
        by_rock = np.array([self.plane.elasticity(r.young, r.poisson) for r in self.rocks])
        return by_rock[self.block_rock]

    @kept_property
    def impedances(self) -> Floats:
        """Impedances rho c_p and rho c_s of each block, Pa s/m, shape (n, 2).

        c_p^2 = E'_11/rho, c_s^2 = G/rho: of waves in the plane, by the plane assumption.
        """
        moduli = self.elasticity[:, [0, 2], [0, 2]]
        return np.asarray(np.sqrt(self.density[:, None] * moduli))

    @kept_property
    def compliance(self) -> Floats:
        """Inverse of the elasticity matrix of each block, 1/Pa, shape (n, 3, 3)."""
        return np.ascontiguousarray(np.linalg.inv(self.elasticity), np.float64)

    @kept_property
    def stiffest(self) -> float:
        """Largest Young's modulus of the blocks, Pa, without linings where there are others.

        Contact stiffness follows from it: a lining, which may come in a later stage, and a rock
        that no block has do not change how the ground moves.
        """
        used = [self.rocks[k] for k in np.unique(self.block_rock)]
        ground = [rock.young for rock in used if rock.is_ground]
        return max(ground or [rock.young for rock in used])

    @kept_property
    def longest_edge(self) -> float:
        """Length of the longest edge at the start, m."""
        return float(np.hypot(*(self.vertices[self.vertex_after] - self.vertices).T).max())

    @property
    def _points_by_kind(self) -> tuple[tuple[Ints, Floats], ...]:
        """Blocks and places of material points, in the order of ``PointSlices``."""
        lines = self.line_loads
        return (
            (self.fixed_points.block, self.fixed_points.at),
            (self.point_loads.block, self.point_loads.at),
            (lines.block, lines.start),
            (lines.block, lines.end),
            (self.bolts.block, self.bolts.at),
            (self.measured_points.block, self.measured_points.at),
        )

    @kept_property
    def material_points(self) -> MaterialPoints:
        """All material points in one list: fixed, loaded, line starts and ends, bolts, measured."""
        block, at = map(np.concatenate, zip(*self._points_by_kind, strict=True))
        return MaterialPoints(block=block, at=at)

    @kept_property
    def point_slices(self) -> PointSlices:
        """Which of the material points are of which kind."""
        stops = [0, *accumulate(len(block) for block, _ in self._points_by_kind)]
        return PointSlices(*map(slice, stops[:-1], stops[1:]))

    def blocks_called(self, names: Iterable[str]) -> Ints:
        """Return the blocks of openings and blocks by their ``names``, each once, shape (k,).

        Raises ModelError for a name that neither has.
        """
        return blocks_called(names, self.openings, self.block_name)

    def polygon(self, block: int) -> Floats:
        """Return the start outline of one block in user coordinates, m, shape (k, 2)."""
        rows = slice(self.block_start[block], self.block_start[block + 1])
        return self.vertices[rows] + self.origin

    def _repr_html_(self) -> str:
        rows = [
            ("blocks", f"{self.block_count} ({int(self.fixed.sum())} fixed)"),
            ("rocks", ", ".join(rock.name for rock in self.rocks)),
            ("joints", ", ".join(joint.name for joint in self.joint_table.joints)),
            ("measured points", ", ".join(self.measured_points.name) or "none"),
        ]
        drawing = thumbnails.blocks(self.vertices, self.block_start, self.fixed)
        return thumbnails.side_by_side(self.title or "Model", drawing, rows)

    def __repr__(self) -> str:
        return (
            f"Model('{self.title}', {self.block_count} blocks ({int(self.fixed.sum())} fixed), "
            f"{len(self.vertices)} vertices; rocks: {', '.join(r.name for r in self.rocks[:4])}; "
            f"joints: {', '.join(joint.name for joint in self.joint_table.joints[:4])})"
        )


def _alike(values: Floats, size: float) -> Ints:
    """Return numbers that ascend with values (n,), the same for those that hardly differ, (n,)."""
    order = np.argsort(values, kind="stable")
    # Difference of sizes and places of blocks that is none, as a share: coordinates are rounded
    apart = np.diff(values[order], prepend=values[order[:1]]) > 1e-7 * size
    number = np.empty(len(values), np.int64)
    number[order] = np.cumsum(apart)
    return number


def _places(order: Ints) -> Ints:
    """Return the place of each thing in an order (n,)."""
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return place
