"""Unlikely values in a case file: each with its place and a remedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.inputs.bolts import BoltKind
from clast.inputs.in_situ import InSituTable
from clast.inputs.joint_sets import JointSetTable, SpreadTable
from clast.model.arrays import following, polygons_of
from clast.model.checks import OVERLAP_TOLERANCE, point_text
from clast.model.ground_motion import MovingBase
from clast.model.model import Model
from clast.model.stages import Stage

if TYPE_CHECKING:
    from clast.rockmass.cut_report import SetReport  # slow to load, and few cases are cut


def doubts(
    kinds: Mapping[str, BoltKind],
    in_situ: InSituTable | None,
    model: Model,
    stages: Sequence[Stage],
) -> Iterator[str]:
    """Warn of kinds of bolts, in-situ stress and stages that are hardly meant."""
    for name, kind in kinds.items():
        area = kind.area or 0.0
        # Cross-section above which a bolt is not a bolt, m2: 16 cm across
        if area > 0.02:
            unit, factor = ("mm2", 1e-6) if area > 20.0 else ("cm2", 1e-4)
            yield (
                f"bolt_kind '{shortened(name)}': area is {area:g} m2, too large for a bolt; the "
                f"unit is m2: {area:g} {unit} are {area * factor:g}"
            )
    k0 = (in_situ.k0 if in_situ else None) or 0.0
    # Largest ratio of horizontal to vertical stress that rock near the surface has
    if k0 > 10.0:
        yield (
            f"in_situ: k0 is {k0:g}: horizontal stress {k0:g} times the vertical one, which no "
            f"rock has (0.2 to 5); it is a ratio: {k0:g} % are {k0 / 100.0:g}"
        )
    taken = {name for stage in stages for name in stage.excavate}
    for one in model.openings:
        if one.name not in taken and not any(model.block_name[k] in taken for k in one.block):
            yield (
                f"opening '{shortened(one.name)}' is excavated in no stage and so remains rock: "
                f'name it in excavate = ["{shortened(one.name)}"] of a [[stage]], or give it '
                "excavated = true for a void from the start"
            )
    yield from _doubted_base(model, stages)


def seen_sets(sets: Sequence[JointSetTable], reports: Sequence[SetReport]) -> Iterator[str]:
    """Say at which dip, and at which spacing, the section shows sets given by dip and direction."""
    seen = {report.name: report for report in reports if report.seen}
    for one in sets:
        if one.dip is not None and one.name in seen:
            report = seen[one.name]
            yield (
                f"joint set '{shortened(one.name)}' ({one.dip:g}° towards {one.dip_direction:03g}) "
                f"is seen in the section at {report.seen}, its spacing "
                f"{report.spacing_factor:.3g} times the true one"
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
        if one.trace_length is not None and one.bridge_length is None:
            model = one.build().model
            needs = {key for group in model.needs for key in group}
            if "bridge_length" in model.takes and "trace_length" not in needs:
                yield (
                    f"{where}: trace_length has no effect without bridge_length: traces follow "
                    "each other without a gap, so they run from boundary to boundary. Give "
                    'bridge_length, or leave trace_length out; model = "baecher" places single '
                    "traces"
                )


def _doubted_base(model: Model, stages: Sequence[Stage]) -> Iterator[str]:
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


def refuse_unnamed_faces(model: Model) -> None:
    """Refuse blocks that touch along an edge of the default joint, which the case does not give."""
    after = following(model.block_start)
    edges = np.flatnonzero(model.edge_joint < 0)
    polygons = polygons_of(model.vertices, model.block_start)
    middles = shapely.points(0.5 * (model.vertices[edges] + model.vertices[after[edges]]))
    reach = OVERLAP_TOLERANCE * float(np.sqrt(np.abs(model.area)).max(initial=0.0))
    edge, other = shapely.STRtree(polygons).query(middles, predicate="dwithin", distance=reach)
    one, table = model.vertex_block[edges[edge]], model.joint_table
    unnamed = (one != other) & (
        table.rock_pair[model.block_rock[one], model.block_rock[other]] == 0
    )
    paired = {tuple(pair) for pair in table.block_pair.tolist()}
    for k in np.flatnonzero(unnamed):
        pair = tuple(sorted((int(one[k]), int(other[k]))))
        if pair in paired or model.fixed[list(pair)].all():
            continue
        # a contact has the joint that either of its two edges names
        theirs = np.arange(*model.block_start[other[k] : other[k] + 2])
        lines = shapely.linestrings(
            np.stack([model.vertices[theirs], model.vertices[after[theirs]]], axis=1)
        )
        facing = theirs[shapely.distance(lines, middles[edge[k]]) <= reach]
        if (model.edge_joint[facing] < 0).all():
            names = " and ".join(f"'{shortened(model.block_name[block])}'" for block in pair)
            at = shapely.get_coordinates(middles[edge[k]])[0] + model.origin
            raise ModelError(
                f"there is none, but blocks {names} touch at {point_text(at)}, where no joint is "
                "named",
                where="[joint.default]",
                remedy="give it with friction_angle, degrees; 0 for faces without friction",
            )
