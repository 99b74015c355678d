"""Joints as they are given to a builder, and the pairs of blocks and rocks that they belong to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from clast.errors import ModelError, shortened
from clast.inputs.placing.blocks import Names
from clast.model.model import Ints, Joint, JointTable
from clast.model.value_checks import number_of


class JointNumbers(TypedDict, total=False):
    """What a joint is made of (model.model.Joint); what is left out is as a joint has it."""

    friction_angle: float
    cohesion: float
    tensile_strength: float
    residual_cohesion: float | None
    restitution: float | None
    normal_stiffness: float | None
    shear_stiffness: float | None


@dataclass(frozen=True)
class JointEntry:
    """A joint, and the pairs of blocks and of rocks that it lies between."""

    joint: Joint
    between: tuple[tuple[str, str], ...]
    between_rocks: tuple[tuple[str, str], ...]
    allow_small_friction_angle: bool


def pairs_of_names(pairs: Iterable[tuple[str, str]], where: str) -> tuple[tuple[str, str], ...]:
    """Return pairs of names as tuples, or say that they are none."""
    given: object = pairs
    try:
        given = list(pairs)
        found = [tuple(pair) for pair in given if not isinstance(pair, str)]
        if len(found) == len(given) and all(len(pair) == 2 for pair in found):
            return tuple((one, other) for one, other in found)
    except TypeError:
        pass
    raise ModelError(
        f"{shortened(repr(given))} are no pairs of names",
        where=where,
        remedy='give pairs: [["a", "b"]]',
    )


def joint_table(
    entries: Sequence[JointEntry],
    rock_number: dict[str, int],
    block_number: dict[str, int],
    along_edges: set[str],
) -> JointTable:
    """Return the joints, the default first, and the pairs that they belong to.

    ``along_edges`` are the names of those that edges have, or lines that may become edges.
    """
    ordered = sorted(entries, key=lambda entry: entry.joint.name != "default")
    if not ordered or ordered[0].joint.name != "default":
        ordered.insert(0, JointEntry(Joint(), (), (), allow_small_friction_angle=False))
    rock_joint: dict[tuple[int, int], int] = {}
    block_joint: dict[tuple[int, int], int] = {}
    for index, entry in enumerate(ordered):
        name = entry.joint.name
        placed = entry.between or entry.between_rocks or name in along_edges
        if index > 0 and not placed:
            raise ModelError(
                "belongs to no contact",
                where=f"joint '{name}'",
                remedy="call it default, or say where it is with between (pairs of blocks), "
                "between_rocks (pairs of rocks) or the edge_joint of blocks",
            )
        _assign(entry.between_rocks, "rock", rock_number, index, rock_joint, ordered)
        _assign(entry.between, "block", block_number, index, block_joint, ordered)
    rock_pair = np.zeros((len(rock_number), len(rock_number)), np.int64)
    for (one, other), index in rock_joint.items():
        rock_pair[one, other] = rock_pair[other, one] = index
    pairs = sorted(block_joint)
    return JointTable(
        joints=tuple(entry.joint for entry in ordered),
        rock_pair=rock_pair,
        block_pair=np.array(pairs, np.int64).reshape(-1, 2),
        block_pair_joint=np.array([block_joint[pair] for pair in pairs], np.int64),
    )


def joints_of_edges(table: JointTable, names: Names) -> Ints:
    """Return the joint index of each edge by its name, -1 where it has none of its own, (nv,)."""
    number = {joint.name: index for index, joint in enumerate(table.joints)}
    distinct, which = np.unique(names, return_inverse=True)
    found = [
        number_of(name, number, "joint", "blocks, edge_joint") if name else -1
        for name in distinct.tolist()
    ]
    return np.asarray(np.array(found, np.int64)[which])


def _assign(
    pairs: tuple[tuple[str, str], ...],
    kind: str,
    number: dict[str, int],
    index: int,
    assigned: dict[tuple[int, int], int],
    joints: list[JointEntry],
) -> None:
    """Give pairs of blocks or rocks to a joint; refuse pairs that two joints claim."""
    where = f"joint '{joints[index].joint.name}'"
    for one, other in pairs:
        found = (number_of(one, number, kind, where), number_of(other, number, kind, where))
        pair = (min(found), max(found))
        if kind == "block" and found[0] == found[1]:
            raise ModelError(
                f"block '{one}' has no joint with itself",
                where=f"{where}, between",
                remedy="name two different blocks",
            )
        before = assigned.setdefault(pair, index)
        if before != index:
            raise ModelError(
                f"the {kind}s '{one}' and '{other}' belong to joint "
                f"'{joints[before].joint.name}' already",
                where=where,
                remedy="name the pair in one joint only",
            )
