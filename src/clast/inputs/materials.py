"""[rock.NAME] and [joint.NAME]: materials of blocks, and the contacts that have them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.errors import Fault, ModelError
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, RefersTo
from clast.inputs.declaring.table import Fraction, Length, Positive, Strength, Stresses, Table
from clast.inputs.declaring.validation_messages import refusal, refusals
from clast.inputs.declaring.values import number_of
from clast.inputs.placing.place_blocks import Names
from clast.model import joints, model, ranges
from clast.model.joints import JointTable
from clast.model.model import Ints
from clast.model.stages import contradiction

BlockName = Annotated[StrictStr, RefersTo("block")]


OF_COULOMB = {
    "friction_angle": "friction follows from jrc, jcs and residual_friction_angle",
    "cohesion": "what looks like cohesion is the curved strength of the roughness",
    "tensile_strength": "a rough joint carries no tension",
    "residual_cohesion": "sliding leaves residual_friction_angle",
    "slip_weakening": "sliding wears the roughness off as jrc and the length say",
    "kinetic_friction_angle": "its friction does not depend on the speed",
    "critical_speed": "its friction does not depend on the speed",
    "dilation_angle": "it opens by half of the mobilised roughness angle",
    "dilation_until": "it opens until its roughness is worn off",
}
"""Keys that a rough joint has no use for, and why."""


class Rock(Table):
    """A linear elastic rock."""

    NAMED: ClassVar[bool] = True

    young: Annotated[Positive, within(ranges.MODULUS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(gt=-1.0, le=0.5)]
    """Poisson's ratio, -; below 0.5 in plane strain."""
    density: Annotated[Positive, within(ranges.DENSITY)]
    """Density, kg/m3."""
    initial_stress: Stresses = (0.0, 0.0, 0.0)
    """Stress (xx, yy, xy) in the blocks at the start, Pa, tension positive."""

    def rock(self, name: str) -> model.Rock:
        """Return it as a rock of the model."""
        return model.Rock(name=name, **dict(self))


class Joint(Table):
    """Strength and stiffness of contacts along a joint; default is for contacts without a joint."""

    NAMED: ClassVar[bool] = True

    friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Coulomb friction angle, degrees."""
    cohesion: Strength = 0.0
    """Cohesion, Pa; it remains while the joint slips, and is lost where it opens."""
    tensile_strength: Strength = 0.0
    """Tension cut-off, Pa; exceeding it removes tensile strength and cohesion."""
    residual_cohesion: Strength | None = None
    """Cohesion after slip, Pa; 0: brittle, as mortar; all of it if absent: ideally plastic."""
    residual_friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Residual friction angle, degrees; if absent, friction does not weaken."""
    slip_weakening: Annotated[Number, Field(ge=0.0), within(ranges.LENGTH)] = 0.0
    """Slip over which strengths fall from peak to residual, m; 0: at once."""
    kinetic_friction_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] | None = None
    """Friction angle while the joint slides, degrees; the static one if absent."""
    critical_speed: Annotated[Number, Field(ge=0.0), within(ranges.SPEED)] = 0.0
    """Sliding speed from which friction is kinetic, m/s; 0: at once."""
    dilation_angle: Annotated[Number, Field(ge=0.0, lt=90.0)] = 0.0
    """Angle at which the joint opens as it slides, and closes as it slides back, degrees."""
    dilation_until: Length | None = None
    """Slip to either side at which dilation ends, m; it does not end if absent."""
    law: Literal["coulomb", "barton-bandis"] = "coulomb"
    """Strength and closure of the joint: Coulomb's, or those of a rough joint."""
    jrc: Annotated[Number, Field(gt=0.0, le=20.0)] | None = None
    """Joint roughness coefficient of a sample, up to 20; of law "barton-bandis"."""
    jcs: Annotated[Positive, within(ranges.STRESS)] | None = None
    """Compressive strength of the walls of a sample, Pa; of law "barton-bandis"."""
    sample_length: Length | None = None
    """Length of the sample for jrc and jcs, m; 0.1 if absent."""
    field_length: Length | None = None
    """Length of the joint between cross joints, m, for which jrc and jcs are scaled; they are not
    scaled if absent.
    """
    initial_aperture: Length | None = None
    """Aperture of a rough joint without stress, m; jrc/50 mm if absent."""
    strength_reduction: Annotated[Positive, within(ranges.FACTOR)] | None = None
    """Factor by which the tangent of the mobilised friction angle of a rough joint is divided."""
    restitution: Fraction | None = None
    """Coefficient of restitution of impacts, 0 to 1; that of the process if absent."""
    normal_stiffness: Annotated[Positive, within(ranges.JOINT_STIFFNESS)] | None = None
    """Normal stress per closure, Pa/m; the spring of method.contact_law if absent."""
    shear_stiffness: Annotated[Positive, within(ranges.JOINT_STIFFNESS)] | None = None
    """Shear stress per slip, Pa/m; the spring of method.contact_law if absent."""
    aperture: Annotated[Number, Field(ge=0.0)] | None = None
    """Aperture without stress, m, for [flow]; no water enters the joint if 0 or absent.  A rough
    joint has its initial_aperture."""
    residual_aperture: Length | None = None
    """Least hydraulic aperture, m; a tenth of the aperture if absent."""
    maximum_aperture: Length | None = None
    """Largest hydraulic aperture, m; five times the aperture if absent."""
    hydraulic_law: Literal["cubic", "barton", "louis"] = "cubic"
    """Hydraulic aperture of a mechanical one E: "cubic": E/flow_factor^(1/3); "barton":
    E^2/jrc^2.5 in micrometres, at most E; "louis": by relative_roughness."""
    flow_factor: Annotated[Number, Field(ge=1.0), within(ranges.FACTOR)] | None = None
    """Factor by which roughness lowers the flow, of hydraulic_law "cubic"; 1 if absent."""
    relative_roughness: Annotated[Number, Field(gt=0.0, le=0.5)] | None = None
    """Height of asperities over twice the aperture, -, 0.033 to 0.5, of hydraulic_law "louis"."""
    between: list[tuple[BlockName, BlockName]] = Field([])
    """Pairs of blocks with this joint between them: [["a", "b"], ...]."""
    between_rocks: list[tuple[StrictStr, StrictStr]] = Field([])
    """Pairs of rocks with this joint between their blocks: [["granite", "granite"], ...]."""
    allow_small_friction_angle: StrictBool = False
    """True if a friction angle below 1.6 really is in degrees, not in radians."""

    WHEN: ClassVar = {
        "law": {
            "coulomb": (*OF_COULOMB, "aperture"),
            "barton-bandis": (
                *("jrc", "jcs", "sample_length", "field_length", "initial_aperture"),
                *("strength_reduction", "residual_aperture", "maximum_aperture", "hydraulic_law"),
            ),
        },
        "aperture": {ANY: ("residual_aperture", "maximum_aperture", "hydraulic_law")},
        "hydraulic_law": {
            "cubic": ("flow_factor",),
            "barton": ("jrc",),
            "louis": ("relative_roughness",),
        },
    }
    BASIC: ClassVar = ("friction_angle", "cohesion", "tensile_strength", "law", "jrc", "jcs")
    RARE: ClassVar = (
        *("critical_speed", "dilation_until", "sample_length", "strength_reduction"),
        *("residual_aperture", "maximum_aperture", "flow_factor", "allow_small_friction_angle"),
    )
    TYPICAL: ClassVar = {
        **dict.fromkeys(("friction_angle", "residual_friction_angle"), (0.0, 60.0)),
        "dilation_angle": (0.0, 15.0),
        "jrc": (1.0, 20.0),
        "jcs": (10e6, 200e6),
        "aperture": (5e-5, 1e-3),
    }

    @model_validator(mode="after")
    def _does_not_contradict_itself(self) -> Self:
        faults = (*_faults_of_law(self), *_faults_of_flow(self))
        if faults:
            raise refusals(faults)
        fault = contradiction(self.joint("default"), is_small_meant=self.allow_small_friction_angle)
        if fault is not None:
            raise refusal(fault.what, fault.remedy, fault.key)
        return self

    def joint(self, name: str) -> joints.Joint:
        """Return it as a joint of the model."""
        given = self.model_dump(exclude=PLACES | ROUGHNESS | HYDRAULIC)
        given["hydraulics"] = self._hydraulics()
        if self.law == "coulomb":
            return joints.Joint(name=name, **given)
        given["normal_stiffness"] = None
        factor = self.strength_reduction or 1.0
        return joints.Joint(
            name=name, roughness=self._roughness(), strength_reduction=factor, **given
        )

    def _roughness(self) -> joints.BartonBandis:
        """Return the roughness of a rough joint."""
        return joints.BartonBandis(
            jrc=self.jrc or 0.0,
            jcs=self.jcs or 0.0,
            sample_length=self.sample_length or SAMPLE_LENGTH,
            field_length=self.field_length,
            initial_aperture=self.initial_aperture,
            initial_stiffness=self.normal_stiffness,
        )

    def _hydraulics(self) -> joints.Hydraulics | None:
        """Return how water flows along the joint; None: it does not."""
        aperture = self.aperture
        if aperture is None and self.law == "barton-bandis":
            aperture = self.initial_aperture or 1e-3 * (self.jrc or 0.0) / 50.0
        if not aperture:
            return None
        return joints.Hydraulics(
            aperture=aperture,
            residual=self.residual_aperture or 0.1 * aperture,
            maximum=self.maximum_aperture or 5.0 * aperture,
            law=self.hydraulic_law,
            flow_factor=self.flow_factor or 1.0,
            jrc=self.jrc or 0.0,
            relative_roughness=self.relative_roughness or 0.0,
        )


PLACES = {"between", "between_rocks", "allow_small_friction_angle"}
"""Keys of a joint for its place, not for its strength."""


ROUGHNESS = {
    "law",
    "jrc",
    "jcs",
    "sample_length",
    "field_length",
    "initial_aperture",
    "strength_reduction",
}
"""Keys of a rough joint."""
HYDRAULIC = {
    "aperture",
    "residual_aperture",
    "maximum_aperture",
    "hydraulic_law",
    "flow_factor",
    "relative_roughness",
}
"""Keys of a joint for water that flows along it."""
NEEDED = {
    "jrc": "give the joint roughness coefficient of a sample, 0 to 20",
    "jcs": "give the compressive strength of its walls, Pa, e.g. 100e6",
    "residual_friction_angle": "give the friction angle that is left without roughness, degrees",
}
"""Needs of a rough joint, and the remedy where one is missing."""
SAMPLE_LENGTH = 0.1
"""Length of a sample, m (Barton & Choubey 1977)."""
FRICTION_ANGLE_MAX = 70.0
"""Largest friction angle of rough joints, degrees."""
WEAKEST_WALL, WIDEST, LONGEST = 1e5, 5e-3, 10.0
"""Compressive strength, Pa, opening and length of samples, m, that look like other units."""


def _faults_of_law(joint: Joint) -> Iterator[Fault]:
    """Give the faults in the keys of a joint for its law."""
    given = joint.model_fields_set
    if joint.law == "coulomb":
        by_flow = {"jrc"} if joint.hydraulic_law == "barton" else set()
        for key in sorted((ROUGHNESS - {"law"} - by_flow) & given):
            yield Fault(
                'belongs to a joint with law = "barton-bandis"',
                'add law = "barton-bandis", or leave it out',
                (key,),
            )
        return
    for key, reason in OF_COULOMB.items():
        if key in given:
            yield Fault(
                'does not belong to law = "barton-bandis"', f"leave it out: {reason}", (key,)
            )
    missing = [key for key in NEEDED if getattr(joint, key) is None]
    for key in missing:
        what = 'is missing: law = "barton-bandis" needs it'
        yield Fault(what, NEEDED[key], (key,))
    if not missing:
        yield from _faults_of_numbers(joint)


def _faults_of_numbers(joint: Joint) -> Iterator[Fault]:
    """Give the numbers of a rough joint that look like other units, or that give no closure."""
    if joint.jcs is not None and joint.jcs < WEAKEST_WALL:
        meant = f"{joint.jcs:g} looks like MPa, but strengths are in Pa"
        yield Fault(meant, f"write {1e6 * joint.jcs:g}", ("jcs",))
    for key, most in {"initial_aperture": WIDEST, "sample_length": LONGEST}.items():
        value = getattr(joint, key)
        if value is not None and value > most:
            what = f"{value:g} looks like millimetres, but lengths are in m"
            yield Fault(what, f"write {1e-3 * value:g}", (key,))
    if joint.field_length is not None and joint.field_length < (
        joint.sample_length or SAMPLE_LENGTH
    ):
        yield Fault(
            (
                f"{joint.field_length:g} m is less than the length of the sample, "
                f"{joint.sample_length or SAMPLE_LENGTH:g} m"
            ),
            "give the length of the joint between cross joints, or leave it out",
            ("field_length",),
        )
    angle = joint.residual_friction_angle
    if angle is not None and angle >= FRICTION_ANGLE_MAX:
        yield Fault(
            (
                f"{angle:g} degrees leave no room for roughness: the total friction angle is "
                f"capped at {FRICTION_ANGLE_MAX:g}"
            ),
            "give the friction angle of a smooth joint of this rock, 20 to 35 degrees",
            ("residual_friction_angle",),
        )

    rough = joint._roughness()
    if not rough.stiffness > 0.0:
        yield Fault(
            (
                f"the formula of Bandis gives an initial normal stiffness of "
                f"{1e-9 * rough.stiffness:.3g} MPa/mm"
            ),
            "give a smaller initial_aperture, m, or normal_stiffness, Pa/m, itself",
            ("jcs",),
        )
    if not rough.closure > 0.0:
        yield Fault(
            f"the formula of Bandis gives a maximum closure of {1e3 * rough.closure:.3g} mm",
            "give a larger initial_aperture, m",
            ("initial_aperture",),
        )


THINNEST, OPENEST = 1e-7, 0.1
"""Smallest and largest aperture of joints, m."""
OF_LAWS = {
    "jrc": ("barton", "give the joint roughness coefficient, 1 to 20"),
    "relative_roughness": ("louis", "give the height of asperities over twice the aperture"),
    "flow_factor": ("cubic", ""),
}
"""Keys that belong to a hydraulic law, and the remedy where it needs one that is missing."""


def _faults_of_flow(joint: Joint) -> Iterator[Fault]:
    """Give the faults in the keys of a joint for water."""
    given, aperture = joint.model_fields_set, joint.aperture
    rough = joint.law == "barton-bandis"
    if rough and "aperture" in given and aperture:
        what = 'does not belong to law = "barton-bandis"'
        yield Fault(what, "give initial_aperture, or aperture = 0 for no water", ("aperture",))
    elif aperture is None and not rough:
        for key in sorted((HYDRAULIC - {"aperture"}) & given):
            yield Fault("belongs to a joint with an aperture", "give aperture, m, too", (key,))
        return
    for key in ("aperture", "residual_aperture", "maximum_aperture"):
        value = getattr(joint, key)
        if value and not THINNEST <= value <= OPENEST:
            size = "large" if value > OPENEST else "small"
            what = f"{value:g} m is too {size} for the aperture of a joint"
            remedy = f"apertures are in m, from {THINNEST:g} to {OPENEST:g}: 0.2 mm are 2e-4"
            yield Fault(what, remedy, (key,))
    water = joint._hydraulics()
    if water is not None and water.residual > water.aperture:
        what = f"{water.residual:g} m is more than the aperture, {water.aperture:g} m"
        yield Fault(what, "give at most the aperture", ("residual_aperture",))
    if water is not None and water.maximum < water.aperture:
        what = f"{water.maximum:g} m is less than the aperture, {water.aperture:g} m"
        yield Fault(what, "give at least the aperture", ("maximum_aperture",))
    for key, (law, remedy) in OF_LAWS.items():
        if joint.hydraulic_law == law and remedy and getattr(joint, key) is None:
            what = f'is missing: hydraulic_law = "{law}" needs it'
            yield Fault(what, remedy, (key,))
        elif joint.hydraulic_law != law and key in given and key != "jrc":
            what = f'belongs to a joint with hydraulic_law = "{law}"'
            yield Fault(what, f'add hydraulic_law = "{law}", or leave it out', (key,))
    roughness = joint.relative_roughness
    if roughness is not None and roughness <= joints.SMOOTHEST:
        what = f"{roughness:g}: a joint below {joints.SMOOTHEST:g} is hydraulically smooth"
        yield Fault(what, 'give hydraulic_law = "cubic" instead', ("relative_roughness",))


def joint_table(
    given: Mapping[str, Joint],
    rock_number: dict[str, int],
    block_number: dict[str, int],
    along_edges: set[str],
) -> JointTable:
    """Return the joints, the default first, and the pairs that they belong to."""
    ordered = sorted({"default": Joint(), **given}.items(), key=lambda one: one[0] != "default")
    names = [name for name, _ in ordered]
    rock_joint: dict[tuple[int, int], int] = {}
    block_joint: dict[tuple[int, int], int] = {}
    for index, (name, joint) in enumerate(ordered):
        placed = joint.between or joint.between_rocks or name in along_edges
        if index > 0 and not placed:
            remedy = (
                "name it default, or assign it by between (pairs of blocks), "
                "between_rocks (pairs of rocks) or the edge_joint of blocks"
            )
            raise ModelError("is assigned to no contact", where=f"joint '{name}'", remedy=remedy)
        _assign(joint.between_rocks, "rock", rock_number, index, rock_joint, names)
        _assign(joint.between, "block", block_number, index, block_joint, names)
    rock_pair = np.zeros((len(rock_number), len(rock_number)), np.int64)
    for (one, other), index in rock_joint.items():
        rock_pair[one, other] = rock_pair[other, one] = index
    pairs = sorted(block_joint)
    return JointTable(
        joints=tuple(one.joint(name) for name, one in ordered),
        rock_pair=rock_pair,
        block_pair=np.array(pairs, np.int64).reshape(-1, 2),
        block_pair_joint=np.array([block_joint[pair] for pair in pairs], np.int64),
    )


def joints_of_edges(table: JointTable, names: Names) -> Ints:
    """Return the joint index of each edge by its name, -1 where it has none of its own, (nv,)."""
    number = {joint.name: index for index, joint in enumerate(table.joints)}
    distinct, which = np.unique(names, return_inverse=True)
    numbers = [
        number_of(name, number, "joint", "blocks, edge_joint") if name else -1
        for name in distinct.tolist()
    ]
    return np.asarray(np.array(numbers, np.int64)[which])


def _assign(
    pairs: Sequence[tuple[str, str]],
    kind: str,
    number: dict[str, int],
    index: int,
    assigned: dict[tuple[int, int], int],
    names: Sequence[str],
) -> None:
    """Give pairs of blocks or rocks to a joint; refuse pairs that two joints claim."""
    where = f"joint '{names[index]}'"
    for one, other in pairs:
        both = (number_of(one, number, kind, where), number_of(other, number, kind, where))
        pair = (min(both), max(both))
        if kind == "block" and both[0] == both[1]:
            what = f"block '{one}' cannot have a joint with itself"
            raise ModelError(what, where=f"{where}, between", remedy="name two different blocks")
        before = assigned.setdefault(pair, index)
        if before != index:
            what = f"the {kind}s '{one}' and '{other}' already belong to joint '{names[before]}'"
            raise ModelError(what, where=where, remedy="name the pair in one joint only")
