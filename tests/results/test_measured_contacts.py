"""[[measured_contact]]: what is recorded at a place and of a joint, and what is refused."""

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.exports.csv_tables import TABLES

WEIGHT = 2500.0 * 9.8 * 2.0 * 1.0
"""Of the brick, N/m."""


def brick(*, turn=0.0, swapped=False, **joint):
    """Return a builder with a brick of 2 m x 1 m on a table, with a joint of its own."""
    builder = clast.ModelBuilder(gravity=(9.8 * np.sin(turn), -9.8 * np.cos(turn)))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("bed", friction_angle=30.0, between=[["table", "brick"]], **joint)
    add = [
        lambda: builder.block(
            name="table", vertices=[(-2, -1), (6, -1), (6, 0), (-2, 0)], fixed=True
        ),
        lambda: builder.block(name="brick", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)]),
    ]
    for one in reversed(add) if swapped else add:
        one()
    return builder


@pytest.mark.parametrize("swapped", [False, True])
def test_stress_and_slip_of_a_brick_on_a_slope(swapped):
    """At rest N/L = w cos(a) and T/L = w sin(a); the sign of the shear is that of the slip."""
    turn = np.radians(20.0)
    builder = brick(turn=turn, swapped=swapped)
    builder.measured_contact("joint", joint="bed")
    builder.measured_contact("toe", (2.0, 0.0))
    builder.measured_contact("heel", at=(0.0, 0.0))
    run = clast.simulate(builder.build(), step=2e-3, end=0.2, dynamic_ratio=0.0)
    joint, toe, heel = (run.measured_contact(name) for name in ("joint", "toe", "heel"))
    assert joint["normal"][-1] == pytest.approx(WEIGHT * np.cos(turn) / 2.0, rel=1e-4)
    assert abs(joint["shear"][-1]) == pytest.approx(WEIGHT * np.sin(turn) / 2.0, rel=1e-4)
    assert np.sign(joint["shear"][-1]) == -np.sign(joint["slip"][-1])
    assert joint["sliding"][-1] == 0.0
    # the brick leans down the slope: more at the toe
    assert toe["normal"][-1] > joint["normal"][-1] > heel["normal"][-1]
    assert joint["opening_least"][-1] <= toe["opening"][-1] < heel["opening"][-1] <= 1e-12


def test_a_brick_that_slides_has_slipped_as_far_as_it_has_moved():
    builder = brick()
    builder.measured_contact("joint", joint="bed")
    builder.measured_point("A", (1.0, 0.5), block="brick")
    builder.add_joint("default", friction_angle=30.0)
    model = builder.build()
    velocity = np.zeros((2, 6))
    velocity[1, 0] = 1.0
    from dataclasses import replace

    run = clast.simulate(replace(model, velocity=velocity), step=1e-3, end=0.1)
    history = run.measured_contact("joint")
    moved = run.history("A").displacement[-1, 0]
    assert history["slip"][-1] == pytest.approx(-moved, rel=1e-3)
    assert history["slip_least"][-1] <= history["slip"][-1] <= history["slip_most"][-1]
    assert history["sliding"][-1] == 1.0
    assert abs(history["shear"][-1]) == pytest.approx(
        np.tan(np.radians(30.0)) * history["normal"][-1], rel=1e-2
    )


def test_nothing_touches():
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.measured_contact("A", (0.0, 0.0))
    run = clast.simulate(builder.build(), step=1e-3, end=2e-3)
    history = run.measured_contact("A")
    assert len(history) == 2 and (history["normal"] == 0.0).all()
    assert np.isnan(history["slip"]).all() and np.isnan(history["opening"]).all()


def test_files_tables_and_csv_have_them(tmp_path):
    builder = brick()
    builder.measured_contact("joint", joint="bed")
    builder.measured_contact("toe / right", (2.0, 0.0))
    case = builder.case(step=1e-3, end=5e-3, every=5e-3)
    again = clast.Case.from_text(case.to_toml(), "test")
    run = again.run(output=tmp_path / "run.vtkhdf")
    results = clast.read(tmp_path / "run.vtkhdf")
    assert results.measured_contact_name == ("joint", "toe / right")
    for name in results.measured_contact_name:
        mine, theirs = run.measured_contact(name), results.measured_contact(name)
        assert (mine.rows == theirs.rows).all() and len(mine) == 5
    rows = list(TABLES["measured_contacts"](results, [0, 1]))
    assert rows[0][:4] == ("measured_contact", "time", "normal", "shear")
    assert len(rows) == 1 + 2 * 5
    with pytest.raises(CaseError, match="there is no measured contact 'toe'"):
        results.measured_contact("toe")
    assert "normal" in results.measured_contact("joint")._repr_html_()
