"""From velocity and displacement to acceleration, base lines, components, and what comes after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from clast.errors import CaseError
from clast.inputs.records.components import Component, along, together
from clast.inputs.records.conversion import (
    Samples,
    brought_to_rest,
    correction_of,
    from_displacement,
    from_velocity,
)
from clast.model.ground_motion import Accelerogram, InertialForce, MovingBase

RATE = 2.0 * np.pi * 1.5
TIME = np.linspace(0.5, 3.5, 601)
SINE = np.stack([0.2 * np.sin(RATE * (TIME - 0.5)), -0.1 * np.sin(RATE * (TIME - 0.5))], axis=1)
TROUGH = 0.03 * (1.0 - np.cos(RATE * (TIME - 0.5)))[:, None]


def test_a_velocity_is_met_at_all_times_as_straight_lines():
    record = from_velocity(TIME, SINE).accelerogram()
    for instant in (0.2, 0.5, 0.5031, 1.0, 1.2345, 2.7172, 3.5, 4.0):
        line = [np.interp(instant, TIME, SINE[:, axis], left=0.0) for axis in (0, 1)]
        assert record.velocity(instant) == pytest.approx(line, abs=1e-13)


def test_displacement_of_a_velocity_is_the_integral_of_its_straight_lines():
    record = from_velocity(TIME, SINE).accelerogram()
    low = float(TIME[0])
    for instant in (0.5025, 0.61, 0.7777):
        way, _ = quad(
            lambda t: np.interp(t, TIME, SINE[:, 0]),
            low,
            instant,
            points=[float(t) for t in TIME if t < instant],
            limit=200,
        )
        assert record.displacement(instant)[0] == pytest.approx(way, abs=1e-13)
    assert record.displacement(3.5) == pytest.approx(np.trapezoid(SINE, TIME, axis=0), abs=1e-12)


def test_a_sine_of_velocity_gives_its_cosine_of_acceleration():
    step = float(TIME[1] - TIME[0])
    found = from_velocity(TIME, SINE).acceleration[:, 0]
    middle = TIME[:-1] + 0.5 * step
    exact = 0.2 * RATE * np.cos(RATE * (middle - 0.5))
    # the chord of a sine is shorter by the factor sin(x) / x with x = omega h / 2, exactly
    half = 0.5 * RATE * step
    assert found == pytest.approx(exact * np.sin(half) / half, abs=1e-10)


def test_the_mean_acceleration_of_a_step_is_the_gain_of_velocity():
    ground = InertialForce(from_velocity(TIME, SINE).accelerogram())
    for start, end in ((0.5, 0.505), (0.61, 0.6133), (1.0, 1.2), (3.4, 5.0)):
        gain = np.interp(end, TIME, SINE[:, 0]) - np.interp(start, TIME, SINE[:, 0])
        mean = ground.body_acceleration(start, end)[0]
        assert mean == pytest.approx(-gain / (end - start), abs=1e-11)


def test_a_displacement_is_met_at_every_instant():
    base = MovingBase(from_displacement(TIME, np.hstack([TROUGH + 7.0, TROUGH])).accelerogram())
    moved = np.array([base.anchor_displacement(t)[0] for t in TIME])
    assert moved == pytest.approx(TROUGH[:, 0], abs=1e-11)


def test_a_displacement_gives_its_acceleration():
    found = from_displacement(TIME, TROUGH).acceleration[:, 0]
    exact = 0.03 * RATE**2 * np.cos(RATE * (TIME - 0.5))
    # at its end the spline has no acceleration; that is forgotten within some intervals
    step = float(TIME[1] - TIME[0])
    assert np.abs(found - exact)[:-30].max() < exact.max() * (RATE * step) ** 2 / 6.0
    assert found[-1] == pytest.approx(0.0, abs=1e-12)


def test_a_velocity_must_begin_at_rest():
    late = SINE.copy()
    late[0] = 0.001
    assert from_velocity(TIME, late).accelerogram().velocity(TIME[1]) == pytest.approx(SINE[1])
    late[0] = 0.01
    with pytest.raises(CaseError, match=r"begins with 0\.01 m/s, of 0\.2 m/s at most"):
        from_velocity(TIME, late)


def test_a_line_is_taken_off():
    line = 0.3 + 0.2 * TIME[:, None] * np.array([1.0, -2.0])
    samples = Samples(time=TIME, acceleration=line)
    assert np.abs(correction_of("linear")(samples)).max() < 1e-12
    both = Samples(time=TIME, acceleration=SINE + line)
    alone = Samples(time=TIME, acceleration=SINE)
    expected = correction_of("linear")(alone)
    assert correction_of("linear")(both) == pytest.approx(expected, abs=1e-12)
    assert correction_of("none")(both) is both.acceleration


@pytest.mark.parametrize("frequency", [0.25, 0.5, 1.0, 4.0])
def test_a_highpass_weakens_as_its_formula_says_without_a_shift(frequency):
    time = np.arange(0.0, 200.0, 0.01)
    wave = np.sin(2.0 * np.pi * frequency * time)[:, None]
    found = correction_of("highpass:0.5")(Samples(time=time, acceleration=wave))
    # the bilinear transform warps frequencies: f -> tan(pi f h) / (pi h)
    ratio = np.tan(np.pi * 0.5 * 0.01) / np.tan(np.pi * frequency * 0.01)
    middle = slice(5000, 15000)
    assert found[middle] == pytest.approx(wave[middle] / (1.0 + ratio**8), abs=1e-6)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("highpass:60", "has no corner at 60 Hz"),
        ("highpass:0.001", "has no corner at 0.001 Hz"),
        ("highpass:0", "is not a valid base line"),
        ("highpass:", "is not a valid base line"),
        ("highpass:1e", "is not a valid base line"),
        ("lowpass:3", "is not a valid base line"),
        ("", "is not a valid base line"),
    ],
)
def test_base_lines_that_are_none(name, said):
    time = np.arange(0.0, 10.0, 0.01)
    with pytest.raises(CaseError, match=said) as error:
        correction_of(name)(Samples(time=time, acceleration=np.zeros((1000, 2))))
    assert "give" in error.value.remedy


def test_a_base_line_needs_equal_intervals():
    uneven = Samples(time=np.array([0.0, 1.0, 3.0]), acceleration=np.ones((3, 2)))
    with pytest.raises(CaseError, match="1 to 2 s apart"):
        correction_of("linear")(uneven)


def test_the_ground_is_brought_to_rest_within_a_second():
    record = Accelerogram(np.array([0.0, 1.0, 1.5]), np.array([[0, 1], [2, -1], [1, 3.0]]))
    stopped = brought_to_rest(record)
    assert stopped.time[-1] == 2.5
    assert np.abs(record.velocity(1.5)).min() > 0.4
    assert stopped.velocity(2.5) == pytest.approx([0.0, 0.0], abs=1e-15)
    assert stopped.velocity(9.0) == pytest.approx([0.0, 0.0], abs=1e-15)
    assert stopped.displacement(9.0) == pytest.approx(stopped.displacement(2.5), abs=1e-14)
    for instant in (0.3, 1.2, 1.5):
        assert stopped.velocity(instant) == pytest.approx(record.velocity(instant), abs=0.0)


def part(values, begin=0.0, interval=0.1, quantity="acceleration"):
    time = begin + interval * np.arange(len(values))
    samples = Samples(time=time, acceleration=np.array(values, float)[:, None])
    return Component(samples=samples, quantity=quantity, note="", doubt=None)


def moved(component, direction):
    return replace(component, samples=along(component.samples, direction))


def test_two_components_are_added():
    first, second = moved(part([0, 5, 10]), (3.0, 4.0)), moved(part([1, 2]), (0.0, 1.0))
    total, note = together(first, second)
    assert total.acceleration == pytest.approx(np.array([[0, 1], [3, 6], [6, 8]]))
    assert note == "the vertical component ends 1 value(s) before the other: 0 m/s2 from there on"
    back, note = together(second, first)
    assert back.acceleration == pytest.approx(total.acceleration)
    assert note is not None and note.startswith("the first component")
    assert together(first, first)[1] is None


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (part([0, 1], interval=0.2), "one every 0.1 s"),
        (part([0, 1], begin=0.05), "begins at 0.05 s"),
        (part([0, 1], quantity="velocity"), "is velocity, but the first component is accel"),
    ],
)
def test_components_that_do_not_belong_together(other, said):
    with pytest.raises(CaseError, match=said):
        together(moved(part([0, 5, 10]), (1.0, 0.0)), moved(other, (0.0, 1.0)))
