"""Static stages of what bends: walls and bars near buckling, frames that lean, chains that fall."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import clast
from clast import Stage
from clast.verification.problems.masonry import wall_buckling

WIDTH, STIFFNESS = 0.3, 2e9


def wall(
    courses: int,
    load: float,
    off: float,
    gravity: float,
    mirror: float,
    angle: float,
    over: float = 0.0,
) -> tuple[clast.Model, np.ndarray]:
    """Return a dry wall of 3 m under a load off its middle, and the direction of its sway."""
    turn = np.radians(angle)
    across = mirror * np.array([np.cos(turn), np.sin(turn)])
    up = np.array([-np.sin(turn), np.cos(turn)])
    builder = clast.ModelBuilder(gravity=tuple(-gravity * up))
    builder.add_rock("stone", young=1e12, poisson=0.0, density=2000.0)
    builder.add_joint(friction_angle=40.0, normal_stiffness=STIFFNESS, shear_stiffness=STIFFNESS)

    def box(name: str, half: float, low: float, high: float, fixed: bool = False) -> None:
        corners = [(-half, low), (half, low), (half, high), (-half, high)][:: int(mirror)]
        builder.block(vertices=[x * across + y * up for x, y in corners], name=name, fixed=fixed)

    box("base", 2.0, -1.0, 0.0, True)
    for k in range(courses):
        box(f"course {k + 1}", 0.5 * WIDTH, 3.0 * k / courses, 3.0 * (k + 1) / courses)
    grows = {}
    if over:
        builder.add_amplitude("up", [0.0, over], [0.0, 1.0])
        grows = {"amplitude": "up"}
    builder.point_load(off * across + 3.0 * up, -load * up, block=f"course {courses}", **grows)
    builder.measured_point("top", 3.0 * up, block=f"course {courses}")
    return builder.build(), across


def loaded(model: clast.Model, **settings: float) -> clast.Run:
    """Return one static stage until its equilibrium."""
    settings = {"end": 20.0, "step": 0.02, **settings}
    return clast.simulate(model, stages=[Stage(name="load")], dynamic_ratio=0.0, **settings)


@pytest.mark.parametrize("courses", [3, 12, 24])
@pytest.mark.parametrize(("share", "off"), [(1.02, 1e-5), (1.1, 1e-4), (1.5, 1e-3)])
def test_a_wall_beyond_its_buckling_load_fails(courses: int, share: float, off: float):
    load = share * wall_buckling.buckling_load(courses)
    run = loaded(wall(courses, load, off, 9.8, 1, 37.0)[0])
    (record,) = run.stages
    assert record.outcome == "fails"
    assert record.mechanism[0] == f"course {courses}"
    assert record.steps <= 50


def bars(young: float, ends: Sequence[tuple[np.ndarray, np.ndarray]]) -> clast.ModelBuilder:
    """Return bars with pointed ends from place to place, and a fixed block far from them."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("bar", young=young, poisson=0.0, density=2000.0)
    builder.add_joint(friction_angle=0.0)
    builder.block(vertices=[(-9, -9), (-8, -9), (-8, -8), (-9, -8)], name="ground", fixed=True)
    for k, (first, last) in enumerate(ends):
        way = last - first
        side = 0.05 * np.array([-way[1], way[0]]) / np.hypot(*way)
        near, far = first + 0.1 * way, last - 0.1 * way
        outline = [first, near - side, far - side, last, far + side, near + side]
        builder.block(vertices=outline, name=f"bar {k + 1}")
    return builder


@pytest.mark.parametrize("young", [2e9, 2e12])
@pytest.mark.parametrize("share", [0.5, 0.9, 1.2])
def test_two_bars_go_to_their_equilibrium_however_stiff_their_hinges_are(
    young: float, share: float
):
    spring, off = 1e5, 1e-3
    middle, top = np.array([off, 1.0]), np.array([0.0, 2.0])
    builder = bars(young, [(np.zeros(2), middle), (middle, top)])
    rigid = {"x": "rigid", "y": "rigid", "contacts": False}
    builder.link((0, 0), blocks=("ground", "bar 1"), **rigid)
    builder.link(middle, blocks=("bar 1", "bar 2"), **rigid, rotation=spring)
    builder.link(top, blocks=("ground", "bar 2"), x="rigid")
    load = share * 2.0 * spring
    builder.point_load(top, (0.0, -load), block="bar 2")
    builder.measured_point("middle", middle, block="bar 1")
    run = loaded(builder.build(), max_displacement=0.5)
    (record,) = run.stages
    assert record.outcome == "equilibrium"
    long = np.hypot(*middle)
    start = np.arcsin(off / long)

    def moment(turn: float) -> float:
        return float(2.0 * spring * (turn - start) - load * long * np.sin(turn))

    turn = brentq(moment, *((0.5, 3.0) if share > 1.0 else (0.0, 1.5)))
    right = long * np.sin(turn) - off
    # soft bars shorten, which counts 1/(1 - 0.9) times
    rel = 0.02 if young == 2e9 else 0.003
    assert run.history("middle").displacement[-1, 0] == pytest.approx(right, rel=rel)


@pytest.mark.parametrize("share", [0.5, 0.9, 1.1])
def test_a_frame_leans_to_its_equilibrium(share: float):
    spring, lateral = 1e5, 0.01
    builder = bars(2e11, [(np.array([x, 0.0]), np.array([x, 2.0])) for x in (0.0, 2.0)])
    beam = [(-0.1, 2.0), (2.1, 2.0), (2.1, 2.1), (-0.1, 2.1)]
    builder.block(vertices=beam, name="beam")
    rigid = {"x": "rigid", "y": "rigid", "contacts": False}
    for x, name in ((0.0, "bar 1"), (2.0, "bar 2")):
        builder.link((x, 0), blocks=("ground", name), **rigid, rotation=spring)
        builder.link((x, 2), blocks=(name, "beam"), **rigid)
    load = share * spring
    builder.point_load((1.0, 2.05), (lateral * load, -load), block="beam")
    builder.measured_point("beam", (1.0, 2.05), block="beam")
    run = loaded(builder.build(), max_displacement=0.5)
    assert run.stages[0].outcome == "equilibrium"

    def moment(turn: float) -> float:
        return float(2 * spring * turn - 2 * load * (np.sin(turn) + lateral * np.cos(turn)))

    right = 2.0 * np.sin(brentq(moment, 1e-9, 3.0))
    assert run.history("beam").displacement[-1, 0] == pytest.approx(right, rel=3e-3)


@pytest.mark.parametrize("dip", [10.0, 45.0])
def test_a_chain_falls_from_a_straight_v_to_its_catenary(dip: float):
    count = 20
    down = np.array([np.cos(np.radians(dip)), -np.sin(np.radians(dip))])
    ways = [down] * (count // 2) + [down * (1.0, -1.0)] * (count // 2)
    places = np.vstack([np.zeros(2), np.cumsum(ways, axis=0)])
    builder = bars(2e11, list(pairwise(places)))
    builder.gravity = (0.0, -9.8)
    names = ["ground", *(f"bar {k + 1}" for k in range(count)), "ground"]
    for at, one, other in zip(places, names[:-1], names[1:], strict=True):
        builder.link(at, blocks=(one, other), x="rigid", y="rigid", contacts=False)
    for k in range(1, count):
        builder.measured_point(f"{k}", places[k], block=f"bar {k}")
    run = loaded(builder.build(), max_displacement=0.5)
    assert run.stages[0].outcome == "equilibrium"
    # the vertical force in the middle of each bar, in weights of a bar, over the thrust
    lifted = np.arange(count) - 0.5 * (count - 1)

    def span(thrust: float) -> float:
        return float(np.sum(thrust / np.hypot(thrust, lifted)) - places[-1, 0])

    thrust = brentq(span, 1e-6, 1e6)
    bar = np.stack([np.full(count, thrust), lifted], axis=1) / np.hypot(thrust, lifted)[:, None]
    moved = [run.history(f"{k}").displacement[-1] for k in range(1, count)]
    assert np.abs(places[1:-1] + moved - np.cumsum(bar, axis=0)[:-1]).max() < 5e-4


def test_a_free_body_under_loads_that_balance_is_in_equilibrium():
    builder = bars(2e11, [(np.zeros(2), np.array([1.0, 0.0]))])
    for at, force in (((0.1, 0.0), (1e5, 0.0)), ((0.9, 0.0), (-1e5, 0.0))):
        builder.point_load(at, force, block="bar 1")
    run = loaded(builder.build())
    assert (run.stages[0].outcome, run.stages[0].steps) == ("equilibrium", 3)


def test_a_wall_loaded_in_its_middle_takes_no_step_more():
    model, across = wall(12, 0.5 * wall_buckling.buckling_load(12), 0.0, 9.8, 1, 0.0)
    run = loaded(model)
    assert (run.stages[0].outcome, run.stages[0].steps) == ("equilibrium", 4)
    assert abs(run.history("top").displacement[-1] @ across) < 1e-9


def seen(vectors: Sequence[Sequence[float]], view: np.ndarray) -> list[np.ndarray]:
    """Return vectors as a view has them, in the order that keeps outlines counter-clockwise."""
    turned = [view @ np.asarray(one, float) for one in vectors]
    return turned if np.linalg.det(view) > 0.0 else turned[::-1]


VIEWS = {
    "as drawn": (np.eye(2), 1),
    "mirrored": (np.diag([-1.0, 1.0]), 1),
    "numbered otherwise": (np.eye(2), -1),
    "turned": (np.array([[0.8, -0.6], [0.6, 0.8]]), 1),
}


def folding(spring: float, share: float, view: str = "as drawn", **method: str) -> clast.Run:
    """Return the run of two straight bars on a spring under a share of their buckling load."""
    turn, order = VIEWS[view]
    places = [np.array([0.0, y]) for y in (0.0, 1.0, 2.0)]
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("bar", young=2e11, poisson=0.0, density=0.02 * spring)
    builder.add_joint(friction_angle=0.0)
    ground = [(-9, -9), (-8, -9), (-8, -8), (-9, -8)]
    outlines = {"ground": ground}
    for k in (0, 1):
        sides = [(-0.05, k + 0.9), (-0.05, k + 0.1), (0, k), (0.05, k + 0.1), (0.05, k + 0.9)]
        outlines[f"bar {k + 1}"] = [*sides, (0, k + 1)]
    for name, outline in list(outlines.items())[::order]:
        builder.block(vertices=seen(outline, turn), name=name, fixed=name == "ground")
    first, middle, top = (turn @ one for one in places)
    rigid = {"x": "rigid", "y": "rigid", "contacts": False}
    builder.link(first, blocks=("ground", "bar 1"), **rigid)
    builder.link(middle, blocks=("bar 1", "bar 2"), **rigid, rotation=spring)
    builder.link(top, blocks=("ground", "bar 2"), x="rigid", direction=turn[:, 0])
    builder.point_load(top, turn @ (0.0, -share * 2.0 * spring), block="bar 2")
    return loaded(builder.build(), **method)


@pytest.mark.parametrize("rotation", ["exact", "sine"])
@pytest.mark.parametrize("spring", [1e5, 1.0, 1e-2])
def test_the_way_in_which_bars_fold_does_not_depend_on_units(spring: float, rotation: str):
    """A mode with w.K w = 1 turns the bars by 1 / sqrt(4 k) rad, of which no block knows."""
    branch = folding(spring, 1.5, rotation=rotation).stages[0].branch
    assert "towards +x" in branch or "towards -x" in branch


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize(("share", "branches"), [(0.99, False), (1.01, True), (3.0, True)])
def test_two_straight_bars_report_that_they_may_fold_to_either_side(
    view: str, share: float, branches: bool
):
    run = folding(1e5, share, view)
    (record,) = run.stages
    assert record.outcome == "equilibrium"
    assert ("more than one path" in record.branch) == branches
    assert any("more than one path" in one for one in run.report.warnings) == branches
    if branches:
        assert f" {share:.3g} times" in record.branch


@pytest.mark.parametrize("courses", [3, 12, 24])
@pytest.mark.parametrize(("share", "off", "branches"), [(0.95, 0, 0), (1.1, 0, 1), (1.1, 1e-4, 0)])
def test_a_wall_loaded_in_its_middle_reports_that_it_may_buckle_to_either_side(
    courses: int, share: float, off: float, branches: int
):
    load = share * wall_buckling.buckling_load(courses)
    run = loaded(wall(courses, load, off, 9.8, 1, 37.0)[0])
    assert bool(run.stages[0].branch) == bool(branches)
    assert ("unstable" in str(run.stages[0])) == bool(branches)


@pytest.mark.parametrize("share", [0.9, 1.5])
def test_a_load_that_grows_past_the_branch_reports_it_once(share: float):
    load = share * wall_buckling.buckling_load(12)
    run = loaded(wall(12, load, 0.0, 0.0, 1, 37.0, over=10.0)[0], step=0.5, end=12.0)
    reports = [one for one in run.report.warnings if "more than one path" in one]
    assert len(reports) == (share > 1.0)
    # half of the steps are enough to see it
    assert all("at t = 8" in one or "at t = 7.5" in one for one in reports)


def test_what_falls_or_slides_reports_no_branch():
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("stone", young=1e10, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=20.0)
    builder.block(vertices=[(0, 0), (4, 0), (4, 4)], name="slope", fixed=True)
    builder.block(vertices=[(1, 1), (2, 2), (1, 2)], name="wedge")
    (record,) = loaded(builder.build()).stages
    assert (record.outcome, record.branch) == ("fails", "")
