"""[[link]] and [[moment]]: hinges, rollers, sliders, springs, ties, struts; moments on blocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.actions.links import COMPONENTS, LinkRows, Links
from clast.actions.loads import Moments
from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY
from clast.inputs.declaring.table import OR_TEXT, Force, Length, Point, Positive, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.placing.bolt_lines import Ground
from clast.model import ranges
from clast.model.ranges import check_names
from clast.model.supports import GROUND

Stiffness = Annotated[Annotated[Positive, within(ranges.STIFFNESS)] | Literal["rigid"], OR_TEXT]
Strength = Annotated[Positive, within(ranges.FORCE)]
Stretch = Annotated[Positive, within(ranges.LENGTH)]
Dashpot = Annotated[Number, Field(ge=0.0), within(ranges.STIFFNESS)]


class Link(Table):
    """Springs between two blocks at a point, in x and y (or along and across) and rotation.

    Components that are left out are free: a hinge has x and y "rigid", a roller one of them.
    """

    name: StrictStr | None = None
    """Name; its number if absent."""
    at: Point
    """Point [x, y] of both blocks, m."""
    block: StrictStr | None = None
    """Block that is linked to the ground: to a place that no block carries and nothing moves but a
    [ground_motion] of the base."""
    blocks: tuple[StrictStr, StrictStr] | None = None
    """Blocks that are linked, in place of block."""
    direction: tuple[Number, Number] = (1.0, 0.0)
    """Direction of x, which turns with the first of two blocks and stays as it is on the ground; y
    is 90 degrees to the left of it."""
    x: Stiffness | None = None
    """Stiffness along the direction, N/m per m, or "rigid"."""
    y: Stiffness | None = None
    """Stiffness across the direction, N/m per m, or "rigid"."""
    rotation: Stiffness | None = None
    """Stiffness against rotation, N per rad, or "rigid"."""
    yield_force: Strength | None = None
    """Force along, and across, at which it yields, N/m; it is elastic if absent."""
    yield_moment: Strength | None = None
    """Moment at which it yields, N; elastic if absent."""
    rupture: Stretch | None = None
    """Elongation along or across at which it breaks, m; never if absent."""
    rupture_rotation: Annotated[Positive, Field(le=360.0)] | None = None
    """Rotation at which it breaks, degrees; never if absent."""
    gap: Length | None = None
    """Play to either side before it acts along and across, m."""
    damping: Dashpot = 0.0
    """Force per velocity along and across, N s/m2."""
    rotation_damping: Dashpot = 0.0
    """Moment per angular velocity, N s."""
    contacts: StrictBool = True
    """False: the two blocks may overlap, and have no contacts with each other in the whole run;
    with a link to the ground, the block and all fixed ones."""
    stage: StrictStr | None = None
    """Stage that installs it, without force; it exists from the start if absent."""

    ONE_OF: ClassVar = {
        'give blocks = ["1", "2"], or block = "1" for a link to the ground': ("block", "blocks")
    }
    WHEN: ClassVar = {
        "x": {ANY: ("direction", "yield_force", "rupture", "gap", "damping")},
        "y": {ANY: ("direction", "yield_force", "rupture", "gap", "damping")},
        "rotation": {ANY: ("yield_moment", "rupture_rotation", "rotation_damping")},
    }
    BASIC: ClassVar = ("x", "y", "rotation")

    @model_validator(mode="after")
    def _links_two(self) -> Self:
        if self.blocks is not None and self.blocks[0] == self.blocks[1]:
            what = f"links block '{shortened(self.blocks[0])}' with itself"
            remedy = "name two blocks, or one with block for a link to the ground"
            raise refusal(what, remedy, "blocks")
        if not any(self.direction):
            raise refusal("has no direction", "give a vector, e.g. [1, 0]", "direction")
        return self

    @model_validator(mode="after")
    def _does_something(self) -> Self:
        along = self.x is not None or self.y is not None
        if not along and self.rotation is None and not self.damping and not self.rotation_damping:
            remedy = 'give x, y or rotation a stiffness, or "rigid"; a hinge has x and y'
            raise refusal("restrains nothing", remedy)
        needs = {
            "yield_force": along,
            "rupture": along,
            "gap": along,
            "yield_moment": self.rotation is not None,
            "rupture_rotation": self.rotation is not None,
        }
        for key, there in needs.items():
            if getattr(self, key) is not None and not there:
                of = "rotation" if key.endswith(("moment", "rotation")) else "x or y"
                what = f"{key} is that of {of}, which is free"
                raise refusal(what, f"give {of}, or leave it out", key)
        return self

    def components(self) -> dict[str, dict[str, float]]:
        """Return the numbers of each component that is not free."""
        parts = {}
        for name, key in zip(COMPONENTS, ("x", "y", "rotation"), strict=True):
            given, turns = getattr(self, key), key == "rotation"
            damping = self.rotation_damping if turns else self.damping
            if given is None and not damping:
                continue
            strength = self.yield_moment if turns else self.yield_force
            rupture = self.rupture_rotation if turns else self.rupture
            limit = np.inf if rupture is None else float(np.radians(rupture) if turns else rupture)
            parts[name] = {
                "stiffness": np.inf if given == "rigid" else float(given or 1e-12),
                "strength": np.inf if strength is None else strength,
                "rupture": limit,
                "gap": 0.0 if turns else self.gap or 0.0,
                "damping": damping,
            }
        return parts

    @classmethod
    def actions(cls, records: Sequence[Any], ground: Ground) -> Iterable[Any]:
        """Return the action of all links."""
        if not records:
            return
        names = [one.name or f"link {number}" for number, one in enumerate(records, 1)]
        check_names("link", names)
        block = np.array(
            [_blocks(one, name, ground) for one, name in zip(records, names, strict=True)]
        )
        parts = [
            (k, name, of) for k, one in enumerate(records) for name, of in one.components().items()
        ]
        direction = np.array([one.direction for one in records], float)
        on_ground = block[:, 1] == GROUND
        numbers = {
            key: np.array([of[key] for _, _, of in parts], float)
            for key in ("stiffness", "strength", "rupture", "gap", "damping")
        }
        rows = LinkRows(
            name=tuple(names),
            block=block,
            at=np.array([one.at for one in records]) - ground.outlines.origin,
            along=direction / np.hypot(*direction.T)[:, None],
            turning=np.stack([~on_ground, on_ground], axis=1).astype(float),
            stage=tuple(one.stage or "" for one in records),
            also=(),
            link=np.array([k for k, _, _ in parts]),
            component=np.array([COMPONENTS.index(name) for _, name, _ in parts]),
            **numbers,
        )
        apart = [
            (one, other)
            for (one, second), record in zip(block.tolist(), records, strict=True)
            for other in (np.flatnonzero(ground.fixed).tolist() if second == GROUND else [second])
            if not record.contacts
        ]
        pairs = np.array(apart, np.int64).reshape(-1, 2)
        yield Links(rows=rows, apart=np.unique(np.sort(pairs, axis=1), axis=0))


def _blocks(one: Link, name: str, ground: Ground) -> tuple[int, int]:
    """Return the blocks of a link; raises ModelError where they cannot be linked."""
    where = name if name.startswith("link ") else f"link '{shortened(name)}'"
    if one.blocks is not None:
        first, second = (ground.block(name, f"{where}, blocks") for name in one.blocks)
    else:
        first, second = ground.block(one.block or "", f"{where}, block"), GROUND
    if ground.fixed[first] and (second == GROUND or ground.fixed[second]):
        what = "links a fixed block to the ground" if second == GROUND else "links two fixed blocks"
        raise ModelError(what, where=where, remedy="leave it out, or fixed out of one of them")
    return first, second


class Moment(Table):
    """A moment on a block."""

    block: StrictStr
    """Block."""
    moment: Force
    """Moment, N, counter-clockwise: N m per m of thickness."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which it is multiplied; constant if absent."""

    @classmethod
    def actions(cls, records: Sequence[Any], ground: Ground) -> Iterable[Any]:
        """Return the action of all moments."""
        if not records:
            return
        places = [(f"moment {k}", one) for k, one in enumerate(records, 1)]
        yield Moments(
            block=np.array([ground.block(one.block, f"{at}, block") for at, one in places]),
            moment=np.array([one.moment for one in records], float),
            factor=np.array(
                [ground.amplitude(one.amplitude, f"{at}, amplitude") for at, one in places]
            ),
            tables=tuple(one.amplitude for one in records if one.amplitude is not None),
        )
