"""Which bolts a stage installs."""

from __future__ import annotations

import numpy as np

from clast.model.model import Bools, Model
from clast.model.stages.stage import Stage


def installed_by(model: Model, stage: Stage) -> Bools:
    """Return the bolts that a stage installs: those it names, and those that name it, (k,).

    It names bolts, kinds of bolts, or patterns.
    """
    bolts = model.bolts
    named = set(stage.install)
    found = [
        own_stage == stage.name or not named.isdisjoint((name, kind, group))
        for name, kind, group, own_stage in zip(
            bolts.name, bolts.kind, bolts.group, bolts.stage, strict=True
        )
    ]
    return np.array(found, np.bool_)
