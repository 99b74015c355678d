"""[[fill]] and [[load_train]]: dead and moving loads that rest on the surface of blocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, StrictStr, model_validator

from clast.errors import Fault, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Coordinate, Line, Positive, Table
from clast.inputs.declaring.validation_messages import refusals
from clast.inputs.placing.bolt_lines import Ground
from clast.inputs.placing.surface import (
    BESIDE,
    Resting,
    SurfaceParts,
    footprint,
    surface_parts,
    under_fill,
    under_wheel,
)
from clast.model import ranges
from clast.model.model import Bools, Floats, PointLoads
from clast.model.ranges import check_text
from clast.model.surcharge import Surcharge

STEEPEST = 80.0
"""Largest angle at which a load spreads, degrees from the vertical."""
ROUND_OFF = 1e-9
"""How far beyond its ends an axle is still on a path, in units of its length."""


def _turns(points: Line, key: str) -> Iterator[Fault]:
    """Report a line that has no two points, or does not go one way."""
    if len(points) < 2:
        yield Fault(f"has {len(points)} point(s)", "give at least 2", (key,))
        return
    steps = np.diff([x for x, _ in points])
    back = np.flatnonzero(steps * steps[0] <= 0.0) if steps[0] else [0]
    for k in back[:1]:
        what = f"turns back, or rises vertically, from point {k + 1} to point {k + 2}"
        yield Fault(what, "let it run from left to right, or from right to left", (key,))


class Fill(Table):
    """Fill that rests on the blocks below its surface: a weight without strength."""

    surface: Line
    """Points [x, y] of its surface, from one side to the other, m."""
    density: Annotated[Positive, within(ranges.DENSITY)]
    """Density, kg/m3."""
    name: StrictStr | None = None
    """Name by which stages refer to it."""

    @model_validator(mode="after")
    def _goes_one_way(self) -> Self:
        faults = list(_turns(self.surface, "surface"))
        if faults:
            raise refusals(faults)
        return self


class LoadTrain(Table):
    """Axles of a vehicle or a train on a path over the blocks, at one position."""

    path: Line
    """Points [x, y] of the line that the wheels run on, in the direction of travel, m."""
    position: Coordinate
    """Distance of the front from the beginning of the path, along it, m."""
    axles: list[Annotated[Number, Field(ge=0.0), within(ranges.COORDINATE)]]
    """Distances of the axles behind the front, m."""
    loads: list[Annotated[Number, Field(ge=0.0), within(ranges.FORCE)]]
    """Load of each axle, downwards, N per metre of thickness."""
    spread_angle: Annotated[Number, Field(ge=0.0, le=STEEPEST)] = 0.0
    """Angle from the vertical at which loads spread down to the blocks, degrees."""
    contact_length: Annotated[Number, Field(ge=0.0), within(ranges.LENGTH)] = 0.0
    """Length of the path on which a wheel or a sleeper rests, m."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which the loads are multiplied; constant if absent."""
    name: StrictStr | None = None
    """Name by which stages and studies refer to it."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        faults = list(_turns(self.path, "path"))
        if not self.axles:
            faults.append(Fault("has no axle", "give at least one", ("axles",)))
        elif len(self.axles) != len(self.loads):
            what = f"has {len(self.loads)} load(s) for {len(self.axles)} axle(s)"
            faults.append(Fault(what, "give one load for each axle", ("loads",)))
        if faults:
            raise refusals(faults)
        return self

    def wheels(self, origin: Floats) -> tuple[Floats, Bools]:
        """Return the wheel of each axle about the origin, m, (k, 2).

        And whether it is on the path, (k,).
        """
        path = np.array(self.path) - origin
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
        place = self.position - np.array(self.axles)
        slack = ROUND_OFF * along[-1]
        on = (place >= -slack) & (place <= along[-1] + slack)
        return np.stack([np.interp(place, along, x) for x in path.T], axis=1), on


@dataclass(frozen=True, kw_only=True)
class SurfaceLoading:
    """Gravity and blocks at the start, on which loads on the surface depend."""

    gravity: Floats
    """Acceleration of gravity, m/s2, shape (2,)."""
    gravity_factor: int
    """Number of its amplitude."""
    there: Bools
    """Blocks that are there from the start, shape (n,)."""


Axle = tuple[list[Any], float, str]
"""Wheel and ends of the footprint (3, 2), m, load, N per metre of thickness, and train."""


def surcharge_in(
    fills: Sequence[Fill], trains: Sequence[LoadTrain], ground: Ground, of: SurfaceLoading
) -> tuple[PointLoads, Surcharge, tuple[str, ...]]:
    """Return the forces of fill and trains, their shapes for pictures, and notes.

    Forces on fixed blocks, which have no effect, are left out.
    """
    loads, notes = [PointLoads()], list[str]()
    rings, axles = list[tuple[Floats, str]](), list[Axle]()
    for number, fill in enumerate(fills, 1):
        force, outlines = _of_fill(fill, _label("fill", number, fill.name), ground, of)
        loads.append(force)
        rings += [(ring, fill.name or "") for ring in outlines]
    for number, train in enumerate(trains, 1):
        label = _label("load train", number, train.name)
        forces, shown, told = _of_train(train, label, ground, of)
        loads += forces
        axles += shown
        notes += told
    names = *(one.name for one in fills), *(one.name for one in trains)
    surcharge = Surcharge(
        fill=tuple(ring for ring, _ in rings),
        fill_name=tuple(name for _, name in rings),
        axle=np.array([one[0] for one in axles], float).reshape(-1, 3, 2),
        load=np.array([one[1] for one in axles]),
        axle_name=tuple(one[2] for one in axles),
        names=tuple(dict.fromkeys(name for name in names if name)),
    )
    return joined(loads), surcharge, tuple(notes)


def joined(loads: Sequence[PointLoads]) -> PointLoads:
    """Return point loads as one."""
    keys = ("block", "at", "force", "factor")
    arrays = {key: np.concatenate([getattr(one, key) for one in loads]) for key in keys}
    return PointLoads(**arrays, name=tuple(name for one in loads for name in one.name))


def _label(kind: str, number: int, name: str | None) -> str:
    if name is None:
        return f"{kind} {number}"
    check_text(name, f"{kind} {number}")
    return f"{kind} '{shortened(name)}'"


def _rising(points: Line, origin: Floats) -> Floats:
    """Return a line about the origin with x rising, m, shape (m, 2)."""
    line = np.array(points) - origin
    return line if line[0, 0] < line[-1, 0] else line[::-1].copy()


def _loads(resting: Resting, force: Floats, ground: Ground, named: tuple[str, int]) -> PointLoads:
    """Return forces per unit of amount (2,) on blocks that are not fixed, by name and amplitude."""
    free = ~ground.fixed[resting.block]
    amount = resting.amount[free]
    return PointLoads(
        block=resting.block[free],
        at=resting.at[free],
        force=amount[:, None] * force,
        factor=np.full(len(amount), named[1], np.int64),
        name=(named[0],) * len(amount),
    )


def _of_fill(
    fill: Fill, label: str, ground: Ground, of: SurfaceLoading
) -> tuple[PointLoads, list[Floats]]:
    """Return the weight of fill on blocks, and the outlines of the fill."""
    if of.gravity[0] or of.gravity[1] > 0.0:
        what = "it is a weight upon what lies below it, but gravity does not act downwards"
        raise ModelError(what, where=label, remedy="draw it as blocks, or turn the model")
    line = _rising(fill.surface, ground.outlines.origin)
    span = float(line[0, 0]), float(line[-1, 0])
    parts = surface_parts(line, span, ground.outlines, of.there)
    resting = under_fill(line, parts)
    if not len(resting.block):
        remedy = "draw its surface above the blocks that carry it"
        raise ModelError("rests on no block", where=label, remedy=remedy)
    named = fill.name or "", of.gravity_factor
    return _loads(resting, fill.density * of.gravity, ground, named), _outlines(line, parts)


def _outlines(line: Floats, parts: SurfaceParts) -> list[Floats]:
    """Return the outlines of fill between a line (m, 2) and the parts below it, m, (c, 2) each."""
    # Gaps of fill that are not drawn, in units of its length
    apart = 1e-4 * (line[-1, 0] - line[0, 0])
    cut = np.flatnonzero(parts.x[1:, 0] - parts.x[:-1, 1] > apart) + 1
    outlines = []
    for x, y in zip(np.split(parts.x, cut), np.split(parts.y, cut), strict=True):
        inner = line[(line[:, 0] > x.min()) & (line[:, 0] < x.max()), 0]
        above = np.concatenate([[x.max()], inner[::-1], [x.min()]])
        top = np.stack([above, np.interp(above, *line.T)], axis=1)
        outlines.append(np.concatenate([np.stack([x.ravel(), y.ravel()], axis=1), top]))
    return outlines


def _of_train(
    train: LoadTrain, label: str, ground: Ground, of: SurfaceLoading
) -> tuple[list[PointLoads], list[Axle], list[str]]:
    """Return the forces of a train, its axles that have a load, and notes of those that do not."""
    outlines, name = ground.outlines, train.name or ""
    wheels, on = train.wheels(outlines.origin)
    half = max(0.5 * train.contact_length, BESIDE * float(np.sqrt(np.abs(outlines.area).min())))
    spread = float(np.tan(np.radians(train.spread_angle)))
    reach = half + spread * float(np.ptp([*outlines.vertices[:, 1], *wheels[:, 1]]))
    span = float(wheels[:, 0].min() - reach), float(wheels[:, 0].max() + reach)
    parts = surface_parts(_rising(train.path, outlines.origin), span, outlines, of.there)
    named = name, ground.amplitude(train.amplitude, f"{label}, amplitude")
    loads, axles, nowhere = list[PointLoads](), list[Axle](), list[int]()
    for k in np.flatnonzero(on).tolist():
        _refuse_inside(wheels[k], parts, ground, f"{label}, axle {k + 1}")
        foot = footprint(wheels[k], half, spread, parts)
        if not len(foot.block):
            nowhere.append(k)
            continue
        loads.append(_loads(under_wheel(foot), np.array([0.0, -train.loads[k]]), ground, named))
        ends = ((foot.x.flat[e], foot.y.flat[e]) for e in (foot.x.argmin(), foot.x.argmax()))
        axles.append(([wheels[k], *ends], train.loads[k], name))
    places = {"off its path": np.flatnonzero(~on).tolist(), "over no block": nowhere}
    notes = [
        f"{label} has no load of axle(s) {', '.join(str(k + 1) for k in idle)}, which are {place}"
        for place, idle in places.items()
        if idle
    ]
    return loads, axles, notes


def _refuse_inside(wheel: Floats, parts: SurfaceParts, ground: Ground, where: str) -> None:
    """Refuse a wheel where the path runs within a block."""
    for low, high, block in parts.hidden:
        if low <= wheel[0] <= high:
            what = f"at {ground.text(wheel)} is inside {ground.outlines.label(block)}"
            remedy = "draw the path on or above the blocks that carry it"
            raise ModelError(what, where=where, remedy=remedy)
