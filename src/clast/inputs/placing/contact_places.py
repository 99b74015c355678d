"""Contacts that are measured: where, or along which joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.measurements import MeasuredContact
from clast.model.joints import JointTable
from clast.model.model import Floats, MeasuredContacts


def contacts_measured(
    given: Sequence[MeasuredContact], table: JointTable, origin: Floats
) -> MeasuredContacts:
    """Return the contacts to be recorded; raises ModelError for names that cannot be.

    ``origin`` (2,), m, is the origin of the model's coordinates.
    """
    joints = [joint.name for joint in table.joints]
    names: list[str] = []
    for number, one in enumerate(given, 1):
        where = f"measured_contact {number}"
        if not one.name.strip() or one.name in names:
            what = "is used twice" if one.name in names else "is not a valid name"
            raise ModelError(
                f"'{shortened(one.name)}' {what}", where=f"{where}, name", remedy="give another"
            )
        if one.joint is not None and one.joint not in joints:
            raise ModelError(
                f"there is no joint '{shortened(one.joint)}'",
                where=f"{where}, joint",
                remedy=spelling.advice(one.joint, joints, kind="joint"),
            )
        names.append(one.name)
    nowhere = np.full(2, np.nan)
    places = [nowhere if one.at is None else np.asarray(one.at) - origin for one in given]
    return MeasuredContacts(
        name=tuple(names),
        at=np.array(places, np.float64).reshape(-1, 2),
        joint=np.array(
            [-1 if one.joint is None else joints.index(one.joint) for one in given], np.int64
        ),
    )
