"""Blocks between joints of random spacing: how many there are, and how large.

Spacings are exponential, so that the lines of each set are a Poisson process along its normal:
N = (1 + N1)(1 + N2) blocks with N1 and N2 of means l1 W and l2 H.  A block is the product of two
independent exponential lengths; P(A > a) is the integral of l1 exp(-l1 x - l2 a/x), which is
z K1(z) with z = 2 sqrt(l1 l2 a).

Blocks that end at the right or the top of the domain are left out.  Each network counts with the
share of its own blocks, for larger networks have smaller blocks: weighting by their numbers would
be biased.
"""

import numpy as np
from scipy import special

from clast.rockmass import Exponential, JointSet, cut
from clast.verification.fixtures import CUT, areas, drawing_of, rectangle
from clast.verification.problems import Floats, Model, Trial, problem

WIDTH, HEIGHT = 40.0, 30.0
"""Sides of the domain, m."""
UPRIGHT, LEVEL = 0.5, 0.8
"""Lines per m of upright and of level joints, l1 and l2."""
AREAS = np.array([0.5, 1.0, 2.5, 5.0, 10.0])
"""Areas a that blocks are compared with, m2."""
SETS = (
    JointSet(name="upright", angle=90.0, spacing=Exponential(mean=1.0 / UPRIGHT)),
    JointSet(name="level", angle=0.0, spacing=Exponential(mean=1.0 / LEVEL)),
)
SEEDS, FEW = 400, 40
"""Networks, and where time is short."""
ERRORS = 3.0
"""Tolerance of means, in standard errors."""
KOLMOGOROV = 1.628
"""One sample of n in a hundred has a distribution farther than this/sqrt(n) from its own."""


def exact_mean() -> float:
    """Return E[N]."""
    return (1.0 + UPRIGHT * WIDTH) * (1.0 + LEVEL * HEIGHT)


def exact_deviation() -> float:
    """Return the standard deviation of N: variances of products of independent numbers."""
    one, other = UPRIGHT * WIDTH, LEVEL * HEIGHT
    square = (one + (1.0 + one) ** 2) * (other + (1.0 + other) ** 2)
    return float(np.sqrt(square - exact_mean() ** 2))


def exact_share(area: Floats) -> Floats:
    """Return P(A > a)."""
    z = 2.0 * np.sqrt(UPRIGHT * LEVEL * area)
    return np.asarray(z * special.k1(z))


def of_network(seed: int) -> tuple[int, Floats]:
    """Return the number of blocks of a network, and the areas of those that end inside, m2."""
    rock_mass = cut(rectangle(WIDTH, HEIGHT, smallest_block=0.0), SETS, seed=seed)
    high = np.maximum.reduceat(rock_mass.vertices, rock_mass.block_start[:-1], axis=0)
    inside = (high < np.array([WIDTH, HEIGHT]) - 1e-6).all(axis=1)
    return rock_mass.block_count, areas(rock_mass)[inside]


def distance(sample: Floats) -> float:
    """Return the largest distance between the distribution of areas and its own, Kolmogorov's."""
    below = 1.0 - exact_share(np.sort(sample))
    step = np.arange(len(sample) + 1) / len(sample)
    return float(max((step[1:] - below).max(), (below - step[:-1]).max()))


def _drawing() -> Model:
    rock_mass = cut(rectangle(WIDTH, HEIGHT, smallest_block=0.0), SETS, seed=1)
    return drawing_of(rock_mass, "Two sets of random spacing")


@problem(set_up=_drawing, variants=(CUT,), quick=(CUT,), few=(FEW,))
def random_spacing(trial: Trial, seeds: int = SEEDS) -> None:
    """Blocks between joints of random spacing.

    Upright and level joints of exponential spacing, 0.5 and 0.8 lines a metre, cut 40 m x 30 m, 400
    times.

    Exact: E[N] = (1 + l1 W)(1 + l2 H) = 525, deviation 153.5; P(A > a) = z K1(z), z = 2 sqrt(l1 l2
    a).
    Source: Poisson processes; the distribution of the product of two exponential lengths.
    """
    networks = [of_network(seed) for seed in range(seeds)]
    counts = np.array([count for count, _ in networks], float)
    shares = np.array([(own[:, None] > AREAS).mean(axis=0) for _, own in networks])
    one_each = np.array(
        [np.random.default_rng(seed).choice(own) for seed, (_, own) in enumerate(networks)]
    )
    root = np.sqrt(seeds)
    of_mean = f"three standard errors of the mean of {seeds} networks"
    quantity, computed = "mean number of blocks", counts.mean()
    trial.absolute(quantity, "", computed, exact_mean(), ERRORS * exact_deviation() / root, of_mean)
    trial.relative(
        "deviation of the number of blocks",
        "",
        counts.std(ddof=1),
        exact_deviation(),
        ERRORS / np.sqrt(2.0 * seeds),
        f"three standard errors of the deviation of {seeds} networks",
    )
    errors = ERRORS * shares.std(axis=0, ddof=1) / root
    for area, share, exact, error in zip(
        AREAS, shares.mean(axis=0), exact_share(AREAS), errors, strict=True
    ):
        trial.absolute(f"share of blocks above {area:g} m2", "", share, exact, error, of_mean)
    quantity = "distance of the distributions of areas"
    reason = "Kolmogorov's for one block of each network, exceeded by one sample in a hundred"
    trial.absolute(quantity, "", distance(one_each), 0.0, KOLMOGOROV / root, reason)
    fine, marks = np.geomspace(0.02, 15.0, 100), np.geomspace(0.02, 15.0, 25)
    larger = np.mean([(own[:, None] > marks).mean(axis=0) for _, own in networks], axis=0)
    labels = ("area a, m²", "share of blocks that are larger")
    chart = trial.chart("areas of blocks", *labels, log="x")
    chart.exact("z K₁(z)", fine, exact_share(fine))
    chart.computed(marks, larger)
