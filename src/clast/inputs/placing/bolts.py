"""Bolts as they are given to a builder, and the points and springs that they become."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypedDict

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.placing.blocks import Vector
from clast.inputs.placing.bolt_kinds import check_rupture
from clast.inputs.placing.bolt_lines import Ground, Pieces, joints_between
from clast.model import ranges
from clast.model.bolts import BoltKind, Bolts
from clast.model.checks import locate
from clast.model.model import Floats
from clast.model.value_checks import check_names, check_number, check_numbers, number_of


class BoltChoices(TypedDict, total=False):
    """What may be said of a bolt or a pattern beside its kind and its place."""

    anchorage: str
    """"ends": one spring between two points; "grouted": one for each joint that it crosses."""
    free_length: float | None
    """Length on each side of a joint along which a grouted bolt is free, m."""
    pretension_is: str
    """"initial": changes with movement from the start; "jacked": held until it is locked."""
    stage: str | None
    """Stage that installs it; None: it is there from the start."""


@dataclass(frozen=True, kw_only=True)
class BoltEntry:
    """A bolt from ``start``, its head, to ``end``, m."""

    label: str
    name: str | None
    kind: str
    start: Vector
    end: Vector
    blocks: Sequence[str] | None
    choices: Mapping[str, Any]
    group: str = ""


@dataclass(frozen=True, kw_only=True)
class Anchored:
    """The points of one bolt from head to toe, and between which of them its springs act."""

    block: list[int]
    at: list[Floats]
    ends: list[tuple[int, int]]


JACKED = {"initial": False, "jacked": True}
"""What pretension_is may be -> whether a jack holds it."""


def bolts_of(kinds: Sequence[BoltKind], entries: Sequence[BoltEntry], ground: Ground) -> Bolts:
    """Return the bolts of a model; ModelError names bolt and remedy where one cannot be."""
    check_names("bolt kind", [kind.name for kind in kinds])
    if not entries:
        return Bolts()
    names = [str(k) if entry.name is None else entry.name for k, entry in enumerate(entries, 1)]
    check_names("bolt", names)
    kind_number = {kind.name: number for number, kind in enumerate(kinds)}
    parts = [_anchored(entry, ground) for entry in entries]
    first = np.cumsum([0, *(len(part.block) for part in parts)])
    chosen = [
        kinds[number_of(e.kind, kind_number, "bolt kind", f"{e.label}, kind")] for e in entries
    ]
    at = np.array([point for part in parts for point in part.at]).reshape(-1, 2)
    pairs = [(first[k] + i, first[k] + j) for k, part in enumerate(parts) for i, j in part.ends]
    ends = np.array(pairs, np.int64).reshape(-1, 2)
    bolt = np.repeat(np.arange(len(entries)), np.diff(first))
    return _with_springs(
        Bolts(
            name=tuple(names),
            kind=tuple(kind.name for kind in chosen),
            group=tuple(entry.group for entry in entries),
            stage=tuple(entry.choices.get("stage") or "" for entry in entries),
            installed=np.array([not entry.choices.get("stage") for entry in entries], np.bool_),
            locked=np.zeros(len(entries), np.bool_),
            block=np.array([block for part in parts for block in part.block], np.int64),
            at=at,
            bolt=bolt,
            ends=ends,
        ),
        chosen,
        entries,
    )


def _with_springs(bolts: Bolts, kinds: Sequence[BoltKind], entries: Sequence[BoltEntry]) -> Bolts:
    """Return the bolts with what their springs bear, by the kind (k,) of each."""
    owner = bolts.of_spring
    length = np.hypot(*(bolts.at[bolts.ends[:, 1]] - bolts.at[bolts.ends[:, 0]]).T)
    stiffness, rupture = np.zeros(len(owner)), np.full(len(owner), np.inf)
    for k, (kind, entry) in enumerate(zip(kinds, entries, strict=True)):
        own = owner == k
        stiffness[own] = kind.stiffness_of(length[own])
        rupture[own] = kind.rupture_of(length[own])
        for m in np.flatnonzero(own):
            where, remedy = f"{entry.label}, kind '{kind.name}'", "see to young, area and length"
            ranges.check_size(stiffness[m], ranges.STIFFNESS, f"{where}, stiffness", remedy)
            check_rupture(kind, stiffness[m], rupture[m], where)
    strength = [np.inf if kind.yield_force is None else kind.yield_force for kind in kinds]
    jacked = [_is_jacked(entry, kind) for entry, kind in zip(entries, kinds, strict=True)]
    return replace(
        bolts,
        stiffness=stiffness,
        rupture=rupture,
        yield_force=np.array(strength)[owner],
        pretension=np.array([kind.pretension for kind in kinds])[owner],
        compression=np.array([kind.compression for kind in kinds], np.bool_)[owner],
        jacked=np.array(jacked, np.bool_)[owner],
    )


def _is_jacked(entry: BoltEntry, kind: BoltKind) -> Any:
    """Return whether a jack holds the pretension of a bolt; refuse a jack that holds nothing."""
    jacked = _choice(entry, "pretension_is", JACKED)
    if jacked and kind.pretension == 0.0:
        raise ModelError(
            f"a jack would hold nothing: kind '{shortened(kind.name)}' has no pretension",
            where=f"{entry.label}, pretension_is",
            remedy="give pretension to its kind, or leave pretension_is out",
        )
    return jacked


def _choice(entry: BoltEntry, key: str, known: Mapping[str, Any]) -> Any:
    """Return what a bolt has chosen by name; the first is what it has where it says nothing."""
    name = entry.choices.get(key) or next(iter(known))
    if name not in known:
        raise ModelError(
            f"there is no {key} '{shortened(str(name))}'",
            where=entry.label,
            remedy=spelling.advice(str(name), known, kind=key),
        )
    return known[name]


def _anchored(entry: BoltEntry, ground: Ground) -> Anchored:
    """Return the points and springs of a bolt."""
    line = np.array(
        [
            check_numbers(entry.start, 2, f"{entry.label}, start") - ground.outlines.origin,
            check_numbers(entry.end, 2, f"{entry.label}, end") - ground.outlines.origin,
        ]
    )
    if (line[0] == line[1]).all():
        raise ModelError("has no length", where=entry.label, remedy="give two different ends")
    found: Anchored = _choice(entry, "anchorage", ANCHORAGES)(entry, line, ground)
    return found


# Anchored at its ends ----------------------------------------------------------------------------


def _at_its_ends(entry: BoltEntry, line: Floats, ground: Ground) -> Anchored:
    """Return one spring between two points."""
    if entry.choices.get("free_length") is not None:
        raise ModelError(
            "a bolt that is anchored at its ends has no free_length: it is free all along",
            where=entry.label,
            remedy='leave it out, or anchorage = "grouted"',
        )
    block = _blocks_of_ends(entry, line, ground)
    if block[0] == block[1]:
        raise ModelError(
            f"both ends are in {ground.outlines.label(block[0])}, which it cannot hold",
            where=entry.label,
            remedy="move one end across a joint, into another block",
        )
    return Anchored(block=block, at=[line[0], line[1]], ends=[(0, 1)])


def _blocks_of_ends(entry: BoltEntry, line: Floats, ground: Ground) -> list[int]:
    """Return the blocks of head and toe."""
    named = np.full(2, -1, np.int64)
    if entry.blocks is not None:
        given = list(entry.blocks) if not isinstance(entry.blocks, str) else []
        if len(given) != 2:
            raise ModelError(
                f"{shortened(repr(entry.blocks))} are not the blocks of its two ends",
                where=f"{entry.label}, blocks",
                remedy='name both, the head first: blocks = ["1", "2"]',
            )
        numbers = {name: number for number, name in enumerate(ground.outlines.names)}
        for k, name in enumerate(given):
            named[k] = number_of(name, numbers, "block", f"{entry.label}, blocks")

    def where(k: int) -> str:
        return f"{entry.label}, {('start', 'end')[k]} at {ground.text(line[k])}"

    shapes = np.array(shapely.points(line))
    try:
        found = locate(shapes, named, where, ground.outlines, ground.tree, ground.moved)
    except ModelError as error:
        if "common boundary" not in error.what:
            raise
        remedy = 'say which ones its ends move with, the head first: blocks = ["1", "2"]'
        raise ModelError(error.what, where=error.where, remedy=remedy) from None
    return [int(one) for one in found]


# Grouted -----------------------------------------------------------------------------------------


def _grouted(entry: BoltEntry, line: Floats, ground: Ground) -> Anchored:
    """Return a spring for each joint that the bolt crosses, and its own ends beside them."""
    if entry.blocks is not None:
        raise ModelError(
            "a grouted bolt moves with all blocks that it runs through",
            where=f"{entry.label}, blocks",
            remedy='leave blocks out; only anchorage = "ends" may need them',
        )
    free = entry.choices.get("free_length")
    if free is None:
        raise ModelError(
            "free_length is missing",
            where=entry.label,
            remedy="say how long the bolt is free on each side of a joint, m, e.g. a few of its "
            "diameters: free_length = 0.1",
        )
    free = check_number(free, f"{entry.label}, free_length")
    if not free > 0.0:
        raise ModelError(
            f"must be above 0, not {free:g}", where=f"{entry.label}, free_length", remedy="give m"
        )
    ranges.check_size(free, ranges.LENGTH, f"{entry.label}, free_length", "give m")
    pieces = ground.pieces(line)
    joints_between(pieces, line, ground, entry.label, free)
    return _crossings(pieces, line, free)


def _crossings(pieces: Pieces, line: Floats, free: float) -> Anchored:
    """Return the head, two points beside each joint, and the toe."""
    length = float(np.hypot(*(line[1] - line[0])))
    along = (line[1] - line[0]) / length
    # what lies between two joints is shared by the springs of both
    room = np.diff(pieces.ends, axis=1)[:, 0]
    share = np.full(len(room), 0.5)
    share[[0, -1]] = 1.0
    reach = np.minimum(free, share * room)
    block, at, ends = [int(pieces.block[0])], [line[0]], []
    for k in range(len(room) - 1):
        before, after = pieces.ends[k, 1] - reach[k], pieces.ends[k + 1, 0] + reach[k + 1]
        ends.append((len(block), len(block) + 1))
        block += [int(pieces.block[k]), int(pieces.block[k + 1])]
        at += [line[0] + before * along, line[0] + after * along]
    return Anchored(block=[*block, int(pieces.block[-1])], at=[*at, line[1]], ends=ends)


ANCHORAGES: dict[str, Callable[[BoltEntry, Floats, Ground], Anchored]] = {
    "ends": _at_its_ends,
    "grouted": _grouted,
}
"""Name of an anchorage -> what makes points and springs of a bolt."""
