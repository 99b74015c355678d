"""[[motion]]: the motion of a block is prescribed, regardless of the forces on it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import StrictStr, model_validator

from clast.actions.motions import (
    Course,
    Motions,
    OneMotion,
    Servo,
    along_displacements,
    along_velocities,
    at_constant_speed,
)
from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, RefersTo
from clast.inputs.declaring.table import (
    OR_TABLE,
    OR_TEXT,
    Force,
    Interval,
    Point,
    Positive,
    Speed,
    Stress,
    Table,
)
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.placing.bolt_lines import Ground
from clast.model import ranges
from clast.model.model import Floats, Ints
from clast.model.ranges import check_names

AXES = ("x", "y", "rotation")
"""Components of a motion."""
Scale = Annotated[Number, within(ranges.FACTOR)]


class CourseTable(Table):
    """A component that follows an amplitude."""

    displacement: Annotated[StrictStr, RefersTo("amplitude")] | None = None
    """Amplitude whose value is the displacement since the motion began, m or degrees."""
    velocity: Annotated[StrictStr, RefersTo("amplitude")] | None = None
    """Amplitude whose value is the velocity, m/s or degrees/s."""
    scale: Scale = 1.0
    """Factor on all values of the amplitude."""

    ONE_OF: ClassVar = {
        'give one of them: y = {displacement = "settlement"}': ("displacement", "velocity")
    }


Component = Annotated[Speed | CourseTable, OR_TABLE]


class Motion(Table):
    """A prescribed motion of blocks; its reaction is recorded.

    Components that are left out stay free, or fixed where the block is fixed.  Time counts from
    where the motion begins.
    """

    name: StrictStr | None = None
    """Name, also of its reaction; "motion" and its number if absent."""
    block: StrictStr | None = None
    """Block that moves, fixed or free."""
    blocks: list[StrictStr] | None = None
    """Blocks with the same motion, in place of block."""
    fixed_point: Point | None = None
    """Coordinates [x, y] of a [[fixed_point]] that moves, in place of block, m; it has x and y
    only, and is held in a component left out."""
    x: Component | None = None
    """Velocity to the right, m/s, or an amplitude: {displacement = "NAME"}, {velocity =
    "NAME"}."""
    y: Component | None = None
    """Velocity upwards, m/s, or an amplitude."""
    rotation: Component | None = None
    """Angular velocity, counter-clockwise, degrees/s, or an amplitude in degrees or degrees/s."""
    about: Point | None = None
    """Centre of rotation [x, y] at the start, m; it moves with the blocks by x and y, 0 if absent;
    the centroid of each block if absent.
    """
    force: tuple[Force, Force] | None = None
    """Force [x, y] with which a servo presses on each block, N per metre of thickness."""
    stress: tuple[Stress, Stress] | None = None
    """The same over the width of each block across x and across y, Pa."""
    limit_speed: Annotated[Positive, within(ranges.SPEED)] | None = None
    """Speed of the servo without resistance, m/s; the force falls to 0 there."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which force or stress is multiplied; constant if absent."""
    ease: Interval | None = None
    """Time over which jumps of velocity are smoothed, s; they are shocks if absent."""
    stage: StrictStr | None = None
    """Stage with which it begins; the start of the run if absent."""
    until: Annotated[Interval | Annotated[StrictStr, RefersTo("stage")], OR_TEXT] | None = None
    """Duration, s, or the stage with which it ends; then free blocks are released with their
    velocity and fixed ones stop, within the time of ease.
    """

    ONE_OF: ClassVar = {
        'give one of block = "1", blocks = ["1", "2"] and fixed_point = [x, y]': (
            "block",
            "blocks",
            "fixed_point",
        )
    }
    INSTEAD: ClassVar = (("force", "stress"),)
    WHEN: ClassVar = {
        "rotation": {ANY: ("about",)},
        "force": {ANY: ("limit_speed", "amplitude")},
        "stress": {ANY: ("limit_speed", "amplitude")},
    }
    BASIC: ClassVar = ("x", "y", "rotation", "limit_speed")

    @model_validator(mode="after")
    def _says_what_moves(self) -> Self:
        if self.fixed_point is not None:
            for key in ("rotation", "about", "force", "stress"):
                if getattr(self, key) is not None:
                    remedy = "give x and y, or move the block"
                    raise refusal(f"a fixed point has no {key}", remedy, key)
            return self
        names = self.named
        if not names:
            raise refusal("is empty", 'give ["1", "2"]', "blocks")
        twice = next((one for k, one in enumerate(names) if one in names[:k]), None)
        if twice is not None:
            raise refusal(f"names block '{shortened(twice)}' twice", "name it once", "blocks")
        return self

    @model_validator(mode="after")
    def _moves_somehow(self) -> Self:
        if not any(self.courses) and self.force is None and self.stress is None:
            what = "does not say how the block moves"
            raise refusal(what, "give x, y or rotation, or force or stress for a servo")
        if self.about is not None and self.rotation is None:
            what = "about is the centre of a rotation"
            raise refusal(what, "give rotation, or leave about out", "about")
        if self.rotation is not None and len(self.named) > 1 and self.about is None:
            what = "several blocks need a common centre of rotation"
            raise refusal(what, "give about = [x, y], or a motion for each block", "rotation")
        return self

    @model_validator(mode="after")
    def _servo_is_whole(self) -> Self:
        given = [key for key in ("force", "stress") if getattr(self, key) is not None]
        if len(given) > 1:
            raise refusal("has both force and stress", "give one of them")
        if given and self.limit_speed is None:
            what = "limit_speed is missing"
            raise refusal(what, "give the speed of the servo without resistance, m/s")
        for key in ("limit_speed", "amplitude"):
            if not given and getattr(self, key) is not None:
                raise refusal(f"{key} is for a servo", "give force or stress, or leave it out", key)
        if not given:
            return self
        pressed = getattr(self, given[0])
        if not any(pressed):
            raise refusal("applies no force", "give a force, or leave the motion out", given[0])
        for axis, size in zip(AXES, pressed, strict=False):
            if size and (getattr(self, axis) is not None or self.about is not None):
                remedy = f"leave {axis} out, or 0 in {given[0]} where it moves"
                raise refusal(f"{axis} is given both a motion and a force", remedy, given[0])
        return self

    @property
    def named(self) -> list[str]:
        """Names of its blocks."""
        return [self.block] if self.block is not None else list(self.blocks or ())

    @property
    def courses(self) -> tuple[Any, ...]:
        """Courses of x, y and rotation."""
        return self.x, self.y, self.rotation

    @classmethod
    def actions(cls, records: Sequence[Any], ground: Ground) -> Iterable[Any]:
        """Return the action of all motions."""
        if not records:
            return
        names = [one.name or f"motion {number}" for number, one in enumerate(records, 1)]
        check_names("motion", names)
        each = tuple(_motion(one, name, ground) for name, one in zip(names, records, strict=True))
        _check_apart(each, ground)
        yield Motions(each=each)


def called(name: str) -> str:
    """Return how messages call a motion of this name."""
    return name if name.startswith("motion ") else f"motion '{shortened(name)}'"


def _motion(one: Motion, name: str, ground: Ground) -> OneMotion:
    """Return a motion of blocks of the ground."""
    where = called(name)
    point = None
    if one.fixed_point is not None:
        point = int(ground.fixed_point(one.fixed_point, where)[0])
    key = "block" if one.block is not None else "blocks"
    blocks = ground.blocks(one.named, f"{where}, {key}")
    about = None
    if one.about is not None:
        x, y = (np.array(one.about) - ground.outlines.origin).tolist()
        about = x, y
    courses = [
        _course(given, axis, one, where, ground)
        for axis, given in zip(AXES, one.courses, strict=True)
    ]
    if about is not None or point is not None:
        courses[:2] = [at_constant_speed(0.0, 0.0) if c is None else c for c in courses[:2]]
    until = one.until
    return OneMotion(
        name=name,
        block=blocks,
        point=point,
        courses=(courses[0], courses[1], courses[2]),
        about=about,
        servo=_servo(one, blocks, where, ground),
        stage=one.stage or "",
        until=math.inf if until is None or isinstance(until, str) else until,
        last_stage=until if isinstance(until, str) else "",
    )


def _course(given: Any, axis: str, one: Motion, where: str, ground: Ground) -> Course | None:
    """Return how far a component goes, None where it is free."""
    unit = math.pi / 180.0 if axis == "rotation" else 1.0
    ease = one.ease or 0.0
    if given is None:
        return None
    if not isinstance(given, CourseTable):
        return at_constant_speed(unit * given, ease)
    quantity = "velocity" if given.displacement is None else "displacement"
    place = f"{where}, {axis}.{quantity}"
    table = ground.factors[ground.amplitude(getattr(given, quantity), place)]
    if quantity == "velocity":
        return along_velocities(table, unit * given.scale, ease)
    if table.at(0.0) != 0.0:
        what = (
            f"amplitude '{table.name}' is {table.at(0.0):g} where the motion begins: it must "
            "begin at 0"
        )
        raise ModelError(what, where=place, remedy="make it 0 at time 0")
    return along_displacements(table, unit * given.scale, ease)


def _servo(one: Motion, blocks: Ints, where: str, ground: Ground) -> Servo | None:
    """Return the servo of a motion, None where it has none."""
    if one.limit_speed is None:
        return None
    factor = None
    if one.amplitude is not None:
        factor = ground.factors[ground.amplitude(one.amplitude, f"{where}, amplitude")]
    force = one.force
    if one.stress is not None:
        sizes = np.array([_size(ground, int(block)) for block in blocks])
        if np.ptp(sizes, axis=0).max() > 1e-9 * sizes.max():
            remedy = "give a motion for each, or force in place of stress"
            raise ModelError("its blocks differ in width", where=f"{where}, stress", remedy=remedy)
        width, height = sizes[0]
        force = float(one.stress[0] * height), float(one.stress[1] * width)
    fixed = [int(block) for block in blocks if ground.fixed[block]]
    if fixed:
        what = (
            f"block '{shortened(ground.outlines.names[fixed[0]])}' is fixed, so no force "
            "can move it"
        )
        remedy = (
            "leave fixed out and hold the components that should not move, e.g. x = 0, rotation = 0"
        )
        raise ModelError(what, where=where, remedy=remedy)
    return Servo(force=force or (0.0, 0.0), limit_speed=one.limit_speed, factor=factor)


def _size(ground: Ground, block: int) -> Floats:
    """Return width and height of a block, m, shape (2,)."""
    first, past = ground.outlines.start[block : block + 2]
    return np.asarray(np.ptp(ground.outlines.vertices[first:past], axis=0))


def _check_apart(each: tuple[OneMotion, ...], ground: Ground) -> None:
    """Refuse blocks that cannot be moved so: held by a fixed point, or moved twice."""
    names = ground.outlines.names
    since: dict[tuple[int, int], OneMotion] = {}
    _check_points(each, ground)
    for one in each:
        pressed = () if one.servo is None else [axis for axis in (0, 1) if one.servo.force[axis]]
        for block in one.block.tolist():
            if one.held and block in ground.points.block:
                what = f"block '{shortened(names[block])}' is held by a fixed point, too"
                remedy = (
                    "remove the fixed point, or the motion; components that shall not move are "
                    "given as 0"
                )
                raise ModelError(what, where=one.label, remedy=remedy)
            for axis in (*one.held, *pressed):
                other = since.setdefault((block, axis), one)
                # one may end with the stage with which the other begins
                pairs = ((one, other), (other, one))
                apart = any(a.last_stage != "" and a.last_stage == b.stage for a, b in pairs)
                if other is not one and not apart:
                    raise ModelError(
                        f"{AXES[axis]} of block '{shortened(names[block])}' is moved by "
                        f"{other.label}, too",
                        where=one.label,
                        remedy="let only one of them move it, or end one (until) with the stage in "
                        "which the other begins",
                    )
                since[block, axis] = one


def _check_points(each: tuple[OneMotion, ...], ground: Ground) -> None:
    """Refuse fixed points that are moved twice, or that cannot move with their block."""
    moved: dict[int, OneMotion] = {}
    for one in each:
        if one.point is None:
            continue
        where, block = one.label, int(ground.points.block[one.point])
        if one.point in moved:
            what = f"{moved[one.point].label} moves the same fixed point"
            raise ModelError(what, where=where, remedy="let only one of them move it")
        if ground.fixed[block]:
            what = f"its block '{shortened(ground.outlines.names[block])}' is fixed"
            raise ModelError(what, where=where, remedy="move the block, or leave fixed out")
        moved[one.point] = one
