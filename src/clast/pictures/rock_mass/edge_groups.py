"""The edges of a cut, each once, in groups that look alike: one for each joint, and a few more."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats
from clast.pictures.canvas import INK
from clast.pictures.strokes import (
    CONSTRUCTED,
    WELD,
    EdgeGroup,
    Stroke,
    following,
    groups,
    partners,
    strokes_of,
)
from clast.rockmass import Cut

PLAIN = Stroke(label="joints", colour=INK, width=0.7)
RIM = Stroke(label="boundary", colour=INK, width=1.5, above=3)


@dataclass(frozen=True, kw_only=True)
class Sorted:
    """All edges of a cut, each once."""

    joints: tuple[EdgeGroup, ...]
    """Those of each joint that has some, then those along which no joint is named."""
    others: tuple[EdgeGroup, ...]
    """Welds, construction joints, and the rim where only one block is."""

    @property
    def rim(self) -> Floats:
        """Edges with rock on their left only, m, shape (n, 2, 2)."""
        found = [one.ends for one in self.others if one.stroke is RIM]
        return found[0] if found else np.zeros((0, 2, 2))

    @property
    def plain(self) -> tuple[EdgeGroup, ...]:
        """The joints all alike."""
        ends = [one.ends for one in self.joints]
        return (EdgeGroup(ends=np.concatenate(ends), stroke=PLAIN),) if ends else ()


def edges_of(cut: Cut) -> Sorted:
    """Return the edges of a cut by their joints, those inside once."""
    after = following(cut.block_start)
    ends = np.stack([cut.vertices, cut.vertices[after]], axis=1)
    partner = partners(cut.vertices, after)
    once = (partner < 0) | (np.arange(len(partner)) < partner)
    number = np.where(partner < 0, len(cut.joint_names), cut.edge_joint)
    strokes = {**strokes_of(dict(enumerate(cut.joint_names))), len(cut.joint_names): RIM}
    found = groups(strokes, number[once], ends[once])
    others = (CONSTRUCTED, WELD, RIM)
    return Sorted(
        joints=tuple(one for one in found if one.stroke not in others),
        others=tuple(one for one in found if one.stroke in others),
    )
