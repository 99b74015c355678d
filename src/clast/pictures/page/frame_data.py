"""The parts of a page that change with frames: motion, fields, contacts, supports, points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats, Ints
from clast.pictures.draw_flow import flows_of, surfaces_of, text_of_flow
from clast.pictures.draw_water import dry_of, pressures_of, waters_of
from clast.pictures.faces import Faces
from clast.pictures.flow_values import FLOW_FIELDS, dry_channels, largest_flow, with_widest
from clast.pictures.frames import places_of_points
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.linings import DIAGRAMS, carries, pairs_of
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
    link_label,
    places_of,
    states_of,
)
from clast.results import Recording
from clast.results.frames import absent_in_frame
from clast.results.schema import LINK_STATES

CONTACT_BYTES, FACE_BYTES, CHANNEL_BYTES = 28, 16, 20
"""Bytes of a contact, a face of a joint and a channel in a frame, before they are compressed."""
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
FACE_COLUMNS = 6
"""Columns of a face: its ends, its value, its edge; of a channel there is its width as well."""
CONTACT_NAMES = ("vertex", "by", "mode", "joint")
"""Columns that identify it: vertex, block that the vertex enters, mode and joint."""


def moving(results: Recording, numbers: Ints, budget: float) -> dict[str, Any]:
    """Return the content of some frames on the page; m about the middle of the start.

    ``budget`` is the size of contacts and joints, bytes, before they are compressed.
    """
    start = results.vertices(0)
    frames = (results.vertices(int(number)) for number in numbers)
    motion = affine(start, frames, results.block_start)
    # The motion for the page; strains are no finer than displacements at a block's edge.
    rounding = ROUNDING * float(np.ptp(start, axis=0).max())
    moved = max(float(np.abs(motion[name]).max()) for name in ("x", "y"))
    least = dict.fromkeys(("x", "y"), max(rounding, NOISE * moved)) | {"angle": ROUNDING}
    quantum = max(float(np.ptp(motion[name])) for name in ("x", "y")) / LEVELS
    low = np.minimum.reduceat(start, results.block_start[:-1])
    high = np.maximum.reduceat(start, results.block_start[:-1])
    deformed = np.any([np.abs(motion[name]).max(axis=0) > ROUNDING for name in STRAINS], axis=0)
    sizes = np.hypot(*(high - low)[deformed].T)
    fine = quantum / float(sizes.max()) if deformed.any() else 0.0
    shown = {name: packed(values, least.get(name, fine)) for name, values in motion.items()}
    stages = results.frame_stages
    about = _About(results, numbers, start)
    # frames in which each block is taken away, comes, ...: linings of later stages go in the first
    gone: list[list[int]] = [[] for _ in results.block_name]
    before = np.zeros(len(gone), np.bool_)
    for frame, number in enumerate(numbers):
        absent = absent_in_frame(results, int(number))
        for block in np.flatnonzero(absent != before):
            gone[block].append(frame)
        before = absent
    return {
        "times": results.times[numbers].tolist(),
        "stages": [stages[n] for n in numbers] if stages else [],
        "gone": gone,
        "motion": shown,
        "fields": _packed_fields(results, numbers, motion, shown),
        **_contacts_and_joints(about, budget),
        "levels": _levels(about),
        "flows": _flows(about),
        "bolts": _bolts(about),
        "points": _points(about),
        "links": _links(about),
        "reactions": _reactions(about),
        "linings": _linings(results, numbers),
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


def _packed_fields(
    results: Recording, numbers: Ints, motion: dict[str, Floats], shown: dict[str, Any]
) -> dict[str, Any]:
    """Return the fields for the page but for those that follow from the ``motion``."""
    # displacements may count from a later stage, and rotations of blocks that deform are sums
    many = len(numbers) * len(results.block_name) > MANY
    levels = FEWER_LEVELS if many else LEVELS
    rounding = ROUNDING * max(1.0, float(np.ptp(results.vertices(0), axis=0).max()))
    fields = {}
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
            fields[name] = packed(one, least, levels)
    return fields


# Contacts and joints -----------------------------------------------------------------------------


def _contacts_and_joints(about: _About, budget: float) -> dict[str, Any]:
    """Return contacts and joints; where room is short, a part of them evenly in space."""
    contacts = _contacts(about, Rows(CONTACT_BYTES, budget))
    order = spread(about.start)
    faces = {name: _faces(about, name, order, Rows(FACE_BYTES, budget)) for name in FACES}
    if not any(rows[:, 4].any() for rows in faces["worn"].rows):
        del faces["worn"]
    if about.results.water:
        # none are told by an edge
        faces["water"] = Rows(FACE_BYTES, budget)
        for number in map(int, about.numbers):
            waters = waters_of(about.results, number)
            wet = pressures_of(about.results, waters, number, about.results.vertices(number))
            pressure, no_edge = wet.pressure.mean(axis=1), np.full(len(wet.ends), -1)
            _add_faces(
                about,
                faces["water"],
                Faces(ends=wet.ends, value=pressure, edge=no_edge),
                order[wet.edge],
            )
    if len(about.results.channels.edge):
        largest = {number: largest_flow(about.results, number) for number in about.numbers.tolist()}
        for name, values in {**_flow_values(about.results), "dry": dry_channels}.items():
            faces[name] = Rows(CHANNEL_BYTES, budget)
            for number, flow in largest.items():
                found = with_widest(values(about.results, number), flow, max(largest.values()))
                _add_faces(about, faces[name], found, order[found.edge])
    room = room_of_each([one.bytes * one.total for one in (contacts, *faces.values())], budget)

    def cut(one: Rows) -> tuple[NDArray[Any], dict[str, Any]]:
        flat, count = one.first(int(room / one.bytes))
        return flat, {"shown": len(flat), "of": one.total, "count": count}

    flat, counts = cut(contacts)
    columns: dict[str, Any] = {
        name: packed(flat[None, :, k], NOISE * float(np.abs(flat[:, like]).max(initial=0.0)))
        for k, (name, like) in enumerate(CONTACT_NUMBERS.items())
    }
    for k, name in enumerate(CONTACT_NAMES, len(CONTACT_NUMBERS)):
        columns[name] = raw(flat[:, k], "<i4")
    joints = {}
    for name, rows in faces.items():
        flat_faces, counts_of_faces = cut(rows)
        ends = {
            end: packed(flat_faces[None, :, k]) for k, end in enumerate(("x0", "y0", "x1", "y1"))
        }
        value = raw(flat_faces[:, 4], "<f4")
        joints[name] = {
            **counts_of_faces,
            **ends,
            "value": value,
            "edge": raw(flat_faces[:, 5], "<i4"),
        }
        if flat_faces.shape[1] > FACE_COLUMNS:
            joints[name]["width"] = raw(flat_faces[:, FACE_COLUMNS], "<f4")
    return {"contacts": {**counts, **columns}, "faces": joints}


def _contacts(about: _About, kept: Rows) -> Rows:
    """Return numbers and names of every contact; those of two blocks stay together."""
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
        kept.add(rows, np.where(stays, ALWAYS, order[smaller]))
    return kept


def _faces(about: _About, name: str, order: Floats, rows: Rows) -> Rows:
    """Return ends and value of every face of the joints; ``order`` (nv,) is that of their edges."""
    for number in about.numbers:
        faces = JOINT_FIELDS[name].values(about.results, int(number))
        _add_faces(about, rows, faces, order[faces.edge])
    return rows


def _flow_values(results: Recording) -> dict[str, Callable[[Recording, int], Faces]]:
    """Return the functions that give channels of a frame each field; no gravity: no head."""
    weightless = results.channels.weight == 0.0
    fields = {name: one.values for name, one in FLOW_FIELDS.items()}
    return {name: one for name, one in fields.items() if not (weightless and name == "head")}


def _add_faces(about: _About, rows: Rows, faces: Faces, place: Floats) -> None:
    """Add faces; the one with the largest value is always kept."""
    if len(place):
        place[np.abs(faces.value).argmax()] = ALWAYS
    columns = [(faces.ends - about.origin).reshape(-1, 4), faces.value, faces.edge]
    rows.add(np.column_stack(columns + ([] if faces.width is None else [faces.width])), place)


def _levels(about: _About) -> list[list[Any]]:
    """Return which waters press in each frame, and their ranges of x, m, that lie in voids."""
    results = about.results
    surfaces = [water.surface.tobytes() for water in results.water]
    levels: list[list[Any]] = []
    for number in map(int, about.numbers):
        here = {surfaces.index(one.surface.tobytes()): one for one in waters_of(results, number)}
        voids = {k: dry_of(results, here[k], number) - about.origin[0] for k in sorted(here)}
        levels.append([[k, dry.tolist()] for k, dry in voids.items()])
    return levels


def _flows(about: _About) -> list[dict[str, Any]]:
    """Return the water tables of each frame, m, and the flows with their places and texts."""
    results, origin = about.results, about.origin
    if not len(results.channels.edge):
        return [{"tables": [], "flows": []} for _ in about.numbers]
    flows = []
    for number in map(int, about.numbers):
        told = [
            [*(at - origin).tolist(), text_of_flow(name, flow)]
            for name, at, flow in flows_of(results, number)
        ]
        lines = [(one - origin).round(4).tolist() for one in surfaces_of(results, number)]
        flows.append({"tables": lines, "flows": told})
    return flows


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
    names, places = about.results.point_name, places_of_points(about.results, about.numbers)
    return [
        {"name": name, "x": place[:, 0].tolist(), "y": place[:, 1].tolist()}
        for name, place in zip(names, (places - about.origin).swapaxes(0, 1), strict=True)
    ]


def supports_of(results: Recording) -> dict[str, Any]:
    """Return names, colours, points and vertices of supports and pairs, which stay the same."""
    links = results.link_lines
    looks = [(link_label(state), LINK_COLOURS[state]) for state in LINK_STATES]
    return {
        "convergences": results.convergence_points.tolist(),
        "link_looks": looks,
        "link_holds": links.holds.tolist() if links.name else [],
        "reaction_colour": REACTION_COLOUR,
        "linings": [{"face": results.lining(name).face.tolist()} for name in results.lining_name],
        "lining_pairs": pairs_of(results).tolist(),
        "diagrams": {name: astuple(one) for name, one in DIAGRAMS.items()},
    }


def _links(about: _About) -> dict[str, Any] | None:
    """Return both points, directions and states of the links in some frames; None without any."""
    results, links = about.results, about.results.link_lines
    if not links.name:
        return None
    places, directions, states = (
        np.stack([column(results, int(k)) for k in about.numbers])
        for column in (places_of, directions_of, states_of)
    )
    at = places - about.origin
    ends = {f"{axis}{end}": at[:, :, end, k] for end in (0, 1) for k, axis in enumerate("xy")}
    ends |= {"alongX": directions[..., 0], "alongY": directions[..., 1]}
    return {
        "names": list(links.name),
        **{name: raw(values, "<f4") for name, values in ends.items()},
        "state": raw(states, "<i4"),
    }


def _reactions(about: _About) -> dict[str, Any] | None:
    """Return where reactions act, m, and their forces, N/m, in some frames; NaN for none."""
    names = about.results.reaction_name
    if not names:
        return None
    rows = np.full((4, len(about.numbers), len(names)), np.nan)
    for row, number in enumerate(about.numbers):
        for name, at, force in forces_in(about.results, int(number)):
            rows[:, row, names.index(name)] = *(at - about.origin), *force
    columns = zip(("x", "y", "fx", "fy"), rows, strict=True)
    return {"names": list(names), **{name: raw(values, "<f4") for name, values in columns}}


def _linings(results: Recording, numbers: Ints) -> dict[str, str] | None:
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
