"""Bolts in runs and result files: histories, frames, states, events; files without any."""

import numpy as np
import pytest

import clast


def three_bolts() -> clast.ModelBuilder:
    """A box that falls away from a beam: one bolt holds, one yields, one breaks."""
    builder = clast.ModelBuilder(gravity=(0.0, -10.0))
    builder.add_rock("rock", young=1e12, poisson=0.2, density=2500.0)
    builder.block(vertices=[(98, 1), (102, 1), (102, 2), (98, 2)], name="beam", fixed=True)
    builder.block(vertices=[(99, -1), (101, -1), (101, 0), (99, 0)], name="box")
    builder.add_bolt_kind("strong", stiffness=1e6)
    builder.add_bolt_kind("soft", stiffness=1e6, yield_force=1e4)
    builder.add_bolt_kind("brittle", stiffness=1e6, rupture_elongation=0.02)
    for x, kind in ((99.5, "strong"), (100, "soft"), (100.5, "brittle")):
        builder.bolt((x, -0.5), (x, 1.0), kind=kind, name=kind)
    return builder


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    path = tmp_path_factory.mktemp("bolts") / "bolts.vtkhdf"
    return clast.simulate(three_bolts(), end=0.2, step=1e-3, every=0.02, output=path)


def test_run_and_file_say_the_same(run: clast.Run):
    read = clast.read(run.output)
    memory = clast.simulate(three_bolts(), end=0.2, step=1e-3, every=0.02)
    assert read.bolt_name == run.bolt_name == ("strong", "soft", "brittle")
    for name in read.bolt_name:
        history = read.bolt_history(name)
        np.testing.assert_array_equal(history.rows, run.bolt_history(name).rows)
        assert len(history) == run.report.steps + 1
    for frame in (0, 4, -1):
        one, other = read.bolts(frame), memory.bolts(frame)
        np.testing.assert_array_equal(one.points, other.points)
        np.testing.assert_array_equal(one.force, other.force)
        np.testing.assert_array_equal(one.state, other.state)
    np.testing.assert_allclose(read.bolts(0).points[0], [99.5, -0.5])


def test_histories_hold_what_the_bolts_bore(run: clast.Run):
    strong, soft, brittle = (run.bolt_history(name) for name in run.bolt_name)
    np.testing.assert_allclose(strong.force, 1e6 * strong.elongation, atol=1e-6)
    assert soft.force.max() == 1e4
    assert [one.state_name for one in (strong, soft, brittle)] == ["intact", "yielded", "broken"]
    breaks = int(np.argmax(brittle.state == 3))
    assert brittle.elongation[:breaks].max() <= 0.02
    assert (brittle.force[breaks:] == 0.0).all()


def test_the_report_says_when(run: clast.Run):
    said = [note for note in run.report.notes if note.startswith("bolt")]
    assert len(said) == 2
    assert said[0].startswith("bolt 'soft' yielded at t = 0.0")
    assert said[1].startswith("bolt 'brittle' broke at t = 0.")
    assert clast.read(run.output).report.notes == run.report.notes
