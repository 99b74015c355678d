"""Random networks of joints, and what every cut has to keep."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from clast.inputs.builder import InputBuilder
from clast.rockmass import (
    Baecher,
    Box,
    Circle,
    CrossJointed,
    Cut,
    Domain,
    Exponential,
    Horseshoe,
    JointSet,
    Lognormal,
    Normal,
    Opening,
    PoissonLines,
    Region,
    Trace,
    Uniform,
    Veneziano,
    VonMises,
    Voronoi,
)


def assert_tiles(found: Cut, area: float | None = None) -> None:
    """Blocks are simple, counter-clockwise, do not overlap, share whole edges and fill the area."""
    start, vertices = found.block_start, found.vertices
    owner = np.repeat(np.arange(found.block_count), np.diff(start))
    local = vertices - vertices.min(axis=0)
    shapes = shapely.polygons(shapely.linearrings(local, indices=owner))
    assert shapely.is_valid(shapes).all()
    assert shapely.is_ccw(shapely.get_exterior_ring(shapes)).all()
    report = found.report
    total = shapely.area(shapes).sum()
    assert report.blocks == found.block_count
    assert abs(total / report.area - 1.0) < 1e-12
    expected = report.domain_area if area is None else area
    assert abs(report.domain_area / expected - 1.0) < 1e-9, (report.domain_area, expected)
    assert abs(total / expected - 1.0) < 1e-9, (total / expected - 1.0, report.notes)
    # The blocks cover as much together as they have areas: none lies on another.
    assert abs(shapely.coverage_union_all(shapes).area / total - 1.0) < 1e-9
    assert shapely.coverage_is_valid(shapes)
    here = {}
    for block in range(found.block_count):
        loop = [tuple(at) for at in found.polygon(block).tolist()]
        assert len(set(loop)) == len(loop) >= 3
        for k, (a, b) in enumerate(zip(loop, loop[1:] + loop[:1], strict=True)):
            assert (a, b) not in here, "two blocks on one side of an edge"
            here[a, b] = int(found.edge_joint[start[block] + k])
    alone = [edge for edge in here if edge[::-1] not in here]
    assert all(here[edge] == -1 for edge in alone)
    assert all(here[edge] == here[edge[::-1]] for edge in here if edge[::-1] in here)
    # What has no other block beside it is an outline, all along.
    lines = shapely.union_all(shapely.linestrings(np.array(alone) - vertices.min(axis=0)))
    rim = shapely.boundary(shapely.coverage_union_all(shapes))
    assert abs(lines.length - rim.length) < 1e-9 * rim.length


def built(found: Cut) -> Any:
    """Return the model of the blocks: clast's own checks have looked at them."""
    builder = InputBuilder()
    for name in found.rock_names:
        builder.add_rock(name, young=50e9, poisson=0.2, density=2700.0)
    builder.blocks(vertices=found.vertices, start=found.block_start, rock=found.rock_names[0])
    return builder.build()


def random_boundary(rng: np.random.Generator, size: float) -> np.ndarray:
    """Return a star-shaped boundary, m, shape (k, 2), either way round."""
    count = int(rng.integers(3, 9))
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, count))
    gaps = np.diff(np.append(angle, angle[0] + 2.0 * np.pi))
    if gaps.max() > 2.8 or gaps.min() < 0.1:
        angle = 2.0 * np.pi * (np.arange(count) + 0.3) / count
    radius = size * rng.uniform(0.4, 1.0, count)
    corners = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corners += rng.choice([0.0, 1e3, 5e5]) * rng.uniform(0.5, 1.0, 2)
    return corners[::-1] if rng.random() < 0.3 else corners


def random_network(seed: int, blocks: float) -> tuple[Domain, dict[str, Any]]:
    """Return a domain and the arguments of ``cut`` for about so many blocks."""
    rng = np.random.default_rng(seed)
    size = float(rng.choice([1.0, 30.0, 400.0]))
    if rng.random() < 0.4:
        low = rng.choice([0.0, 4.2e5]) * rng.uniform(0.5, 1.0, 2)
        width, height = size * rng.uniform(0.5, 1.5, 2)
        boundary = low + np.array([[0, 0], [width, 0], [width, height], [0, height]])
    else:
        boundary = random_boundary(rng, size)
    outline = shapely.Polygon(boundary)
    spacing = np.sqrt(outline.area / blocks)
    sets = _random_sets(rng, spacing)
    middle = np.array(outline.representative_point().coords[0])
    low, high = boundary.min(axis=0), boundary.max(axis=0)
    traces = [
        Trace(points=rng.uniform(low, high, (int(rng.integers(2, 5)), 2)), joint="fault")
        for _ in range(int(rng.integers(0, 4)))
    ]
    traces = [
        t for t in traces if shapely.LineString(t.points).intersects(outline.buffer(-1e-3 * size))
    ]
    regions = []
    if rng.random() < 0.4:
        cut_too = "contact" if rng.random() < 0.5 else None
        regions.append(
            Region(name="bed", polygon=middle + 0.4 * size * _box(rng), rock="shale", joint=cut_too)
        )
    openings = _random_openings(rng, middle, size)
    return Domain(boundary=boundary), {
        "sets": sets,
        "traces": traces,
        "openings": openings,
        "regions": regions,
        "seed": seed,
    }


def _box(rng: np.random.Generator) -> np.ndarray:
    w, h = rng.uniform(0.2, 1.0, 2)
    return np.array([[-w, -h], [w, -h], [w, h], [-w, h]])


def _random_openings(rng: np.random.Generator, middle: np.ndarray, size: float) -> list[Opening]:
    kind = int(rng.integers(0, 6))
    excavated, joint = bool(rng.random() < 0.6), bool(rng.random() < 0.7)
    r = 0.15 * size * rng.uniform(0.5, 1.5)
    shapes: list[Any] = [
        Circle(center=middle, radius=r),
        Horseshoe(center=middle, width=2 * r, wall_height=r),
        Box(corner=middle - 0.5 * r, size=(r, 2 * r)),
    ]
    if kind >= len(shapes):
        return []
    return [
        Opening(name="heading", shape=shapes[kind], excavated=excavated, construction_joint=joint)
    ]


def _random_sets(rng: np.random.Generator, s: float) -> list[JointSet]:
    spreads = [s, Normal(mean=s, sd=0.3 * s), Lognormal(mean=s, sd=0.5 * s), Exponential(mean=s)]
    spreads.append(Uniform(low=0.5 * s, high=1.5 * s))

    def angle() -> float:
        return float(rng.choice([0.0, 30.0, 45.0, 90.0, rng.uniform(0.0, 180.0)]))

    def spread() -> Any:
        return spreads[int(rng.integers(len(spreads)))]

    scatter = VonMises(kappa=float(rng.choice([20.0, 200.0]))) if rng.random() < 0.5 else None
    choices = [
        lambda k: JointSet(name=k, angle=angle(), spacing=spread(), joint=k),
        lambda k: JointSet(
            name=k,
            angle=angle(),
            spacing=spread(),
            trace_length=6.0 * s,
            bridge_length=1.0 * s,
            stagger=0.5,
            angle_spread=scatter,
        ),
        lambda k: JointSet(
            name=k,
            model=Baecher(),
            angle=angle(),
            intensity=1.0 / s,
            joint=k,
            trace_length=Exponential(mean=5.0 * s),
            angle_spread=scatter,
        ),
        lambda k: JointSet(name=k, model=Baecher(), intensity=1.5 / s, trace_length=4.0 * s),
        lambda k: JointSet(
            name=k,
            model=Veneziano(),
            angle=angle(),
            intensity=1.0 / s,
            trace_length=5.0 * s,
            bridge_length=s,
            joint=k,
            angle_spread=scatter,
        ),
        lambda k: JointSet(name=k, model=PoissonLines(), intensity=1.5 / s, joint=k),
        lambda k: JointSet(name=k, model=Voronoi(), spacing=1.3 * s, joint=k),
    ]
    count = int(rng.integers(1, 4))
    found = [choices[int(rng.integers(len(choices)))](f"set {k}") for k in range(count)]
    if rng.random() < 0.3:
        found.append(
            JointSet(
                name="cross",
                model=CrossJointed(),
                angle=angle(),
                spacing=1.5 * s,
                joint="cross",
                terminates_at=["set 0"],
                stagger=0.5,
            )
        )
    return found
