"""Fill and load trains: what rests on which block, and that nothing but the blocks decides it."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

import clast
from clast.errors import CaseError, ModelError
from clast.pictures.draw_surcharge import surcharge_of
from clast.pictures.page.scene import scene_of

GRAVITY = 9.8
ROAD = [(-1.0, 1.5), (5.0, 2.0)]


def vault(sign: float = 1.0, order: int = 1) -> clast.ModelBuilder:
    """Return voussoirs of half an ellipse and two fixed springers, mirrored and in any order."""
    builder = clast.ModelBuilder(title="Vault")
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2400.0)
    builder.add_joint(friction_angle=35.0)
    angle = np.linspace(np.pi, 0.0, 10)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner, outer = (circle * half + (2.0, -1.0) for half in ((2.5, 1.7), (3.0, 2.2)))
    loops = [[inner[k], outer[k], outer[k + 1], inner[k + 1]] for k in range(9)]
    names = [f"stone {k}" for k in range(9)]
    loops += [[(-2, -3), (0, -3), (0, -1), (-2, -1)], [(4, -3), (6, -3), (6, -1), (4, -1)]]
    names += ["left", "right"]
    for name, loop in list(zip(names, loops, strict=True))[::order]:
        corners = np.array(loop) * (sign, 1.0)
        corners = corners if shapely.LinearRing(corners).is_ccw else corners[::-1]
        builder.block(name=name, vertices=corners, fixed=name in ("left", "right"))
    return builder


def mirrored(points, sign):
    return [(sign * x, y) for x, y in points]


def loaded(sign: float = 1.0, order: int = 1, **keys) -> clast.ModelBuilder:
    builder = vault(sign, order)
    builder.fill(mirrored(ROAD, sign), 1900.0, name="fill")
    train = {"position": 3.5, "axles": [0.0, 1.1, 2.0], "loads": [2e4, 3e4, 1e4]}
    train |= {"spread_angle": 25.0, "contact_length": 0.2, "name": "train", **keys}
    builder.load_train(mirrored(ROAD, sign), **train)
    return builder


def on_blocks(model, sign: float = 1.0) -> dict[tuple[str, str], np.ndarray]:
    """Return force, and moment about the origin, on each block by block and load."""
    sums: dict[tuple[str, str], np.ndarray] = {}
    loads = model.point_loads
    for block, at, force, name in zip(
        loads.block, loads.at + model.origin, loads.force, loads.name, strict=True
    ):
        moment = sign * (at[0] * force[1] - at[1] * force[0])
        key = model.block_name[block], name
        sums[key] = sums.get(key, 0.0) + np.array([sign * force[0], force[1], moment])
    return sums


def check_alike(one, other, near: float = 1e-9):
    assert one.keys() == other.keys()
    for key, force in one.items():
        assert force == pytest.approx(other[key], abs=near * 1e4), key


def test_a_mirrored_bridge_and_blocks_in_another_order_carry_the_same():
    usual = on_blocks(loaded().build())
    assert len(usual) > 12
    check_alike(usual, on_blocks(loaded(sign=-1.0).build(), -1.0))
    check_alike(usual, on_blocks(loaded(order=-1).build()))


def test_axles_may_come_in_any_order_and_as_trains_of_their_own():
    usual = on_blocks(loaded().build())
    turned = loaded(axles=[2.0, 0.0, 1.1], loads=[1e4, 2e4, 3e4])
    check_alike(usual, on_blocks(turned.build()))
    apart = loaded(axles=[0.0], loads=[2e4])
    for behind, load in ((1.1, 3e4), (2.0, 1e4)):
        keys = {"spread_angle": 25.0, "contact_length": 0.2, "name": "train"}
        apart.load_train(ROAD, 3.5 - behind, [0.0], [load], **keys)
    check_alike(usual, on_blocks(apart.build()))
    # the same train from the other end of the path, backwards
    length = float(np.hypot(6.0, 0.5))
    back = vault()
    back.fill(ROAD, 1900.0, name="fill")
    keys = {"spread_angle": 25.0, "contact_length": 0.2, "name": "train"}
    back.load_train(ROAD[::-1], length - 1.5, [0.0, 0.9, 2.0], [1e4, 3e4, 2e4], **keys)
    check_alike(usual, on_blocks(back.build()), 1e-8)


def seen_from_above(model, x):
    """Return the topmost block of vertical lines, -1 for none, and its height there, by shapely."""
    lines = shapely.linestrings([[(one, -9.0), (one, 9.0)] for one in x])
    heights = [
        shapely.bounds(
            shapely.intersection(shapely.Polygon(model.polygon(k) + model.origin), lines)
        )
        for k in range(model.block_count)
    ]
    tops = np.nan_to_num(np.array(heights)[:, :, 3], nan=-np.inf)
    return np.where(np.isfinite(tops.max(axis=0)), tops.argmax(axis=0), -1), tops.max(axis=0)


SAMPLES = 3000


def test_fill_and_axles_are_those_of_a_quadrature():
    model = loaded().build()
    width = 6.0 / SAMPLES
    x = -1.0 + width * (np.arange(SAMPLES) + 0.5)
    block, y = seen_from_above(model, x)
    road = np.interp(x, *np.transpose(ROAD))
    exact = {
        "fill": [1900.0 * GRAVITY * width * (road - y)],
        "train": [],
    }
    along = np.array(ROAD[1]) - ROAD[0]
    for behind, load in ((0.0, 2e4), (1.1, 3e4), (2.0, 1e4)):
        wheel = np.array(ROAD[0]) + (3.5 - behind) * along / np.hypot(*along)
        cone = np.abs(x - wheel[0]) <= 0.1 + np.tan(np.radians(25.0)) * (wheel[1] - y)
        middle = int(np.searchsorted(x, wheel[0]))
        last = middle + int(np.argmin(np.append(cone[middle:], False)))
        first = middle - int(np.argmin(np.append(cone[middle::-1], False))) + 1
        foot = np.zeros(SAMPLES)
        foot[first:last] = load / (last - first)
        exact["train"].append(foot)
    found = on_blocks(model)
    for name, parts in exact.items():
        amount = np.sum(parts, axis=0)
        for number in range(9):
            here = block == number
            force = -amount[here].sum(), -(amount * x)[here].sum()
            own = found.get((f"stone {number}", name), np.zeros(3))
            assert own[[1, 2]] == pytest.approx(force, abs=2e-3 * amount.sum()), (name, number)


def deck(*marks: float) -> clast.ModelBuilder:
    """Return blocks between marks side by side, with their tops at y = 0, on a fixed one."""
    builder = clast.ModelBuilder(title="Deck")
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2400.0)
    builder.add_joint(friction_angle=35.0)
    for k, (low, high) in enumerate(pairwise(marks)):
        builder.block(name=f"{k}", vertices=[(low, -1), (high, -1), (high, 0), (low, 0)])
    ends = marks[0] - 1, marks[-1] + 1
    corners = [(ends[0], -2), (ends[1], -2), (ends[1], -1), (ends[0], -1)]
    builder.block(name="ground", vertices=corners, fixed=True)
    return builder


def forces(builder) -> dict[str, float]:
    loads = (model := builder.build()).point_loads
    return {
        model.block_name[block]: -float(force[1])
        for block, force in zip(loads.block, loads.force, strict=True)
    }


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axle_on_a_joint_is_shared_and_one_beside_it_is_not(sign):
    marks = (0.0, 1.0, 3.0) if sign > 0 else (-3.0, -1.0, 0.0)
    names = ("0", "1") if sign > 0 else ("1", "0")
    for at, parts in ((1.0, (500.0, 500.0)), (0.9, (1000.0, 0.0)), (1.1, (0.0, 1000.0))):
        builder = deck(*marks)
        builder.load_train(mirrored([(0, 0), (3, 0)], sign), at, [0.0], [1000.0])
        found = forces(builder)
        assert [found.get(name, 0.0) for name in names] == pytest.approx(parts)
    # a wheel that is long lies on both, by its length
    builder = deck(*marks)
    builder.load_train(mirrored([(0, 0), (3, 0)], sign), 0.9, [0.0], [1000.0], contact_length=0.4)
    assert [forces(builder)[name] for name in names] == pytest.approx([750.0, 250.0])


def test_a_train_without_spread_is_its_point_loads():
    builder = deck(0.0, 2.0)
    builder.load_train([(0, 0), (2, 0)], 1.5, [0.0, 1.0], [1000.0, 3000.0])
    (force,) = on_blocks(builder.build()).values()
    assert force == pytest.approx([0.0, -4000.0, -(1.5 * 1000.0 + 0.5 * 3000.0)])


def test_axles_off_the_path_and_over_no_block_have_no_load_and_are_told():
    builder = deck(0.0, 2.0)
    builder.load_train([(-3, 0), (2, 0)], 6.0, [0.0, 2.0, 4.5, 7.0], [1e3] * 4, name="lorry")
    model = builder.build()
    assert forces(builder) == pytest.approx({"0": 1000.0})
    told = "load train 'lorry' has no load of axle(s)"
    assert [note for note in model.notes if "train" in note] == [
        f"{told} 1, 4, which are off its path",
        f"{told} 3, which are over no block",
    ]


@pytest.mark.parametrize("wide", [0.0, 0.3])
def test_a_wheel_over_an_open_joint_needs_to_be_longer_than_it(wide):
    builder = deck(0.0, 1.0)
    builder.block(name="1", vertices=[(1.1, -1), (2, -1), (2, 0), (1.1, 0)])
    builder.load_train([(0, 0), (2, 0)], 1.05, [0.0], [1e3], contact_length=wide)
    # on the fixed ground below, or half on each side
    assert forces(builder) == pytest.approx({"0": 500.0, "1": 500.0} if wide else {})


def test_a_stage_brings_a_train_even_where_none_of_its_axles_has_a_load():
    builder = deck(0.0, 2.0)
    builder.load_train([(0, 0), (2, 0)], 9.0, [0.0], [1e3], name="lorry")
    builder.fill([(0, 1), (2, 1)], 2000.0, name="fill")
    stages = [
        clast.Stage(name="alone", time=0.02, until="time"),
        clast.Stage(name="loaded", time=0.02, until="time", loads=["lorry", "fill"]),
    ]
    run = clast.simulate(builder.build(), end=0.04, step=1e-2, stages=stages)
    assert [len(surcharge_of(run, frame).fill) for frame in (0, -1)] == [0, 1]


def test_what_pictures_show_is_in_the_file_about_the_users_origin(tmp_path):
    model = loaded().build()
    path = tmp_path / "vault.vtkhdf"
    clast.simulate(model, end=0.01, step=1e-2, output=path)
    results = clast.read(path)
    shown = surcharge_of(results, -1)
    along = np.array(ROAD[1]) - ROAD[0]
    assert shown.axle[0, 0] == pytest.approx(ROAD[0] + 3.5 * along / np.hypot(*along))
    assert shown.load == pytest.approx([2e4, 3e4, 1e4])
    fill = shapely.union_all([shapely.Polygon(ring) for ring in shown.fill])
    stones = map(shapely.Polygon, np.split(results.vertices(0), results.block_start[1:-1]))
    assert fill.intersection(shapely.union_all([*stones])).area < 1e-9
    forces = on_blocks(model).items()
    weight = -sum(force[1] for (_, name), force in forces if name == "fill")
    assert weight == pytest.approx(1900.0 * GRAVITY * fill.area)
    assert fill.covers(shapely.Point(2.0, 1.4))
    page = scene_of(results, 1e6)["surcharge"]
    assert [one["load"] for one in page["axles"]] == [2e4, 3e4, 1e4]
    assert clast.plot_results(results, tmp_path / "vault.png").exists()


def test_a_case_file_holds_both_tables(tmp_path):
    path = tmp_path / "vault.toml"
    path.write_text(loaded().to_toml(end=0.01, step=1e-2))
    check_alike(on_blocks(loaded().build()), on_blocks(clast.load(path).model()))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"path": [(0, 0)]}, "has 1 point(s)"),
        ({"path": [(0, 0), (2, 0), (1, 0)]}, "turns back, or rises vertically, from point 2"),
        ({"loads": [1.0, 2.0]}, "has 2 load(s) for 1 axle(s)"),
        ({"axles": [], "loads": []}, "has no axle"),
        ({"loads": [-1.0]}, "loads"),
        ({"spread_angle": 85.0}, "spread_angle"),
        ({"amplitude": "none"}, "amplitude"),
        ({"path": [(0, -0.5), (2, -0.5)]}, "axle 1: at (1, -0.5) is inside"),
    ],
)
def test_broken_trains_are_refused_in_words(keys, said):
    builder = deck(0.0, 2.0)
    usual = {"path": [(0, 0), (2, 0)], "position": 1.0, "axles": [0.0], "loads": [1.0]}
    with pytest.raises(ModelError) as refused:
        builder.load_train(**{**usual, **keys})
        builder.build()
    assert said in str(refused.value)
    assert refused.value.remedy


def test_two_mistakes_of_a_train_are_told_at_once():
    with pytest.raises(CaseError) as refused:
        clast.Case.validated(
            {"load_train": [{"path": [[0, 0]], "position": 0.0, "axles": [], "loads": []}]},
            "vault.toml",
        )
    assert "1 point(s)" in str(refused.value)
    assert "no axle" in str(refused.value)


def test_fill_that_rests_on_nothing_is_refused():
    builder = deck(0.0, 2.0)
    builder.fill([(8, 1), (9, 1)], 2000.0)
    with pytest.raises(ModelError, match="rests on no block"):
        builder.build()
