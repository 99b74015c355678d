"""The edges of a frame in the colours of their joints."""

from __future__ import annotations

import numpy as np

from clast.model.model import Bools, Floats
from clast.pictures.strokes import EdgeGroup, following, groups, partners, strokes_of
from clast.results import Recording


def edges_by_joint(
    results: Recording, here: Floats, start: Floats, apart: float, absent: Bools
) -> tuple[EdgeGroup, ...]:
    """Return the edges of all blocks in the places ``here`` (nv, 2), m, in groups by joint.

    Edges of two blocks that ran along each other at the ``start`` (nv, 2) are one as long as they
    are no farther ``apart`` than that, m, and of one joint.  Blocks that are ``absent`` (n,) have
    none.  Only joints that edges have get a colour, so that it is the same in all frames.  Raises
    CaseError where an earlier clast wrote the results.
    """
    joint = results.edge_joint
    after = following(results.block_start)
    ends = np.stack([here, here[after]], axis=1)
    other = partners(start, after)
    opened = np.hypot(*(ends - ends[other, ::-1]).T).max(axis=0) > apart
    own = (other < 0) | opened | (joint != joint[other])
    out = np.repeat(absent, np.diff(results.block_start))
    once = ~out & (own | out[other] | (np.arange(len(other)) < other))
    names = {number: results.joint_name[number] for number in np.unique(joint[joint >= 0]).tolist()}
    return groups(strokes_of(names), joint[once], ends[once])
