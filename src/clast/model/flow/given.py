"""Water that flows in joints as it is given: boundaries, wells, and properties of water."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from clast.model.arrays import Bools, Floats, Ints
from clast.model.factors import Factor
from clast.model.flow.channels import Network

HEAD, PRESSURE, FLUX, RAIN = "head", "pressure", "flux", "rain"
SEEPS, TIGHT, RATE = "seepage", "impermeable", "rate"
RANK = {TIGHT: 0, FLUX: 1, RAIN: 2, SEEPS: 2, PRESSURE: 3, HEAD: 3}
"""Where a node is of two boundaries, the kind with the higher rank decides."""
STEADY, FULL = "steady", "full"
"""Coupling by equilibria in which apertures and pressures agree, or in one potential."""
REST = ("bare rock", "tight sides")
"""Names of the outer nodes of no boundary: those that give water off, and those that do not."""


@dataclass(frozen=True, kw_only=True, repr=False)
class FlowBoundary:
    """Outer nodes along lines, and the water there."""

    name: str
    line: Floats
    """Straight lines about the model's origin, m, shape (s, 2, 2)."""
    needs: Ints
    """Block that has to be excavated for each line to count, -1 for none, shape (s,)."""
    kind: str
    """HEAD, PRESSURE, FLUX, RAIN, SEEPS or TIGHT."""
    value: float = 0.0
    """Height y of a head about the case's zero, m, pressure, Pa, flux or rain, m/s."""
    factor: Factor | None = None
    """The height of a head as it changes with time; None: it is constant."""
    seeps_above: bool = True
    """Whether faces above the head give water off."""
    presses: bool = True
    """Whether a head presses on the faces below it."""

    def lines(self, absent: Bools) -> Floats:
        """Return its lines while blocks are ``absent`` (n,), m, shape (s, 2, 2)."""
        return self.line[(self.needs < 0) | absent[self.needs]]

    def at(self, time: float) -> float:
        """Return its value at a time, s."""
        return self.value if self.factor is None else self.factor.at(time)

    def __repr__(self) -> str:
        return f"FlowBoundary('{self.name}', {self.kind})"


@dataclass(frozen=True, kw_only=True, repr=False)
class Well:
    """Nodes from which water is taken, or into which it is put."""

    name: str
    at: Floats
    """Its places on joints about the model's origin, m, shape (d, 2)."""
    kind: str
    """HEAD, PRESSURE or RATE."""
    value: float
    """Height y, m, pressure, Pa, or rate into the rock in all, m2/s."""
    only_outflow: bool = False
    """Whether it takes water and gives none."""
    stage: str = ""
    """Stage with which it begins, "" from the start."""
    begun: bool = True
    """Whether it has begun."""

    def __repr__(self) -> str:
        return f"Well('{self.name}', {self.kind} {self.value:g})"


@dataclass(frozen=True, kw_only=True, repr=False)
class Flow:
    """Water that flows in the joints of a model."""

    state: str
    """"steady", "transient" or "hydrostatic"."""
    coupling: str = "none"
    """"none", STEADY or FULL."""
    passes: int = 10
    """Times that a step of FULL coupling is solved again at most."""
    initial: str = "steady"
    """Water at the start of "transient": "steady", "dry" or "hydrostatic"."""
    weight: float
    """Weight of water rho g, N/m3, 0 without gravity."""
    density: float
    """Density of water, kg/m3."""
    viscosity: float
    """Viscosity of water, Pa s."""
    bulk_modulus: float = 2e9
    """Bulk modulus of water, Pa."""
    confined: bool
    """Whether all joints are full, and pressures may be negative."""
    longest: float = np.inf
    """Longest piece of a channel, m."""
    level: float = 0.0
    """Height y of water at rest, m."""
    boundaries: tuple[FlowBoundary, ...] = ()
    wells: tuple[Well, ...] = ()
    measured: tuple[tuple[str, str], ...] = ()
    """Name of each measured flow, and of the boundary, well or opening that it is of."""
    network: Network | None = None
    """Its channels while nothing is excavated."""
    sides: Floats = field(default_factory=lambda: np.zeros(3))
    """x of the left and right side of the model and y of its bottom, about its origin, m."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of boundaries, wells and the rest."""
        boundaries = (one.name for one in self.boundaries)
        return (*boundaries, *(one.name for one in self.wells), *REST)

    @property
    def points(self) -> Floats:
        """Places of wells about the model's origin, m, shape (d, 2)."""
        return np.concatenate([np.zeros((0, 2)), *(one.at for one in self.wells)])

    @property
    def changes(self) -> bool:
        """Whether any head changes with time."""
        return any(one.factor is not None for one in self.boundaries)

    def reynolds(self, flow: Floats) -> Floats:
        """Return the Reynolds numbers Re = rho q/mu of flows q in channels, m2/s, (k,)."""
        return np.asarray(self.density * np.abs(flow) / self.viscosity)

    def __repr__(self) -> str:
        return f"Flow({self.state}, {len(self.boundaries)} boundaries, {len(self.wells)} wells)"


def with_changes(
    flow: Flow,
    changes: Mapping[str, Mapping[str, float]],
    begun: set[str],
    waiting: set[str],
) -> Flow:
    """Return a flow whose boundaries a stage gives other values, and with wells that begin.

    ``changes`` has kinds and values by the names of boundaries, as in ``{"lake": {"head": 40.0}}``;
    ``begun`` are wells and stages that have begun, ``waiting`` boundaries that have not.
    """
    boundaries = []
    for one in flow.boundaries:
        for kind, value in changes.get(one.name, {}).items():
            one = replace(one, kind=kind, value=value, factor=None)
        if one.name in waiting:
            one = replace(one, line=one.line[:0], needs=one.needs[:0])
        boundaries.append(one)
    wells = [
        replace(one, begun=one.begun or bool(begun & {one.name, one.stage or one.name}))
        for one in flow.wells
    ]
    return replace(flow, boundaries=tuple(boundaries), wells=tuple(wells))
