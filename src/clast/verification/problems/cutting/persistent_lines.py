"""Blocks between persistent joints: Euler's formula, areas and intensity."""

import numpy as np

from clast.rockmass import Baecher, Circle, Cut, Exponential, JointSet, Opening, cut
from clast.verification.fixtures import CUT, areas, drawing_of, rectangle
from clast.verification.problems import Floats, Trial, box, problem

WIDTH, HEIGHT = 10.0, 8.0
"""Sides of the domain, m."""
SETS = (
    JointSet(name="A", angle=30.0, spacing=1.3, origin=(0, 0), joint="a"),
    JointSet(name="B", angle=115.0, spacing=0.9, origin=(0.2, 0.1), joint="b"),
)
SCALES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Sides of further domains over those of the first."""
EXACT = "a count"
ROUND_OFF = "round-off; corners lie on the exact outlines"
GRID = "nodes are rounded to a grid of 1e-5 m"


def network(scale: float = 1.0) -> Cut:
    """Return the blocks of both sets in the domain, or in one so many times as large."""
    return cut(rectangle(scale * WIDTH, scale * HEIGHT, smallest_block=0.0), SETS)


def exact_lines(one: JointSet, scale: float = 1.0) -> Floats:
    """Return where the lines of a set enter and leave the domain, by hand, m, shape (n, 2, 2)."""
    angle = np.radians(float(one.angle or 0.0))
    along = np.array([np.cos(angle), np.sin(angle)])
    normal = np.array([-along[1], along[0]])
    corners = scale * np.array(box(0, 0, WIDTH, HEIGHT))
    offsets = (corners - np.array(one.origin)) @ normal / float(str(one.spacing))
    low, high = np.zeros(2), scale * np.array([WIDTH, HEIGHT])
    lines = []
    for k in range(int(np.ceil(offsets.min())), int(np.floor(offsets.max())) + 1):
        foot = np.array(one.origin) + k * float(str(one.spacing)) * normal
        displacements = np.sort((np.stack([low, high]) - foot) / along, axis=0)
        lines.append(
            foot + np.stack([displacements[0].max() * along, displacements[1].min() * along])
        )
    return np.array(lines)


def exact_crossings(one: Floats, other: Floats) -> int:
    """Return how many lines (n, 2, 2) of one set cross those of another inside the domain."""
    a, b = one[:, None, 0], one[:, None, 1]
    c, d = other[None, :, 0], other[None, :, 1]

    def side(p: Floats, q: Floats, at: Floats) -> Floats:
        return np.asarray((q - p)[..., 0] * (at - p)[..., 1] - (q - p)[..., 1] * (at - p)[..., 0])

    apart = side(a, b, c) * side(a, b, d) < 0.0
    return int((apart & (side(c, d, a) * side(c, d, b) < 0.0)).sum())


def exact_blocks(scale: float = 1.0) -> int:
    """Return 1 + L + X."""
    first, second = (exact_lines(one, scale) for one in SETS)
    return 1 + len(first) + len(second) + exact_crossings(first, second)


def exact_intensity() -> float:
    """Return the length of all lines over the area, m/m2."""
    lines = np.concatenate([exact_lines(one) for one in SETS])
    return float(np.hypot(*(lines[:, 1] - lines[:, 0]).T).sum()) / (WIDTH * HEIGHT)


def exact_cell() -> float:
    """Return the area of a block between two neighbours of each set, s1 s2/sin(angle), m2."""
    between = np.radians(float(SETS[1].angle or 0.0) - float(SETS[0].angle or 0.0))
    return float(np.prod([float(str(one.spacing)) for one in SETS]) / np.sin(between))


def euler(rock_mass: Cut) -> tuple[int, int]:
    """Return edges less vertices plus parts of the blocks drawn once, and faces: the same number.

    Of blocks without holes, in one piece, F = E - V + 1; a void inside them is a face as well.
    """
    nodes, at = np.unique(rock_mass.vertices, axis=0, return_inverse=True)
    after = np.arange(len(at)) + 1
    after[rock_mass.block_start[1:] - 1] = rock_mass.block_start[:-1]
    edges = np.unique(np.sort(np.stack([at.ravel(), at.ravel()[after]], axis=1), axis=1), axis=0)
    voids = 1
    return len(edges) - len(nodes) + 1, rock_mass.block_count + voids


def traces_about_a_tunnel() -> Cut:
    """Return the blocks that traces cut about a circular void, wherever they end."""
    traces = [
        JointSet(
            name=f"traces at {angle:g}",
            model=Baecher(),
            angle=angle,
            intensity=2.0,
            trace_length=Exponential(mean=4.0),
        )
        for angle in (20.0, 100.0)
    ]
    tunnel = Opening(name="tunnel", shape=Circle(center=(5, 4), radius=1.5), excavated=True)
    return cut(rectangle(WIDTH, HEIGHT), traces, openings=[tunnel], seed=1)


@problem(set_up=lambda: drawing_of(network(), "Two persistent sets"), variants=(CUT,), quick=(CUT,))
def persistent_lines(trial: Trial) -> None:
    """Blocks between persistent joints.

    Two sets of endless joints, at 30 degrees every 1.3 m and at 115 degrees every 0.9 m, cut 10 m x
    8 m; small blocks are kept. Then traces of two sets that end anywhere are cut about a tunnel:
    what borders nothing is taken out, and blocks have no holes.

    Exact: 1 + L + X blocks of L lines and X crossings; F = E - V + 1; a whole cell has s1 s2/sin(85
    degrees); the areas sum up to the domain's.
    Source: Euler's formula for planar graphs in one piece.
    """
    rock_mass, report = network(), network().report
    sizes = areas(rock_mass)
    by_hand, faces = euler(traces_about_a_tunnel())
    trial.absolute("blocks, 1 + L + X", "", report.blocks, exact_blocks(), 0.0, EXACT)
    trial.absolute("blocks foreseen", "", report.estimate, exact_blocks(), 0.0, EXACT)
    for one, said in zip(SETS, report.sets, strict=True):
        lines = len(exact_lines(one))
        trial.absolute(f"lines of set {one.name}", "", said.lines, lines, 0.0, EXACT)
    trial.relative("sum of the areas", "m2", sizes.sum(), WIDTH * HEIGHT, 1e-12, ROUND_OFF)
    quantity, reason = "length of joints per area", "lines are drawn before they are rounded"
    computed = sum(one.p21 for one in report.sets)
    trial.relative(quantity, "m/m2", computed, exact_intensity(), 1e-9, reason)
    trial.relative("area of a whole cell", "m2", float(np.median(sizes)), exact_cell(), 1e-4, GRID)
    quantity = "blocks and the void of traces about a tunnel, E - V + 1"
    trial.absolute(quantity, "", faces, by_hand, 0.0, EXACT)
    fine = np.geomspace(SCALES[0], SCALES[-1], 60)
    chart = trial.chart("blocks between two sets", "width of the domain, m", "blocks", log="y")
    chart.exact("1 + L + X", WIDTH * fine, [exact_blocks(float(scale)) for scale in fine])
    chart.computed(WIDTH * np.array(SCALES), [network(scale).block_count for scale in SCALES])
