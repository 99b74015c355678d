"""Random systems of blocks, and what an outline clipper finds where contact detection looks too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
import shapely.affinity
import shapely.ops
from scipy.spatial import Voronoi

from clast.case.case_file import Case
from clast.contact.contacts import ContactResponse, Contacts
from clast.errors import RunStopped
from clast.model.model import Model
from clast.model.state import State
from clast.results import Run, RunRecorder
from clast.run.simulate import simulate

# --- drawing a system ------------------------------------------------------------------------


def cells(rng: np.random.Generator, count: int, size: float) -> list[shapely.Polygon]:
    """Return the Voronoi cells of clustered points in a rectangle; they tile it."""
    width, height = size * rng.uniform(0.5, 1.5, 2)
    clustered = rng.uniform(0.0, 1.0, (count, 2)) ** rng.choice([1.0, 1.0, 2.0, 3.0])
    points = clustered * (width, height)
    around = [points, points * (-1, 1), points * (1, -1)]
    around += [points * (-1, 1) + (2 * width, 0), points * (1, -1) + (0, 2 * height)]
    diagram = Voronoi(np.concatenate(around))
    corners = np.clip(diagram.vertices, 0.0, (width, height))
    regions = [diagram.regions[region] for region in diagram.point_region[:count]]
    return [shapely.Polygon(corners[region]) for region in regions]


def united(rng: np.random.Generator, parts: list[shapely.Polygon]) -> list[shapely.Polygon]:
    """Return the parts with some neighbours made one block, mostly with re-entrant corners."""
    left, made = list(parts), []
    while left:
        block = left.pop(rng.integers(len(left)))
        for _ in range(rng.integers(0, 3)):
            beside = [k for k, one in enumerate(left) if block.intersection(one).length > 1e-3]
            if not beside:
                break
            both = shapely.union_all([block, left[beside[0]]], grid_size=1e-9)
            if both.geom_type != "Polygon" or both.interiors:
                break
            block = both
            left.pop(beside[0])
        made.append(block)
    return made


def courses(rng: np.random.Generator, count: int, size: float) -> list[shapely.Polygon]:
    """Return courses of bricks of different heights and widths, flush or in bond."""
    found, y = [], 0.0
    while len(found) < count:
        height, x = size * rng.uniform(0.05, 0.3), 0.0
        while x < size and len(found) < count:
            width = size * rng.uniform(0.05, 0.8)
            found.append(shapely.box(x, y, x + width, y + height))
            x += width
        y += height
    return found


def jointed(rng: np.random.Generator, count: int, size: float) -> list[shapely.Polygon]:
    """Return what two joint sets leave of a square."""
    found = [shapely.box(0.0, 0.0, size, size)]
    for dip in rng.uniform(0.0, np.pi, 2):
        along = np.array([np.cos(dip), np.sin(dip)])
        for offset in np.arange(-size, size, 2.0 * size / np.sqrt(count) * rng.uniform(0.4, 1.0)):
            at = 0.5 * size + offset * np.array([-along[1], along[0]])
            trace = shapely.LineString([at - 3 * size * along, at + 3 * size * along])
            found = [p for one in found for p in shapely.ops.split(one, trace).geoms]
    return found


def drawn(seed: int) -> Case:
    """Return the random system of this number as a case of some 50 to 150 steps."""
    rng = np.random.default_rng([20, seed])
    size = 10.0 ** rng.uniform(-1.0, 1.0)
    kind = rng.choice(["cells", "united", "united", "courses", "jointed"])
    count = int(rng.integers(3, 30))
    make = {"courses": courses, "jointed": jointed}.get(str(kind), cells)
    shapes = make(rng, count, size)
    if kind == "united":
        shapes = united(rng, shapes)
    if rng.random() < 0.5:  # loose: blocks that lay close, each shrunk and turned a little
        shapes = [
            shapely.affinity.scale(one, *([rng.uniform(0.9, 0.99)] * 2), origin=one.centroid)
            for one in shapes
        ]
    shapes = [shapely.remove_repeated_points(one, 1e-6 * size).normalize() for one in shapes]
    area = max(one.area for one in shapes)
    shapes = [one for one in shapes if one.is_valid and 1e-4 * area < one.area and is_thick(one)]
    about = shapely.Point(rng.uniform(0.0, size, 2))
    nearest = sorted(shapes, key=about.distance)[: int(rng.integers(2, 11))]
    return Case.model_validate(_tables(rng, nearest, size))


def is_thick(shape: shapely.Polygon) -> bool:
    """Return whether no edge is shorter than a hundredth of the polygon's width."""
    points = np.asarray(shape.exterior.coords)
    shortest = np.hypot(*np.diff(points, axis=0).T).min()
    return bool(shortest > 0.01 * np.sqrt(shape.area))


def _tables(rng: np.random.Generator, shapes: list[shapely.Polygon], size: float) -> dict[str, Any]:
    young = 10.0 ** rng.uniform(7.0, 10.5)
    share = 10.0 ** rng.uniform(-3.0, np.log10(50.0))
    step = 10.0 ** rng.uniform(np.log10(2e-4), np.log10(2e-2))
    speed = 10.0 ** rng.uniform(-1.5, 1.0) * rng.choice([0.0, 1.0, 1.0, 1.0])
    strength = 10.0 ** rng.uniform(4.0, 7.0) * (rng.random() < 0.2)
    inwards = rng.uniform(0.0, 2.0) * (rng.random() < 0.7)
    middle = shapely.union_all(shapes).centroid
    blocks = []
    for k, one in enumerate(shapes):
        away = np.array([one.centroid.x - middle.x, one.centroid.y - middle.y, 0.0])
        own = rng.uniform(-1.0, 1.0, 3) - inwards * away / (np.hypot(away[0], away[1]) + 1e-9)
        blocks.append(
            {
                "name": str(k + 1),
                "vertices": np.asarray(one.exterior.coords)[:-1][::-1].tolist(),
                "velocity": (speed * own * (1.0, 1.0, 1.0 / size)).tolist(),
            }
        )
    if rng.random() < 0.5:
        base = [[-size, -0.3 * size], [2.5 * size, -0.3 * size], [2.5 * size, 0], [-size, 0]]
        blocks.insert(0, {"name": "base", "vertices": base, "fixed": True})
    return {
        "schema": 1,
        "title": "random system",
        "plane": str(rng.choice(["stress", "strain"])),
        "gravity": [0.0, -9.81 * float(rng.choice([0.0, 1.0, 1.0]))],
        "time": {"step": step, "end": step * int(rng.integers(50, 150))},
        "rock": {
            "r": {
                "young": young,
                "poisson": rng.uniform(0.0, 0.35),
                "density": rng.uniform(1500.0, 3000.0),
            }
        },
        "joint": {
            "default": {
                "friction_angle": rng.uniform(1.7, 60.0) * (rng.random() < 0.9),
                "cohesion": strength,
                "tensile_strength": 0.5 * strength,
            }
        },
        "block": blocks,
        "method": {
            "process": "convex",
            "contact_law": {"name": "penalty", "normal_stiffness": share * young},
        },
    }


# --- looking at what came out ----------------------------------------------------------------


@dataclass(frozen=True)
class Overlap:
    """Two blocks whose outlines overlap."""

    blocks: tuple[str, str]
    depth: float
    """Diameter of the largest circle in what they share, m."""
    known: float
    """Penetration that contacts of the two know of, m."""


@dataclass(frozen=True)
class Outcome:
    """What came out of a random system."""

    run: Run
    unseen: tuple[Overlap, ...]
    """Overlaps of frames that are deeper than contacts know, each pair's worst."""
    gain: float
    """Largest energy beyond that of the start over the energy turned over."""
    share: float
    """p/E."""


def overlaps(model: Model, state: State) -> list[Overlap]:
    """Return every pair of blocks whose outlines overlap, by clipping polygons."""
    shapes = [shapely.Polygon(one) for one in np.split(state.vertices, model.block_start[1:-1])]
    memory, found = state.memory, []
    own = model.vertex_block[memory.vertex]
    for i, j in shapely.STRtree(shapes).query(shapes).T:
        if i >= j or (model.fixed[i] and model.fixed[j]):
            continue
        shared = shapely.intersection(
            shapes[i], shapes[j], grid_size=1e-9 * float(np.sqrt(shapes[i].area))
        )
        if shared.area < 1e-12 * shapes[i].area:
            continue
        parts = [part for part in shapely.get_parts(shared) if part.area > 0.0]
        depth = 2.0 * max(shapely.maximum_inscribed_circle(part).length for part in parts)
        of_pair = ((own == i) & (memory.block == j)) | ((own == j) & (memory.block == i))
        known = float(max(0.0, -memory.gap[of_pair].min(initial=0.0)))
        names = model.block_name[i], model.block_name[j]
        found.append(Overlap(names, depth, known))
    return found


class Watching(RunRecorder):
    """Looks at the overlaps of every frame."""

    def __init__(self, model: Model, slack: float) -> None:
        super().__init__(model)
        self.slack, self.worst = slack, dict[tuple[str, str], Overlap]()

    def frame(
        self,
        state: State,
        contacts: Contacts | None = None,
        response: ContactResponse | None = None,
    ) -> None:
        """Keep each pair's worst overlap."""
        super().frame(state, contacts, response)
        for one in overlaps(self._model, state):
            before = self.worst.get(one.blocks)
            beyond = one.depth - 1.5 * one.known
            if beyond > self.slack and (
                before is None or beyond > before.depth - 1.5 * before.known
            ):
                self.worst[one.blocks] = one


def outcome(case: Case) -> Outcome:
    """Return what comes out of a random system, looked at in twenty frames."""
    model = case.model()
    method = case.method(model)
    size = float(np.sqrt(model.area.min()))
    recorder = Watching(model, 1e-4 * size)
    schedule = replace(case.schedule(), every=case.time.end / 20)
    try:
        run = simulate(model, method, schedule, recorder=recorder)
    except RunStopped as stopped:
        run = stopped.run  # type: ignore[assignment]
    energy = run.energy
    stored = sum(
        energy[name] for name in ("kinetic", "elastic", "gravity", "contact", "fixed_points")
    )
    held = stored - energy["loads"]
    # what bonds over gaps and coordinates that are rounded hold from the start shows in a step
    gain = float((held - held[:2].max()).max())
    rounding = 0.5 * method.contact_law.normal_stiffness * (1e-6 * size) ** 2
    turned_over = max(float(energy["kinetic"].max()), float(np.ptp(energy["gravity"])), rounding)
    share = method.contact_law.normal_stiffness / model.stiffest
    return Outcome(run, tuple(recorder.worst.values()), gain / turned_over, share)
