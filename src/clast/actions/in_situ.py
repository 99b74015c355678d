"""The outline of a rock mass under in-situ stress: loaded by it, and held by springs beside that.

    f = q - k_n n n.u - k_t t t.u,    q = sigma n L

at either end of an edge of length L with its outward normal n, half of q each; u is how far the end
has moved from where it was.  The traction stays as it was at the start and does not turn: it is the
load of the rock beyond.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from clast.actions.action import (
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.block.displacement import basis
from clast.model.edges import edges_of, outer_boundary, outline_edges
from clast.model.model import Floats, Ints, Model
from clast.model.state import Ledger
from clast.model.surroundings import InSituStress

TRACTION_SHARE_MIN = 1e-9
"""Share of the largest traction below which an edge is free: the ground surface."""


@dataclass(frozen=True, kw_only=True)
class LoadedEnds:
    """The ends of the edges of an outline that stress presses on, k of them."""

    vertex: Ints
    """Vertex at each end, shape (k,)."""
    block: Ints
    """Its block, shape (k,)."""
    force: Floats
    """Force of half an edge, N/m, shape (k, 2)."""
    hold: Floats
    """Stiffness k_n n n^T + k_t t t^T, N/m per m, shape (k, 2, 2)."""

    def of_edges(self, pairs: Ints) -> Ints:
        """Return the ends (e, 2) of edges that ``pairs`` (p, 2) name by their first vertices."""
        edge = np.tile(self.vertex[: len(self.vertex) // 2], 2)
        ends = [np.zeros((0, 2), np.int64)]
        for one in np.unique(pairs[:, 0]):
            row = np.isin(edge, pairs[pairs[:, 0] == one, 1]).nonzero()[0]
            ends.append(np.stack([np.full(len(row), one), row], axis=1))
        return np.concatenate(ends)


@dataclass(frozen=True)
class InSituBoundary(Action):
    """Traction and springs along the outline of a model with in-situ stress."""

    stress: InSituStress
    stiffness: float
    """Stiffness of the springs of fixed points, N/m per m."""
    support: ClassVar[str] = "outline"
    """Kind of support in its shares, row by row, for their reactions."""

    def begin(self, model: Model) -> LoadedEnds:
        """Return the ends of loaded edges; those of fixed blocks need none."""
        edge, share = loaded_parts(model, self.stress)
        length, normal, sigma = along_outline(model, self.stress, edge, share)
        traction = tractions(sigma, normal)
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        held, slid = (self.stiffness * share for share in self.stress.held)
        hold = held * _squares(normal) + slid * _squares(along)
        # dashpots, and springs before them, are what viscous edges have beside the load
        hold[np.isin(edge, model.viscous_edges.edge)] = 0.0
        vertex = np.concatenate([edge, model.vertex_after[edge]])
        # T is linear: what a uniform traction on a part is worth at the ends of its edge
        middle = share.mean(axis=1)
        weight = np.concatenate([1.0 - middle, middle])
        return LoadedEnds(
            vertex=vertex,
            block=model.vertex_block[vertex],
            force=weight[:, None] * np.tile(length[:, None] * traction, (2, 1)),
            hold=weight[:, None, None] * np.tile(hold, (2, 1, 1)),
        )

    def contribution(self, start: StepStart, state: LoadedEnds) -> Contribution:
        """Return the forces at the ends, and how they fall with the displacements."""
        at = start.state.vertices[state.vertex]
        moved = at - start.model.vertices[state.vertex]
        force = state.force - np.einsum("kxy,ky->kx", state.hold, moved)
        rows = basis(at - start.frames.centroid[state.block])
        return Contribution(
            block=state.block,
            force=np.einsum("kxi,kx->ki", rows, force),
            stiffness=start.forces_at * np.einsum("kxi,kxy,kyj->kij", rows, state.hold, rows),
            forces_at=start.forces_at,
        )

    def finish(
        self, start: StepStart, state: LoadedEnds, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of traction and springs: that of traction comes from outside."""
        work, stored = energy_of_linear(contribution, solution.displacement)
        rows = basis(start.state.vertices[state.vertex] - start.frames.centroid[state.block])
        moved = np.einsum("kxi,ki->kx", rows, solution.displacement[state.block])
        brought = float(np.sum(state.force * moved))
        return ActionResult(
            work=work, ledger=Ledger(loads=brought, fixed_points=stored + brought), state=state
        )


def _squares(direction: Floats) -> Floats:
    """Return n n^T of directions (k, 2), shape (k, 2, 2)."""
    return direction[:, :, None] * direction[:, None]


def loaded_parts(model: Model, stress: InSituStress) -> tuple[Ints, Floats]:
    """Return the parts of edges that the stress loads: edge (k,), share (k, 2).

    Not those of the ground surface and of fixed blocks.
    """
    edge, share = _parts_of_outline(model, stress)
    _, normal, sigma = along_outline(model, stress, edge, share)
    size = np.hypot(*tractions(sigma, normal).T)
    carries = size > TRACTION_SHARE_MIN * size.max(initial=0.0)
    carries &= ~model.fixed[model.vertex_block[edge]]
    return edge[carries], share[carries]


def _parts_of_outline(model: Model, stress: InSituStress) -> tuple[Ints, Floats]:
    """Return the parts of edges on the outline: edge (k,), share (k, 2).

    Those on the sides that are named, or on the convex hull.  Where the top of the model carries
    stress it is cut out of the rock at depth: then notches within the hull are loaded too.  Where
    it does not it is the ground surface, and so are the faces of slopes within the hull.
    """
    hull = outline_edges(model.vertices, model.block_start, stress.sides)[:, 0]
    whole = np.tile([0.0, 1.0], (len(hull), 1))
    if stress.sides or not _is_deep(model, stress):
        return hull, whole
    edges = edges_of(model.vertices, model.vertex_after, model.vertex_block, model.area)
    edge, share = outer_boundary(edges, model.block_start)
    notch = ~(np.isin(edge, hull) | np.isin(edge, stress.voids))
    return np.concatenate([hull, edge[notch]]), np.concatenate([whole, share[notch]])


def _is_deep(model: Model, stress: InSituStress) -> bool:
    """Return whether the top of the model carries stress."""
    height = model.vertices[:, 1] + model.origin[1]
    top, bottom = np.abs(stress.at(np.array([height.max(), height.min()]))).max(axis=1)
    return bool(top > TRACTION_SHARE_MIN * bottom)


def along_outline(
    model: Model, stress: InSituStress, edge: Ints, share: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return lengths, m, and normals (k, 2) of parts of edges, and the stress at their middles.

    The stress in Pa, (k, 3).
    """
    first, last = model.vertices[edge], model.vertices[model.vertex_after[edge]]
    along = last - first
    length = np.hypot(*along.T)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    middle = first[:, 1] + share.mean(axis=1) * along[:, 1] + model.origin[1]
    return length * np.diff(share, axis=1)[:, 0], normal, stress.at(middle)


def tractions(stress: Floats, normal: Floats) -> Floats:
    """Return the traction sigma n, Pa, of stresses (k, 3) on faces with normals (k, 2), (k, 2)."""
    xx, yy, xy = stress.T
    nx, ny = normal.T
    return np.stack([xx * nx + xy * ny, xy * nx + yy * ny], axis=1)
