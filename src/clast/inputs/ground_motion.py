"""[ground_motion]: an earthquake or a shaking table."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import AfterValidator, StrictStr, model_validator

from clast.errors import CaseError, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY
from clast.inputs.declaring.table import OR_TABLE, Acceleration, Instant, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.records.columns import check_sizes, doubted_times, read_record
from clast.inputs.records.components import Component, along, component, is_other_unit, together
from clast.inputs.records.conversion import STOP_TIME_S, Samples, brought_to_rest, correction_of
from clast.inputs.records.formats import format_of
from clast.model import ranges
from clast.model.ground_motion import (
    Accelerogram,
    GroundMotion,
    IncomingWave,
    InertialForce,
    MovingBase,
    Recorded,
)

GROUND_MOTIONS: dict[str, type[InertialForce] | type[MovingBase] | type[IncomingWave]] = {
    "body-force": InertialForce,
    "base": MovingBase,
    "incoming": IncomingWave,
}
OF_FILES = ("format", "quantity", "unit", "direction")
"""Keys that only a record in a file has."""
NEED_UNIT = frozenset({*OF_FILES, "baseline", "after"})
"""Keys with which columns of numbers need a unit; without all of them they are in m/s2."""

Format = Literal["auto", "csv", "at2", "k-net", "sac"]
Quantity = Literal["acceleration", "velocity", "displacement"]
Unit = Literal["m/s2", "g", "cm/s2", "gal", "mm/s2", "m/s", "cm/s", "mm/s", "m", "cm", "mm"]
Scale = Annotated[Number, within(ranges.FACTOR)]


def _known_baseline(name: str) -> str:
    """Refuse a base line that is none."""
    try:
        correction_of(name)
    except CaseError as error:
        raise refusal(error.what, error.remedy) from None
    return name


class VerticalRecordTable(Table):
    """The record of the vertical component."""

    file: StrictStr
    """File beside the case file."""
    format: Format = "auto"
    """Format, as that of the first component."""
    unit: Unit | None = None
    """Unit of the values; by default that of the file, or of the first component."""
    scale: Scale = 1.0
    """Factor on all values."""


@dataclass(frozen=True)
class _Said:
    """The result of reading a record, for the user."""

    notes: list[str] = field(default_factory=list)
    """Notes on values that were read, assumed and changed."""
    doubts: list[str] = field(default_factory=list)
    """Doubts, each with its remedy."""

    def doubt(self, text: str | None) -> None:
        """Add a doubt, if there is one."""
        self.doubts.extend([text] if text else [])


class GroundMotionTable(Table):
    """An accelerogram, linear between its instants, and how it reaches the blocks.

    The ground starts from rest.  After the last instant it has no acceleration, and keeps the
    velocity that it then has.
    """

    acts: Literal["body-force", "base", "incoming"]
    """"body-force": minus the acceleration on the mass of every block, motion is relative to the
    ground; "base": fixed points, links to the ground and ends of linings on it move with the
    ground.  Fixed blocks do not move: a base that moves is held by fixed points; "incoming": the
    motion is that of a wave that comes up through the viscous edges that face down, half of the
    motion of an outcrop."""
    file: StrictStr | None = None
    """Record beside the case file, instead of lists: columns t, ax and, if wanted, ay, or another
    format."""
    format: Format = "auto"
    """"csv": columns of numbers; "at2": PEER, with NPTS and DT; "k-net": K-NET and KiK-net; "sac":
    SAC, needs the extra records; "auto": by the ending of the name, else by how the file begins."""
    quantity: Quantity | None = None
    """Quantity of the file; by default as the file states, else acceleration.  Velocity is taken as
    linear between the instants, displacement as a cubic spline through them."""
    unit: Unit | None = None
    """Unit of the values; by default that of the file.  Columns of numbers need it as soon as one
    of format, quantity, direction, vertical as a file, baseline, after is given; without all of
    them they are in m/s2."""
    direction: tuple[Number, Number] | None = None
    """Direction [x, y] of the ground's motion for a file of one component; [1, 0] if absent."""
    time: list[Instant] | None = None
    """Times, s, increasing."""
    acceleration: list[Acceleration] | None = None
    """Horizontal acceleration of the ground at the instants, m/s2, to the right."""
    vertical: Annotated[list[Acceleration] | VerticalRecordTable, OR_TABLE] | None = None
    """Vertical acceleration of the ground at the instants, m/s2, upwards, or {file = ...} beside
    file; none if absent.  The shorter of two files goes on with no acceleration."""
    scale: Scale = 1.0
    """Factor on all values: 9.81 for a record in g whose unit is not given."""
    baseline: Annotated[StrictStr, AfterValidator(_known_baseline)] = "none"
    """Correction of the accelerations: "none"; "linear": subtract the straight line that fits them
    best; "highpass:0.1": remove frequencies below 0.1 Hz, by a Butterworth filter of order 4 that
    runs forwards and backwards."""
    after: Literal["hold", "stop"] = "hold"
    """After the last instant the ground keeps its velocity, "hold", or comes to rest within 1 s,
    "stop"."""

    INSTEAD: ClassVar = (("file", "time"),)
    WHEN: ClassVar = {
        "file": {ANY: OF_FILES},
        "time": {ANY: ("acceleration",)},
    }
    BASIC: ClassVar = ("acceleration",)

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        lists = {"time": self.time, "acceleration": self.acceleration}
        if isinstance(self.vertical, list):
            lists["vertical"] = self.vertical
        given = {key: len(values) for key, values in lists.items() if values is not None}
        if self.file is not None and given:
            raise refusal("there are lists as well", "name the file, or give the lists", "file")
        if self.file is None and not {"time", "acceleration"} <= set(given):
            remedy = 'give file = "record.csv", or time = [...] and acceleration = [...]'
            raise refusal("there is no accelerogram", remedy)
        if len(set(given.values())) > 1:
            counted = ", ".join(f"{key} {count}" for key, count in given.items())
            raise refusal(f"the lists differ in length: {counted}", "give lists of equal length")
        return self

    @model_validator(mode="after")
    def _suits_its_source(self) -> Self:
        keys = [key for key in OF_FILES if key in self.model_fields_set]
        keys += ["vertical"] if isinstance(self.vertical, VerticalRecordTable) else []
        if self.file is None and keys:
            remedy = "leave it out; lists are m/s2 along x, and vertical = [...] along y"
            raise refusal("belongs to a record in a file, but there are lists", remedy, keys[0])
        if self.direction is not None and not any(self.direction):
            what = "[0, 0] is not a direction"
            raise refusal(what, "give e.g. [1, 0], to the right", "direction")
        return self

    @classmethod
    def keys_of(cls, value: Any) -> dict[str, Any] | None:
        """Return the keys that make the ground motion of a script."""
        acts = next((name for name, kind in GROUND_MOTIONS.items() if type(value) is kind), None)
        if acts is None:
            return None
        record = value.accelerogram
        along, upwards = record.acceleration.T
        keys = {"acts": acts, "time": record.time, "acceleration": along}
        return {**keys, "vertical": upwards} if upwards.any() else keys

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Set the motion of the ground, and note how it was read."""
        said = _Said()
        builder.ground_motion = GROUND_MOTIONS[self.acts](self._record(folder, said))
        builder.notes += [f"[ground_motion] {note}" for note in said.notes]

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say where a heading contradicts the unit, and where the base line is off."""
        said = _Said()
        self._record(folder, said)
        return (f"[ground_motion] {doubt}" for doubt in said.doubts)

    def _record(self, folder: Path, said: _Said) -> Accelerogram:
        """Return the record, corrected, with its notes and doubts."""
        samples = self._samples(folder, said)
        with _placed("baseline"):
            corrected = correction_of(self.baseline)(samples)
        record = replace(samples, acceleration=corrected).accelerogram()
        if self.after == "hold":
            return record
        end, stopped = float(record.time[-1]), brought_to_rest(record)
        peak = float(np.hypot(*stopped.acceleration[-2]))
        speed = record.velocity(end).tolist()
        said.notes.append(
            f"after its record, from {end:g} to {end + STOP_TIME_S:g} s, the ground is brought to "
            f"rest from ({speed[0]:.3g}, {speed[1]:.3g}) m/s by up to {peak:.3g} m/s2"
        )
        return stopped

    def _samples(self, folder: Path, said: _Said) -> Samples:
        """Return the acceleration (x, y) as it is given, m/s2."""
        if self.file is None:
            time = np.array(self.time, np.float64)
            horizontal = np.array(self.acceleration, np.float64)
            listed = self.vertical if isinstance(self.vertical, list) else None
            vertical = np.zeros(len(time)) if listed is None else np.array(listed)
            acceleration = np.stack([horizontal, vertical], axis=1)
            return Samples(time=time, acceleration=self.scale * acceleration)
        if self._is_plain(folder / self.file):
            return self._plain(folder / self.file, said)
        samples = self._from_files(folder, folder / self.file, said)
        if self.baseline == "none":
            said.doubts.extend(_offset(samples, self.file))
        return samples

    def _is_plain(self, path: Path) -> bool:
        """Return whether the file is columns of m/s2, for the table asks for nothing else."""
        asked = self.model_fields_set & NEED_UNIT or isinstance(self.vertical, VerticalRecordTable)
        with _placed("file"):
            return not asked and format_of(path) == "csv"

    def _plain(self, path: Path, said: _Said) -> Samples:
        """Return columns of accelerations (x, y), m/s2, at instants of any interval."""
        with _placed("file"):
            record = read_record(path)
            check_sizes(record.time, record.values, record.name)
        said.doubt(doubted_times(record.time, path.name))
        if record.guess and is_other_unit(record, abs(self.scale)):
            name, size = record.guess
            said.doubt(
                f"scale is {self.scale:g}, but the heading of {shortened(str(self.file))} says "
                f"that accelerations are in {name}: give scale = {size:g} if they are"
            )
        acceleration = np.zeros((len(record.time), 2))
        acceleration[:, : record.values.shape[1]] = record.values
        return Samples(time=record.time, acceleration=self.scale * acceleration)

    def _from_files(self, folder: Path, path: Path, said: _Said) -> Samples:
        """Return the acceleration (x, y) of one or two records, m/s2."""
        table = self.vertical
        with _placed("file"):
            first = component(
                path, format=self.format, quantity=self.quantity, unit=self.unit, scale=self.scale
            )
            said.notes.append(first.note)
            said.doubt(first.doubt)
            one = self._directed(first)
        if not isinstance(table, VerticalRecordTable):
            return one.samples
        with _placed("vertical"):
            second = component(
                folder / table.file,
                format=table.format,
                quantity=self.quantity,
                unit=table.unit,
                unit_else=self.unit,
                scale=table.scale,
            )
            _check_single(second, "vertical")
            said.notes.append(f"vertical, {second.note}")
            said.doubt(second.doubt)
            upwards = replace(second, samples=along(second.samples, (0.0, 1.0)))
            total, shorter = together(one, upwards)
        said.notes.extend([shorter] if shorter else [])
        return total

    def _directed(self, first: Component) -> Component:
        """Return the first component as motion (x, y)."""
        if isinstance(self.vertical, VerticalRecordTable):
            _check_single(first, "vertical")
        if first.samples.acceleration.shape[1] == 2 and self.direction is None:
            return first
        _check_single(first, "direction")
        return replace(first, samples=along(first.samples, self.direction or (1.0, 0.0)))


def _check_single(found: Component, key: str) -> None:
    """Refuse two components in one file where one is needed."""
    if found.samples.acceleration.shape[1] != 1:
        what = "the file has two components, x and y, where one is wanted"
        remedy = "leave direction and vertical out, or give one column beside the time"
        raise CaseError(what, where=key, remedy=remedy)


def _offset(samples: Samples, file: str) -> Iterator[str]:
    """Say where the mean acceleration of a record is not small, so that the ground drifts away."""
    record = samples.accelerogram()
    end, peak = float(record.time[-1]), float(np.abs(record.acceleration).max())
    mean = float(np.hypot(*record.velocity(end))) / (end - float(record.time[0]))
    # Mean acceleration, as a share of the peak, above which a record's base line is off
    if mean > 0.05 * peak:
        yield (
            f"the mean acceleration of {shortened(file)} is {mean:.3g} m/s2, "
            f"{100.0 * mean / peak:.2g} % of its peak: an instrument offset, removed by "
            'baseline = "linear"'
        )


@contextmanager
def _placed(key: str) -> Iterator[None]:
    """Name the table and the key in errors of records; ``key`` is the one that is read."""
    try:
        yield
    except CaseError as error:
        place = error.where
        if place in ("", key):
            place = key
        elif key != "file" or place not in (*OF_FILES, "vertical"):
            place = f"{key}, {place}"
        where = f"[ground_motion] {place}"
        raise ModelError(error.what, where=where, remedy=error.remedy) from None


def check_ground_motion(motion: GroundMotion, attached: int) -> None:
    """Refuse accelerograms that are none, and a moving base with nothing ``attached`` to it."""
    where = "ground_motion"
    if isinstance(motion, Recorded):
        time, acceleration = motion.accelerogram.time, motion.accelerogram.acceleration
        if time.ndim != 1 or len(time) < 2 or acceleration.shape != (len(time), 2):
            what = f"time has shape {time.shape} and acceleration {acceleration.shape}"
            remedy = "give at least 2 instants, and an acceleration (x, y) for each"
            raise ModelError(what, where=where, remedy=remedy)
        if not (np.isfinite(time).all() and np.isfinite(acceleration).all()):
            what = "is not finite"
            raise ModelError(what, where=where, remedy="give times in s and accelerations in m/s2")
        ranges.check_size(float(np.abs(time).max()), ranges.TIME, f"{where}, time", "give s")
        largest = float(np.abs(acceleration).max())
        ranges.check_size(largest, ranges.ACCELERATION, f"{where}, acceleration", "give m/s2")
        # an inner instant may stand twice: the acceleration jumps there
        interval = np.concatenate([[0.0], np.diff(time), [0.0]])
        falls = interval[1:-1] < 0.0
        stays = (interval[1:-1] == 0.0) & ((interval[:-2] == 0.0) | (interval[2:] == 0.0))
        for k in np.flatnonzero(falls | stays)[:1]:
            raise ModelError(
                f"instant {k + 2}, {time[k + 1]:g} s, is not after instant {k + 1}, {time[k]:g} s",
                where=where,
                remedy="order the instants by time, each once (twice where the acceleration jumps)",
            )
    if isinstance(motion, MovingBase) and attached == 0:
        raise ModelError(
            "the base moves, but nothing is attached to it",
            where=where,
            remedy="attach blocks to it by fixed points or links to the ground (a fixed block does "
            "not move), or let the motion act as a body force",
        )
