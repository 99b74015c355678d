"""From [flow] and its boundaries and wells to the flow of a model: places, checks, remarks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.inputs import flow as inputs
from clast.inputs.declaring.values import number_of
from clast.inputs.water import Bed
from clast.model.arrays import Floats, Ints
from clast.model.checks import point_text
from clast.model.drainage import distances, places_on
from clast.model.edges import outline_edges
from clast.model.factors import NO_FACTOR
from clast.model.flow.balance import INNER
from clast.model.flow.channels import Network
from clast.model.flow.conditions import Conditions, conditions_of, faces_on, nodes_on
from clast.model.flow.given import FULL, RAIN, SEEPS, Flow, FlowBoundary, Well
from clast.model.flow.network import network_of
from clast.model.model import Model
from clast.model.ranges import check_names
from clast.model.water import WetFaces, ends_of_faces


@dataclass(frozen=True, kw_only=True)
class FlowInputs:
    """The tables of a flow."""

    flow: inputs.FlowTable | None
    boundaries: Sequence[inputs.FlowBoundary]
    wells: Sequence[inputs.Well]
    measured: Sequence[inputs.MeasuredFlow]


@dataclass(frozen=True)
class _Rock:
    """The rock in which water flows."""

    model: Model
    bed: Bed
    network: Network
    faces: Floats
    """Outer faces at the start, m, shape (r, 2, 2)."""


def with_flow(model: Model, given: FlowInputs, bed: Bed) -> Model:
    """Return a model in whose joints water flows, with remarks; the same where there is no flow."""
    table = given.flow
    if table is None:
        kinds = ("flow_boundary", "well", "measured_flow")
        for key, some in zip(kinds, (given.boundaries, given.wells, given.measured), strict=True):
            if some:
                remedy = "add [flow], e.g. with viscosity = 1e-3, or remove it"
                raise ModelError("there is no [flow]", where=f"{key} 1", remedy=remedy)
        return model
    rock = _rock(model, bed, network_of(model))
    flow = _flow(table, rock)
    boundaries = tuple(_boundaries(given.boundaries, rock, flow))
    wells = tuple(_well(one, rock) for one in given.wells)
    flow = replace(flow, boundaries=boundaries, wells=wells)
    check_names("flow", flow.names)
    measured = {name: 0 for name in flow.names}
    for one in given.measured:
        number_of(one.of, measured, "flow", f"measured flow '{shortened(one.name)}', of")
    check_names("measured flow", [one.name for one in given.measured])
    flow = replace(flow, measured=tuple((one.name, one.of) for one in given.measured))
    flowing = replace(model, flow=flow)
    _check_pieces(flow, rock.network)
    if wells or flow.longest < np.inf:
        rock = _rock(flowing, bed, network_of(flowing, flow.longest, flow.points))
    flowing = replace(model, flow=replace(flow, network=rock.network))
    conditions = conditions_of(flowing, rock.network, rock.faces, 0.0)
    _check_overlaps(flow, rock)
    _check_water(model, rock.network)
    if flow.coupling == FULL:
        _check_stiffness(model, rock.network)
    # springs let water in where nothing lets it out
    if flow.state != "hydrostatic" and (flow.coupling != FULL or flow.initial == "steady"):
        _check_sources(rock, conditions)
    notes = (*model.notes, *_remarks(flow, rock, conditions))
    return replace(flowing, notes=notes)


def _rock(model: Model, bed: Bed, network: Network) -> _Rock:
    faces = WetFaces(edge=network.face_edge, share=network.face_share)
    ends = ends_of_faces(faces, model.vertices, model.vertex_after)
    return _Rock(model, bed, network, ends)


def _flow(table: inputs.FlowTable, rock: _Rock) -> Flow:
    """Return the flow without its boundaries."""
    if not len(rock.network.length):
        what = "no joint between two blocks has an aperture: there is nowhere for water to flow"
        remedy = "give [joint.NAME] an aperture, m, e.g. aperture = 2e-4"
        raise ModelError(what, where="flow", remedy=remedy)
    across, up = rock.bed.gravity.tolist()
    if across != 0.0 or up > 0.0:
        what = f"gravity is [{across:g}, {up:g}]: a flow needs gravity straight down, or none"
        remedy = "give gravity = [0.0, -9.81]; a horizontal load is seismic_coefficient"
        raise ModelError(what, where="flow", remedy=remedy)
    x, y = rock.model.vertices.T
    return Flow(
        state=table.state,
        weight=table.density * float(-up),
        viscosity=table.viscosity,
        density=table.density,
        bulk_modulus=table.bulk_modulus,
        initial=table.initial or "steady",
        coupling=table.coupling,
        passes=table.passes,
        confined=table.confined or up == 0.0,
        longest=table.longest or np.inf,
        level=table.level or 0.0,
        sides=np.array([x.min(), x.max(), y.min()]),
    )


def _boundaries(
    given: Sequence[inputs.FlowBoundary], rock: _Rock, flow: Flow
) -> Iterator[FlowBoundary]:
    """Give the boundaries in their order, and the walls of openings that none of them is of."""
    blocks, bed = rock.bed.blocks_of_openings, rock.bed
    openings = dict.fromkeys([*bed.openings, *blocks], 0)
    for number, one in enumerate(given, 1):
        label = f"flow boundary {number}"
        if flow.state == "hydrostatic":
            remedy = 'remove it, or give state = "steady"'
            raise ModelError("water at rest has no boundaries", where=label, remedy=remedy)
        line, needs = _lines(label, one.where, rock, openings)
        openings.pop(one.where.opening or "", None)
        kind, value, factor = one.kind, getattr(one, one.kind), None
        if kind == "head" and flow.weight == 0.0:
            remedy = "give the pressure, Pa"
            raise ModelError("there is no gravity, and so no head", where=label, remedy=remedy)
        if one.amplitude is not None:
            at = bed.ground.amplitude(one.amplitude, f"{label}, amplitude")
            factor = None if at == NO_FACTOR else bed.ground.factors[at]
            low = float((rock.network.at[:, 1] + rock.model.origin[1]).min())
            if factor is not None and factor.value.max() < low:
                what = f"its heads are below all joints, by {low - factor.value.max():.4g} m"
                remedy = "give heights y in the coordinates of the case, not depths"
                raise ModelError(what, where=f"{label}, amplitude", remedy=remedy)
        yield FlowBoundary(
            name=one.name or one.where.opening or f"boundary {number}",
            line=line,
            needs=needs,
            kind=kind,
            value=0.0 if value is None else float(value),
            factor=factor,
            seeps_above=one.seepage_above,
            presses=one.presses,
        )
    for name in openings:
        line, needs = _walls(name, rock)
        yield FlowBoundary(name=name, line=line, needs=needs, kind=SEEPS)


def _lines(
    label: str, where: inputs.FlowWhere, rock: _Rock, openings: Mapping[str, int]
) -> tuple[Floats, Ints]:
    """Return the lines of a boundary, m, (s, 2, 2), and the blocks whose excavation they need."""
    model, outlines = rock.model, rock.bed.ground.outlines
    if where.opening is not None:
        known = {*rock.bed.openings, *rock.bed.blocks_of_openings}
        number_of(where.opening, dict.fromkeys(sorted(known), 0), "opening", f"{label}, where")
        if where.opening not in openings:
            what = f"opening '{shortened(where.opening)}' has two boundaries"
            raise ModelError(what, where=f"{label}, where", remedy="give it one")
        return _walls(where.opening, rock)
    if where.side is not None:
        line = model.vertices[outline_edges(model.vertices, outlines.start, (where.side,))]
    elif where.edges is not None:
        line = np.array(where.edges, np.float64).reshape(-1, 2, 2) - outlines.origin
    else:
        polygon = np.array(where.polygon).reshape(-1, 2) - outlines.origin
        shape = shapely.Polygon(polygon) if len(polygon) > 2 else shapely.Polygon()
        inside = shapely.covers(shape, shapely.points(rock.faces.mean(axis=1)))
        line = rock.faces[inside]
    if not len(nodes_on(rock.network, line)):
        what = "no joint with an aperture comes out there"
        remedy = "give outer edges of the model at which joints end"
        raise ModelError(what, where=f"{label}, where", remedy=remedy)
    return np.asarray(line), np.full(len(line), -1)


def _walls(name: str, rock: _Rock) -> tuple[Floats, Ints]:
    """Return the outline of a void, or the edges of the blocks of an opening, and these."""
    model = rock.model
    if name in rock.bed.blocks_of_openings:
        edge = np.flatnonzero(np.isin(model.vertex_block, rock.bed.blocks_of_openings[name]))
        ends = np.stack([edge, model.vertex_after[edge]], axis=1)
        return model.vertices[ends], model.vertex_block[edge]
    ring = rock.bed.openings[name]
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1), np.full(len(ring), -1)


def _well(given: inputs.Well, rock: _Rock) -> Well:
    """Return a well with its places on joints."""
    where, origin = f"well '{shortened(given.name)}'", rock.model.origin
    ends = rock.network.at[rock.network.node]
    near = rock.network.near[rock.network.node].min(axis=1)
    if given.at is not None:
        at = np.array([given.at]) - origin
        away = float(distances(ends, at)[0])
        if away > near.max():
            nearest = rock.network.at[np.hypot(*(rock.network.at - at[0]).T).argmin()] + origin
            what = f"{point_text(at[0] + origin)} is not on a joint with an aperture"
            remedy = (
                f"the nearest is {away:.3g} m away: joints meet at {point_text(nearest)}; or give "
                "a line that crosses joints"
            )
            raise ModelError(what, where=f"{where}, at", remedy=remedy)
    else:
        at = places_on(np.array(given.line) - origin, ends, near)
        if not len(at):
            remedy = "let it cross joints that have an aperture"
            raise ModelError("crosses no joint", where=f"{where}, line", remedy=remedy)
    kind = next(key for key in inputs.WELLS if getattr(given, key) is not None)
    return Well(
        name=given.name,
        at=at,
        kind=kind,
        value=float(getattr(given, kind)),
        only_outflow=given.only_outflow,
        stage=given.stage or "",
        begun=given.stage is None,
    )


PIECES_MAX = 1_000_000
"""Channels that are more than anyone can want: a solution takes minutes."""


def _check_pieces(flow: Flow, network: Network) -> None:
    """Refuse channels in too many pieces."""
    count = float(np.ceil(network.length / flow.longest).sum())
    if count > PIECES_MAX:
        least = f"{network.length.sum() / PIECES_MAX:.1g}"
        raise ModelError(
            f"{flow.longest:g} m divide {network.length.sum():.4g} m of joints into {count:.3g} "
            f"channels, of {PIECES_MAX} at most",
            where="flow, longest",
            remedy=f"give more than {least} m, e.g. a fifth of the size of a block",
        )


def _check_overlaps(flow: Flow, rock: _Rock) -> None:
    """Refuse boundaries of different kinds on one face."""
    gone = rock.model.absent
    on = [(one, faces_on(rock.faces, one.lines(gone))) for one in flow.boundaries]
    for (first, mine), (second, other) in combinations(on, 2):
        both = np.intersect1d(mine, other)
        kinds = {first.kind, second.kind}
        alike = kinds <= {RAIN, SEEPS} or (first.kind, first.value) == (second.kind, second.value)
        if len(both) and not alike:
            at = point_text(rock.faces[both[0]].mean(axis=0) + rock.model.origin)
            what = f"'{second.name}' has the face at {at} as well, with another kind of boundary"
            remedy = "give each face one boundary"
            where = f"flow boundary '{shortened(first.name)}'"
            raise ModelError(what, where=where, remedy=remedy)


def _check_water(model: Model, network: Network) -> None:
    """Refuse [[water]] in joints in which water flows."""
    width = len(model.vertices)
    ours = network.edge @ [width, 1]
    for number, water in enumerate(model.water, 1):
        if np.isin(water.joints.edge @ [width, 1], ours).any():
            what = "presses in joints in which [flow] lets water flow"
            remedy = 'give acts_on = "faces", or name joints without an aperture'
            raise ModelError(what, where=f"water {number}", remedy=remedy)


def _check_stiffness(model: Model, network: Network) -> None:
    """Refuse joints that conduct and that nothing closes but the stiffness of the contact law."""
    for number in np.unique(network.joint).tolist():
        joint = model.joint_table.joints[number]
        if joint.normal_stiffness is None and joint.roughness is None:
            raise ModelError(
                "water opens and closes the joint, and it has no stiffness",
                where=f"joint '{shortened(joint.name)}', normal_stiffness",
                remedy='give it, Pa/m, e.g. normal_stiffness = 1e10, or leave coupling = "none"',
            )


def _check_sources(rock: _Rock, conditions: Conditions) -> None:
    """Refuse water that is put into joints, or taken from them, with no other end."""
    network = rock.network
    part = network.parts
    ends = np.zeros(part.max(initial=-1) + 1, np.bool_)
    ends[part[conditions.kind != INNER]] = True
    some = (conditions.inflow != 0.0) & ~ends[part]
    for one in np.unique(part[some])[:1].tolist():
        mine = part == one
        rate = float(conditions.inflow[mine].sum())
        length = float(network.length[mine[network.node[:, 0]]].sum())
        at = point_text(network.at[mine].mean(axis=0) + rock.model.origin)
        way = "to go" if rate > 0.0 else "to come from"
        raise ModelError(
            f"water has nowhere {way}: {rate:.4g} m2/s for {length:.4g} m of joints about {at}",
            where="flow",
            remedy="give these joints a [[flow_boundary]] with a head, a pressure or seepage",
        )


def _remarks(flow: Flow, rock: _Rock, conditions: Conditions) -> Iterator[str]:
    """Give the lengths of outer faces by kind, m, and joints that no boundary reaches."""
    network, faces = rock.network, rock.faces
    long = np.hypot(*(faces[:, 1] - faces[:, 0]).T)
    left = np.ones(len(faces), np.bool_)
    parts = []
    for one in flow.boundaries:
        on = faces_on(faces, one.lines(rock.model.absent))
        left[on] = False
        if len(on):
            parts.append(f"{long[on].sum():.4g} m '{one.name}' ({one.kind})")
    bare, tight = len(flow.names) - 2, len(flow.names) - 1
    for number, text in ((bare, "bare, giving water off"), (tight, "tight")):
        own = network.at[conditions.part == number]
        if len(own) and left.any():
            tree = shapely.STRtree(shapely.linestrings(faces[left]))
            found = tree.query(shapely.points(own), "dwithin", distance=network.near.max())[1]
            parts.append(f"{long[left][np.unique(found)].sum():.4g} m {text}")
    total = network.length.sum()
    said = f"flow: {len(network.length)} channels, {total:.4g} m of joints"
    yield (
        f"{said}; outer faces: {', '.join(parts) or 'none'}"
        if flow.state != "hydrostatic"
        else said
    )
    part = network.parts
    reached = np.zeros(part.max(initial=-1) + 1, np.bool_)
    reached[part[conditions.kind != INNER]] = True
    dry = ~reached[part]
    if flow.state != "hydrostatic" and dry.any():
        length = float(network.length[dry[network.node[:, 0]]].sum())
        at = point_text(network.at[dry][0] + rock.model.origin)
        yield f"flow: {length:.4g} m of joints, at {at} for one, reach no boundary and stay dry"
