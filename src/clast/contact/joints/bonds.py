"""Bonds of contacts: their places, and their loss by slip and tension.

Contacts along a joint with strength are bonded where the joint is closed at the start of the run:
where coordinates leave no gap but that of their rounding.  One that is open holds nothing, however
little, and whatever closes it later.  A bond has the cohesion c and the tensile strength sigma_t
of its joint.

- Tension beyond sigma_t, or a gap beyond critdis, ends both for good.
- Slip ends nothing where the joint is ideally plastic: |T| <= N tan(phi) + c L however far it
  slips, as limit equilibrium has it.  A joint with a residual cohesion is brittle: the first slip
  ends the bond, and leaves that cohesion until the contact opens; or it goes with the path of
  sliding (contact/joints/weakening.py), and the bond ends when none of that is left.

Cohesion belongs to the plane, not to the corner that was there first.  A face that slides on takes
its bonds along: a contact that comes up where faces lie on each other is bonded as they are.

Corners that meet in a point of bonded rock.

Around a point where several blocks meet, as in a mesh of triangles, there are blocks that share no
face, only this point.  Where bonded faces join one to the next round the point, they hold these two
together, or apart, as well.  A contact of the two would add nothing but impacts and friction at a
place where the rock is whole: it would take the energy of waves.  It comes up when a bond breaks.

Peak and residual strength, static and kinetic friction: strength after sliding.

    tan(phi) = tan(phi_p) + s (tan(phi_r) - tan(phi_p))        s = min(1, slid / slip_weakening)

and likewise cohesion, from all of it to the residual one, and tensile strength, to nothing.
``slid`` is how far a contact has slid, to and fro, by the start of the step: within a step
strengths are constant, so that the equations of a step stay those of Coulomb's law.

Friction of a contact that slid in the last step, at a speed v, falls further, to the kinetic one:

    tan(phi) = tan(phi_s) + min(1, v/v_c) (tan(phi_k) - tan(phi_s))

with v_c = 0 at once.  In statics nothing has a speed.

Contacts that are closed at the start of the run have their peak strength.  How far they have slid
belongs to their faces, as bonds do (contact/joints/bonds.py): a contact that comes up where a face
slides on, to the next piece of its plane as well, has slid as far as the face has.  Where neither
face has carried there is the residual strength: they have never fitted each other.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from clast.block.polygon import SMALL_ANGLE
from clast.compute.jit import kernel
from clast.contact.contacts import ContactResponse, Contacts, Places
from clast.contact.joints.barton_bandis import mobilised, rough_contacts
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory


def flush_edges(
    vertex: Ints, edge: Ints, direction: Floats, block_start: Ints
) -> tuple[Ints, Ints]:
    """Return which of its two edges each vertex (k,) has along an edge (k,), else -1, (k,) each.

    Along it means within 3 degrees, the blocks on either side; ``direction`` (nv, 2) are the unit
    vectors of edges, ``block_start`` (n + 1,) is the first vertex of each block.
    """
    before = np.arange(-1, len(direction) - 1)
    before[block_start[:-1]] = block_start[1:] - 1
    flush = []
    for own in (before[vertex], vertex):
        one, other = direction[own], direction[edge]
        sine = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
        opposite = np.einsum("kx,kx->k", one, other) < 0.0
        flush.append(np.where((np.abs(sine) <= SMALL_ANGLE) & opposite, own, -1))
    return flush[0], flush[1]


def had_by_faces(
    kept: tuple[Floats, ...],
    memory: ContactMemory,
    ends: tuple[Ints, Ints],
    direction: Floats,
    block_start: Ints,
) -> tuple[Floats, ...]:
    """Return the earlier values of the faces of contacts, (k,) each, nan where neither has borne.

    ``kept`` are numbers of the rows of the ``memory``, (r,) each; where contacts of a face differ,
    the largest by size counts.  ``ends`` are vertex and edge of the contacts (k,).
    """
    vertex, edge = ends
    along = flush_edges(memory.vertex, memory.edge, direction, block_start)
    mine = flush_edges(vertex, edge, direction, block_start)
    earlier = []
    for values in kept:
        # of every edge, and of -1, which is none; NaN where nothing is known of it
        low, high = np.full((2, len(direction) + 1), np.nan)
        for own in along:
            flush = own >= 0
            for face in (own[flush], memory.edge[flush]):
                np.fmax.at(high, face, values[flush])
                np.fmin.at(low, face, values[flush])
        face = np.where(-low > high, low, high)
        result = np.full(len(vertex), np.nan)
        for own in mine:
            for of_face in (face[own], face[edge]):
                larger = (own >= 0) & ~(np.abs(of_face) <= np.abs(result))
                result = np.where(larger & ~np.isnan(of_face), of_face, result)
        earlier.append(result)
    return tuple(earlier)


def slide_lengths(
    carried: Floats,
    bonded: Bools,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> Floats:
    """Return how far contacts have slid, m, (m,), given their memory.

    ``carried`` (m,) is 0 and ``bonded`` (m,) False for contacts that come up after the start;
    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    new = np.flatnonzero((places.row < 0) & ~bonded)
    if not len(new):
        return carried
    ends = places.vertex[new], places.edge[new]
    (known,) = had_by_faces((memory.slide_length,), memory, ends, direction, model.block_start)
    worn = model.joint_table.worn_after.take(places.joint[new])
    slid = carried.copy()
    slid[new] = np.where(known >= 0.0, known, worn)
    return slid


def friction_of(table: JointTable, places: Places, slid: Floats, speed: Floats) -> Floats:
    """Return tan(phi) of contacts that have slid so far, m, and slide at a speed, m/s, (m,)."""
    static = _weakened(table, places, slid)
    if not table.has_kinetic_friction:
        return static
    kinetic = table.kinetic_friction.take(places.joint)
    critical = table.critical_speed.take(places.joint)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(speed > 0.0, np.minimum(1.0, speed / critical), 0.0)
    slower = static + share * (np.minimum(kinetic, static) - static)
    return np.where(np.isnan(kinetic), static, slower)


def _weakened(table: JointTable, places: Places, slid: Floats) -> Floats:
    """Return tan(phi) of contacts that have slid so far, m, and stand, shape (m,)."""
    peak = table.strengths[0].take(places.joint)
    if not table.weakens:
        return peak
    left = table.residual_friction.take(places.joint)
    lost = share_lost(table, places.joint, slid)
    return np.where(np.isnan(left), peak, peak + lost * (left - peak))


def share_lost(table: JointTable, joint: Ints, slid: Floats) -> Floats:
    """Return by which share contacts have fallen from peak to residual strength, (m,)."""
    return np.asarray(np.minimum(1.0, slid / table.worn_after.take(joint)))


def strength_lost(table: JointTable, joint: Ints, slid: Floats, bonded: Bools) -> Floats:
    """Return which share of what they can lose contacts along ``joint`` (k,) have lost, (k,).

    0 at the peak, 1 at the residual strength; ``slid`` (k,) is how far they have slid, m.  Bonds
    that are broken are lost; of a rough joint beyond its peak it is the roughness that is lost.
    """
    loses = ~np.isnan(table.residual_friction)
    loses |= ~np.isnan(table.residual_cohesion) & (table.slip_weakening > 0.0)
    lost = np.where(loses.take(joint), share_lost(table, joint, slid), 0.0)
    rough = rough_contacts(table, joint)
    if rough is not None:
        x = slid[rough.rows] / rough.peak_slip
        lost[rough.rows] = np.where(x > 1.0, 1.0 - mobilised(x), 0.0)
    _, cohesion, tensile_strength = table.strengths
    binds = ((cohesion > 0.0) | (tensile_strength > 0.0)).take(joint)
    return np.where(binds & ~bonded, 1.0, lost)


CORNER_DISTANCE_MAX = 0.1
"""Distance between corners that are one point, in units of critdis; a face is longer."""
BLOCKS_ROUND_POINT_MAX = 64
"""Blocks around a point, at most."""


def without_points_in_bonds(
    corners: Places, bonded: Bools, vertices: Floats, critdis: float
) -> Places:
    """Return the contacts of vertices without those of blocks that bonds join round the point.

    ``bonded`` (m,) are those with a bond, ``vertices`` (nv, 2) those of the blocks, m; corners
    within a tenth of ``critdis``, m, of each other are one point.
    """
    near = CORNER_DISTANCE_MAX * critdis
    # bonds that give way let blocks overlap along such a point by as much
    of_faces = corners.length > near
    points, faces = np.flatnonzero(~of_faces), np.flatnonzero(of_faces & bonded)
    if not (len(points) and len(faces)):
        return corners
    ends = corners.vertex, corners.vertex_block, corners.edge_block
    joined = _are_joined(points, faces, ends, vertices, near)
    if not joined.any():
        return corners
    return Places(**{one.name: getattr(corners, one.name)[~joined] for one in fields(Places)})


@kernel()
def _are_joined(points, faces, contacts, vertices, near):
    """Return which contacts (m,) are among ``points`` and of blocks that ``faces`` join round them.

    ``points`` and ``faces`` are numbers of contacts, these by vertex and the two blocks (m,) each.
    """
    vertex, vertex_block, edge_block = contacts
    joined = np.zeros(len(vertex), np.bool_)
    count = max(vertex_block.max(), edge_block.max()) + 1
    start = np.zeros(count + 1, np.int64)
    for f in faces:
        start[vertex_block[f] + 1] += 1
        start[edge_block[f] + 1] += 1
    for b in range(count):
        start[b + 1] += start[b]
    of_block, filled = np.empty(start[-1], np.int64), start[:-1].copy()
    for f in faces:
        for b in (vertex_block[f], edge_block[f]):
            of_block[filled[b]] = f
            filled[b] += 1
    met = np.empty(BLOCKS_ROUND_POINT_MAX, np.int64)
    for c in points:
        x, y = vertices[vertex[c], 0], vertices[vertex[c], 1]
        met[0], known, at = vertex_block[c], 1, 0
        while at < known and not joined[c]:
            b, at = met[at], at + 1
            for k in range(start[b], start[b + 1]):
                f = of_block[k]
                p = vertex[f]
                if abs(vertices[p, 0] - x) > near or abs(vertices[p, 1] - y) > near:
                    continue
                other = edge_block[f] if vertex_block[f] == b else vertex_block[f]
                if other == edge_block[c]:
                    joined[c] = True
                    break
                if known < BLOCKS_ROUND_POINT_MAX and not _is_among(other, met, known):
                    met[known] = other
                    known += 1
    return joined


@kernel()
def _is_among(one, some, count):
    """Return whether a number is one of the first ``count`` of some."""
    for k in range(count):
        if some[k] == one:
            return True
    return False


ROUNDED_GAP = 1e-5
"""Gap of faces that are drawn as one line, in units of the size of the smaller block.

Coordinates with five decimals on blocks of 1 m leave as much; cut rock is closed to 1e-15.
"""


@dataclass(frozen=True)
class Bonds:
    """The remaining bonds of contacts."""

    bonded: Bools
    """True while cohesion and tensile strength are intact, shape (m,)."""
    cohesive: Bools
    """True while bonded, or slipped but not opened since, shape (m,)."""


def bonded_at_start(places: Places, model: Model, direction: Floats) -> Bools:
    """Return which contacts that have no memory are bonded when the run starts, (m,).

    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    return are_closed(places, model, direction) & (places.row < 0)


def are_closed(places: Places, model: Model, direction: Floats) -> Bools:
    """Return along which contacts a joint is closed, over the length that each stands for, (m,).

    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    wedge = np.zeros(len(places.gap))
    along = flush_edges(places.vertex, places.edge, direction, model.block_start)
    for own in (np.where(places.point > 0, places.vertex, one) for one in along):
        one, other = direction[own], direction[places.edge]
        sine = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
        wedge = np.maximum(wedge, np.where(own >= 0, sine, 0.0))
    return np.asarray(places.gap + wedge * places.length <= _rounded(places, model))


def _rounded(places: Places, model: Model) -> Floats:
    """Return the gaps that rounding of coordinates leaves at contacts, m, (m,)."""
    blocks = places.vertex_block, places.edge_block
    return np.asarray(ROUNDED_GAP * np.sqrt(np.minimum(*(model.area.take(one) for one in blocks))))


def torn(contacts: Contacts, response: ContactResponse) -> Bools:
    """Return which bonds end because of tension, shape (m,)."""
    ended = contacts.bonded & ~response.bonded
    in_tension: Bools = ended & (response.normal_force < 0.0)
    return in_tension


def without_bonds(contacts: Contacts, response: ContactResponse) -> Contacts:
    """Return the contacts without the bonds that the ``response`` says have ended."""
    ended, cohesive = contacts.bonded & ~response.bonded, contacts.cohesive
    cohesive = cohesive & ~torn(contacts, response)
    residual = contacts.residual_cohesion
    # a law of one's own may end bonds that slip leaves whole
    slipped = np.where(np.isnan(residual), contacts.cohesion, residual)
    left = np.where(cohesive, slipped, 0.0)
    return replace(
        contacts,
        bonded=contacts.bonded & response.bonded,
        cohesive=cohesive,
        cohesion=np.where(ended, left, contacts.cohesion),
        tensile_strength=np.where(ended, 0.0, contacts.tensile_strength),
    )


def bonds_of(
    bonds: Bonds,
    slid: Floats,
    speed: Floats,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> dict[str, Any]:
    """Return friction, bonds and the strengths that they have left, (m,) each by its name.

    ``bonds`` are those that the contacts at ``places`` have of themselves, ``slid`` (m,) is how far
    they remember to have slid, m, ``speed`` (m,) how fast in the last step, m/s;
    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    table, joint = model.joint_table, places.joint
    _, cohesion, tensile_strength = table.strengths
    if table.weakens:
        slid = slide_lengths(slid, bonds.bonded, places, memory, direction, model)
    residual = table.residual_cohesion
    if not table.binds:
        none = np.zeros(len(joint))
        return {
            "bonded": bonds.bonded,
            "cohesive": bonds.cohesive,
            "slide_length": slid,
            "friction": friction_of(table, places, slid, speed),
            "cohesion": none,
            "residual_cohesion": residual.take(joint),
            "tensile_strength": none,
        }
    if memory.cohesive.any():
        lasts = (cohesion > 0.0) & ~(residual == 0.0)
        new = np.flatnonzero((places.row < 0) & lasts.take(joint) & ~bonds.bonded)
        if len(new):
            bonds = _taken_along(bonds, new, places, memory, direction, model)
    bonded, left = bonds.bonded, np.where(np.isnan(residual), cohesion, residual)
    whole, ended, tension = (one.take(joint) for one in (cohesion, left, tensile_strength))
    slips = residual.take(joint)
    gradual = (table.slip_weakening > 0.0).take(joint) & ~np.isnan(slips)
    if gradual.any():
        lost = np.where(gradual, share_lost(table, places.joint, slid), 0.0)
        whole, tension = whole + lost * (ended - whole), (1.0 - lost) * tension
        slips = np.where(gradual & (lost < 1.0), np.nan, slips)
    return {
        "bonded": bonded,
        "cohesive": bonds.cohesive,
        "slide_length": slid,
        "friction": friction_of(table, places, slid, speed),
        "cohesion": np.where(bonded, whole, np.where(bonds.cohesive, ended, 0.0)),
        "residual_cohesion": slips,
        "tensile_strength": np.where(bonded, tension, 0.0),
    }


def _taken_along(
    bonds: Bonds,
    new: Ints,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> Bonds:
    """Return the bonds with those of contacts ``new`` (k,) that their faces had elsewhere.

    A face has those of the contacts that it lay on another face with, and takes them to a face
    that is no farther away than these give way.
    """
    ends = places.vertex[new], places.edge[new]
    had = tuple(np.where(kept, memory.gap, np.nan) for kept in (memory.bonded, memory.cohesive))
    given = had_by_faces(had, memory, ends, direction, model.block_start)
    closed = _rounded(places, model)[new]
    result = []
    for kept, gap in zip((bonds.bonded, bonds.cohesive), given, strict=True):
        kept = kept.copy()
        # NaN, where the faces had none, is no bound
        kept[new] |= places.gap[new] <= np.maximum(np.abs(gap), closed)
        result.append(kept)
    return Bonds(*result)
