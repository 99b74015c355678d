"""Random rock masses as cases, from a decimetre to a kilometre."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely

from clast.case.case_file import Case
from clast.model.model import Floats

STEPS = 20
"""Steps of a run."""
MODELS = ("parallel", "cross-jointed", "baecher", "veneziano", "poisson-lines", "voronoi")
JOINTS = ("default", "smooth", "rough")
ROCKS = ("granite", "shale")

Random = np.random.Generator
Table = dict[str, Any]


# --- drawing a rock mass ---------------------------------------------------------------------


def drawn(seed: int, largest: float = 5000.0) -> Case:
    """Return the random rock mass of this number, about 10 to ``largest`` blocks, most of them few.

    All random numbers are drawn alike for every ``largest``.
    """
    rng = np.random.default_rng([41, seed])
    size = 10.0 ** rng.uniform(-1.0, 3.0)
    blocks = 10.0 * (0.1 * largest) ** (rng.uniform() ** 3)
    boundary = _boundary(rng, size) + _place(rng)
    outline = shapely.Polygon(boundary)
    spacing = float(np.sqrt(outline.area / blocks))
    middle = np.array(outline.representative_point().coords[0])
    step = 10.0 ** rng.uniform(-4.0, -2.3) * min(1.0, float(np.sqrt(spacing)))
    domain: Table = {
        "boundary": boundary.tolist(),
        "rock": ROCKS[0],
        "section_azimuth": float(rng.uniform(0.0, 360.0)),
        "seed": int(rng.integers(0, 1000)),
        "fixed_sides": _sides(rng),
    }
    if rng.random() < 0.1:
        domain |= {"smallest_block": 0.0, "smallest_edge": 0.0}
    traces, openings = _traces(rng, outline), _openings(rng, middle, outline)
    sets, regions = _sets(rng, spacing, bool(traces)), _regions(rng, middle, size)
    named = {"default", *(one["joint"] for one in (*sets, *traces, *regions) if "joint" in one)}
    joints = {name: _joint(rng) for name in JOINTS}
    case = {
        "schema": 1,
        "title": f"random rock mass {seed}",
        "plane": str(rng.choice(["stress", "strain"])),
        "gravity": [0.0, -9.81],
        "time": {"step": step, "end": STEPS * step},
        "rock": {name: _rock(rng) for name in ROCKS},
        "joint": {name: table for name, table in joints.items() if name in named},
        "domain": domain,
        "joint_set": sets,
        "trace": traces,
        "opening": openings,
        "region": regions,
        "output": {"every": STEPS * step, "contacts": False},
    }
    if rng.random() < 0.25 and "bottom" not in domain["fixed_sides"]:
        case["block"] = [_base(boundary)]
    elif not domain["fixed_sides"]:
        domain["fixed_sides"] = ["bottom"]
    return Case.model_validate(case)


def _place(rng: Random) -> Floats:
    """Return where the lower left is, m, (2,): near the origin, or far away as maps have it."""
    far = rng.choice([0.0, 0.0, 1e3, 1e6])
    return far * rng.uniform(0.5, 1.5, 2) * rng.choice([-1.0, 1.0], 2)


def _boundary(rng: Random, size: float) -> Floats:
    """Return a rectangle, a slope, or the outline of a star, m, shape (k, 2), either way round."""
    width, height = size * rng.uniform(0.3, 1.0, 2)
    kind = rng.integers(0, 4)
    if kind < 2:
        corners = [(0, 0), (width, 0), (width, height), (0, height)]
    elif kind == 2:
        toe, bench = rng.uniform(0.2, 0.8, 2)
        crest = rng.uniform(0.1, toe)
        corners = [
            (0, 0),
            (width, 0),
            (width, bench * height),
            (toe * width, bench * height),
            (crest * width, height),
            (0, height),
        ]
    else:
        count = int(rng.integers(3, 10))
        turn = 2.0 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
        reach = size * rng.uniform(0.3, 1.0, count)
        corners = list(zip(reach * np.cos(turn), reach * np.sin(turn), strict=True))
    found = np.array(corners, float)
    return found[::-1] if rng.random() < 0.2 else found


def _sides(rng: Random) -> list[str]:
    return [
        ["bottom"],
        ["bottom", "left", "right"],
        ["bottom", "left"],
        ["left", "right"],
        [],
        [],
    ][int(rng.integers(0, 6))]


def _base(boundary: Floats) -> Table:
    """Return a fixed block below the rock mass."""
    (left, low), (right, high) = boundary.min(axis=0), boundary.max(axis=0)
    deep, wide = 0.2 * (high - low), 0.1 * (right - left)
    corners = [(left - wide, low - deep), (right + wide, low - deep)]
    corners += [(right + wide, low), (left - wide, low)]
    return {
        "name": "base",
        "vertices": np.array(corners).tolist(),
        "rock": "granite",
        "fixed": True,
    }


def _rock(rng: Random) -> Table:
    return {
        "young": 10.0 ** rng.uniform(8.0, 11.0),
        "poisson": rng.uniform(0.0, 0.35),
        "density": rng.uniform(1800.0, 3000.0),
    }


def _joint(rng: Random) -> Table:
    strength = 10.0 ** rng.uniform(3.0, 6.0) * (rng.random() < 0.2)
    return {
        "friction_angle": rng.uniform(2.0, 60.0),
        "cohesion": strength,
        "tensile_strength": 0.5 * strength,
    }


def _spread(rng: Random, mean: float) -> float | Table:
    """Return a number or a distribution with this mean."""
    choices: list[float | Table] = [
        mean,
        {"distribution": "uniform", "low": 0.5 * mean, "high": 1.5 * mean},
        {"distribution": "normal", "mean": mean, "sd": 0.3 * mean},
        {"distribution": "lognormal", "mean": mean, "sd": 0.6 * mean},
        {"distribution": "exponential", "mean": mean},
    ]
    return choices[int(rng.integers(len(choices)))]


def _direction(rng: Random, spaced: bool) -> Table:
    """Return the keys of a direction, in the section or in space, with or without scatter."""
    scattered = rng.random() < 0.4
    kappa = float(rng.choice([20.0, 60.0, 300.0]))
    if rng.random() < 0.2:
        found = {"dip": rng.uniform(15.0, 90.0), "dip_direction": rng.uniform(0.0, 360.0)}
        spacing = {"spacing_is": "apparent"} if spaced else {}
        return {**found, **spacing, **({"fisher_kappa": kappa} if scattered else {})}
    angle = float(rng.choice([0.0, 45.0, 90.0, rng.uniform(0.0, 180.0), rng.uniform(0.0, 180.0)]))
    scatter = {"angle_spread": {"distribution": "von-mises", "kappa": kappa}}
    return {"angle": angle, **(scatter if scattered else {})}


def _parallel(rng: Random, s: float) -> Table:
    found = {"spacing": _spread(rng, s), **_direction(rng, True)}
    if rng.random() < 0.4:
        found |= {"trace_length": _spread(rng, 5.0 * s), "bridge_length": _spread(rng, s)}
        found["stagger"] = float(rng.choice([0.0, 0.5]))
    return found


def _cross_jointed(rng: Random, s: float) -> Table:
    found = {"spacing": _spread(rng, s), **_direction(rng, True)}
    return {**found, "terminates_at": ["set 0"], "stagger": float(rng.choice([0.0, 0.5]))}


def _baecher(rng: Random, s: float) -> Table:
    direction = _direction(rng, False) if rng.random() < 0.7 else {}
    return {"intensity": 1.2 / s, "trace_length": _spread(rng, 5.0 * s), **direction}


def _veneziano(rng: Random, s: float) -> Table:
    lengths = {"trace_length": 5.0 * s, "bridge_length": s}
    return {"intensity": 1.0 / s, **lengths, **_direction(rng, False)}


def _poisson_lines(rng: Random, s: float) -> Table:
    direction = _direction(rng, False) if rng.random() < 0.5 else {}
    return {"intensity": 1.2 / s, **direction}


def _voronoi(rng: Random, s: float) -> Table:
    return {"spacing": s, "model": {"name": "voronoi", "rounds": int(rng.choice([0, 0, 3]))}}


MAKERS: dict[str, Callable[[Random, float], Table]] = {
    "parallel": _parallel,
    "cross-jointed": _cross_jointed,
    "baecher": _baecher,
    "veneziano": _veneziano,
    "poisson-lines": _poisson_lines,
    "voronoi": _voronoi,
}


def _sets(rng: Random, spacing: float, traced: bool) -> list[Table]:
    """Return one to three sets; cross-jointed ones end at the first, or at the traces, too."""
    first = str(rng.choice([name for name in MODELS if name != "cross-jointed"]))
    names = [first, *(str(name) for name in rng.choice(MODELS, int(rng.integers(0, 3))))]
    wide = spacing * np.sqrt(len(names))
    found = []
    for k, name in enumerate(names):
        table = {"name": f"set {k}", "model": name, **MAKERS[name](rng, float(wide))}
        if name == "cross-jointed" and traced and rng.random() < 0.5:
            table["terminates_at"] = ["set 0", "traces"]
        if rng.random() < 0.6:
            table["joint"] = str(rng.choice(JOINTS))
        found.append(table)
    return found


def _traces(rng: Random, outline: shapely.Polygon) -> list[Table]:
    """Return up to three polylines that cross the domain."""
    low, high = np.array(outline.bounds).reshape(2, 2)
    found = []
    for _ in range(int(rng.integers(0, 4)) * (rng.random() < 0.5)):
        points = rng.uniform(low, high, (int(rng.integers(2, 6)), 2))
        if shapely.intersection(shapely.LineString(points), outline).length > 0.1 * np.ptp(low):
            found.append({"points": points.tolist(), "joint": str(rng.choice(JOINTS))})
    return found


def _openings(rng: Random, middle: Floats, outline: shapely.Polygon) -> list[Table]:
    """Return an opening about ``middle`` in every third rock mass."""
    reach = float(outline.exterior.distance(shapely.Point(middle))) * rng.uniform(0.1, 1.1)
    shapes: list[Table] = [
        {"shape": "circle", "center": middle.tolist(), "radius": 0.9 * reach, "chords": 12},
        {
            "shape": "horseshoe",
            "center": middle.tolist(),
            "width": reach,
            "wall_height": 0.4 * reach,
        },
        {"shape": "box", "corner": middle.tolist(), "size": [reach, 0.5 * reach]},
    ]
    excavated, joint = bool(rng.random() < 0.5), bool(rng.random() < 0.7)
    kind = int(rng.integers(0, 9))
    if kind >= len(shapes):
        return []
    how = {"excavated": excavated, "construction_joint": joint}
    return [{"name": "heading", **shapes[kind], **how}]


def _regions(rng: Random, middle: Floats, size: float) -> list[Table]:
    """Return a bed of another rock in every third rock mass, its outline cut or not."""
    half = 0.3 * size * rng.uniform(0.2, 1.0, 2)
    joint = {"joint": "smooth"} if rng.random() < 0.5 else {}
    if rng.random() < 0.67:
        return []
    corners = middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return [{"name": "bed", "polygon": corners.tolist(), "rock": "shale", **joint}]
