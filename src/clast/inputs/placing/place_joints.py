"""The pairs of blocks and rocks, and the edges, that joints belong to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clast.errors import ModelError
from clast.inputs.declaring.values import number_of
from clast.inputs.materials import Joint
from clast.inputs.placing.place_blocks import Names
from clast.model.joints import JointTable
from clast.model.model import Ints


def joint_table(
    given: Mapping[str, Joint],
    rock_number: dict[str, int],
    block_number: dict[str, int],
    along_edges: set[str],
) -> JointTable:
    """Return the joints, the default first, and the pairs that they belong to.

    ``along_edges`` are the names of those that edges have, or lines that may become edges.
    """
    ordered = sorted({"default": Joint(), **given}.items(), key=lambda one: one[0] != "default")
    names = [name for name, _ in ordered]
    rock_joint: dict[tuple[int, int], int] = {}
    block_joint: dict[tuple[int, int], int] = {}
    for index, (name, joint) in enumerate(ordered):
        placed = joint.between or joint.between_rocks or name in along_edges
        if index > 0 and not placed:
            raise ModelError(
                "is assigned to no contact",
                where=f"joint '{name}'",
                remedy="name it default, or assign it by between (pairs of blocks), "
                "between_rocks (pairs of rocks) or the edge_joint of blocks",
            )
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
    found = [
        number_of(name, number, "joint", "blocks, edge_joint") if name else -1
        for name in distinct.tolist()
    ]
    return np.asarray(np.array(found, np.int64)[which])


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
        found = (number_of(one, number, kind, where), number_of(other, number, kind, where))
        pair = (min(found), max(found))
        if kind == "block" and found[0] == found[1]:
            raise ModelError(
                f"block '{one}' cannot have a joint with itself",
                where=f"{where}, between",
                remedy="name two different blocks",
            )
        before = assigned.setdefault(pair, index)
        if before != index:
            raise ModelError(
                f"the {kind}s '{one}' and '{other}' already belong to joint '{names[before]}'",
                where=where,
                remedy="name the pair in one joint only",
            )
