"""The blocks and welded edges of openings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.rock_mass import OpeningTable
from clast.model.names import check_text
from clast.model.openings import Opening


def openings_of(
    entries: Sequence[OpeningTable],
    block_number: Mapping[str, int],
    edge_joint: NDArray[np.str_],
) -> tuple[Opening, ...]:
    """Return the openings with the numbers of their blocks and welded edges.

    ``block_number`` are the numbers of the blocks by name, ``edge_joint`` (nv,) the names of the
    joints of edges.  Raises ModelError for names that are taken or unknown, and blocks of two.
    """
    found: dict[str, Opening] = {}
    owner: dict[int, str] = {}
    for one in entries:
        where = f"opening '{shortened(one.name)}'"
        check_text(one.name, "opening")
        if one.name in found or one.name in block_number:
            taken = "opening" if one.name in found else "block"
            raise ModelError(
                f"there already is {_article(taken)} {taken} with this name",
                where=where,
                remedy="give it another name: stages excavate openings and blocks by their names",
            )
        numbers = []
        for name in one.blocks:
            if name not in block_number:
                raise ModelError(
                    f"there is no block '{shortened(name)}'",
                    where=where,
                    remedy=spelling.advice(name, block_number, kind="block"),
                )
            number = block_number[name]
            if number in owner:
                raise ModelError(
                    f"block '{shortened(name)}' already belongs to opening '{owner[number]}'",
                    where=where,
                    remedy="put each block in one opening only",
                )
            owner[number] = one.name
            numbers.append(number)
        welded = np.zeros(0, np.int64)
        if one.weld is not None:
            welded = np.flatnonzero(edge_joint == one.weld).astype(np.int64)
            if not len(welded):
                raise ModelError(
                    f"no edge has the joint '{shortened(one.weld)}'",
                    where=f"{where}, weld",
                    remedy="name the joint between the inside and the outside",
                )
        block = np.array(sorted(numbers), np.int64)
        found[one.name] = Opening(name=one.name, block=block, welded=welded)
    return tuple(found.values())


def _article(word: str) -> str:
    return "an" if word[0] in "aeiou" else "a"
