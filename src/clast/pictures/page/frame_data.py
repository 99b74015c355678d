"""The parts of a page that change with frames: motion, fields, contacts, supports, points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats, Ints
from clast.model.stage_records import counted_from
from clast.pictures.draw_water import dry_of, pressures_of, waters_of
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.linings import DIAGRAMS, carries, comes_back
from clast.pictures.page.packing import (
    ALWAYS,
    LEVELS,
    Rows,
    affine,
    packed,
    raw,
    room_of_each,
    spread,
)
from clast.pictures.supports import (
    LINK_COLOURS,
    REACTION_COLOUR,
    directions_of,
    forces_in,
    places_of,
    states_of,
)
from clast.results import Recording
from clast.results.frames import absent_in_frame
from clast.results.schema import LINK_STATES

CONTACT_BYTES, FACE_BYTES = 28, 16
"""Bytes of a contact and of a face of a joint in a frame, before they are compressed."""
MANY, FEWER_LEVELS = 500_000, 4_095
"""Blocks times frames above which fields are rounded more, and the levels of their range then."""
STRAINS, ROUNDING = ("xx", "yy", "xy"), 1e-12
"""Quantities of the motion that are strains, and strains that come of rounding."""
NOISE = 1e-9
"""Numbers below this share of the largest of their kind come of rounding: they are 0."""
FIELDS = (
    ("velocity_x", "velocity_y"),
    ("sigma_xx", "sigma_yy", "sigma_xy"),
    ("displacement_x", "displacement_y"),
    ("rotation",),
)
"""Fields of the result file that the page works out its others from, by kind."""
OF_MOTION = {"displacement_x": "x", "displacement_y": "y", "rotation": "angle"}
"""Those that follow from the motion, unless displacements have been reset."""
FACES = ("slip", "opening", "worn")
"""Fields of joints on the page: it has the others of each contact that is clicked."""
CONTACT_NUMBERS = {
    "x": [0, 1],
    "y": [0, 1],
    "angle": [2],
    "normal": [3, 4],
    "shear": [3, 4],
    "strength": [5],
    "slip": [6, 7],
    "opening": [6, 7],
}
"""Quantities of a contact: place, direction, forces, strength, slip, opening; those like it."""
CONTACT_NAMES = ("vertex", "by", "mode", "joint")
"""What tells it: vertex, block that the vertex enters, mode and joint."""


class _Frames(Sequence[Floats]):
    """The vertices (nv, 2) of some frames, read one after the other."""

    def __init__(self, results: Recording, numbers: Ints) -> None:
        self._results, self._numbers = results, numbers

    def __len__(self) -> int:
        return len(self._numbers)

    def __getitem__(self, k: Any) -> Any:
        return self._results.vertices(int(self._numbers[k]))

    def __iter__(self) -> Iterator[Floats]:
        for number in self._numbers:
            yield self._results.vertices(int(number))


def moving(results: Recording, numbers: Ints, budget: float) -> dict[str, Any]:
    """Return the content of some frames on the page; m about the middle of the start.

    ``budget`` is the size of contacts and joints, bytes, before they are compressed.
    """
    start = results.vertices(0)
    motion = affine(start, _Frames(results, numbers), results.block_start)
    shown = _packed_motion(motion, start, results.block_start)
    stages = results.frame_stages
    about = _About(results, numbers, start)
    return {
        "times": results.times[numbers].tolist(),
        "stages": [stages[n] for n in numbers] if stages else [],
        "gone": _gone(results, numbers),
        "motion": shown,
        "fields": _packed_fields(results, numbers, motion, shown),
        **_thinned(about, budget),
        "levels": _levels(about),
        "bolts": _bolts(about),
        "points": _points(about),
        "links": links_in(results, numbers, about.origin),
        "reactions": reactions_in(results, numbers, about.origin),
        "linings": linings_in(results, numbers),
    }


@dataclass(frozen=True)
class _About:
    """Frames that are shown, and the blocks as they were at the start."""

    results: Recording
    numbers: Ints
    start: Floats
    """Vertices at the start, m, shape (nv, 2)."""

    @property
    def origin(self) -> Floats:
        """Point that places are relative to, m, shape (2,)."""
        return np.asarray(self.start.mean(axis=0))


def _gone(results: Recording, numbers: Ints) -> list[list[int]]:
    """Return the frames in which each block is taken away, comes, is taken away, and so on.

    Linings of later stages are taken away in the first.
    """
    found: list[list[int]] = [[] for _ in results.block_name]
    before = np.zeros(len(found), np.bool_)
    for frame, number in enumerate(numbers):
        absent = absent_in_frame(results, int(number))
        for block in np.flatnonzero(absent != before):
            found[block].append(frame)
        before = absent
    return found


def _packed_motion(motion: dict[str, Floats], start: Floats, block_start: Ints) -> dict[str, Any]:
    """Return the motion for the page; strains are no finer than displacements at a block's edge."""
    rounding = ROUNDING * float(np.ptp(start, axis=0).max())
    moved = max(float(np.abs(motion[name]).max()) for name in ("x", "y"))
    least = dict.fromkeys(("x", "y"), max(rounding, NOISE * moved)) | {"angle": ROUNDING}
    quantum = max(float(np.ptp(motion[name])) for name in ("x", "y")) / LEVELS
    low = np.minimum.reduceat(start, block_start[:-1])
    high = np.maximum.reduceat(start, block_start[:-1])
    deformed = np.any([np.abs(motion[name]).max(axis=0) > ROUNDING for name in STRAINS], axis=0)
    sizes = np.hypot(*(high - low)[deformed].T)
    fine = quantum / float(sizes.max()) if deformed.any() else 0.0
    return {name: packed(values, least.get(name, fine)) for name, values in motion.items()}


def _packed_fields(
    results: Recording, numbers: Ints, motion: dict[str, Floats], shown: dict[str, Any]
) -> dict[str, Any]:
    """Return the fields for the page, of many blocks and frames in fewer levels.

    Those that follow from the ``motion`` are left out unless they differ from it by a tenth of what
    it is rounded to as it is ``shown``: displacements may count from a later stage, and rotations
    of blocks that deform are sums over steps.
    """
    many = len(numbers) * len(results.block_name) > MANY
    levels = FEWER_LEVELS if many else LEVELS
    rounding = ROUNDING * max(1.0, float(np.ptp(results.vertices(0), axis=0).max()))
    found = {}
    for names in FIELDS:
        values = {
            name: np.stack([results.field(name, int(number)) for number in numbers])
            for name in names
        }
        least = NOISE * max(float(np.abs(np.nan_to_num(one)).max()) for one in values.values())
        for name, one in values.items():
            same = OF_MOTION.get(name)
            if same is not None:
                table = shown[same]
                quantum = (table["high"] - table["low"]) / table["levels"]
                if np.abs(np.nan_to_num(one - motion[same])).max() <= max(0.1 * quantum, rounding):
                    continue
            found[name] = packed(one, least, levels)
    return found


# Contacts and joints -----------------------------------------------------------------------------


def _thinned(about: _About, budget: float) -> dict[str, Any]:
    """Return contacts and joints; where room is short, a share of them evenly in space."""
    contacts = _contacts(about, Rows(CONTACT_BYTES, budget))
    order = spread(about.start)
    faces = {name: _faces(about, name, order, Rows(FACE_BYTES, budget)) for name in FACES}
    if not any(rows[:, 4].any() for rows in faces["worn"].rows):
        del faces["worn"]
    if about.results.water:
        faces["water"] = _wetted(about, order, Rows(FACE_BYTES, budget))
    room = room_of_each([one.bytes * one.total for one in (contacts, *faces.values())], budget)

    def cut(one: Rows) -> tuple[NDArray[Any], dict[str, Any]]:
        flat, count = one.first(int(room / one.bytes))
        return flat, {"shown": len(flat), "of": one.total, "count": count}

    flat, counts = cut(contacts)
    found: dict[str, Any] = {
        name: packed(flat[None, :, k], NOISE * float(np.abs(flat[:, like]).max(initial=0.0)))
        for k, (name, like) in enumerate(CONTACT_NUMBERS.items())
    }
    for k, name in enumerate(CONTACT_NAMES, len(CONTACT_NUMBERS)):
        found[name] = raw(flat[:, k], "<i4")
    joints = {}
    for name, rows in faces.items():
        flat_faces, told = cut(rows)
        ends = {
            end: packed(flat_faces[None, :, k]) for k, end in enumerate(("x0", "y0", "x1", "y1"))
        }
        value = raw(flat_faces[:, 4], "<f4")
        joints[name] = {**told, **ends, "value": value, "edge": raw(flat_faces[:, 5], "<i4")}
    return {"contacts": {**counts, **found}, "faces": joints}


def _contacts(about: _About, found: Rows) -> Rows:
    """Return CONTACT_NUMBERS and CONTACT_NAMES of every contact, in ``found``.

    Those of two blocks stay together, in the order of the smaller one: what passes between the
    blocks is their sum.
    """
    start, first = about.start, about.results.block_start[:-1]
    count = np.diff(about.results.block_start)[:, None]
    order = spread(np.add.reduceat(start, first) / count)
    high, low = np.maximum.reduceat(start, first), np.minimum.reduceat(start, first)
    size = (high - low).prod(axis=1)
    for number in about.numbers:
        table = about.results.contacts(int(number))
        forces = table.normal_force, table.shear_force
        angle = np.arctan2(table.normal[:, 1], table.normal[:, 0])
        moved = table.strength, table.slip, table.opening
        names = table.vertex, table.edge_block, table.mode, table.joint
        place = table.position - about.origin
        rows = np.column_stack([place, angle, *forces, *moved, *names])
        pair = np.sort(np.stack([table.vertex_block, table.edge_block]), axis=0)
        smaller = np.where(size[pair[0]] < size[pair[1]], *pair)
        largest = np.hypot(*forces).argmax() if len(table) else 0
        stays = (pair == pair[:, largest : largest + 1]).all(axis=0)
        found.add(rows, np.where(stays, ALWAYS, order[smaller]))
    return found


def _faces(about: _About, name: str, order: Floats, found: Rows) -> Rows:
    """Return ends and value of every face of the joints; ``order`` (nv,) is that of their edges."""
    for number in about.numbers:
        faces = JOINT_FIELDS[name].values(about.results, int(number))
        ends = (faces.ends - about.origin).reshape(-1, 4)
        rows = np.column_stack([ends, faces.value, faces.edge])
        found.add(rows, _with_largest(order[faces.edge], np.abs(faces.value)))
    return found


def _with_largest(order: Floats, size: Floats) -> Floats:
    """Return an order (m,) in which the row of the largest ``size`` (m,) is always kept."""
    if len(size):
        order[size.argmax()] = ALWAYS
    return order


def _wetted(about: _About, order: Floats, found: Rows) -> Rows:
    """Return faces and joints under water with their mean pressures; none are told by an edge."""
    for number in map(int, about.numbers):
        waters = waters_of(about.results, number)
        wet = pressures_of(about.results, waters, number, about.results.vertices(number))
        ends = (wet.ends - about.origin).reshape(-1, 4)
        pressure = wet.pressure.mean(axis=1)
        rows = np.column_stack([ends, pressure, np.full(len(ends), -1.0)])
        found.add(rows, _with_largest(order[wet.edge], pressure))
    return found


def _levels(about: _About) -> list[list[Any]]:
    """Return which waters press in each frame, and their ranges of x, m, that lie in voids."""
    results = about.results
    surfaces = [water.surface.tobytes() for water in results.water]
    found: list[list[Any]] = []
    for number in map(int, about.numbers):
        here = {surfaces.index(one.surface.tobytes()): one for one in waters_of(results, number)}
        voids = {k: dry_of(results, here[k], number) - about.origin[0] for k in sorted(here)}
        found.append([[k, dry.tolist()] for k, dry in voids.items()])
    return found


# Bolts and measured points -----------------------------------------------------------------------


def _bolts(about: _About) -> dict[str, Any] | None:
    """Return points, forces and states of bolts in every frame; None without any."""
    first = about.results.bolts(0)
    if not len(first):
        return None
    every = [about.results.bolts(int(number)) for number in about.numbers]
    at = np.stack([one.points - about.origin for one in every])
    return {
        "names": list(first.name),
        "bolt": first.bolt.tolist(),
        "x": raw(at[..., 0], "<f4"),
        "y": raw(at[..., 1], "<f4"),
        "force": raw(np.stack([one.force for one in every]), "<f4"),
        "state": raw(np.stack([one.state for one in every]), "<i4"),
    }


def _points(about: _About) -> list[dict[str, Any]]:
    """Return the measured points with where they are in every frame."""
    results, found = about.results, []
    for k, (name, at) in enumerate(zip(results.point_name, results.point_start, strict=True)):
        history = results.history(name)
        row = results.rows_at(history.time, about.numbers)
        before = [counted_from(results.stages, k, float(history.time[one])) for one in row]
        place = at - about.origin + history.displacement[row] + np.reshape(before, (-1, 2))
        found.append({"name": name, "x": place[:, 0].tolist(), "y": place[:, 1].tolist()})
    return found


def supports_of(results: Recording) -> dict[str, Any]:
    """Return names, colours and vertices of links, reactions and linings, which stay the same."""
    links = results.link_lines
    looks = [
        ("link" if one == "intact" else f"link, {one}", LINK_COLOURS[one]) for one in LINK_STATES
    ]
    return {
        "link_looks": looks,
        "link_holds": links.holds.tolist() if links.name else [],
        "reaction_colour": REACTION_COLOUR,
        "linings": [
            {"face": results.lining(name).face.tolist(), "closed": comes_back(results, name)}
            for name in results.lining_name
        ],
        "diagrams": {name: astuple(one) for name, one in DIAGRAMS.items()},
    }


def links_in(results: Recording, numbers: Ints, origin: Floats) -> dict[str, Any] | None:
    """Return both points, directions and states of the links in some frames; None without any."""
    links = results.link_lines
    if not links.name:
        return None
    places = np.stack([places_of(results, int(k)) for k in numbers]) - origin
    directions = np.stack([directions_of(results, int(k)) for k in numbers])
    states = np.stack([states_of(results, int(k)) for k in numbers])
    ends = {f"{axis}{end}": places[:, :, end, k] for end in (0, 1) for k, axis in enumerate("xy")}
    ends |= {"wayX": directions[..., 0], "wayY": directions[..., 1]}
    return {
        "names": list(links.name),
        **{name: raw(values, "<f4") for name, values in ends.items()},
        "state": raw(states, "<i4"),
    }


def reactions_in(results: Recording, numbers: Ints, origin: Floats) -> dict[str, Any] | None:
    """Return where reactions act, m, and their forces, N/m, in some frames; NaN for none."""
    names = results.reaction_name
    if not names:
        return None
    found = np.full((4, len(numbers), len(names)), np.nan)
    for row, number in enumerate(numbers):
        for name, at, force in forces_in(results, int(number)):
            found[:, row, names.index(name)] = *(at - origin), *force
    columns = zip(("x", "y", "fx", "fy"), found, strict=True)
    return {"names": list(names), **{name: raw(values, "<f4") for name, values in columns}}


def linings_in(results: Recording, numbers: Ints) -> dict[str, str] | None:
    """Return N, Q and M of the joints of all linings in some frames; NaN: it does not bear."""
    if not results.lining_name:
        return None
    every: dict[str, list[Floats]] = {one.column: [] for one in DIAGRAMS.values()}
    for name in results.lining_name:
        lining = results.lining(name)
        rows = results.rows_at(lining.time, numbers)
        for column, values in every.items():
            values.append(np.where(carries(lining)[rows], getattr(lining, column)[rows], np.nan))
    return {name: raw(np.concatenate(values, axis=1), "<f4") for name, values in every.items()}
