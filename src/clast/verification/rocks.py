"""Cases of rocks that fall on a profile, for the problems of the group rockfall."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clast.case.case_file import Case
from clast.model.model import Floats, Model
from clast.trajectory import path
from clast.trajectory.campaign import Campaign, Path
from clast.verification.fixtures import new_model
from clast.verification.variants import Variant

PATHS = Variant(name="paths", process={"name": "none"})
"""Rocks are followed; no process, law or integrator applies."""
GRAVITY, DENSITY = 9.8, 2500.0
FLOOR = ((-50.0, 0.0), (50.0, 0.0))
SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
"""Rock of 1 m x 1 m."""
SURFACE = "ground"


def falling(
    profile: ArrayLike,
    surface: dict[str, Any],
    source: dict[str, Any],
    gravity: float = GRAVITY,
    **tables: Any,
) -> Campaign:
    """Return the paths of a case with one surface and one source of rocks 1 m long."""
    points = np.asarray(profile, np.float64).tolist()
    content = {
        "gravity": [0.0, -gravity],
        "surface": {SURFACE: surface},
        "source": [{"name": "rock", "rocks": 1, "length": 1.0, "density": DENSITY, **source}],
        **tables,
    }
    table = {"profile": points, "surface": [SURFACE], **tables.get("rockfall", {})}
    return Case.validated({**content, "rockfall": table}, "case").campaign()


def regular(count: int, radius: float = 0.5) -> Floats:
    """Return a regular polygon, (n, 2), its first edge below and level."""
    angle = -0.5 * np.pi + np.pi * (2.0 * np.arange(count) + 1.0) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def turned(points: Floats, angle: float) -> Floats:
    """Return points (n, 2) turned about the origin, rad."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def rock_at(shape: Floats, at: ArrayLike, **keys: Any) -> dict[str, Any]:
    """Return the keys of a source of one polygon (n, 2) about its centroid, as large as it is."""
    x, y = shape.T
    area = 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    place = np.asarray(at, np.float64).tolist()
    return {"at": place, "shape": shape.tolist(), "volume": area, **keys}


def blows_of(one: Path) -> Floats:
    """Return the records of the blows of a path."""
    rows = one.course.records[: one.course.tally[0]]
    return rows[rows[:, path.KIND] == path.BLOW]


def picture(profile: ArrayLike, shape: Floats, at: ArrayLike) -> Model:
    """Return a profile as a fixed block and a rock above it, for a figure."""
    line = np.array(profile, np.float64)
    low = line[:, 1].min() - 0.1 * np.ptp(line[:, 0])
    builder = new_model("Rockfall", young=1e9, density=DENSITY)
    ground = [*line[::-1].tolist(), (line[0, 0], low), (line[-1, 0], low)]
    builder.block(name="ground", vertices=ground, fixed=True)
    builder.block(name="rock", vertices=(shape + np.asarray(at)).tolist())
    return builder.build()
