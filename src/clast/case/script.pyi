"""The names of scripts, written by tools/script_stub.py from the declarations of inputs."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from numpy.typing import NDArray

from clast.actions.action import Action
from clast.block.rotation import RotationRule
from clast.case.case_file import Case
from clast.contact.corner_rules import CornerRule
from clast.contact.laws import ContactLaw
from clast.inputs.placing.place_blocks import Vector
from clast.linear.solvers import LinearSolver
from clast.model.model import Bools, Floats, Ints, Model, Plane
from clast.model.stages import Stage as _Stage
from clast.results import Run, RunRecorder
from clast.run.schedule import Progress, Schedule
from clast.step.integration import Integrator
from clast.step.method import Method, StepProcess

Pair = tuple[float, float] | list[float] | NDArray[Any]
"""Two numbers."""
Triple = tuple[float, float, float] | list[float] | NDArray[Any]
"""Three numbers."""
Numbers = Sequence[float] | NDArray[Any]
"""Any number of numbers."""
Points = Sequence[Pair] | NDArray[Any]
"""Points [x, y], shape (n, 2)."""
Names = tuple[str, ...] | list[str]
"""Names, not one name."""
Strengths = Mapping[str, Mapping[str, float]]

class ModelBuilder:
    """Collects the parts of a system of blocks, and makes the Model or a case of it.

    Lengths in m, forces in N per metre of thickness, stresses in Pa (tension positive, order xx,
    yy, xy), angles in degrees, velocities in m/s and rad/s.  Polygons are counter-clockwise.
    Its methods take the keys of a case file's tables; how things fit together is judged by
    ``build``, ``case`` and ``to_toml``.
    """

    title: str
    """Title."""
    plane: Literal["stress", "strain"] | Plane
    """Plane assumption: "stress", "strain" or an object, e.g. ``clast.PlaneStrain()``."""
    gravity: Pair
    """Acceleration of gravity [x, y], m/s2."""
    gravity_amplitude: str | None
    """Name of the amplitude of gravity over time."""
    seismic_coefficient: Pair
    """Push on all blocks that lasts, as a share [x, y] of their weight."""
    ground_motion: Any
    """Earthquake or shaking table: the keys of [ground_motion], or e.g. ``clast.MovingBase``.

    Keys:
        acts: "body-force": minus the acceleration on the mass of every block, motion is relative to the ground; "base": fixed points, links to the ground and ends of linings on it move with the ground. Fixed blocks do not move: a base that moves is held by fixed points; "incoming": the motion is that of a wave that comes up through the viscous edges that face down, half of the motion of an outcrop.
        file: Record beside the case file, instead of lists: columns t, ax and, if wanted, ay, or another format.
        format: "csv": columns of numbers; "at2": PEER, with NPTS and DT; "k-net": K-NET and KiK-net; "sac": SAC, needs the extra records; "auto": by the ending of the name, else by how the file begins.
        quantity: Quantity of the file; by default as the file states, else acceleration. Velocity is taken as linear between the instants, displacement as a cubic spline through them.
        unit: Unit of the values; by default that of the file. Columns of numbers need it as soon as one of format, quantity, direction, vertical as a file, baseline, after is given; without all of them they are in m/s2.
        direction: Direction [x, y] of the ground's motion for a file of one component; [1, 0] if absent.
        time: Times, s, increasing.
        acceleration: Horizontal acceleration of the ground at the instants, m/s2, to the right.
        vertical: Vertical acceleration of the ground at the instants, m/s2, upwards, or {file = ...} beside file; none if absent. The shorter of two files goes on with no acceleration.
        scale: Factor on all values: 9.81 for a record in g whose unit is not given.
        baseline: Correction of the accelerations: "none"; "linear": subtract the straight line that fits them best; "highpass:0.1": remove frequencies below 0.1 Hz, by a Butterworth filter of order 4 that runs forwards and backwards.
        after: After the last instant the ground keeps its velocity, "hold", or comes to rest within 1 s, "stop".
    """
    in_situ: Any
    """Stress in the rock before anything is dug: the keys of [in_situ], ``clast.InSituStress`` or ``clast.Overburden``.

    Keys:
        stress: Stress [xx, yy, xy] at the datum, Pa, tension positive.
        gradient: Its change by metre of depth below the datum, Pa/m.
        datum: Height y at which the stress holds, m: 0 if absent; the top of the rock for "overburden".
        vertical: In place of a stress: the weight of the rock above, by its mean density.
        k0: Horizontal by vertical stress, -, with vertical = "overburden".
        contacts: Whether contacts begin with the forces of the stress, or have to find them by moving.
        boundary: Support of the outline beside the stress that loads it: springs along its normal, in both directions, or none.
        sides: Sides of the box around all blocks that are loaded; all edges on the convex hull if empty.
    """
    flow: Any
    """Water that flows in joints: the keys of [flow].

    Keys:
        state: Steady flow between boundaries; flow that takes time; or water at rest under a level.
        coupling: "none": pressures act, and apertures are those of the start; "steady": at the end of a stage until equilibrium, or of a static run, apertures and pressures of state "steady" agree; "full": blocks open and close joints, and are moved by what flows, of state "transient".
        passes: Times that a step of "full" is solved again at most, for conductances to agree with it.
        level: Height y of water at rest, m, of state or initial "hydrostatic".
        initial: Water at the start of state "transient": steady flow, if absent, none, or at rest under a level.
        bulk_modulus: Bulk modulus of water, Pa, for flow that takes time.
        viscosity: Viscosity, Pa s.
        density: Density, kg/m3.
        longest: Longest piece of a channel, m; channels are not divided if absent.
        confined: True: all joints are full, and pressures may be negative; so it is without gravity.
    """
    rockfall: Any
    """Profile that rocks fall on: the keys of [rockfall].

    Keys:
        profile: Points [x, y] of the profile from left to right, m; overhangs are allowed. Blocks of the case stand on it; alone they are the profile.
        surface: Surface of each segment of the profile, or one for all: [surface.NAME].
        file: Table (.csv) with x, y and the surface from each point on, or drawing (.dxf) of lines whose layers are named like surfaces, in place of profile and surface; or track (.gpx) down the slope, with one surface.
        seed: Seed of all random numbers.
        time_limit: Time after which a path ends, s.
        stations: Places along the profile, at equal distances, at which passing rocks are measured.
    """
    actions: list[Any]
    """Objects of one's own that act on blocks (clast.actions.action)."""
    line_joints: list[str]
    """Joints of lines, whether or not these become edges of blocks."""
    repair: Any
    """Repair of blocks that are drawn a little apart: the keys of [repair], or ``clast.rockmass.BlockRepair``.

    Keys:
        tolerance: Largest gap or overlap of corners and edges that should coincide, m: vertices within it are merged, or moved onto the edge of another block; none moves further.
    """
    def __init__(
        self,
        title: str = ...,
        plane: Literal["stress", "strain"] | Plane = ...,
        gravity: Pair = ...,
        gravity_amplitude: str | None = ...,
        seismic_coefficient: Pair = ...,
        ground_motion: Any = ...,
        in_situ: Any = ...,
        flow: Any = ...,
        rockfall: Any = ...,
        actions: list[Any] = ...,
        line_joints: list[str] = ...,
        repair: Any = ...,
    ) -> None: ...
    def add_amplitude(self, name: str, time: Numbers, value: Numbers) -> str:
        """A factor of loads over time, linear between its instants and constant outside them.

        Loads name it in ``amplitude``; each step has the load times the value at its end.

        Args:
            name: Name by which others refer to it.
            time: Times, s, increasing.
            value: Values at the instants, -.
        """
        ...

    def add_bolt_kind(
        self,
        name: str,
        *,
        stiffness: float | None = None,
        young: float | None = None,
        area: float | None = None,
        out_of_plane_spacing: float | None = None,
        yield_force: float | None = None,
        rupture_elongation: float | None = None,
        rupture_strain: float | None = None,
        pretension: float = 0.0,
        compression: bool = False,
    ) -> str:
        """Stiffness and strength of bolts: stiffness, or young, area and out_of_plane_spacing.

        With stiffness its numbers are per metre of thickness, with out_of_plane_spacing of one bolt.

        Args:
            name: Name by which others refer to it.
            stiffness: Force per elongation, N/m per m.
            young: Young's modulus of one bolt, Pa; with area and out_of_plane_spacing in place of stiffness.
            area: Cross-section of one bolt, m2.
            out_of_plane_spacing: Distance between bolts along the thickness, m; with it all other numbers are of one bolt.
            yield_force: Force at which it yields, N per metre of thickness; N of one bolt with out_of_plane_spacing. It is elastic if absent.
            rupture_elongation: Elongation, plastic part included, at which it breaks, m; never if absent.
            rupture_strain: The same as a share of its length, -.
            pretension: Force at installation, N per metre of thickness; N of one bolt with out_of_plane_spacing.
            compression: True for bars, which carry compression; cables carry none.
        """
        ...

    def add_joint(
        self,
        name: str = "default",
        *,
        friction_angle: float = 0.0,
        cohesion: float = 0.0,
        tensile_strength: float = 0.0,
        residual_cohesion: float | None = None,
        residual_friction_angle: float | None = None,
        slip_weakening: float = 0.0,
        kinetic_friction_angle: float | None = None,
        critical_speed: float = 0.0,
        dilation_angle: float = 0.0,
        dilation_until: float | None = None,
        law: Literal["coulomb", "barton-bandis"] = "coulomb",
        jrc: float | None = None,
        jcs: float | None = None,
        sample_length: float | None = None,
        field_length: float | None = None,
        initial_aperture: float | None = None,
        strength_reduction: float | None = None,
        restitution: float | None = None,
        normal_stiffness: float | None = None,
        shear_stiffness: float | None = None,
        aperture: float | None = None,
        residual_aperture: float | None = None,
        maximum_aperture: float | None = None,
        hydraulic_law: Literal["cubic", "barton", "louis"] = "cubic",
        flow_factor: float | None = None,
        relative_roughness: float | None = None,
        between: Sequence[Names] = ...,
        between_rocks: Sequence[Names] = ...,
        allow_small_friction_angle: bool = False,
    ) -> str:
        """Strength and stiffness of contacts along a joint; default is for contacts without a joint.

        Args:
            name: Name by which others refer to it.
            friction_angle: Coulomb friction angle, degrees.
            cohesion: Cohesion, Pa; it remains while the joint slips, and is lost where it opens.
            tensile_strength: Tension cut-off, Pa; exceeding it removes tensile strength and cohesion.
            residual_cohesion: Cohesion after slip, Pa; 0: brittle, as mortar; all of it if absent: ideally plastic.
            residual_friction_angle: Residual friction angle, degrees; if absent, friction does not weaken.
            slip_weakening: Slip over which strengths fall from peak to residual, m; 0: at once.
            kinetic_friction_angle: Friction angle while the joint slides, degrees; the static one if absent.
            critical_speed: Sliding speed from which friction is kinetic, m/s; 0: at once.
            dilation_angle: Angle at which the joint opens as it slides, and closes as it slides back, degrees.
            dilation_until: Slip to either side at which dilation ends, m; it does not end if absent.
            law: Strength and closure of the joint: Coulomb's, or those of a rough joint.
            jrc: Joint roughness coefficient of a sample, up to 20; of law "barton-bandis".
            jcs: Compressive strength of the walls of a sample, Pa; of law "barton-bandis".
            sample_length: Length of the sample for jrc and jcs, m; 0.1 if absent.
            field_length: Length of the joint between cross joints, m, for which jrc and jcs are scaled; they are not scaled if absent.
            initial_aperture: Aperture of a rough joint without stress, m; jrc/50 mm if absent.
            strength_reduction: Factor by which the tangent of the mobilised friction angle of a rough joint is divided.
            restitution: Coefficient of restitution of impacts, 0 to 1; that of the process if absent.
            normal_stiffness: Normal stress per closure, Pa/m; the spring of method.contact_law if absent.
            shear_stiffness: Shear stress per slip, Pa/m; the spring of method.contact_law if absent.
            aperture: Aperture without stress, m, for [flow]; no water enters the joint if 0 or absent. A rough joint has its initial_aperture.
            residual_aperture: Least hydraulic aperture, m; a tenth of the aperture if absent.
            maximum_aperture: Largest hydraulic aperture, m; five times the aperture if absent.
            hydraulic_law: Hydraulic aperture of a mechanical one E: "cubic": E/flow_factor^(1/3); "barton": E^2/jrc^2.5 in micrometres, at most E; "louis": by relative_roughness.
            flow_factor: Factor by which roughness lowers the flow, of hydraulic_law "cubic"; 1 if absent.
            relative_roughness: Height of asperities over twice the aperture, -, 0.033 to 0.5, of hydraulic_law "louis".
            between: Pairs of blocks with this joint between them: [["a", "b"], ...].
            between_rocks: Pairs of rocks with this joint between their blocks: [["granite", "granite"], ...].
            allow_small_friction_angle: True if a friction angle below 1.6 really is in degrees, not in radians.
        """
        ...

    def add_rock(
        self,
        name: str,
        *,
        young: float,
        poisson: float,
        density: float,
        initial_stress: Triple = ...,
    ) -> str:
        """A linear elastic rock.

        Args:
            name: Name by which others refer to it.
            young: Young's modulus, Pa.
            poisson: Poisson's ratio, -; below 0.5 in plane strain.
            density: Density, kg/m3.
            initial_stress: Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive.
        """
        ...

    def add_surface(
        self,
        name: str,
        normal_restitution: float | str,
        *,
        tangential_restitution: float | str | None = None,
        friction_angle: float | str | None = None,
        rolling_resistance: float | str = 0.0,
        roughness: float | str = 0.0,
        roughness_spacing: float | None = None,
        speed_scaling: float | str | None = None,
    ) -> str:
        """A surface of the profile, as rocks bounce, slide and roll on it.

        Args:
            name: Name by which others refer to it.
            normal_restitution: Share R_n of the normal velocity that a blow gives back.
            tangential_restitution: Share R_t of the tangential velocity of the contact that a blow leaves.
            friction_angle: Friction angle, degrees, which bounds the tangential impulse; arctan((1 - R_t)/R_t) for sliding, and 84 for blows, if absent.
            rolling_resistance: Moment arm of the normal force, m.
            roughness: Standard deviation of the angle of the face that a corner strikes, degrees.
            roughness_spacing: Length along the profile of facets that have one angle in all blows of a path, m; each blow has an angle of its own if absent.
            speed_scaling: Normal speed K at which R_n halves, m/s: R_n/(1 + (v/K)^2), Pfeiffer and Bowen 1989.
        """
        ...

    def add_weld(self, name: str) -> str:
        """Add a joint that no load opens or shears, and return its name.

        Cohesion and tensile strength are WELD_STRENGTH, Pa: the springs of its contacts are linear.
        """
        ...

    def barrier(
        self,
        name: str,
        x: float,
        height: float,
        *,
        inclination: float = 0.0,
        capacity: float | None = None,
        restitution: float = 0.0,
        friction_angle: float = 30.0,
    ) -> None:
        """A barrier on the profile: a fence that takes energy up to its capacity, or a wall.

        Args:
            name: Name.
            x: Its foot, on the profile, m.
            height: Height along it, m.
            inclination: Angle from the vertical, positive towards +x, degrees.
            capacity: Kinetic energy that it takes, J: a rock with less is held, one with more goes on with the rest; a wall, which rocks bounce off, if absent.
            restitution: Share of the normal velocity that a wall gives back.
            friction_angle: Friction angle of a wall, degrees.
        """
        ...

    def block(
        self,
        *,
        vertices: Points,
        name: str | None = None,
        rock: str | None = None,
        fixed: bool = False,
        velocity: Triple = ...,
        initial_stress: Triple | None = None,
        edge_joint: Names | None = None,
    ) -> str:
        """A block by its coordinates.

        Args:
            vertices: Coordinates [x, y] of its vertices, counter-clockwise, m.
            name: Name; the block's number if absent.
            rock: Rock; may be left out where there is only one.
            fixed: True for a block that cannot move at all.
            velocity: Velocity (u, v, omega) at the start, m/s and rad/s, counter-clockwise.
            initial_stress: Stress (xx, yy, xy) at the start, Pa, tension positive; the rock's if absent.
            edge_joint: Joint of the edge from each vertex to the next, one name per vertex; "" for none.
        """
        ...

    def block_names(self) -> Names:
        """Return the names of the blocks until now, in their order."""
        ...

    def blocks(
        self,
        *,
        vertices: Floats,
        start: Ints | Sequence[int] | None = None,
        names: Sequence[str] | None = None,
        rock: str | Sequence[str] | None = None,
        fixed: bool | Bools = False,
        velocity: Vector = ...,
        initial_stress: Vector | None = None,
        edge_joint: Sequence[str] | None = None,
    ) -> Names:
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
        ...

    def bolt(
        self,
        start: Pair,
        end: Pair,
        *,
        kind: str,
        anchorage: Literal["ends", "grouted"] = "ends",
        free_length: float | None = None,
        pretension_is: Literal["initial", "jacked"] = "initial",
        stage: str | None = None,
        name: str | None = None,
        blocks: Names | None = None,
    ) -> None:
        """A bolt between two points, which move with their blocks.

        Args:
            start: Head [x, y], in a block or on its face, m.
            end: Other end [x, y], in another block, m.
            kind: Kind: [bolt_kind.NAME].
            anchorage: ends: one spring between head and toe; grouted: one for every joint that it crosses.
            free_length: Length on each side of a joint along which a grouted bolt is free, m.
            pretension_is: initial: changes with movement from the start; jacked: a jack holds it until a later stage begins, or to the end of the run.
            stage: Stage that installs it; it exists from the start if absent.
            name: Name; its number if absent.
            blocks: Blocks of both ends, the head first; needed only where blocks touch.
        """
        ...

    def bolt_pattern(
        self,
        opening: Points | str,
        *,
        kind: str,
        anchorage: Literal["ends", "grouted"] = "ends",
        free_length: float | None = None,
        pretension_is: Literal["initial", "jacked"] = "initial",
        stage: str | None = None,
        name: str | None = None,
        length: float,
        spacing: float,
        to: float = 360.0,
        angles: Pair = ...,
    ) -> None:
        """Bolts round an opening, radial from its centroid.

        Args:
            opening: Name of an [[opening]], or corners [x, y] of one, m.
            kind: Kind: [bolt_kind.NAME].
            anchorage: ends: one spring between head and toe; grouted: one for every joint that it crosses.
            free_length: Length on each side of a joint along which a grouted bolt is free, m.
            pretension_is: initial: changes with movement from the start; jacked: a jack holds it until a later stage begins, or to the end of the run.
            stage: Stage that installs it; it exists from the start if absent.
            name: Name of the pattern and its bolts; that of the opening if absent.
            length: Length of each bolt, m.
            spacing: Distance of the heads along the wall, m.
            to: Last direction, degrees; both ends keep half of the remaining spacing.
            angles: First and last direction, degrees, counter-clockwise from +x.
        """
        ...

    def build(self) -> Model:
        """Check everything and return the Model; raise ModelError with the remedy otherwise."""
        ...

    def case(
        self,
        *,
        stages: Sequence[Stage] = ...,
        step: float = ...,
        end: float = ...,
        max_displacement: float | None = ...,
        dynamic_ratio: float = ...,
        smallest_step: float | None = ...,
        process: Literal["modified", "convex", "open-close"] | dict[str, Any] | StepProcess = ...,
        contact_law: Literal["penalty", "augmented-lagrangian"] | dict[str, Any] | ContactLaw = ...,
        corner_rule: Literal["bisector", "shi"] | dict[str, Any] | CornerRule = ...,
        rotation: Literal["exact", "sine", "linear"] | dict[str, Any] | RotationRule = ...,
        integrator: Literal["constant-acceleration", "backward-euler", "midpoint"]
        | dict[str, Any]
        | Integrator = ...,
        solver: Literal["auto", "cholesky", "pcg"] | dict[str, Any] | LinearSolver = ...,
        critdis: float | None = ...,
        fixed_point_stiffness: float | None = ...,
        every: float | None = ...,
        contacts: bool = ...,
        checkpoint_every: float | None = ...,
        damping: Literal["none", "rayleigh", "adaptive", "kinetic"] | dict[str, Any] | Action = ...,
    ) -> Case:
        """Return the case of these blocks; ``keys`` are those of [time], [method] and [output].

        ``builder.case(end=2.0, process="modified").run()``.  A step that is not given follows from
        the blocks, the end is 1 s; ``stages`` are the parts of the run.  Raises CaseError and
        ModelError, naming place and remedy.

        Args:
            step: Length of a step, s; shorter steps are used where max_displacement requires them.
            end: End of the run, s; with [[stage]] the time limit of stages that give none.
            max_displacement: Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size (square root of the area) of the smallest block if absent.
            dynamic_ratio: Share of velocity carried to the next step: 0 static, 1 dynamic.
            smallest_step: The run stops where it would need a smaller step than this, s.
            process: Process of a step.
            contact_law: Forces from penetration and slip.
            corner_rule: Edge through which a vertex enters at a corner.
            rotation: How points follow the rotation of their block.
            integrator: Time integration: "constant-acceleration" damps vibrations by w h/4 of critical, "midpoint" not at all (for waves), "backward-euler" by w h/2.
            solver: Solver of the equations of a step.
            critdis: Edges are lengthened by this in contact detection, m; 0.5 % of the smallest block's size (square root of its area) if absent.
            fixed_point_stiffness: Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent.
            every: Time between frames, s; a hundredth of the run, or a step, if absent.
            contacts: True: contact forces are kept in every frame.
            checkpoint_every: Wall time between checkpoints, s, from which ``clast resume`` continues; if absent, one is written when a run ends early.
            damping: Damping of the stage.
        """
        ...

    def collector(self, name: str, x: float) -> None:
        """A place along the profile at which passing rocks are measured.

        Args:
            name: Name.
            x: Its place, m.
        """
        ...

    def drawpoint(
        self, name: str, line: Points, rate: float | None = None, *, stage: str | None = None
    ) -> None:
        """A line past which blocks are taken out while the run goes on.

        Args:
            name: Name.
            line: Its ends [[x, y], [x, y]], m: blocks leave once their centroid has come from its left side to its right, seen from the first point to the second.
            rate: Mass taken out per second and metre of depth at most, kg/(s m); whatever comes if absent.
            stage: Stage from which on it draws; the start of the run if absent.
        """
        ...

    def fill(self, surface: Points, density: float, *, name: str | None = None) -> None:
        """Fill that rests on the blocks below its surface: a weight without strength.

        Args:
            surface: Points [x, y] of its surface, from one side to the other, m.
            density: Density, kg/m3.
            name: Name by which stages refer to it.
        """
        ...

    def fixed_point(self, at: Pair, block: str | None = None) -> None:
        """A point of a block that is held in place by a stiff spring.

        Args:
            at: Coordinates [x, y], m.
            block: Block; needed only where blocks touch.
        """
        ...

    def flow_boundary(
        self,
        name: str | None = None,
        *,
        head: float | None = None,
        pressure: float | None = None,
        flux: float | None = None,
        rain: float | None = None,
        seepage: Literal[True] | None = None,
        impermeable: Literal[True] | None = None,
        amplitude: str | None = None,
        seepage_above: bool = True,
        presses: bool = True,
        side: Literal["left", "right", "bottom", "top"] | None = None,
        edges: Sequence[Points] | None = None,
        polygon: Points | None = None,
        opening: str | None = None,
    ) -> None:
        """Head, pressure, flow or faces in air at outer nodes of the joints.

        Args:
            name: Name by which stages and results refer to it.
            head: Height y up to which water stands in the joints, m.
            pressure: Pressure, Pa.
            flux: Flow into the rock by length of the boundary, m/s.
            rain: Rain on the horizontal, m/s; what cannot enter runs off.
            seepage: True: faces in air, which give water off and take none.
            impermeable: True: no water passes.
            amplitude: The [amplitude.NAME] of heads over time, m, in the place of head.
            seepage_above: Whether faces above the head give water off; false: they are tight.
            presses: Whether the water presses on outer faces below the head.
            side: Side of the box around all blocks: all edges on it.
            edges: Straight lines [[p, q], ...] along outer edges, m: all edges on them.
            polygon: Polygon, m: all outer edges with their middle in it.
            opening: Opening by its name: its walls, once it is excavated.
        """
        ...

    def line_load(
        self,
        start: Pair,
        end: Pair,
        traction: Pair,
        block: str | None = None,
        amplitude: str | None = None,
        name: str | None = None,
    ) -> None:
        """A traction along a line that moves with its block, usually along an edge.

        Args:
            start: First end of the line [x, y], m.
            end: Second end of the line [x, y], m.
            traction: Force per length [x, y], N/m per metre of thickness.
            block: Block; needed only where blocks touch.
            amplitude: Amplitude over time by which the load is multiplied; constant if absent.
            name: Name by which stages refer to it; several loads may share one.
        """
        ...

    def lining(
        self,
        name: str,
        *,
        opening: str | None = None,
        polyline: Points | None = None,
        part: Points | None = None,
        side: Literal["left", "right", "middle"] | None = None,
        closed: bool | None = None,
        thickness: float,
        segment: float,
        young: float,
        poisson: float = 0.2,
        density: float = 2400.0,
        tension: float | None = None,
        compression: float | None = None,
        joint: str | None = None,
        start: Literal["free", "hinged", "clamped"] = "free",
        end: Literal["free", "hinged", "clamped"] = "free",
        joins: str | None = None,
        connection: Literal["clamped", "hinged"] | None = None,
        stage: str | None = None,
    ) -> None:
        """A lining of stiff segments along an opening or a polyline.

        Between segments, at the middle of the thickness, are the springs of a beam.

        Args:
            name: Name; its segments are blocks called NAME/1, NAME/2, ...
            opening: Opening that it lines on the inside.
            polyline: Points [x, y] that it follows, m; it is closed if the last equals the first.
            part: With opening: it begins at the first point and ends at the second, counter-clockwise, m.
            side: With polyline: its side, looking along it; if absent, that of the rock, else left.
            closed: False: the last segment is not joined to the first; as the line if absent.
            thickness: Thickness, m.
            segment: Length of a segment, m; between corners it is rounded to a whole number of segments.
            young: Young's modulus, Pa.
            poisson: Poisson's ratio.
            density: Density, kg/m3.
            tension: Tensile strength, Pa; with compression; it is elastic if both are absent.
            compression: Compressive strength, Pa.
            joint: Joint to the rock, [joint.NAME]: strength and stiffness of the bond.
            start: Support of its first end by the ground, which is no block.
            end: Support of its last end by the ground.
            joins: Lining to whose ends those of its own are joined that lie at one place with them, free of stress when both are there.
            connection: With joins: whether the joint bears a moment; "clamped" if absent.
            stage: Stage that installs it, free of stress, on the outline at that time; it exists from the start if absent.
        """
        ...

    def link(
        self,
        at: Pair,
        *,
        name: str | None = None,
        block: str | None = None,
        blocks: Names | None = None,
        direction: Pair = ...,
        x: float | Literal["rigid"] | None = None,
        y: float | Literal["rigid"] | None = None,
        rotation: float | Literal["rigid"] | None = None,
        yield_force: float | None = None,
        yield_moment: float | None = None,
        rupture: float | None = None,
        rupture_rotation: float | None = None,
        gap: float | None = None,
        damping: float = 0.0,
        rotation_damping: float = 0.0,
        contacts: bool = True,
        stage: str | None = None,
    ) -> None:
        """Springs between two blocks at a point, in x and y (or along and across) and rotation.

        Components that are left out are free: a hinge has x and y "rigid", a roller one of them.

        Args:
            at: Point [x, y] of both blocks, m.
            name: Name; its number if absent.
            block: Block that is linked to the ground: to a place that no block carries and nothing moves but a [ground_motion] of the base.
            blocks: Blocks that are linked, in place of block.
            direction: Direction of x, which turns with the first of two blocks and stays as it is on the ground; y is 90 degrees to the left of it.
            x: Stiffness along the direction, N/m per m, or "rigid".
            y: Stiffness across the direction, N/m per m, or "rigid".
            rotation: Stiffness against rotation, N per rad, or "rigid".
            yield_force: Force along, and across, at which it yields, N/m; it is elastic if absent.
            yield_moment: Moment at which it yields, N; elastic if absent.
            rupture: Elongation along or across at which it breaks, m; never if absent.
            rupture_rotation: Rotation at which it breaks, degrees; never if absent.
            gap: Play to either side before it acts along and across, m.
            damping: Force per velocity along and across, N s/m2.
            rotation_damping: Moment per angular velocity, N s.
            contacts: False: the two blocks may overlap, and have no contacts with each other in the whole run; with a link to the ground, the block and all fixed ones.
            stage: Stage that installs it, without force; it exists from the start if absent.
        """
        ...

    def load_train(
        self,
        path: Points,
        position: float,
        axles: Numbers,
        loads: Numbers,
        *,
        spread_angle: float = 0.0,
        contact_length: float = 0.0,
        amplitude: str | None = None,
        name: str | None = None,
    ) -> None:
        """Axles of a vehicle or a train on a path over the blocks, at one position.

        Args:
            path: Points [x, y] of the line that the wheels run on, in the direction of travel, m.
            position: Distance of the front from the beginning of the path, along it, m.
            axles: Distances of the axles behind the front, m.
            loads: Load of each axle, downwards, N per metre of thickness.
            spread_angle: Angle from the vertical at which loads spread down to the blocks, degrees.
            contact_length: Length of the path on which a wheel or a sleeper rests, m.
            amplitude: Amplitude over time by which the loads are multiplied; constant if absent.
            name: Name by which stages and studies refer to it.
        """
        ...

    def measured_contact(
        self, name: str, at: Pair | None = None, *, joint: str | None = None
    ) -> None:
        """Forces, opening and slip of contacts, recorded every step: at a place, or of a joint.

        Args:
            name: Name.
            at: Place [x, y], m: the contact nearest to it at each step.
            joint: Joint: the mean of its contacts, each by its length, with extremes.
        """
        ...

    def measured_convergence(self, name: str, of: Names) -> None:
        """The approach of two measured points, recorded every step: positive where they close in.

        It is their relative displacement along the line between them at the start, since then or since
        a stage has reset it.

        Args:
            name: Name.
            of: Two [[measured_point]]s, e.g. ["left wall", "right wall"].
        """
        ...

    def measured_flow(self, name: str, of: str) -> None:
        """A flow that is recorded every step.

        Args:
            name: Name.
            of: Boundary, well or opening by its name.
        """
        ...

    def measured_point(self, name: str, at: Pair, block: str | None = None) -> None:
        """A point whose displacement, velocity and rotation are recorded every step.

        Args:
            name: Name.
            at: Coordinates [x, y], m.
            block: Block; needed only where blocks touch.
        """
        ...

    def measured_reaction(
        self,
        name: str,
        *,
        side: Literal["left", "right", "bottom", "top"] | None = None,
        block: str | None = None,
        blocks: Names | None = None,
        fixed_point: Pair | None = None,
        about: Pair | None = None,
    ) -> None:
        """The total reaction of some supports, recorded every step.

        Args:
            name: Name.
            side: Side of the box around all blocks: its fixed blocks and points, viscous edges, and edges under in-situ stress.
            block: Block, fixed or moved.
            blocks: Blocks, fixed or moved.
            fixed_point: Coordinates [x, y] of a [[fixed_point]], m.
            about: Reference point [x, y] of its moment, m; the centre of the supports if absent.
        """
        ...

    def moment(self, block: str, moment: float, *, amplitude: str | None = None) -> None:
        """A moment on a block.

        Args:
            block: Block.
            moment: Moment, N, counter-clockwise: N m per m of thickness.
            amplitude: Amplitude over time by which it is multiplied; constant if absent.
        """
        ...

    def motion(
        self,
        *,
        name: str | None = None,
        block: str | None = None,
        blocks: Names | None = None,
        fixed_point: Pair | None = None,
        x: float | dict[str, Any] | None = None,
        y: float | dict[str, Any] | None = None,
        rotation: float | dict[str, Any] | None = None,
        about: Pair | None = None,
        force: Pair | None = None,
        stress: Pair | None = None,
        limit_speed: float | None = None,
        amplitude: str | None = None,
        ease: float | None = None,
        stage: str | None = None,
        until: float | str | None = None,
    ) -> None:
        """A prescribed motion of blocks; its reaction is recorded.

        Components that are left out stay free, or fixed where the block is fixed.  Time counts from
        where the motion begins.

        Args:
            name: Name, also of its reaction; "motion" and its number if absent.
            block: Block that moves, fixed or free.
            blocks: Blocks with the same motion, in place of block.
            fixed_point: Coordinates [x, y] of a [[fixed_point]] that moves, in place of block, m; it has x and y only, and is held in a component left out.
            x: Velocity to the right, m/s, or an amplitude: {displacement = "NAME"}, {velocity = "NAME"}.
            y: Velocity upwards, m/s, or an amplitude.
            rotation: Angular velocity, counter-clockwise, degrees/s, or an amplitude in degrees or degrees/s.
            about: Centre of rotation [x, y] at the start, m; it moves with the blocks by x and y, 0 if absent; the centroid of each block if absent.
            force: Force [x, y] with which a servo presses on each block, N per metre of thickness.
            stress: The same over the width of each block across x and across y, Pa.
            limit_speed: Speed of the servo without resistance, m/s; the force falls to 0 there.
            amplitude: Amplitude over time by which force or stress is multiplied; constant if absent.
            ease: Time over which jumps of velocity are smoothed, s; they are shocks if absent.
            stage: Stage with which it begins; the start of the run if absent.
            until: Duration, s, or the stage with which it ends; then free blocks are released with their velocity and fixed ones stop, within the time of ease.
        """
        ...

    def opening(
        self,
        name: str,
        blocks: Names = ...,
        weld: str | None = None,
        *,
        shape: Literal["circle", "horseshoe", "box", "polygon"] | None = None,
        center: Pair | None = None,
        radius: float | None = None,
        width: float | None = None,
        wall_height: float | None = None,
        chords: int | None = None,
        corner: Pair | None = None,
        size: Pair | None = None,
        points: Points | None = None,
        file: str | None = None,
        layer: str | None = None,
        unit: str | None = None,
        excavated: bool = False,
        construction_joint: bool = True,
    ) -> None:
        """An opening: void from the start, or rock with a welded outline that can be excavated.

        Args:
            name: Name.
            blocks: Names of blocks, without a domain, that are excavated together; instead of a shape.
            weld: With blocks: the joint [joint.NAME] whose edges are welded until it is excavated, and have no joint afterwards.
            shape: circle (center, radius, chords), horseshoe (center, width, wall_height, chords), box (corner, size) or polygon (points).
            center: Centre of a circle, middle of the floor of a horseshoe [x, y], m.
            radius: Radius of the circle that has the area of the opening, m.
            width: Width of a horseshoe, m.
            wall_height: Height of the walls below the half circle of a horseshoe, m.
            chords: Straight edges of a circle, 32 if absent, or of the roof of a horseshoe, 16 if absent.
            corner: Lower left corner of a box [x, y], m.
            size: Width and height of a box, m.
            points: Corners [x, y] of a polygon, m.
            file: Outline in a file beside the case file, .dxf or .csv; instead of a shape.
            excavated: True for a void from the start; else it is rock.
            construction_joint: True: while it is rock its outline is cut and welded; false: it is not cut.
        """
        ...

    def point_load(
        self,
        at: Pair,
        force: Pair,
        block: str | None = None,
        amplitude: str | None = None,
        name: str | None = None,
    ) -> None:
        """A force at a point that moves with its block.

        Args:
            at: Coordinates [x, y], m.
            force: Force [x, y], N per metre of thickness.
            block: Block; needed only where blocks touch.
            amplitude: Amplitude over time by which the load is multiplied; constant if absent.
            name: Name by which stages refer to it; several loads may share one.
        """
        ...

    def pressure(
        self,
        start: Pair,
        end: Pair,
        value: float | Pair,
        block: str | None = None,
        amplitude: str | None = None,
        name: str | None = None,
    ) -> None:
        """A pressure on the edges along a straight line; it stays normal to them as they turn.

        It acts on the parts of edges that lie on the line at the start of the run, from outside the
        blocks, and goes with them.

        Args:
            start: First end of the line [x, y], m.
            end: Second end of the line [x, y], m.
            value: Pressure, Pa, positive into the blocks: one number, or [at start, at end], linear between.
            block: Block; needed only where edges of two blocks lie on the line.
            amplitude: Amplitude over time by which the load is multiplied; constant if absent.
            name: Name by which stages refer to it; several loads may share one.
        """
        ...

    def source(
        self,
        name: str,
        at: Pair | None = None,
        *,
        line: Points | None = None,
        file: str | None = None,
        faster_than: float = 0.1,
        rocks: int | None = None,
        volume: float | str | None = None,
        density: float | str = 2700.0,
        length: float | None = None,
        corners: float | str = 6.0,
        elongation: float | str = 1.2,
        shape: Points | None = None,
        velocity: tuple[float | str, float | str] = ...,
        spin: float | str = 0.0,
    ) -> None:
        """Rocks that start at a point or anywhere on a line.

        Args:
            name: Name.
            at: Point [x, y] of their centroids, m; rocks that would stand in the profile are raised.
            line: Ends [[x, y], [x, y]] of the line on which they start, m.
            file: Result file of a run: its blocks that move at its end are the rocks, the others stand.
            faster_than: Speed above which a block of that run is a rock, m/s.
            rocks: Number of rocks; as many as blocks if absent, which take turns if there are fewer.
            volume: Volume of a rock, m3; a number or a distribution.
            density: Density, kg/m3.
            length: Length of rocks out of the plane, m; the cube root of the volume if absent.
            corners: Number of corners of random rocks.
            elongation: Ratio of the axes of the ellipse that the corners of random rocks lie on.
            shape: Convex polygon [x, y] of all its rocks, -, counter-clockwise, scaled to their volume.
            velocity: Velocity [x, y], m/s; numbers or distributions.
            spin: Spin, counter-clockwise, rad/s.
        """
        ...

    def to_toml(
        self,
        *,
        stages: Sequence[Stage] = ...,
        step: float = ...,
        end: float = ...,
        max_displacement: float | None = ...,
        dynamic_ratio: float = ...,
        smallest_step: float | None = ...,
        process: Literal["modified", "convex", "open-close"] | dict[str, Any] | StepProcess = ...,
        contact_law: Literal["penalty", "augmented-lagrangian"] | dict[str, Any] | ContactLaw = ...,
        corner_rule: Literal["bisector", "shi"] | dict[str, Any] | CornerRule = ...,
        rotation: Literal["exact", "sine", "linear"] | dict[str, Any] | RotationRule = ...,
        integrator: Literal["constant-acceleration", "backward-euler", "midpoint"]
        | dict[str, Any]
        | Integrator = ...,
        solver: Literal["auto", "cholesky", "pcg"] | dict[str, Any] | LinearSolver = ...,
        critdis: float | None = ...,
        fixed_point_stiffness: float | None = ...,
        every: float | None = ...,
        contacts: bool = ...,
        checkpoint_every: float | None = ...,
        damping: Literal["none", "rayleigh", "adaptive", "kinetic"] | dict[str, Any] | Action = ...,
    ) -> str:
        """Return these blocks as the text of a case file, which gives the same Model to the bit.

        ``stages`` and ``keys`` as in ``case``.  Raises CaseError for objects of a script, which no
        file can hold.

        Args:
            step: Length of a step, s; shorter steps are used where max_displacement requires them.
            end: End of the run, s; with [[stage]] the time limit of stages that give none.
            max_displacement: Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size (square root of the area) of the smallest block if absent.
            dynamic_ratio: Share of velocity carried to the next step: 0 static, 1 dynamic.
            smallest_step: The run stops where it would need a smaller step than this, s.
            process: Process of a step.
            contact_law: Forces from penetration and slip.
            corner_rule: Edge through which a vertex enters at a corner.
            rotation: How points follow the rotation of their block.
            integrator: Time integration: "constant-acceleration" damps vibrations by w h/4 of critical, "midpoint" not at all (for waves), "backward-euler" by w h/2.
            solver: Solver of the equations of a step.
            critdis: Edges are lengthened by this in contact detection, m; 0.5 % of the smallest block's size (square root of its area) if absent.
            fixed_point_stiffness: Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent.
            every: Time between frames, s; a hundredth of the run, or a step, if absent.
            contacts: True: contact forces are kept in every frame.
            checkpoint_every: Wall time between checkpoints, s, from which ``clast resume`` continues; if absent, one is written when a run ends early.
            damping: Damping of the stage.
        """
        ...

    def viscous_boundary(
        self,
        *,
        normal: float = 1.0,
        tangential: float = 1.0,
        static: Literal["hold", "none"] = "hold",
        begins: float = 0.0,
        stage: str | None = None,
        side: Literal["left", "right", "bottom", "top"] | None = None,
        edges: Sequence[Points] | None = None,
        polygon: Points | None = None,
    ) -> None:
        """Dashpots on outer edges in place of the rock beyond, which absorb waves.

        On an edge act -normal rho c_p v_n and -tangential rho c_s v_t, with rho, c_p and c_s of the
        block behind it.

        Args:
            normal: Multiple of rho c_p; 0: free along the normal.
            tangential: Multiple of rho c_s; 0: free along the edge.
            static: Forces of the springs when the dashpots begin: kept as a traction, "hold", or removed, "none".
            begins: Time, s, from which the dashpots act; springs as stiff as those of fixed points hold the edges before it, in the directions that have dashpots.
            stage: Stage with which the dashpots begin, in the place of begins.
            side: Side of the box around all blocks: all edges on it.
            edges: Straight lines [[p, q], ...] along outer edges, m: all edges on them.
            polygon: Polygon, m: all outer edges with their middle in it.
        """
        ...

    def water(
        self,
        level: float | None = None,
        *,
        name: str | None = None,
        line: Points | dict[str, Any] | None = None,
        acts_on: Literal["faces", "joints", "both"] = "both",
        density: float = 1000.0,
        joints: Names | None = None,
        amplitude: float | str = 1.0,
        drained_at: Sequence[Pair | Points | str] | str = ...,
        wetted: Literal["open-and-closed", "closed"] = "open-and-closed",
    ) -> None:
        """Water that presses on all edges below its surface, and follows the blocks.

        Args:
            level: Height y of a horizontal surface, m; or give a line.
            name: Name by which stages refer to it.
            line: Points [x, y] of a phreatic line, m, or {file = "line.csv"}; it is horizontal beyond its ends.
            acts_on: Surfaces it presses on: "faces": edges that no other block covers; "joints": both faces where blocks lie along each other; "both".
            density: Density, kg/m3.
            joints: Joints that it enters, by name; all if absent.
            amplitude: Share of the full head, 0 to 1; or the [amplitude.NAME] of such shares: water that rises.
            drained_at: Where there is no pressure: points [x, y] of joints, m, lines [[x, y], [x, y]], openings by name, those that stages excavate from then on; along the joints it falls towards them.
            wetted: Whether a joint that opens keeps its pressure, or loses it ("closed").
        """
        ...

    def well(
        self,
        name: str,
        at: Pair | None = None,
        *,
        line: Points | None = None,
        pressure: float | None = None,
        head: float | None = None,
        rate: float | None = None,
        only_outflow: bool = False,
        stage: str | None = None,
    ) -> None:
        """Points of joints from which water is taken, or into which it is put.

        Args:
            name: Name by which stages and results refer to it.
            at: Point of a joint [x, y], m.
            line: Borehole from a point to another, m: every joint that it crosses.
            pressure: Pressure, Pa; 0 for a drain.
            head: Height y to which water stands in it, m.
            rate: Flow into the rock, m2/s; below 0 out of it.
            only_outflow: True for drains: it takes water and gives none.
            stage: Stage with which it begins; from the start if absent.
        """
        ...

def simulate(
    model: str | Path | Case | ModelBuilder | Model,
    method: Method | None = None,
    schedule: Schedule | None = None,
    *,
    output: Path | str | None = None,
    progress: bool | Callable[[Progress], None] = False,
    recorder: RunRecorder | None = None,
    stages: Sequence[Stage] = ...,
    step: float = ...,
    end: float = ...,
    max_displacement: float | None = ...,
    dynamic_ratio: float = ...,
    smallest_step: float | None = ...,
    process: Literal["modified", "convex", "open-close"] | dict[str, Any] | StepProcess = ...,
    contact_law: Literal["penalty", "augmented-lagrangian"] | dict[str, Any] | ContactLaw = ...,
    corner_rule: Literal["bisector", "shi"] | dict[str, Any] | CornerRule = ...,
    rotation: Literal["exact", "sine", "linear"] | dict[str, Any] | RotationRule = ...,
    integrator: Literal["constant-acceleration", "backward-euler", "midpoint"]
    | dict[str, Any]
    | Integrator = ...,
    solver: Literal["auto", "cholesky", "pcg"] | dict[str, Any] | LinearSolver = ...,
    critdis: float | None = ...,
    fixed_point_stiffness: float | None = ...,
    every: float | None = ...,
    contacts: bool = ...,
    checkpoint_every: float | None = ...,
    damping: Literal["none", "rayleigh", "adaptive", "kinetic"] | dict[str, Any] | Action = ...,
) -> Run:
    """Return the run of a model from rest, or its initial velocities, to the end.

    ``clast.simulate(model, end=2.0, process="modified", contact_law=MyLaw())``:  ``model`` is a
    builder or its model, a case or the name of its file.  ``keys`` are those of [time], [method]
    and [output] of a case file; they replace those of a case, and else defaults follow from the
    model (the step, 1 s for the end).  ``method`` and ``schedule`` are in the place of these keys
    where they are given.
    ``output`` is the result file to write (.vtkhdf); without it frames are kept in memory.
    ``progress`` is True for a line on the terminal, or a function to call after every step.
    ``stages`` are the parts of the run, one after the other.  Warnings of the run are Python
    warnings of the category ``clast.RunWarning``, each of them once.

    Raises CaseError and ModelError for input that cannot be simulated, RunStopped where the run
    cannot go on, with the partial results in its ``run``.

    Args:
        step: Length of a step, s; shorter steps are used where max_displacement requires them.
        end: End of the run, s; with [[stage]] the time limit of stages that give none.
        max_displacement: Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size (square root of the area) of the smallest block if absent.
        dynamic_ratio: Share of velocity carried to the next step: 0 static, 1 dynamic.
        smallest_step: The run stops where it would need a smaller step than this, s.
        process: Process of a step.
        contact_law: Forces from penetration and slip.
        corner_rule: Edge through which a vertex enters at a corner.
        rotation: How points follow the rotation of their block.
        integrator: Time integration: "constant-acceleration" damps vibrations by w h/4 of critical, "midpoint" not at all (for waves), "backward-euler" by w h/2.
        solver: Solver of the equations of a step.
        critdis: Edges are lengthened by this in contact detection, m; 0.5 % of the smallest block's size (square root of its area) if absent.
        fixed_point_stiffness: Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent.
        every: Time between frames, s; a hundredth of the run, or a step, if absent.
        contacts: True: contact forces are kept in every frame.
        checkpoint_every: Wall time between checkpoints, s, from which ``clast resume`` continues; if absent, one is written when a run ends early.
        damping: Damping of the stage.
    """
    ...

class Stage(_Stage):
    """A part of a run; stages follow each other, and the state is carried from one to the next.

    Args:
        name: Name.
        until: When it ends: "equilibrium", or "time", when its time is over.
        time: Length of the stage, s, for one until equilibrium at most; None: the end of the schedule.
        damping: Damping of the stage: an object of the method; None: as without stages.
        dynamic_ratio: Share of velocity carried to the next step, 0 static, 1 dynamic; None: as without stages.
        force_ratio: Largest unbalanced force on a block in equilibrium, as a share of all forces on it.
        speed: Largest speed of a block in equilibrium, as a share of sqrt(g x its size).
        hold: Consecutive steps in which that holds.
        reset_displacement: True: displacements are reset at the end of the stage; positions do not change.
        step: Wanted length of a step, s; None: as without stages.
        every: Time between frames, s; None: as without stages.
        excavate: Openings and blocks that are excavated at its start.
        relax: Share of the support forces released by the stage that ends at once.
        relax_time: Time over which the rest of the released forces ends, s.
        release: Share of the support forces of excavated blocks that is released by now, from 0 to 1: {"heading": 0.5}; all of it if absent. A later stage releases the rest.
        install: Bolts that are installed at its start, by their names or kinds.
        joints: Strengths of joints from its start on: {"bedding": {"friction_angle": 25.0}}.
        bonds: "break" as forces reach their strength, or "hold" until the static stage is in balance; only then are they judged.
        jacks: "lock": the jacks of bolts come off at its start; "hold": they stay on.
        loads: Loads, pressures and tables that act from its start on, and none of them before.
        flow: {"state": "transient"}: the flow in joints takes time from its start on; or "steady".
        flow_boundary: Other values of boundaries of the flow from its start on: {"lake": {"head": 40.0}}.
        ground_motion: True: the ground moves in this stage, its record beginning with the stage.
    """
    def __init__(
        self,
        *,
        name: str,
        until: Literal["equilibrium", "time"] = ...,
        time: float | None = ...,
        damping: Literal["none", "rayleigh", "adaptive", "kinetic"]
        | dict[str, Any]
        | Action
        | None = ...,
        dynamic_ratio: float | None = ...,
        force_ratio: float = ...,
        speed: float = ...,
        hold: int = ...,
        reset_displacement: bool = ...,
        step: float | None = ...,
        every: float | None = ...,
        excavate: Names = ...,
        relax: float = ...,
        relax_time: float = ...,
        release: Mapping[str, float] = ...,
        install: Names = ...,
        joints: Strengths = ...,
        bonds: Literal["break", "hold"] = ...,
        jacks: Literal["lock", "hold"] = ...,
        loads: Names = ...,
        flow: dict[str, Any] | None = ...,
        flow_boundary: dict[str, dict[str, Any]] = ...,
        ground_motion: bool = ...,
    ) -> None: ...
