"""Shared parts of problems about cutting: rectangles, a variant without a run, drawn blocks."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model
from clast.rockmass import Cut, Domain, JointSet
from clast.rockmass.cut_lines import set_lines, site
from clast.verification.variants import Variant

CUT = Variant(name="cut", process={"name": "none"})
"""Nothing is simulated: no process, law or integrator applies."""


def rectangle(width: float, height: float, **settings: Any) -> Domain:
    """Return a rectangle above and to the right of the origin as the domain."""
    return Domain(boundary=[(0, 0), (width, 0), (width, height), (0, height)], **settings)


def drawing_of(found: Cut, title: str) -> Model:
    """Return the blocks of a cut as a model, for a picture of them."""
    builder = InputBuilder(title=title)
    for name in found.rock_names:
        builder.add_rock(name, young=50e9, poisson=0.2, density=2700.0)
    rock = [found.rock_names[k] for k in found.rock]
    builder.blocks(vertices=found.vertices, start=found.block_start, rock=rock)
    return builder.build()


def lines_of(one: JointSet, domain: Domain, seed: int = 0) -> Floats:
    """Return the lines of a set inside a domain, m, shape (n, 2, 2)."""
    return set_lines(site(domain, [], []), [one], [], seed)[0].ends


def areas(found: Cut) -> Floats:
    """Return the areas of the blocks of a cut, m2, shape (nb,)."""
    x, y = (found.vertices - found.vertices.min(axis=0)).T
    start = found.block_start
    after = np.arange(len(x)) + 1
    after[start[1:] - 1] = start[:-1]
    return np.asarray(0.5 * np.add.reduceat(x * y[after] - x[after] * y, start[:-1]))
