"""From blocks, rocks, joints, supports and loads in a script (or a case file) to a Model.

    from clast import ModelBuilder

    builder = ModelBuilder(title="Block on an incline")
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=20.0)
    builder.block(name="incline", vertices=[(0, 0), (10, 0), (0, 10)])
    builder.block(name="slider", vertices=[(1, 9), (4, 6), (4, 9)])
    builder.fixed_point((0, 0))
    builder.measured_point("A", (1, 9), block="slider")
    model = builder.build()

Methods take the keys of the tables of a case file, and refuse values that a table alone can judge;
how things fit together is judged by ``InputBuilder.build``, so they may be added in any order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
import shapely

from clast.actions.in_situ import loaded_parts
from clast.errors import ModelError, shortened
from clast.inputs import materials
from clast.inputs.blocks import BlockTable, RepairTable
from clast.inputs.bolts import Bolt, BoltKind, BoltPattern, Directions, with_directions
from clast.inputs.declaring.builder_methods import PlaneOfBuilder, gives, gives_named, single
from clast.inputs.declaring.table import Inputs, Table
from clast.inputs.declaring.values import (
    TITLE_LENGTH_MAX,
    check_actions,
    check_numbers,
    check_point_names,
)
from clast.inputs.drawpoints import DrawpointTable, drawpoints_in
from clast.inputs.flow import FlowBoundary, FlowTable, FlowWhere, MeasuredFlow, Well
from clast.inputs.ground_motion import GroundMotionTable, check_ground_motion
from clast.inputs.in_situ import InSituTable, Overburden
from clast.inputs.linings import linings as place_linings
from clast.inputs.linings.linings import Lining
from clast.inputs.loads import (
    Amplitude,
    FixedPoint,
    LineLoad,
    PointLoad,
    Pressure,
    fixed_points_in,
    line_loads_in,
    measured_points_in,
    point_loads_in,
    points_placed,
    pressed_edges,
)
from clast.inputs.materials import joint_table, joints_of_edges
from clast.inputs.measurements import (
    MeasuredContact,
    MeasuredConvergence,
    MeasuredPoint,
    MeasuredReaction,
    Supported,
    contacts_measured,
    convergences_in,
    reactions_in,
)
from clast.inputs.placing.bolt_lines import Ground
from clast.inputs.placing.bolts import ends_of, idle_note, placed_bolts
from clast.inputs.placing.place_blocks import BlockArrays, Names, Vector, rocks_of
from clast.inputs.placing.place_flow import FlowInputs, with_flow
from clast.inputs.rock_mass import OpeningTable, of_blocks, openings_of
from clast.inputs.rockfall import (
    BarrierTable,
    CollectorTable,
    RockfallTable,
    SourceTable,
    Surface,
)
from clast.inputs.supports.links import Link, Moment
from clast.inputs.supports.motions import Motion
from clast.inputs.surcharges import Fill, LoadTrain, SurfaceLoading, joined, surcharge_in
from clast.inputs.viscous_boundaries import (
    ViscousBoundary,
    Where,
    check_incoming,
    viscous_edges,
    with_where,
)
from clast.inputs.water import Bed, Water, waters_in
from clast.model import checks as model_checks
from clast.model import ranges
from clast.model.checks import BlockOutlines, RepairedBlocks
from clast.model.edges import edges_on
from clast.model.ground_motion import Still, ending_note
from clast.model.joints import WELD_STRENGTH
from clast.model.model import Bools, Floats, Ints, Model, PlaneStrain
from clast.model.ranges import check_names
from clast.model.surroundings import InSituStress


@dataclass
class InputBuilder(Inputs):
    """Collects the parts of a system of blocks; ``build`` checks it and makes the Model.

    Lengths in m, forces in N per metre of thickness, stresses in Pa (tension positive, order xx,
    yy, xy), angles in degrees, velocities in m/s and rad/s.
    """

    title: str = ""
    """Title."""
    plane: Any = PlaneOfBuilder()
    """Plane assumption: "stress", "strain" or an object, e.g. ``clast.PlaneStrain()``."""
    gravity: Vector = (0.0, -9.8)
    """Acceleration of gravity [x, y], m/s2."""
    gravity_amplitude: str | None = None
    """Name of the amplitude of gravity over time."""
    seismic_coefficient: Vector = (0.0, 0.0)
    """Push on all blocks that lasts, as a share [x, y] of their weight."""
    ground_motion: Any = single("ground_motion", GroundMotionTable, Still())
    """Earthquake or shaking table: the keys of [ground_motion], or e.g. ``clast.MovingBase``."""
    in_situ: Any = single("in_situ", InSituTable)
    """Stress in the rock before anything is dug: the keys of [in_situ], ``clast.InSituStress`` or
    ``clast.Overburden``."""
    flow: Any = single("flow", FlowTable)
    """Water that flows in joints: the keys of [flow]."""
    rockfall: Any = single("rockfall", RockfallTable)
    """Profile that rocks fall on: the keys of [rockfall]."""
    actions: list[Any] = field(default_factory=list)
    """Objects of one's own that act on blocks (clast.actions.action)."""
    line_joints: list[str] = field(default_factory=list)
    """Joints of lines, whether or not these become edges of blocks."""
    repair: Any = single("repair", RepairTable)
    """Repair of blocks that are drawn a little apart: the keys of [repair], or
    ``clast.rockmass.BlockRepair``."""
    _entries: list[BlockArrays] = field(default_factory=list, init=False)
    opening_outlines: dict[str, Floats] = field(default_factory=dict, init=False)
    """Outlines of openings by name, counter-clockwise, m, (c, 2) each: for patterns of bolts."""
    _count: int = field(default=0, init=False)
    _placed: tuple[place_linings.PlacedLining, ...] = field(default=(), init=False)

    add_rock = gives_named("rock", materials.Rock)
    """Add a rock, ``[rock.NAME]``, and return its name."""
    add_joint = gives_named("joint", materials.Joint, usual="default")
    """Add a joint, ``[joint.NAME]``, and return its name.

    The joint called "default" serves every contact that no other joint names with ``between``
    (pairs of blocks) or ``between_rocks`` (pairs of rocks, equal ones allowed); a pair of blocks
    takes precedence over the joints of edges (``edge_joint`` of blocks), and these over a pair of
    rocks.  Without any default, contacts are frictionless.
    """
    add_bolt_kind = gives_named("bolt_kind", BoltKind)
    """Add a kind of bolt, ``[bolt_kind.NAME]``, and return its name."""
    block = gives("block", BlockTable)
    """Add a block by its counter-clockwise vertices, ``[[block]]``, and return its name."""
    bolt = gives("bolt", Bolt, "start", "end")
    """Set a bolt from its head ``start`` to ``end``: ``[[bolt]]``."""
    bolt_pattern = gives(
        "bolt_pattern", BoltPattern, "opening", turned=with_directions, also=Directions
    )
    """Set bolts round an opening, ``[[bolt_pattern]]``; ``angles`` are first and last direction."""
    viscous_boundary = gives("viscous_boundary", ViscousBoundary, turned=with_where, also=Where)
    """Let waves leave, ``[[viscous_boundary]]``: on a ``side``, on ``edges``, in a ``polygon``."""
    opening = gives("opening", OpeningTable, "name", "blocks", "weld", turned=of_blocks)
    """Let stages excavate ``blocks`` together under a name: ``[[opening]]``.

    ``weld`` names a joint (``add_weld``): edges with it hold the inside and the outside together
    until the opening is excavated, and have no joint of their own afterwards.
    """
    fixed_point = gives("fixed_point", FixedPoint, "at", "block")
    """Hold a point of a block in place: ``[[fixed_point]]``."""
    add_amplitude = gives_named("amplitude", Amplitude, "time", "value")
    """Add a factor of loads over time, ``[amplitude.NAME]``, and return its name."""
    point_load = gives("point_load", PointLoad, "at", "force", "block", "amplitude", "name")
    """Apply a force at a point of a block: ``[[point_load]]``."""
    line_load = gives(
        "line_load", LineLoad, "start", "end", "traction", "block", "amplitude", "name"
    )
    """Apply a traction along a line of a block: ``[[line_load]]``."""
    pressure = gives("pressure", Pressure, "start", "end", "value", "block", "amplitude", "name")
    """Press on the edges along a line: ``[[pressure]]``."""
    fill = gives("fill", Fill, "surface", "density")
    """Let the weight of fill rest on blocks: ``[[fill]]``."""
    load_train = gives("load_train", LoadTrain, "path", "position", "axles", "loads")
    """Let axles stand on a path over the blocks: ``[[load_train]]``."""
    measured_point = gives("measured_point", MeasuredPoint, "name", "at", "block")
    """Record displacement, velocity and rotation of a point, every step: ``[[measured_point]]``."""
    measured_convergence = gives("measured_convergence", MeasuredConvergence, "name", "of")
    """Record the approach of two measured points, every step: ``[[measured_convergence]]``."""
    measured_contact = gives("measured_contact", MeasuredContact, "name", "at")
    """Record forces, opening and slip at a place or of a joint: ``[[measured_contact]]``."""
    measured_reaction = gives("measured_reaction", MeasuredReaction, "name")
    """Record a reaction beside the totals, every step: ``[[measured_reaction]]``."""
    drawpoint = gives("drawpoint", DrawpointTable, "name", "line", "rate")
    """Take out blocks that pass a line while the run goes on: ``[[drawpoint]]``."""
    motion = gives("motion", Motion)
    """Prescribe the motion of blocks: ``[[motion]]``."""
    link = gives("link", Link, "at")
    """Link two blocks, or a block and the ground, at a point: ``[[link]]``."""
    lining = gives("lining", Lining, "name")
    """Line an opening, an outer edge or a polyline: ``[[lining]]``."""
    moment = gives("moment", Moment, "block", "moment")
    """Turn a block by a moment: ``[[moment]]``."""
    water = gives("water", Water, "level")
    """Let water press on all edges below a level or a phreatic line:  ``[[water]]``."""

    flow_boundary = gives(
        "flow_boundary",
        FlowBoundary,
        "name",
        turned=partial(with_where, kind=FlowWhere),
        also=FlowWhere,
    )
    """Give heads, pressures, rain or faces in air to the flow: ``[[flow_boundary]]``."""
    well = gives("well", Well, "name", "at")
    """Take water from joints, or put it into them: ``[[well]]``."""
    measured_flow = gives("measured_flow", MeasuredFlow, "name", "of")
    """Record a flow every step: ``[[measured_flow]]``."""

    add_surface = gives_named("surface", Surface, "normal_restitution")
    """Add a surface of the profile, ``[surface.NAME]``, and return its name."""
    source = gives("source", SourceTable, "name", "at")
    """Let rocks fall from a point or a line: ``[[source]]``."""
    barrier = gives("barrier", BarrierTable, "name", "x", "height")
    """Put a barrier on the profile: ``[[barrier]]``."""
    collector = gives("collector", CollectorTable, "name", "x")
    """Measure the rocks that pass a place: ``[[collector]]``."""

    def count(self, kind: type[Table]) -> int:
        """Return how many tables of a kind there are; blocks are counted with those of arrays."""
        return self._count if kind is BlockTable else super().count(kind)

    def add_weld(self, name: str) -> str:
        """Add a joint that no load opens or shears, and return its name.

        Cohesion and tensile strength are WELD_STRENGTH, Pa: the springs of its contacts are linear.
        """
        return self.add_joint(name, cohesion=WELD_STRENGTH, tensile_strength=WELD_STRENGTH)

    def add_block(self, record: BlockTable) -> str:
        """Add a block that its table has judged and return its name: its number if it has none."""
        entry = BlockArrays.of_table(self._count, record)
        self._count += 1
        self._entries.append(entry)
        return entry.names[0]

    def blocks(
        self,
        *,
        vertices: Floats,
        start: Ints | Sequence[int] | None = None,
        names: Sequence[str] | None = None,
        rock: str | Sequence[str] | None = None,
        fixed: bool | Bools = False,
        velocity: Vector = (0.0, 0.0, 0.0),
        initial_stress: Vector | None = None,
        edge_joint: Sequence[str] | None = None,
    ) -> tuple[str, ...]:
        """Add k blocks at once, as arrays; return their names.  A wall of a million takes 13 s.

        ``vertices`` in m are (k, s, 2) where every block has s corners, or (nv, 2) with the index
        of each block's first vertex, and nv, in ``start`` (k + 1,).  ``rock`` is one name or
        (k,), ``fixed`` one truth value or (k,); ``velocity`` and ``initial_stress`` are three
        numbers or (k, 3); ``edge_joint`` is (nv,).  Everything else, and every check, is that of
        ``block``: arrays of a million blocks have no table.

        A run is continued with another load, joint or method by making its last state a model; the
        contact penetration in it is not bad geometry (the next run refuses a penetration that
        contacts of the stiffness then chosen cannot have left):

            state, model = run.final, run.model
            builder.blocks(
                vertices=state.vertices,
                start=model.block_start,
                names=model.block_name,
                fixed=model.fixed,
                velocity=state.velocity[:, :3],
                initial_stress=state.stress,
                rock=[model.rocks[k].name for k in model.block_rock],
            )
        """
        entry = BlockArrays(
            self._count, names, rock, vertices, start, fixed, velocity, initial_stress, edge_joint
        )
        self._count += len(entry.names)
        self._entries.append(entry)
        return entry.names

    def build(self) -> Model:
        """Check everything and return the Model; raise ModelError with the remedy otherwise."""
        if self.has(Lining) and not self._placed:
            return self._with_linings().build()
        self._check_names()
        rocks = tuple(one.rock(name) for name, one in self.named(materials.Rock).items())
        for rock in rocks:
            if isinstance(self.plane, PlaneStrain) and rock.poisson == 0.5:
                what = f"{rock.poisson:g} is impossible in plane {self.plane.name}"
                where = f"rock '{shortened(rock.name)}', poisson"
                remedy = "Poisson's ratio is above -1 and below 0.5; rocks have 0.1 to 0.4"
                raise ModelError(what, where=where, remedy=remedy)
        drawn = self._outlines()
        clockwise = drawn.area < 0.0
        edge = drawn.turned_edges(clockwise)
        repaired, polygons = self._repaired(drawn, clockwise)
        outlines, edge = repaired.outlines, edge[repaired.edge]
        edge_joint = self._edge_joint_names()[edge]
        block_rock = rocks_of(self._entries, [rock.name for rock in rocks], len(self._placed))
        block_number = {name: number for number, name in enumerate(outlines.names)}
        rock_number = {rock.name: index for index, rock in enumerate(rocks)}
        along = {*np.unique(edge_joint).tolist(), *self.line_joints}
        joints = place_linings.with_bonds(self.named(materials.Joint), self._placed)
        table = joint_table(joints, rock_number, block_number, along)
        waiting = {name for one in self._placed if one.table.stage for name in one.names}
        waits = np.array([name in waiting for name in outlines.names], np.bool_)
        there = np.where(waits, shapely.Polygon(), polygons)

        held = np.concatenate([entry.held() for entry in self._entries])
        everything = Ground(
            outlines=outlines,
            tree=shapely.STRtree(polygons),
            moved=repaired.moved,
            tolerance=repaired.tolerance,
            factors=tuple(one.factor(name) for name, one in self.named(Amplitude).items()),
            fixed=held,
        )
        fixed = fixed_points_in(self.all(FixedPoint), everything)
        measured = measured_points_in(self.all(MeasuredPoint), everything)
        points = point_loads_in(self.all(PointLoad), everything)
        lines = line_loads_in(self.all(LineLoad), everything)
        ground = replace(everything, tree=shapely.STRtree(there), points=fixed)
        blocks_of_openings = [one.name for one in self.all(OpeningTable)]
        bolts = placed_bolts(self, self.opening_outlines, blocks_of_openings, ground)
        pressures, uncovered = pressed_edges(self.all(Pressure), ground)
        linked = sum(one.block is not None for one in self.all(Link))
        check_ground_motion(self.ground_motion, len(fixed.block) + linked)
        viscous = viscous_edges(self.all(ViscousBoundary), everything)
        check_incoming(self.ground_motion, viscous, outlines)
        check_actions(self.actions)
        gravity = check_numbers(self.gravity, 2, "gravity", ranges.ACCELERATION)
        gravity_factor = ground.amplitude(self.gravity_amplitude, "gravity_amplitude")
        surface = SurfaceLoading(gravity=gravity, gravity_factor=gravity_factor, there=~waits)
        resting, surcharge, idle = surcharge_in(
            self.all(Fill), self.all(LoadTrain), ground, surface
        )
        density = np.array([rock.density for rock in rocks])[block_rock]
        own_joints = joints_of_edges(table, edge_joint)
        openings = openings_of(self.all(OpeningTable), block_number, edge_joint)
        bed = Bed(
            ground=ground,
            table=table,
            edge_joint=own_joints,
            block_rock=block_rock,
            gravity=gravity,
            openings={k: ring - outlines.origin for k, ring in self.opening_outlines.items()},
            blocks_of_openings={one.name: one.block for one in openings},
            waits=waits,
        )
        water, wet = waters_in(self.all(Water), bed)
        area = np.where(waits, 0.0, outlines.area)  # linings that come later weigh nothing yet
        in_situ = self._stress_in_situ(outlines, area, density, gravity)
        linings = place_linings.linings_of_ground(self._placed, ground, self.plane)
        actions = *self.actions, *self.actions_from(ground), *linings
        # links may let blocks overlap
        apart = {pair for one in actions for pair in map(tuple, getattr(one, "apart", ()))}
        overlaps = model_checks.check_overlaps(outlines, there, apart)
        model = Model(
            title=self.title,
            plane=self.plane,
            gravity=gravity + self._push(gravity),
            gravity_factor=gravity_factor,
            origin=outlines.origin,
            rocks=rocks,
            joint_table=table,
            edge_joint=own_joints,
            block_name=outlines.names,
            block_start=outlines.start,
            block_rock=block_rock,
            fixed=held | waits,
            vertices=outlines.vertices,
            velocity=self._velocities(outlines, held),
            initial_stress=self._initial_stresses(outlines, block_rock, in_situ),
            in_situ=in_situ,
            viscous_edges=viscous,
            area=outlines.area,
            fixed_points=ground.points,
            point_loads=joined([points, resting]),
            surcharge=surcharge,
            line_loads=lines,
            pressures=pressures,
            bolts=bolts,
            water=water,
            factors=ground.factors,
            measured_points=measured,
            measured_contacts=contacts_measured(self.all(MeasuredContact), table, outlines.origin),
            convergences=convergences_in(self.all(MeasuredConvergence), measured),
            ground_motion=self.ground_motion,
            actions=actions,
            drawpoints=drawpoints_in(self.all(DrawpointTable), outlines.origin),
            openings=openings,
            absent=waits,
            overlaps=overlaps,
            repairs=repaired.repairs,
            notes=(
                *self.notes,
                *model_checks.turned_note(outlines, clockwise),
                *uncovered,
                *idle,
                *idle_note(bolts),
                *everything.beside_note(
                    (*points_placed((fixed, measured, points, lines)), *ends_of(bolts))
                ),
                *wet,
                *ending_note(self.ground_motion),
            ),
        )
        outline = np.zeros(0, np.int64) if in_situ is None else loaded_parts(model, in_situ)[0]
        supports = Supported(ground, viscous.edge, np.unique(outline), actions)
        model = replace(model, reactions=reactions_in(self.all(MeasuredReaction), supports))
        flow = FlowInputs(
            flow=self.flow,
            boundaries=self.all(FlowBoundary),
            wells=self.all(Well),
            measured=self.all(MeasuredFlow),
        )
        return with_flow(model, flow, bed)

    def _stress_in_situ(
        self, outlines: BlockOutlines, area: Floats, density: Floats, gravity: Floats
    ) -> InSituStress | None:
        """Return the stress in the rock, with the edges of openings.

        That of the overburden is by the mean of ``density`` (n,), kg/m3, over ``area`` (n,), m2.
        """
        given: InSituStress | Overburden | None = self.in_situ
        if isinstance(given, Overburden):
            mean = float((density * area).sum() / area.sum())
            given = given.stress(mean, gravity, outlines.top)
        if given is None or not self.opening_outlines:
            return given
        rings = [ring - outlines.origin for ring in self.opening_outlines.values()]
        voids = edges_on(rings, outlines.vertices, outlines.following)
        return replace(given, voids=tuple(map(int, voids)))

    def _with_linings(self) -> InputBuilder:
        """Return the same with the segments of linings among the blocks."""
        if self.repair is not None:
            remedy = "repair the drawing first (clast cut), and line the repaired blocks"
            what = "a lining cannot follow blocks that are repaired"
            raise ModelError(what, where="lining", remedy=remedy)
        drawn = self._outlines()
        whole = replace(drawn, vertices=drawn.vertices + drawn.origin)
        lined = copy(self)
        lined._entries, lined._named = [*self._entries], {**self._named}
        lined._named[materials.Rock] = {**self.named(materials.Rock)}
        lined._placed = place_linings.placed_linings(
            self.all(Lining),
            shapely.make_valid(whole.polygons()),
            drawn.names,
            self.opening_outlines,
            {one.name: one.blocks for one in self.all(OpeningTable)},
        )
        rocks = list(self.named(materials.Rock).values())
        for one in lined._placed:
            material = place_linings.material(one.table, self.plane, rocks)
            lined._named[materials.Rock][one.rock] = material
            lined._entries.append(place_linings.entry(one, lined._count))
            lined._count += len(one.names)
        return lined

    def _push(self, gravity: Floats) -> Floats:
        """Return the acceleration, m/s2, of the push that lasts, shape (2,)."""
        where = "seismic_coefficient"
        share = check_numbers(self.seismic_coefficient, 2, where, ranges.FACTOR)
        if share.any() and not gravity.any():
            what = "is a share of the weight, but there is no gravity"
            raise ModelError(what, where=where, remedy="give gravity, or leave it out")
        return np.asarray(np.hypot(*gravity) * share)

    def _repaired(
        self, drawn: BlockOutlines, clockwise: Bools
    ) -> tuple[RepairedBlocks, model_checks.Geometries]:
        """Return the blocks counter-clockwise, put together if that is asked for, and checked."""
        turned = drawn.turned(clockwise)
        if self.repair is None:
            # As they were drawn, so that messages number the vertices as the user does.
            polygons = drawn.polygons()
            model_checks.check_polygons(drawn, polygons)
            edge = np.arange(len(drawn.vertices))
            return RepairedBlocks(outlines=turned, edge=edge), polygons
        repaired = self.repair(turned)
        polygons = repaired.outlines.polygons()
        model_checks.check_polygons(repaired.outlines, polygons)
        return repaired, polygons

    def _check_names(self) -> None:
        # Refuse titles that a result file cannot hold.
        title = self.title
        if not isinstance(title, str):
            what = f"{shortened(repr(title))} is not text"
            raise ModelError(what, where="title", remedy="give it in quotes")
        if "\0" in title or len(title) > TITLE_LENGTH_MAX:
            what = "holds a NUL character" if "\0" in title else f"has {len(title)} characters"
            remedy = f"give a text of at most {TITLE_LENGTH_MAX} characters"
            raise ModelError(what, where="title", remedy=remedy)
        check_names("rock", list(self.named(materials.Rock)))
        check_names("joint", list(self.named(materials.Joint)))
        check_names("block", self.block_names())
        check_names("amplitude", list(self.named(Amplitude)))
        check_point_names([one.name for one in self.all(MeasuredPoint)])

    def block_names(self) -> list[str]:
        """Return the names of the blocks until now, in their order."""
        return [name for entry in self._entries for name in entry.names]

    def _outlines(self) -> BlockOutlines:
        """Return all loops as flat arrays about an origin near the case."""
        names = tuple(self.block_names())
        loops = [entry.loops for entry in self._entries]
        counts = np.concatenate([np.zeros(1, np.int64), *(count for count, _ in loops)])
        start = np.cumsum(counts)
        vertices = np.concatenate([np.zeros((0, 2)), *(vertices for _, vertices in loops)])
        given = BlockOutlines(names, start, vertices, np.zeros(2))
        model_checks.check_corner_count(given)
        model_checks.check_coordinates(given)
        origin = _origin(vertices)
        return BlockOutlines(names, start, np.ascontiguousarray(vertices - origin), origin)

    def _edge_joint_names(self) -> Names:
        """Return the name of the joint of each edge, "" for none of its own, shape (nv,)."""
        return np.concatenate([entry.edge_joints() for entry in self._entries])

    def _velocities(self, outlines: BlockOutlines, fixed: Bools) -> Floats:
        """Return the start velocity (u, v, r, 0, 0, 0) of each block, shape (n, 6)."""
        velocity = np.zeros((self._count, 6))
        velocity[:, :3] = np.concatenate([entry.velocities() for entry in self._entries])
        for index in np.flatnonzero(velocity.any(axis=1) & fixed)[:1]:
            where, remedy = (
                f"{outlines.label(index)}, velocity",
                "remove the velocity, or fixed = true",
            )
            raise ModelError("a fixed block has no velocity", where=where, remedy=remedy)
        return velocity

    def _initial_stresses(
        self, outlines: BlockOutlines, block_rock: Ints, in_situ: InSituStress | None
    ) -> Floats:
        """Return the start stress (xx, yy, xy) of each block, Pa, shape (n, 3)."""
        rocks = self.named(materials.Rock).values()
        stress = np.array([one.initial_stress for one in rocks])[block_rock]
        if in_situ is not None:
            stress += in_situ.at(outlines.heights)
        for entry in self._entries:
            if (given := entry.stresses()) is not None:
                stress[entry.first : entry.first + len(given)] = given
        return np.ascontiguousarray(stress)


def _origin(vertices: Floats) -> Floats:
    """Return a rounded centre of the case where it is far from (0, 0), else (0, 0), m.

    Coordinates of 1e6 m leave 1e-10 m of resolution; taken about a centre they leave 1e-16.  The
    centre is rounded so that shifted coordinates stay readable.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float(np.hypot(*(high - low)))
    if size == 0.0 or np.abs([low, high]).max() <= 10.0 * size:
        return np.zeros(2)
    unit = 10.0 ** math.floor(math.log10(size))
    return np.asarray(np.round(0.5 * (low + high) / unit) * unit)
