"""Unlikely values in a case file: each with its place and a remedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from clast.errors import shortened
from clast.inputs.bolts import BoltKind
from clast.inputs.in_situ import InSituTable
from clast.inputs.joint_sets import JointSetTable, SpreadTable
from clast.model.ground_motion import MovingBase
from clast.model.model import Model
from clast.model.stages import Stage
from clast.model.surroundings import OpeningBlocks

LARGEST_BOLT = 0.02
"""Cross-section above which a bolt is not a bolt, m2: 16 cm across."""
LARGEST_K0 = 10.0
"""Largest ratio of horizontal to vertical stress that rock near the surface has."""


def doubts(
    kinds: Mapping[str, BoltKind],
    in_situ: InSituTable | None,
    model: Model,
    stages: Sequence[Stage],
) -> Iterator[str]:
    """Warn of kinds of bolts, in-situ stress and stages that are hardly meant."""
    yield from doubted_bolts(kinds)
    yield from doubted_k0(in_situ.k0 if in_situ else None)
    yield from doubted_openings(model.openings, stages, model.block_name)
    yield from doubted_base(model, stages)


def doubted_bolts(kinds: Mapping[str, BoltKind]) -> Iterator[str]:
    """Warn of cross-sections of bolts that look like mm2 or cm2."""
    for name, kind in kinds.items():
        if kind.area is None or kind.area <= LARGEST_BOLT:
            continue
        unit, factor = ("mm2", 1e-6) if kind.area > 20.0 else ("cm2", 1e-4)
        yield (
            f"bolt_kind '{shortened(name)}': area is {kind.area:g} m2, too large for a bolt; the "
            "unit is m2"
            f": {kind.area:g} {unit} are {kind.area * factor:g}"
        )


def doubted_k0(k0: float | None) -> Iterator[str]:
    """Warn of a ratio of stresses that no rock has, as one in per cent."""
    if k0 is not None and k0 > LARGEST_K0:
        yield (
            f"in_situ: k0 is {k0:g}: horizontal stress {k0:g} times the vertical one, which no "
            f"rock has (0.2 to 5); it is a ratio: {k0:g} % are {k0 / 100.0:g}"
        )


def doubted_sets(sets: Sequence[JointSetTable]) -> Iterator[str]:
    """Warn of scatter beyond the mean, and of traces that no bridges part."""
    for one in sets:
        where = f"joint_set '{shortened(one.name)}'"
        for key in ("spacing", "trace_length", "bridge_length"):
            spread = getattr(one, key)
            if not isinstance(spread, SpreadTable) or spread.sd is None or spread.mean is None:
                continue
            if spread.sd > spread.mean:
                yield (
                    f"{where}, {key}: sd is {spread.sd:g} m and the mean only {spread.mean:g} m, "
                    "so most values would be far from it; sd is in m, not a share or per cent. "
                    "Lower sd, or take an exponential distribution, whose sd is its mean"
                )
        if one.trace_length is not None and one.bridge_length is None and _parted(one):
            yield (
                f"{where}: trace_length has no effect without bridge_length: traces follow each "
                "other without a gap, so they run from boundary to boundary. Give bridge_length, "
                "or "
                'leave trace_length out; model = "baecher" places single traces'
            )


def _parted(one: JointSetTable) -> bool:
    """Return whether the model puts traces and bridges on lines, and needs both."""
    takes = one.build().model.takes
    needs = {key for group in one.build().model.needs for key in group}
    return "bridge_length" in takes and "trace_length" not in needs


def doubted_openings(
    openings: Sequence[OpeningBlocks], stages: Sequence[Stage], block_names: Sequence[str]
) -> Iterator[str]:
    """Warn of openings that no stage excavates, whole or block by block."""
    taken = {name for stage in stages for name in stage.excavate}
    for one in openings:
        if one.name in taken or any(block_names[block] in taken for block in one.block):
            continue
        yield (
            f"opening '{shortened(one.name)}' is excavated in no stage and so remains rock: "
            f'name it in excavate = ["{shortened(one.name)}"] of a [[stage]], or give it '
            "excavated = true for a void from the start"
        )


def doubted_base(model: Model, stages: Sequence[Stage]) -> Iterator[str]:
    """Warn where stages take out blocks by whose fixed points the ground moves the rest."""
    if not isinstance(model.ground_motion, MovingBase):
        return
    held, excavated = model.fixed_points.block, np.zeros(0, np.int64)
    for stage in stages:
        if stage.excavate:
            excavated = np.union1d(excavated, model.blocks_called(stage.excavate))
        lost = np.flatnonzero(np.isin(held, excavated))
        if stage.ground_motion and len(lost):
            names = dict.fromkeys(f"'{shortened(model.block_name[held[k]])}'" for k in lost)
            left = len(held) - len(lost)
            yield (
                f"stage '{shortened(stage.name)}': {len(lost)} of {len(held)} fixed points that "
                f"the ground moves are lost with the excavated block {', '.join(names)}; "
                f"{left} move the rest. Put them into blocks that stay"
            )
            return
