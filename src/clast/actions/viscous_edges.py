"""Viscous edges: dashpots in the place of the rock beyond (Lysmer & Kuhlemeyer 1969).

    t = t_0 - (a rho c_p n n^T + b rho c_s t t^T) v + 2 (rho c_p n n^T + rho c_s t t^T) v_in

is the traction on an edge with the outward normal n: v is its mean velocity d/h in the step, v_in
that of a wave that comes up from below (only on edges that face down), and t_0 the traction on the
edge before: springs hold it until its dashpots begin, and their reaction then stays.  Two Gauss
points an edge.  The dashpots take the energy v.C v h from a step, which cannot be negative; all
work of the traction goes through the boundary.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
from clast.block.displacement import basis
from clast.model.model import Bools, Floats, Model
from clast.model.state import Ledger
from clast.model.surroundings import DOWNWARDS

GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
"""Places along an edge, as shares of its length; each stands for half of it."""


@dataclass(frozen=True, kw_only=True)
class Reaction:
    """The reaction of the rock beyond the edges."""

    force: Floats
    """Force at the Gauss points, N/m, shape (k, 2, 2); springs that still hold add to it."""
    held: Bools
    """Edges that springs held in the last step, shape (k,)."""


@dataclass(frozen=True, kw_only=True)
class _Active:
    """Forces at the Gauss points in a step; edge, point, component."""

    rows: Floats
    """T, shape (k, 2, 2, 6)."""
    held: Bools
    """Edges that springs hold in this step, shape (k,)."""
    resting: Floats
    """Force that stays as it is, N/m, shape (k, 2, 2)."""
    pull: Floats
    """Force of springs at the start of the step, N/m, shape (k, 2, 2); 0 where none hold."""
    wave: Floats
    """Force of the wave that comes in, N/m, shape (k, 2, 2)."""
    stiffness: Floats
    """Of springs where forces are taken, or of dashpots by h, N/m per m, shape (k, 2, 2)."""
    released: float
    """Energy in springs that have been removed, J/m."""


@dataclass(frozen=True)
class BoundaryDashpots(Action):
    """The viscous edges of the model."""

    stiffness: float
    """Stiffness of springs at each Gauss point before dashpots begin, N/m per m."""
    support: ClassVar[str] = "viscous edges"
    """Kind of support in its shares, row by row, for their reactions."""

    def begin(self, model: Model) -> Reaction:
        """Return that nothing is carried yet, and springs hold."""
        count = len(model.viscous_edges)
        return Reaction(force=np.zeros((count, 2, 2)), held=np.ones(count, np.bool_))

    def contribution(self, start: StepStart, state: Reaction) -> Contribution:
        """Return forces at the Gauss points and how they fall with the displacements."""
        active = self._active(start, state)
        rows = active.rows
        force = active.resting + active.pull + active.wave
        return Contribution(
            block=start.model.viscous_edges.block,
            force=np.einsum("kgxi,kgx->ki", rows, force),
            stiffness=np.einsum("kgxi,kxy,kgyj->kij", rows, active.stiffness, rows),
        )

    def finish(
        self, start: StepStart, state: Reaction, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the energy that left through the boundary, and that of springs that hold."""
        active = self._active(start, state)
        moved = _movement(active.rows, solution.displacement[contribution.block])
        resisted = np.einsum("kgx,kxy,kgy->k", moved, active.stiffness, moved)
        came = float(np.sum((active.resting + active.wave) * moved))
        pulled = float(np.sum(active.pull * moved))
        taken, stretched = float(resisted[~active.held].sum()), float(resisted[active.held].sum())
        return ActionResult(
            work=came + pulled - taken - stretched,
            ledger=Ledger(
                boundary=taken - came,
                fixed_points=0.5 / start.forces_at * stretched - pulled - active.released,
                removed=active.released,
            ),
            state=Reaction(force=active.resting, held=active.held),
        )

    def after(
        self, model: Model, state: Reaction, vertices: Floats, centroid: Floats, unknowns: Floats
    ) -> Reaction:
        """Return the reaction when springs have carried d (n, 6), which moves nothing."""
        block = model.viscous_edges.block
        at, _, _ = gauss_points(model, vertices)
        moved = _movement(_rows(at, centroid[block]), unknowns[block])
        force = state.force - np.einsum("kxy,kgy->kgx", self._hold(model), moved)
        return replace(state, force=force)

    def _hold(self, model: Model) -> Floats:
        """Return the stiffness of the springs, in the directions with dashpots, (k, 2, 2)."""
        edges = model.viscous_edges
        normal = gauss_points(model, model.vertices)[2]
        held = np.stack([edges.normal > 0.0, edges.tangential > 0.0], axis=1)
        return self.stiffness * _along_and_across(normal, held.astype(np.float64))

    def _active(self, start: StepStart, state: Reaction) -> _Active:
        """Return the forces of a step."""
        model, edges = start.model, start.model.viscous_edges
        at, length, normal = gauss_points(model, start.state.vertices)
        # Share of a step by which times may differ and be the same
        held = start.state.time < edges.begins - 1e-9 * start.step
        going = state.held & ~held
        hold = self._hold(model)
        away = at - gauss_points(model, model.vertices)[0]
        pull = -np.einsum("kxy,kgy->kgx", hold, away)
        kept = edges.kept[:, None, None] * (state.force + pull)
        impedance = model.impedances[edges.block] * (0.5 * length)[:, None]
        multiple = np.stack([edges.normal, edges.tangential], axis=1)
        dashpots = _along_and_across(normal, multiple * impedance)
        below = (normal[:, 1] <= DOWNWARDS) & ~held
        speed = model.ground_motion.incoming_velocity(*start.span)
        wave = 2.0 * below[:, None] * (_along_and_across(normal, impedance) @ speed)
        by_springs = held[:, None, None]
        return _Active(
            rows=_rows(at, start.frames.centroid[edges.block]),
            held=held,
            resting=np.where(going[:, None, None], kept, state.force),
            pull=np.where(by_springs, pull, 0.0),
            wave=np.repeat(wave[:, None], 2, axis=1),
            stiffness=np.where(by_springs, start.forces_at * hold, dashpots / start.step),
            released=-0.5 * float(np.sum((pull * away)[going])),
        )


def gauss_points(model: Model, vertices: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the Gauss points (k, 2, 2), m, of viscous edges, lengths, m, and outward normals."""
    edges = model.viscous_edges
    past = model.block_start[edges.block + 1]
    after = np.where(edges.edge + 1 < past, edges.edge + 1, model.block_start[edges.block])
    first, line = vertices[edges.edge], vertices[after] - vertices[edges.edge]
    length = np.hypot(*line.T)
    normal = np.stack([line[:, 1], -line[:, 0]], axis=1) / length[:, None]
    return first[:, None] + GAUSS[:, None] * line[:, None], length, normal


def _along_and_across(normal: Floats, factors: Floats) -> Floats:
    """Return f_n n n^T + f_t t t^T of normals (k, 2) and factors (f_n, f_t) (k, 2), (k, 2, 2)."""
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    axes = np.stack([normal, along], axis=1)
    return np.einsum("kd,kdx,kdy->kxy", factors, axes, axes)


def _rows(at: Floats, centroid: Floats) -> Floats:
    """Return T (k, 2, 2, 6) at points (k, 2, 2) of blocks with centroids (k, 2)."""
    return basis((at - centroid[:, None]).reshape(-1, 2)).reshape(-1, 2, 2, 6)


def _movement(rows: Floats, displacement: Floats) -> Floats:
    """Return T d (k, 2, 2), m, of d (k, 6) of the blocks of the edges."""
    return np.einsum("kgxi,ki->kgx", rows, displacement)
