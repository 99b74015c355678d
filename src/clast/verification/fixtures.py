"""Shared parts of problems: rectangles, a model with one rock, cut blocks."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.actions.flow import water_at
from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model, Plane, PlaneStress
from clast.rockmass import Cut, Domain, JointSet
from clast.rockmass.cut_lines import set_lines, site
from clast.verification.variants import Variant

CUT = Variant(name="cut", process={"name": "none"})
"""Nothing is simulated: no process, law or integrator applies."""
BONDED: dict[str, Any] = {"friction_angle": 45.0, "cohesion": 1e12, "tensile_strength": 1e12}
"""Joints that never give way."""


def box(left: float, low: float, right: float, high: float) -> list[tuple[float, float]]:
    """Return the corners of a rectangle, counter-clockwise, m."""
    return [(left, low), (right, low), (right, high), (left, high)]


def new_model(
    title: str,
    *,
    young: float,
    density: float,
    poisson: float = 0.2,
    gravity: float = 0.0,
    plane: Plane | None = None,
    **joint: Any,
) -> InputBuilder:
    """Begin a model with one rock under gravity, m/s2, and the properties of its joints if any."""
    builder = InputBuilder(title=title, gravity=(0.0, 0.0 - gravity), plane=plane or PlaneStress())
    builder.add_rock("rock", young=young, poisson=poisson, density=density)
    if joint:
        builder.add_joint("default", **joint)
    return builder


def rectangle(width: float, height: float, **settings: Any) -> Domain:
    """Return a rectangle above and to the right of the origin as the domain."""
    return Domain(boundary=box(0, 0, width, height), **settings)


def drawing_of(rock_mass: Cut, title: str) -> Model:
    """Return the blocks of a cut as a model, for a picture of them."""
    builder = InputBuilder(title=title)
    for name in rock_mass.rock_names:
        builder.add_rock(name, young=50e9, poisson=0.2, density=2700.0)
    rock = [rock_mass.rock_names[k] for k in rock_mass.rock]
    builder.blocks(vertices=rock_mass.vertices, start=rock_mass.block_start, rock=rock)
    return builder.build()


def lines_of(joints: JointSet, domain: Domain, seed: int = 0) -> Floats:
    """Return the lines of a set inside a domain, m, shape (n, 2, 2)."""
    return set_lines(site(domain, [], []), [joints], [], seed)[0].ends


def areas(rock_mass: Cut) -> Floats:
    """Return the areas of the blocks of a cut, m2, shape (nb,)."""
    x, y = (rock_mass.vertices - rock_mass.vertices.min(axis=0)).T
    start = rock_mass.block_start
    after = np.arange(len(x)) + 1
    after[start[1:] - 1] = start[:-1]
    return np.asarray(0.5 * np.add.reduceat(x * y[after] - x[after] * y, start[:-1]))


def cut_rock(title: str, rock_mass: Cut, *, aperture: float, gravity: float = 9.81) -> InputBuilder:
    """Begin a model with the blocks of a cut, and joints of one aperture, m, without stress."""
    builder = InputBuilder(title=title, gravity=(0.0, -gravity))
    builder.add_rock("rock", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, aperture=aperture)
    builder.blocks(vertices=rock_mass.vertices, start=rock_mass.block_start, fixed=True)
    return builder


def into_rock(model: Model) -> dict[str, float]:
    """Return what flows into the joints at each boundary and well, m2/s, by name."""
    water, flow = water_at(model, 0.0), model.flow
    names = flow.names if flow else ()
    into, out, _ = water.exchange
    sums = np.zeros(len(names))
    sums[: len(into)] = into - out
    return dict(zip(names, sums.tolist(), strict=True))
