"""The page of a run: its numbers as they come back, its text, what it refuses."""

import base64
import re
import zlib
from itertools import pairwise

import numpy as np
import pytest

import clast
from clast.block.polygon import moments
from clast.pictures.page.document import write_page
from clast.pictures.page.packing import affine, packed, room_of_each, spread
from clast.pictures.page.scene import scene_of


def unpacked(table, width):
    """Return the numbers (frames, width) of a packed table, as the page's script reads them."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(table["data"])), np.uint8)
    low, high = np.split(planes.astype(np.int64), 2)
    coded = (low + 256 * high).reshape(-1, width)
    change = np.where(coded % 2 == 1, -((coded + 1) // 2), coded // 2)
    levels = change
    for _ in range(table["order"]):
        levels = np.cumsum(levels, axis=0) % 65536
    step = (table["high"] - table["low"]) / table["levels"]
    found = table["low"] + levels * step
    return np.where(np.abs(found) < 1e-6 * step, 0.0, found)


def placed(motion, start, block_start):
    """Return vertices (frames, nv, 2) from the six numbers of each block."""
    count = np.diff(block_start)
    owner = np.repeat(np.arange(len(count)), count)
    middle = moments(start, block_start)[1]
    x, y = (start - middle[owner]).T
    cosine, sine = np.cos(motion["angle"])[:, owner], np.sin(motion["angle"])[:, owner]
    xx, yy, xy = (motion[name][:, owner] for name in ("xx", "yy", "xy"))
    u, v = (1 + xx) * x + xy * y, xy * x + (1 + yy) * y
    return np.stack(
        [
            middle[owner, 0] + motion["x"][:, owner] + cosine * u - sine * v,
            middle[owner, 1] + motion["y"][:, owner] + sine * u + cosine * v,
        ],
        axis=-1,
    )


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e7])
@pytest.mark.parametrize("offset", [0.0, -3.0])
def test_numbers_come_back_to_half_a_level(scale, offset):
    values = scale * (np.random.default_rng(3).standard_normal((20, 7)) + offset)
    found = unpacked(packed(values), 7)
    assert np.abs(found - values).max() <= 0.5001 * np.ptp(values) / 65535


def test_steady_motion_takes_few_bytes_and_comes_back():
    rng = np.random.default_rng(4)
    time = np.linspace(0.0, 1.0, 200)[:, None]
    values = rng.uniform(0.0, 3.0, 50) * time - 4.9 * time**2
    table = packed(values)
    assert table["order"] == 2
    assert np.abs(unpacked(table, 50) - values).max() <= 0.5001 * np.ptp(values) / 65535
    noise = packed(rng.standard_normal((200, 50)))
    assert noise["order"] == 1 and len(table["data"]) < 0.4 * len(noise["data"])


@pytest.mark.parametrize("least", [1e-3, 0.3, 50.0])
def test_numbers_may_be_rounded_to_a_multiple_and_zero_stays_zero(least):
    values = np.random.default_rng(5).standard_normal((20, 7))
    values[:, 2] = 0.0
    found = unpacked(packed(values, least), 7)
    assert np.abs(found - values).max() <= 0.5001 * least
    assert np.abs(found[:, 2]).max() < 1e-12


@pytest.mark.parametrize(("low", "high"), [(-1.0, 3.7), (-1e-3, 5e6), (-2.0, 1e-9), (0.0, 1.0)])
def test_zero_is_a_level_and_rest_is_zero(low, high):
    values = np.random.default_rng(6).uniform(low, high, (30, 7))
    values[0, :2] = low, high
    values[20:] *= 1e-9
    table = packed(values)
    found = unpacked(table, 7)
    step = (table["high"] - table["low"]) / table["levels"]
    assert table["levels"] <= 65535 and step <= 1.0001 * (high - low) / 65534
    assert np.abs(found - values).max() <= 0.5001 * step
    assert np.abs(values[20:]).max() < 0.5 * step and not found[20:].any()


def test_constants_empty_tables_and_what_is_not_finite():
    assert unpacked(packed(np.full((3, 2), 4.5)), 2) == pytest.approx(np.full((3, 2), 4.5))
    assert packed(np.zeros((0, 0)))["low"] == 0.0
    assert unpacked(packed(np.array([[np.nan, np.inf], [1.0, 0.0]])), 2).min() == 0.0


def test_the_motion_of_blocks_comes_back_from_six_numbers():
    rng = np.random.default_rng(1)
    block_start = np.array([0, 3, 7, 12])
    start = rng.uniform(-5.0, 5.0, (12, 2))
    frames = []
    for k in range(9):
        here = start.copy()
        for first, past in pairwise(block_start):
            # several turns, a shift, and strain
            turn = 0.9 * k * (1 + first)
            strain = np.eye(2) + 0.05 * k * rng.uniform(-1.0, 1.0, (2, 2))
            rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
            here[first:past] = start[first:past] @ (rotation @ strain).T + [3.0 * k, -k]
        frames.append(here)
    motion = affine(start, frames, block_start)
    assert placed(motion, start, block_start) == pytest.approx(np.stack(frames), abs=1e-12)
    assert np.abs(np.diff(motion["angle"], axis=0)).max() < np.pi


def test_a_page_places_vertices_within_its_levels(wall):
    results = wall(4, 5)
    scene = scene_of(results, budget=1e6)
    motion = {name: unpacked(table, 20) for name, table in scene["motion"].items()}
    start = results.vertices(0) - scene["origin"]
    found = placed(motion, start, results.block_start) + scene["origin"]
    true = np.stack([results.vertices(k) for k in range(len(results.times))])
    assert np.abs(found - true).max() < 3e-5 * np.abs(true - true[0]).max()


def test_places_of_a_share_lie_evenly():
    places = np.stack(np.meshgrid(np.arange(40.0), np.arange(25.0)), axis=-1).reshape(-1, 2)
    angle = np.radians(23.0)
    turned = 1e5 + places @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    for order in (spread(places), spread(turned)):
        assert len(np.unique(order)) == 1000
        for share in (0.5, 0.25, 0.1):
            kept = (order < share).reshape(5, 5, 8, 5).sum(axis=(1, 3))
            assert kept.sum() == pytest.approx(1000 * share, abs=1)
            assert np.abs(kept - 25 * share).max() <= 4
    for count in (1, 2, 3):
        assert ((spread(np.zeros((count, 2))) < 1.0).sum()) == count


def wanted(scene):
    """Return the bytes of all contacts and joints of a page."""
    faces = sum(16 * one["of"] for one in scene["faces"].values())
    return 26 * scene["contacts"]["of"] + faces


def kept_of(table):
    """Return vertex and force of the contacts of each frame."""
    vertex = np.frombuffer(zlib.decompress(base64.b64decode(table["vertex"])), np.uint8)
    vertex = vertex.reshape(4, -1).T.copy().view("<i4").ravel()
    normal = unpacked(table["normal"], table["shown"])[0]
    ends = np.cumsum(table["count"])[:-1]
    return np.split(vertex, ends), np.split(normal, ends)


@pytest.mark.parametrize("budget_share", [0.6, 0.3])
def test_contacts_are_left_out_evenly_and_alike_in_all_frames(wall, budget_share):
    """The same joints in each frame, from the top to the foot, with the largest force of each."""
    results = wall(20, 12)
    every = scene_of(results, 1e9)
    budget = budget_share * wanted(every)
    few = scene_of(results, budget)
    share = few["contacts"]["shown"] / few["contacts"]["of"]
    assert few["contacts"]["of"] == every["contacts"]["shown"] == 5 * 19 * 12
    assert wanted(few) == wanted(every)
    bytes_of = 26 * few["contacts"]["shown"] + sum(
        16 * one["shown"] for one in few["faces"].values()
    )
    assert 0.9 * budget < bytes_of <= budget * 1.02
    every_vertex, every_force = kept_of(every["contacts"])
    vertices, forces = kept_of(few["contacts"])
    for frame in range(1, 6):
        assert vertices[frame].tolist() == vertices[1].tolist()
        most = every_force[frame].max()
        assert forces[frame].max() == pytest.approx(most, rel=1e-4)
        quarter = np.floor(4.0 * forces[frame] / most * (1 - 1e-3)).astype(int)
        whole = np.floor(4.0 * every_force[frame] / most * (1 - 1e-3)).astype(int)
        kept = np.bincount(quarter, minlength=4) / np.bincount(whole, minlength=4)
        assert np.abs(kept - share).max() < 0.15
    assert len(every_vertex[1]) == 19 * 12


def test_small_tables_leave_their_room_to_large_ones():
    assert room_of_each([10, 50, 100], 200.0) == 200.0
    assert room_of_each([100, 50, 10], 120.0) == 60.0
    assert room_of_each([100, 100], 120.0) == 60.0


def test_water_that_finds_no_room_is_left_out_at_every_depth(tmp_path):
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e10, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=40.0)
    for k in range(144):
        x, y = k % 12, k // 12
        corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        builder.block(vertices=corners, fixed=y == 0)
    builder.water(12.0, name="gw", acts_on="joints")
    path = tmp_path / "deep.vtkhdf"
    run = clast.simulate(builder, end=2e-3, step=1e-3, every=1e-3, dynamic_ratio=0.0, output=path)
    every = scene_of(run, 1e9)
    few = scene_of(run, 0.3 * wanted(every))["faces"]["water"]
    share = few["shown"] / few["of"]
    assert share < 0.7

    def depths(table):
        return 12.0 - unpacked(table["y0"], table["shown"])[0] - every["origin"][1]

    counts = [
        np.histogram(depths(one), bins=[-0.1, 3.1, 6.1, 9.1, 12.1])[0]
        for one in (every["faces"]["water"], few)
    ]
    assert np.abs(counts[1] / counts[0] - share).max() < 0.1


def test_frames_are_thinned_evenly_and_said(wall):
    scene = scene_of(wall(3, 3), budget=1e5, most_values=27)
    assert scene["frames"] == {"shown": 3, "of": 6}
    assert scene["times"] == pytest.approx([0.0, 0.4, 1.0], abs=0.21)
    assert scene["times"][-1] == pytest.approx(1.0)


NASTY = "</script><script>alert(1)</script> \"'&\u202e\U0001f600\u2028"


def test_a_page_asks_no_network(wall, tmp_path):
    text = write_page(wall(2, 2), tmp_path / "a.html").read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none'") and "unsafe-eval" not in policy
    assert "'unsafe-inline'" not in re.search(r"script-src ([^;]*)", policy)[1]
    assert not re.search(r"<(script|img|link)[^>]*(src|href)=", text)
    for module in ("import {", "export class", "export function"):
        assert module not in text
