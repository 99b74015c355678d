"""The selection to export: frames by number, joints where they are known."""

from __future__ import annotations

from collections.abc import Sequence

from clast.errors import CaseError
from clast.results import Recording, Results


def frames_in(results: Recording, wanted: Sequence[int] | None) -> list[int]:
    """Return the numbers of the frames ``wanted``, from 0; all for None.

    Raises CaseError for one that does not exist, and for none at all.
    """
    if wanted is None:
        return list(range(len(results.times)))
    if not len(wanted):
        raise CaseError("no frame is given", remedy="give one, or leave frames out for all")
    return list(dict.fromkeys(results.frame(int(number)).number for number in wanted))


def edge_joints(results: Recording) -> list[str] | None:
    """Return the joint of the edge that begins at each vertex, "" for none of its own; nv names.

    None where an earlier clast wrote the results, without joints.
    """
    if isinstance(results, Results) and results.joints is None:
        return None
    names = (*results.joint_name, "")  # the index -1 is the last
    return [names[k] for k in results.edge_joint]
