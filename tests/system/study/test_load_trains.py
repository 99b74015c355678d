"""An arch bridge with fill under a lorry, beside limit analysis by linear programming.

The analysis knows nothing of clast's fill and axles: it adds up weights and loads along a fine
division of the road.
"""

import tomllib

import numpy as np
import pytest

import clast
from clast.case.templates import TEMPLATES
from clast.study.collapsing.search import FactorSettings
from clast.verification.limit_analysis import (
    NoEquilibriumError,
    joint_ends,
    largest_factor,
    voussoirs_between,
)

CASE = tomllib.loads(TEMPLATES["arch-bridge"])
(FILL,), (TRAIN,) = CASE["fill"], CASE["load_train"]
(LEFT, ROAD), (RIGHT, _) = TRAIN["path"]
INNER, OUTER = (ends - (0.0, 2.75) for ends in joint_ends(5.8, 0.6 / 5.8, 120.0, 21))
GRAVITY, DENSITY, SAMPLES = 9.8, 2400.0, 20_000
POSITIONS = (12.0, 12.5, 13.0, 13.5, 14.0)
"""Places of the front axle about the worst of all, m."""
WORST = 13.0
TOLERANCE = 0.004


def divided():
    """Return middles of parts of the road, their length, the surface below, its voussoir."""
    width = (RIGHT - LEFT) / SAMPLES
    x = LEFT + width * (np.arange(SAMPLES) + 0.5)
    over = np.abs(x) < OUTER[0, 0]
    y = np.where(over, np.interp(x, *OUTER[::-1].T), OUTER[0, 1])
    return x, width, y, np.where(over, 20 - np.searchsorted(OUTER[1:-1, 0][::-1], x), -1)


def footprint(x, y, at: float):
    """Return the parts of the road that an axle presses on, those in its shadow left out."""
    reach = 0.5 * TRAIN["contact_length"] + np.tan(np.radians(TRAIN["spread_angle"])) * (ROAD - y)
    inside, middle = np.abs(x - at) <= reach, int(np.searchsorted(x, at))
    last = middle + int(np.argmin(np.append(inside[middle:], False)))
    first = middle - int(np.argmin(np.append(inside[: middle + 1][::-1], False))) + 1
    return np.arange(first, last)


def exact_factor(position: float) -> float:
    """Return how many lorries the bridge carries by limit analysis; infinity for any number."""
    arch = voussoirs_between(INNER, OUTER, CASE["joint"]["default"]["friction_angle"])
    x, width, y, stone = divided()
    live = np.zeros(SAMPLES)
    for behind, load in zip(TRAIN["axles"], TRAIN["loads"], strict=True):
        if 0.0 <= position - behind <= RIGHT - LEFT:
            foot = footprint(x, y, LEFT + position - behind)
            live[foot] += load / len(foot)
    loads = []
    for amount in (FILL["density"] * GRAVITY * width * (ROAD - y), live):
        total = np.zeros(63)
        for k in range(21):
            part = amount * (stone == k)
            if size := part.sum():
                middle = np.array([(part * x).sum(), (part * y).sum()]) / size
                total += arch.force_at(k, middle, np.array([0.0, -size]))
        loads.append(total)
    dead = arch.body_force((0.0, -DENSITY * GRAVITY)) + loads[0]
    try:
        return largest_factor(arch, dead, loads[1])
    except NoEquilibriumError:
        return np.inf


def bridge(position: float) -> clast.Case:
    return clast.Case.from_toml(TEMPLATES["arch-bridge"], [f"load_train.1.position={position}"])


def mirrored(position: float) -> clast.ModelBuilder:
    """Return the bridge from behind, its blocks in another order, the fill in two parts."""
    builder = clast.ModelBuilder(title="The bridge from behind")
    builder.add_rock("stone", **CASE["rock"]["stone"])
    builder.add_joint(**CASE["joint"]["default"])
    for one in CASE["block"][::-1]:
        corners = [(-x, y) for x, y in one["vertices"]][::-1]
        builder.block(name=one["name"], vertices=corners, fixed=one.get("fixed", False))
    for ends in ((LEFT, -1.2), (-1.2, RIGHT)):
        builder.fill([(x, ROAD) for x in ends], FILL["density"])
    for behind, load in zip(TRAIN["axles"][::-1], TRAIN["loads"][::-1], strict=True):
        keys = {key: TRAIN[key] for key in ("spread_angle", "contact_length", "name")}
        path = [(RIGHT, ROAD), (LEFT, ROAD)]
        builder.load_train(path, position - behind, [0.0], [load], **keys)
    return builder


def test_the_worst_position_of_a_sweep_is_that_of_limit_analysis(tmp_path):
    exact = {one: exact_factor(one) for one in np.arange(1.0, 18.0, 0.5)}
    assert min(exact, key=exact.__getitem__) == WORST
    study = clast.Study(
        bridge(WORST),
        vary={"load_train.lorry.position": list(POSITIONS)},
        measure={"factor": "factor_of_safety()"},
        factor=FactorSettings(by="load lorry", tolerance=TOLERANCE),
    )
    table = study.run(tmp_path / "line", workers=1)
    found = dict(zip(POSITIONS, table["factor"], strict=True))
    assert min(found, key=found.__getitem__) == WORST
    for position, factor in found.items():
        assert factor == pytest.approx(exact[position], rel=0.01)


def test_the_bridge_from_behind_with_axles_apart_carries_the_same():
    keys = {"end": 0.6, "step": 1e-2, "dynamic_ratio": 0.0}
    factors = [
        clast.collapse_load(case, "load lorry", tolerance=TOLERANCE).low
        for case in (bridge(4.5), mirrored(4.5).case(**keys))
    ]
    assert factors[0] == pytest.approx(factors[1], rel=TOLERANCE)
    assert factors[0] == pytest.approx(exact_factor(4.5), rel=0.01)
