"""The exact answers of problems with motion and limits, against plain integration and limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import trapezoid

from clast.verification.problems.friction import ladder, plane_of_weakness
from clast.verification.problems.masonry import arch, arch_push, kern, rocking
from clast.verification.problems.slopes import (
    active_passive,
    block_train,
    slide_topple,
    wet_slope,
)
from clast.verification.problems.underground import (
    bolted_stages,
    key_block,
    kirsch,
    pull_test,
    roof_wedge,
    snap_through,
)
from clast.verification.problems.waves import moving_base, newmark, rocking_spectrum


def test_newmark():
    # integrated independently
    assert pytest.approx((1.729768, 1.137158), rel=1e-6) == (newmark.YIELD, newmark.FACTOR)
    assert newmark.begin() == pytest.approx(0.0573604, abs=1e-7)
    assert newmark.end() == pytest.approx(0.6777028, abs=1e-7)
    assert newmark.exact_displacement(1.0) == pytest.approx(0.31361979, rel=1e-7)
    assert newmark.exact_displacement(2.0) == pytest.approx(0.6272396, rel=1e-7)


def test_stick_and_slip_against_small_steps():
    step = 2e-5
    way = speed = 0.0
    for k in range(round(moving_base.DURATION / step)):
        base = float(moving_base.base_speed((k + 1) * step))
        most = moving_base.GRIP * step
        speed += float(np.clip(base - speed, -most, most))
        way += step * speed
    exact = moving_base.exact_displacement(np.array([moving_base.DURATION]))[0]
    assert way == pytest.approx(exact, abs=2e-4)


def test_modes_of_a_block_on_a_slope():
    found = {name: slide_topple.exact_motion(*block) for name, block in slide_topple.BLOCKS.items()}
    assert found["rest"] == (0.0, 0.0)
    dip, time = slide_topple.DIP, slide_topple.DURATION
    for name in ("slide", "slide, though b/h < tan a"):
        friction = np.tan(np.radians(slide_topple.BLOCKS[name][1]))
        slid = 0.5 * 9.8 * (np.sin(dip) - np.cos(dip) * friction) * time**2
        assert found[name] == pytest.approx((slid, 0.0), abs=1e-9)
    # toppling keeps the energy of the fall
    angle = found["topple"][1]
    assert angle > 0.0


def test_a_thin_ladder_slips_at_90_degrees_less_2_phi():
    assert ladder.exact_limit(50.0, width=1e-9) == pytest.approx(20.0, abs=1e-6)


def test_an_arch_without_joints_is_milankovitchs():
    assert arch.exact_limit(80) == pytest.approx(0.1075, abs=1e-4)


def test_housners_impact():
    # e = 1 - 3/2 sin2 a of a rectangle
    assert pytest.approx(1.0 - 1.5 * np.sin(rocking.SLENDERNESS) ** 2) == rocking.KEPT
    _, _, rate = rocking.exact_fall()
    drop = np.cos(rocking.SLENDERNESS - rocking.TILT) - np.cos(rocking.SLENDERNESS)
    energy = 2.0 * 9.8 * rocking.RADIUS * drop / rocking.INERTIA
    assert rate == pytest.approx(-np.sqrt(energy), rel=1e-6)


def test_blocks_at_their_limit_are_in_equilibrium():
    phi = np.radians(active_passive.exact_limit(5.0))
    a, b = np.radians((active_passive.STEEP, 5.0))
    _, upper, lower = active_passive.outlines(5.0)
    weights = [active_passive.area(upper), active_passive.area(lower)]
    # planes push at phi from their normals, the joint at phi from the horizontal
    first = np.array([[np.sin(a - phi), -np.cos(phi)], [np.cos(a - phi), np.sin(phi)]])
    plane, joint = np.linalg.solve(first, [0.0, weights[0]])
    second = np.array([[np.sin(b - phi)], [np.cos(b - phi)]])
    (lower_plane,) = (weights[1] + joint * np.sin(phi)) / second[1]
    assert plane > 0.0
    assert lower_plane * second[0, 0] + joint * np.cos(phi) == pytest.approx(0.0, abs=1e-9)


def test_force_on_a_key_block():
    phi = np.radians(35.0)
    normal = key_block.exact_force(35.0) * np.cos(phi) / np.cos(phi - key_block.LEAN)
    held = 2.0 * normal * np.sin(phi - key_block.LEAN) / np.cos(phi)
    assert held == pytest.approx(key_block.WEIGHT)


def test_halves_whose_hinges_bear_them():
    # without noses, contacts of 4/3 p at the hinges give way as three of p do: two halves that
    # share the middle one; worked out independently
    stiffer = 2.0 / 1.5
    assert snap_through.exact_rest(stiffer * 1e9, 0.0) == pytest.approx((0.0048485, 321649.8), 1e-5)
    assert snap_through.exact_rest(stiffer * 1e8, 0.0) == pytest.approx((0.0573386, 360144.4), 1e-5)
    assert snap_through.snapping(0.0)[0] == pytest.approx(stiffer * 4.98971e7, rel=1e-5)


def test_pushes_of_arches():
    # a linear programme with friction at both ends of every joint, written independently
    known = dict(zip(arch_push.ARCHES, (0.37361, 0.35675, 0.36797, 0.25700, 0.13895), strict=False))
    for each, factor in known.items():
        # the friction angles of the table are rounded
        assert arch_push.exact_factor(each) == pytest.approx(factor, rel=3e-3), each.name


def test_loads_that_pull_roof_wedges_out():
    # Brady & Brown's equations and a root of S - N tan phi agree on these
    known = {
        (20.0, 1.0): 727_940.5,
        (20.0, 10.0): 481_168.3,
        (10.0, 1000.0): 276_965.6,
        (30.0, 10.0): 291_104.1,
    }
    for (lean, ratio), load in known.items():
        wedge = roof_wedge.Wedge(lean, ratio)
        assert wedge.exact()[0] == pytest.approx(load, rel=1e-6)
    # per metre of side
    wedge = roof_wedge.Wedge(20.0, 10.0)
    assert wedge.exact()[1] * wedge.side == pytest.approx(1.172e-4, rel=1e-4)


def test_factors_of_safety_of_wet_slopes():
    """Known to four digits; the water that clast finds in crack and plane is U and V."""
    slope = wet_slope.critical_slope()
    assert slope.depth == pytest.approx(14.0092, abs=1e-4)
    shares = {0.0: 1.5843, 0.25: 1.5069, 0.5: 1.4164, 1.0: 1.2057}
    for share, factor in shares.items():
        assert slope.exact_factor(share * slope.depth) == pytest.approx(factor, abs=5e-5)
    assert slope.exact_factor(0.0, 0.08) == pytest.approx(1.3716, abs=5e-5)
    steep = wet_slope.steep_slope()
    assert steep.depth == pytest.approx(9.1102, abs=1e-4)
    assert steep.exact_factor(steep.depth - 2.0) == pytest.approx(0.6771, abs=5e-5)
    (water,) = wet_slope.slope_model(slope, slope.depth).water
    assert len(water.joints.edge) == 2
    lowered = np.sort(water.joints.lowered.ravel())  # at the toe alone
    np.testing.assert_allclose(lowered, [0.0, 0.0, 0.0, 60.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("amplitude", "fallen"),
    [(0.60, False), (0.63, True), (1.53, True), (1.56, False), (1.66, False), (1.69, True)],
)
def test_amplitudes_at_which_a_block_falls_over(amplitude, fallen):
    # as another integration of Housner's equations has them
    tilt = rocking_spectrum.exact_tilt(rocking_spectrum.SINE, amplitude, 6.0)[1]
    assert (np.abs(tilt).max() > 1.0) == fallen


def test_kirsch_at_known_points():
    known = {0.0: (4.6296e6, 14.815e6), 45.0: (4.1667e6, 10.833e6), 90.0: (3.7037e6, 6.8519e6)}
    for degrees, stresses in known.items():
        found = kirsch.kirsch_stresses(4.5, np.radians(degrees), 0.5)
        assert found == pytest.approx(stresses, rel=1e-4)
    walls = kirsch.closure(np.radians([0.0, 45.0, 90.0]), 0.5)
    assert walls == pytest.approx([0.46875e-3, 1.40625e-3, 2.34375e-3])
    assert kirsch.closure(0.3, 1.0) == pytest.approx(1.875e-3)


def test_loads_on_an_arch_are_those_of_its_mirror_image():
    mirrored = arch.VOUSSOIRS + 1
    for place in arch.PLACES:
        load = arch.exact_load(place)
        assert arch.exact_load(mirrored - place) == pytest.approx(load, rel=1e-6)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.4])
def test_the_bed_of_a_pier_balances_its_force(share):
    length, edge, turn = kern.exact_bed(share)
    x = np.linspace(0.0, length, 100_001)  # from the edge
    pressure = edge - kern.BEDDING * turn * x
    assert pressure.min() > -1e-3
    assert trapezoid(pressure, x) == pytest.approx(kern.FORCE)
    moment = trapezoid(pressure * (0.5 * kern.WIDTH - x), x)
    assert moment == pytest.approx(kern.FORCE * share * kern.WIDTH)


def test_the_bolt_of_a_roof_against_the_least_energy():
    """Springs of ledges, pillar and bolt, and the stretch of both blocks: minimised directly."""
    one = bolted_stages
    width, height = one.PILLAR
    weight = width * height * one.DENSITY * one.GRAVITY

    def moves(ledges: float, pillar: float, bolt: float, rest: float) -> np.ndarray:
        # beam: foot and growth; pillar: foot and growth; upwards
        rows = [
            (ledges, [1, 0, 0, 0]),
            (2.0 * one.CONTACT * pillar, [1, 0, -1, -1]),
            (2.0 * one.CONTACT, [0, 0, 1, 0]),
            (one.WIDTH * one.YOUNG / one.HEIGHT, [0, 1, 0, 0]),
            (width * one.YOUNG / height, [0, 0, 0, 1]),
            (bolt, [1, 0.5, 0, 0]),
        ]
        stiffness = sum(k * np.outer(row, row) for k, row in rows)
        load = -one.WEIGHT * np.array([1, 0.5, 0, 0]) - weight * np.array([0, 0, 1, 0.5])
        return np.linalg.solve(stiffness, load + bolt * rest * np.array([1, 0.5, 0, 0]))

    def head(found: np.ndarray) -> float:
        return float(found[0] + 0.5 * found[1])

    settled = head(moves(one.LEDGES, 1.0, 0.0, 0.0))
    exact = one.exact_force("settle, bolt, dig")
    dug = head(moves(one.LEDGES, 0.0, one.BOLT, settled))
    assert one.BOLT * (settled - dug) == pytest.approx(exact, rel=1e-9)
    at_start = -one.BOLT * head(moves(one.LEDGES, 1.0, one.BOLT, 0.0))
    assert at_start == pytest.approx(one.exact_force("bolt at the start"), rel=1e-9)
    both = -one.BOLT * head(moves(one.LEDGES, 0.0, one.BOLT, 0.0))
    assert both == pytest.approx(one.exact_force("dig and bolt at the start"), rel=1e-9)


@pytest.mark.parametrize("dip", [35.0, 40.0, 60.0, 80.0])
def test_jaeger_against_the_stress_on_the_plane(dip: float):
    """At the strength the traction on the plane is on Coulomb's line."""
    weak = plane_of_weakness
    normal = np.array([np.sin(np.radians(dip)), np.cos(np.radians(dip))])
    along = np.array([normal[1], -normal[0]])
    axial = weak.CONFINING + weak.exact_strength(dip)
    traction = np.array([weak.CONFINING, axial]) * normal
    bound = weak.COHESION + traction @ normal * np.tan(np.radians(weak.FRICTION_ANGLE))
    assert abs(traction @ along) == pytest.approx(bound)
    assert weak.exact_strength(weak.FLAT) == np.inf
    least = 45.0 + 0.5 * weak.FRICTION_ANGLE
    assert weak.exact_strength(least) <= weak.exact_strength(dip)


def test_blocks_in_a_row_against_the_equations_of_each():
    """Unknown acceleration and two forces from three equations of motion."""
    train = block_train
    slope = train.WEIGHTS * (np.sin(train.DIP) - np.cos(train.DIP) * train.FRICTION)
    matrix = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 1.0], [1.0, 0.0, -1.0]])
    matrix[:, 0] = train.WEIGHTS / train.GRAVITY
    gained, *forces = np.linalg.solve(matrix, slope)
    assert train.acceleration() == pytest.approx(gained)
    assert train.pushes(train.FRICTION, train.acceleration()) == pytest.approx(forces)
    at_limit = train.pushes(train.FRICTION / train.factor(), 0.0)
    weight = train.WEIGHTS[-1]
    resisted = weight * np.cos(train.DIP) * train.FRICTION[-1] / train.factor()
    assert at_limit[-1] == pytest.approx(resisted - weight * np.sin(train.DIP))


@pytest.mark.parametrize("pretension", pull_test.PRETENSIONS)
def test_pull_out_balances_bolt_and_frame(pretension: float):
    test = pull_test
    for load in np.linspace(0.01, test.FURTHER, 40) * test.load_at_rupture(pretension):
        moved = test.exact_moved(load, pretension)
        bolt = min(pretension + test.BOLT * moved, test.YIELD)
        if pretension / test.BOLT + moved > test.RUPTURE:
            bolt = 0.0
        left = bolt + test.FRAME * moved - load
        # a joint that is shut bears what is left of the pretension
        assert left == pytest.approx(0.0, abs=1e-6 * load) or (left > 0.0 and moved == 0.0)
