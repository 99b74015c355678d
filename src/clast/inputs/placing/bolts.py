"""Bolts in the blocks of a model: their points, and the springs between these."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.inputs.bolts import Bolt, BoltKind, BoltPattern
from clast.inputs.declaring.table import Inputs
from clast.inputs.declaring.values import number_of
from clast.inputs.placing.bolt_lines import Ground, joints_between
from clast.model import ranges
from clast.model.model import Floats
from clast.model.ranges import check_names, check_text
from clast.model.supports import Bolts

NAMED_IDLE_MAX = 5
"""Bolts that cross no joint that a note names."""


def bolts_round(
    pattern: BoltPattern,
    number: int,
    openings: tuple[Mapping[str, Floats], Collection[str]],
    ground: Ground,
) -> Iterator[tuple[str, Bolt]]:
    """Give label and record of each bolt of a pattern; ModelError where one would lie in a void.

    ``openings`` are the outlines of openings with a shape, and the names of those of blocks.
    """
    whole = pattern.label(number)
    if pattern.name is not None:
        check_text(pattern.name, whole)
    corners = _outline(pattern, whole, *openings)
    heads, away = _heads(pattern, whole, corners)
    shared = pattern.model_dump(
        include={"kind", "anchorage", "free_length", "pretension_is", "stage"}
    )
    for k, (head, direction) in enumerate(zip(heads, away, strict=True), 1):
        angle = np.degrees(np.arctan2(direction[1], direction[0]))
        label = f"{whole}, bolt {k} at {angle % 360.0:.4g} degrees"
        line = np.array([head, head + pattern.length * direction])
        line, blocks = _in_rock(line, ground, label)
        yield (
            label,
            Bolt(
                name=f"{pattern.group(number)}-{k}",
                start=tuple(line[0].tolist()),
                end=tuple(line[1].tolist()),
                blocks=None if pattern.anchorage == "grouted" else blocks,
                **shared,
            ),
        )


def _outline(
    pattern: BoltPattern, label: str, outlines: Mapping[str, Floats], excavated: Collection[str]
) -> Floats:
    """Return the corners of the opening, counter-clockwise, m, (c, 2)."""
    given = pattern.opening
    if isinstance(given, str):
        if given not in outlines and given in excavated:
            raise ModelError(
                f"'{shortened(given)}' is an opening given by its blocks, so its outline is not "
                "known",
                where=f"{label}, opening",
                remedy="give an opening with a shape in a [domain], or each bolt as a [[bolt]]",
            )
        number_of(given, dict.fromkeys(outlines, 0), "opening", f"{label}, opening")
    corners = np.array(outlines[given] if isinstance(given, str) else given, float)
    if len(corners) < 3:
        what = f"{shortened(repr(given))} is not an outline"
        remedy = "give the name of an opening, or its corners [[x, y], ...], m"
        raise ModelError(what, where=f"{label}, opening", remedy=remedy)
    shape = shapely.Polygon(corners)
    if not shape.is_valid:
        what = "its outline crosses itself"
        raise ModelError(what, where=f"{label}, opening", remedy="order its corners")
    return corners if shapely.is_ccw(shape.exterior) else corners[::-1].copy()


def _heads(pattern: BoltPattern, label: str, corners: Floats) -> tuple[Floats, Floats]:
    """Return where bolts begin, m, and their directions away from the centroid, (b, 2) each."""
    first, last, spacing = pattern.from_, pattern.to, pattern.spacing
    middle = shapely.get_coordinates(shapely.centroid(shapely.Polygon(corners)))[0]
    ring = shapely.LinearRing(corners)
    whole = last - first == 360.0
    begin, end = (_along(ring, middle, angle, label) for angle in (first, last))
    room = ring.length if whole else (end - begin) % ring.length
    count = int(room / spacing * (1.0 + 1e-9)) + (0 if whole else 1)
    # Most bolts of a pattern
    if count > 100_000:
        what = f"would be {count} bolts"
        raise ModelError(what, where=f"{label}, spacing", remedy="raise the spacing")
    apart = room / max(count, 1) if whole else spacing
    left = 0.0 if whole else 0.5 * (room - (count - 1) * spacing)
    places = (begin + left + apart * np.arange(max(count, 1))) % ring.length
    heads = shapely.get_coordinates(shapely.line_interpolate_point(ring, places))
    away = heads - middle
    return heads, away / np.hypot(*away.T)[:, None]


def _along(ring: Any, middle: Floats, angle: float, label: str) -> float:
    """Return where a ray from the middle leaves an outline, m along it."""
    turn = np.radians(angle)
    far = middle + 2.0 * ring.length * np.array([np.cos(turn), np.sin(turn)])
    hits = shapely.get_coordinates(shapely.intersection(ring, shapely.linestrings([middle, far])))
    if not len(hits):  # the centroid of an outline with a bay may lie outside
        raise ModelError(
            f"the ray at {angle:g} degrees from its centroid ({middle[0]:.4g}, "
            f"{middle[1]:.4g}) does not meet its outline",
            where=f"{label}, opening",
            remedy="give other angles from and to, a simpler outline, or single bolts: [[bolt]]",
        )
    outermost = hits[np.argmax(np.hypot(*(hits - middle).T))]
    return float(shapely.line_locate_point(ring, shapely.points(outermost)))


def _in_rock(line: Floats, ground: Ground, label: str) -> tuple[Floats, tuple[str, str]]:
    """Return the ends of a bolt in the rock behind the wall, m, (2, 2), and their blocks.

    An end less than the slack behind a joint belongs to the block before it.
    """
    origin, length = ground.outlines.origin, float(np.hypot(*(line[1] - line[0])))
    pieces = ground.pieces(line - origin)
    # Share of a bolt's length by which its head may lie beside the wall, as outlines are rounded,
    # and its end behind a joint that it does not cross
    slack = 1e-3 * length
    long = np.flatnonzero(np.diff(pieces.ends, axis=1)[:, 0] > slack)
    if not len(long) or pieces.ends[long[0], 0] > slack:
        what, where = "its head lies in no block", line[0]
    elif pieces.ends[long[-1], 1] < length - slack:
        what, where = "its end lies in no block", line[1]
    else:
        along = (line[1] - line[0]) / length
        begin, end = max(float(pieces.ends[long[0], 0]), 0.0), float(pieces.ends[long[-1], 1])
        toe = line[1] if end >= length * (1.0 - 1e-6) else line[0] + end * along
        first, last = (ground.outlines.names[int(pieces.block[k])] for k in (long[0], long[-1]))
        return np.array([line[0] + begin * along, toe]), (first, last)
    remedy = "shorten length, or leave this part of the outline out by from and to"
    raise ModelError(what, where=f"{label}, {ground.text(where - origin)}", remedy=remedy)


@dataclass(frozen=True, kw_only=True)
class Anchored:
    """The points of one bolt from head to toe, and between which of them its springs act."""

    block: list[int]
    at: list[Floats]
    ends: list[tuple[int, int]]


def placed_bolts(
    given: Inputs, openings: Mapping[str, Floats], blocks_of_openings: Sequence[str], ground: Ground
) -> Bolts:
    """Return the bolts of a model, those of patterns behind the others.

    ``openings`` are the outlines of openings by name, (c, 2) each, m; ``blocks_of_openings`` names
    those that are blocks.  ModelError names bolt and remedy where one cannot be.
    """
    kinds = given.named(BoltKind)
    check_names("bolt kind", list(kinds))
    bolts = given.all(Bolt)
    labels = [
        f"bolt {k} '{shortened(bolt.name)}'" if bolt.name else f"bolt {k}"
        for k, bolt in enumerate(bolts, 1)
    ]
    groups = [""] * len(bolts)
    for number, pattern in enumerate(given.all(BoltPattern), 1):
        for label, bolt in bolts_round(pattern, number, (openings, blocks_of_openings), ground):
            bolts = [*bolts, bolt]
            labels.append(label)
            groups.append(pattern.group(number))
    if not bolts:
        return Bolts()
    names = [str(k) if bolt.name is None else bolt.name for k, bolt in enumerate(bolts, 1)]
    check_names("bolt", names)
    named = list(zip(labels, bolts, strict=True))
    lines = [np.array([bolt.start, bolt.end]) - ground.outlines.origin for bolt in bolts]
    parts = [
        _anchored(label, bolt, line, ground)
        for (label, bolt), line in zip(named, lines, strict=True)
    ]
    for part, label in zip(parts, labels[: len(given.all(Bolt))], strict=False):
        if not part.ends:  # of a pattern some may: where joints are random, chance decides
            what = f"crosses no joint: all of it is in {ground.outlines.label(part.block[0])}"
            remedy = "lengthen it, or move one end across a joint into another block"
            raise ModelError(what, where=label, remedy=remedy)
    first = np.cumsum([0, *(len(part.block) for part in parts)])
    known = {name: number for number, name in enumerate(kinds)}
    for label, bolt in named:
        number_of(bolt.kind, known, "bolt kind", f"{label}, kind")
    pairs = [(first[k] + i, first[k] + j) for k, part in enumerate(parts) for i, j in part.ends]
    return _with_springs(
        Bolts(
            name=tuple(names),
            kind=tuple(bolt.kind for bolt in bolts),
            group=tuple(groups),
            stage=tuple(bolt.stage or "" for bolt in bolts),
            installed=np.array([not bolt.stage for bolt in bolts], np.bool_),
            locked=np.zeros(len(bolts), np.bool_),
            block=np.array([block for part in parts for block in part.block], np.int64),
            at=np.array([point for part in parts for point in part.at]).reshape(-1, 2),
            bolt=np.repeat(np.arange(len(bolts)), np.diff(first)),
            ends=np.array(pairs, np.int64).reshape(-1, 2),
        ),
        named,
        [kinds[bolt.kind] for bolt in bolts],
    )


def idle_note(bolts: Bolts) -> Iterator[str]:
    """Yield the note on bolts that cross no joint."""
    springs = np.bincount(bolts.of_spring, minlength=len(bolts))
    idle = [bolts.name[k] for k in np.flatnonzero(springs == 0)]
    if idle:
        names = ", ".join(idle[:NAMED_IDLE_MAX]) + (", ..." if len(idle) > NAMED_IDLE_MAX else "")
        yield f"{len(idle)} of {len(bolts)} bolts cross no joint and carry nothing: {names}"


def ends_of(bolts: Bolts) -> Iterator[tuple[str, int, Floats]]:
    """Give the label, the block and the place (1, 2), m, of head and toe of each bolt."""
    for k, name in enumerate(bolts.name):
        for point in np.flatnonzero(bolts.bolt == k)[[0, -1]]:
            yield f"bolt '{shortened(name)}'", int(bolts.block[point]), bolts.at[[point]]


def _with_springs(
    bolts: Bolts, named: Sequence[tuple[str, Bolt]], kinds: Sequence[BoltKind]
) -> Bolts:
    """Return the bolts with their springs' strength, by label, record and kind (k,) of each."""
    owner = bolts.of_spring
    length = np.hypot(*(bolts.at[bolts.ends[:, 1]] - bolts.at[bolts.ends[:, 0]]).T)
    stiffness, rupture = np.zeros(len(owner)), np.full(len(owner), np.inf)
    for k, (kind, (label, bolt)) in enumerate(zip(kinds, named, strict=True)):
        own = owner == k
        stiffness[own] = kind.stiffness_of(length[own])
        rupture[own] = kind.rupture_of(length[own])
        where, remedy = f"{label}, kind '{bolt.kind}'", "check young, area and length"
        for m in np.flatnonzero(own):
            ranges.check_size(stiffness[m], ranges.STIFFNESS, f"{where}, stiffness", remedy)
            _refuse_early_rupture(kind, stiffness[m], rupture[m], where)
        if bolt.pretension_is == "jacked" and kind.pretension == 0.0:
            what = f"a jack needs a pretension, and kind '{shortened(bolt.kind)}' has no pretension"
            remedy = "give pretension to its kind, or leave pretension_is out"
            raise ModelError(what, where=f"{label}, pretension_is", remedy=remedy)
    strength = [
        np.inf if kind.yield_force is None else kind.per_metre(kind.yield_force) for kind in kinds
    ]
    jacked = [bolt.pretension_is == "jacked" for _, bolt in named]
    return replace(
        bolts,
        stiffness=stiffness,
        rupture=rupture,
        yield_force=np.array(strength)[owner],
        pretension=np.array([kind.per_metre(kind.pretension) for kind in kinds])[owner],
        compression=np.array([kind.compression for kind in kinds], np.bool_)[owner],
        jacked=np.array(jacked, np.bool_)[owner],
    )


def _refuse_early_rupture(kind: BoltKind, stiffness: float, rupture: float, where: str) -> None:
    """Refuse a spring that breaks before it yields, or before it has its pretension."""
    for given, what in ((kind.yield_force, "it yields"), (kind.pretension, "it is tensioned")):
        force = 0.0 if given is None else kind.per_metre(given)
        if rupture < force / stiffness:
            raise ModelError(
                f"it breaks at an elongation of {rupture:.6g} m, but {what} at "
                f"{force / stiffness:.6g} m ({force:g} N/m by {stiffness:g} N/m per m)",
                where=where,
                remedy="raise rupture_elongation or rupture_strain, or the stiffness",
            )


def _anchored(label: str, bolt: Bolt, line: Floats, ground: Ground) -> Anchored:
    """Return a bolt of one spring between two points, or of one for each joint that it crosses."""
    if bolt.anchorage == "ends":
        block = ground.blocks_of_ends(label, line, bolt.blocks)
        ends = [(0, 1)] if block[0] != block[1] else []
        return Anchored(block=block, at=[line[0], line[1]], ends=ends)
    free, pieces = bolt.free_length or 0.0, ground.pieces(line)
    joints_between(pieces, line, ground, label, free)
    along = (line[1] - line[0]) / float(np.hypot(*(line[1] - line[0])))
    # what lies between two joints is shared by the springs of both
    room = np.diff(pieces.ends, axis=1)[:, 0]
    share = np.full(len(room), 0.5)
    share[[0, -1]] = 1.0
    reach = np.minimum(free, share * room)
    blocks, at, ends = [int(pieces.block[0])], [line[0]], []
    for k in range(len(room) - 1):
        before, after = pieces.ends[k, 1] - reach[k], pieces.ends[k + 1, 0] + reach[k + 1]
        ends.append((len(blocks), len(blocks) + 1))
        blocks += [int(pieces.block[k]), int(pieces.block[k + 1])]
        at += [line[0] + before * along, line[0] + after * along]
    return Anchored(block=[*blocks, int(pieces.block[-1])], at=[*at, line[1]], ends=ends)
