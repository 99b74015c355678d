"""Random rock masses as cases, from a decimetre to a kilometre, and what comes of running them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
import shapely

from clast.case.case_file import Case
from clast.errors import CaseError, RunStopped
from clast.inputs.method import CRITDIS_SHARE
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.results import Run
from clast.run.overlap import KNOWN

STEPS = 20
"""Steps of a run."""
DEEP = 10.0
"""Penetrations beyond so many times that of the weight above, and beyond critdis, are wrong."""
GAINED = 1e-3
"""Energy gained beyond this share of what is turned over is wrong."""
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


# --- running it ------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What came of a random rock mass."""

    seed: int
    """Its number."""
    ended: str
    """"ran", or where it ended before: "not cut", "no model", "refused" or "stopped"."""
    said: str = ""
    """Message of the error."""
    blocks: int = 0
    """Blocks."""
    size: float = 0.0
    """Diagonal of the domain, m."""
    sets: tuple[str, ...] = ()
    """Models of its sets."""
    steps: int = 0
    """Accepted steps."""
    cut_steps: int = 0
    """Steps that were tried again with a smaller one."""
    finite: bool = True
    """All coordinates, velocities and energies are numbers."""
    unwarned: tuple[tuple[str, str, float], ...] = ()
    """Overlaps that contacts do not know and no warning names: two blocks and depth, m."""
    warned: int = 0
    """Overlaps that the run warns of."""
    penetration: float = 0.0
    """Largest penetration over what the weight above would give, -."""
    share: float = 0.0
    """Largest penetration over the size of the smallest block, -."""
    gain: float = 0.0
    """Energy beyond that of the start over the energy turned over."""
    seconds: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Wall time of cut, model and check, and run, s."""


def wrong(found: Mapping[str, Any]) -> list[str]:
    """Return what is wrong with an outcome, a dictionary of its fields, in words."""
    if found["ended"] != "ran":
        return [f"{found['ended']}: {found['said']}"]
    said = []
    if not found["finite"]:
        said.append("not finite")
    if found["unwarned"]:
        said.append(f"overlaps without a warning: {found['unwarned'][:3]}")
    if found["penetration"] > DEEP and found["share"] > CRITDIS_SHARE:
        said.append(f"penetration {found['penetration']:.3g} times that of the weight above")
    if found["gain"] > GAINED:
        said.append(f"energy gained: {found['gain']:.2g} of what is turned over")
    return said


def outcome(seed: int, largest: float = 5000.0) -> Outcome:
    """Return what comes of cutting a random rock mass, of the check before a run, and of a run."""
    case = drawn(seed, largest)
    about: Table = {
        "seed": seed,
        "sets": tuple(str(_name(one.model)) for one in case.joint_set),
        "size": float(np.hypot(*np.ptp(np.array(case.domain.boundary), axis=0))),
    }
    clock = [perf_counter()]
    try:
        about["blocks"] = case.cut().cut.block_count
    except CaseError as error:
        return Outcome(ended="not cut", said=str(error), **about)
    clock.append(perf_counter())
    try:
        model = case.model()
    except CaseError as error:
        return Outcome(ended="no model", said=str(error), **about)
    clock.append(perf_counter())
    try:
        run = case.run()
    except RunStopped as stopped:
        return Outcome(ended="stopped", said=str(stopped), **about)
    except CaseError as error:
        return Outcome(ended="refused", said=str(error), **about)
    clock.append(perf_counter())
    about["seconds"] = tuple(np.diff(clock).round(3).tolist())
    return Outcome(ended="ran", **about, **_found(model, run, case))


def _name(model: Any) -> str:
    return str(getattr(model, "name", model))


def _found(model: Model, run: Run, case: Case) -> Table:
    """Return what the end of a run shows."""
    report, state = run.report, run.state
    p = case.method(model).contact_law.normal_stiffness
    numbers = [state.vertices, state.velocity, state.stress]
    numbers += [*run.energy.values()]
    warned = {tuple(sorted(one.blocks)) for one in report.overlaps}
    unwarned = [one for one in deep_overlaps(model, state) if tuple(sorted(one[:2])) not in warned]
    smallest = float(np.sqrt(model.area.min()))
    return {
        "steps": report.steps,
        "cut_steps": report.cut_steps,
        "finite": all(bool(np.isfinite(one).all()) for one in numbers),
        "unwarned": tuple(unwarned),
        "warned": len(warned),
        "penetration": report.largest_penetration / _settlement(model, p),
        "share": report.largest_penetration / smallest,
        "gain": _gain(run),
    }


def _settlement(model: Model, stiffness: float) -> float:
    """Return rho g H b/p: the penetration of one contact that bears the largest block's column."""
    high = float(np.ptp(model.vertices[:, 1]))
    density = max(rock.density for rock in model.rocks)
    return density * 9.81 * high * float(np.sqrt(model.area.max())) / stiffness


def _gain(run: Run) -> float:
    """Return the energy beyond that of the start over the energy turned over."""
    energy = run.energy
    stored = sum(
        energy[name] for name in ("kinetic", "elastic", "gravity", "contact", "fixed_points")
    )
    held = stored - energy["loads"]
    turned = max(float(energy["kinetic"].max()), float(np.ptp(energy["gravity"])), 1e-300)
    return float((held - held[0]).max()) / turned


def deep_overlaps(model: Model, state: State) -> list[tuple[str, str, float]]:
    """Return pairs of blocks that overlap deeper than their contacts know, by clipping polygons.

    Those across from each other at a corner of four may overlap as far as each gives way to the
    two beside it.
    """
    vertices, memory = state.vertices, state.memory
    shapes = np.array([shapely.Polygon(one) for one in np.split(vertices, model.block_start[1:-1])])
    first, second = shapely.STRtree(shapes).query(shapes)
    once = (first < second) & ~(model.fixed[first] & model.fixed[second])
    first, second = first[once], second[once]
    area = shapely.area(shapely.intersection(shapes[first], shapes[second]))
    known, give = _known(model, memory)
    slack = 1e-3 * float(np.sqrt(model.area.min()))
    found = []
    for k in np.flatnonzero(area > 0.25 * np.pi * slack**2):
        i, j = int(first[k]), int(second[k])
        least = max(KNOWN * known.get((i, j), 0.0), give[i] + give[j], slack)
        if area[k] < 0.25 * np.pi * least**2:  # no circle of that diameter has room
            continue
        # without a grid GEOS takes some outlines that touch to the last bit for one inside another
        grid = 1e-9 * float(np.sqrt(shapes[i].area))
        common = shapely.intersection(shapes[i], shapes[j], grid_size=grid)
        parts = [part for part in shapely.get_parts(common) if part.area > 0.0]
        circles = [float(shapely.maximum_inscribed_circle(one).length) for one in parts]
        depth = 2.0 * max(circles, default=0.0)
        if depth > least:
            found.append((model.block_name[i], model.block_name[j], depth))
    return found


def _known(model: Model, memory: Any) -> tuple[dict[tuple[int, int], float], Floats]:
    """Return the deepest contact of each pair, m, and of each block (nb,)."""
    own, other = model.vertex_block[memory.vertex], memory.block
    pairs: dict[tuple[int, int], float] = {}
    give = np.zeros(model.block_count)
    for a, b, gap in zip(own.tolist(), other.tolist(), memory.gap.tolist(), strict=True):
        pair = (a, b) if a < b else (b, a)
        pairs[pair] = max(pairs.get(pair, 0.0), -gap)
        give[[a, b]] = np.maximum(give[[a, b]], -gap)
    return pairs, give
