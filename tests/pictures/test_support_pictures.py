"""Reactions and links in pictures: where they are drawn, and in which colours."""

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.pictures.supports import (
    forces_in,
    handles_of_links,
    places_of,
    reaction_arrows,
    states_of,
)


def beam() -> clast.ModelBuilder:
    """Return a beam that lies on two noses of a fixed block, its centre nearer to the right one."""
    builder = clast.ModelBuilder(title="Beam", gravity=(0.0, -10.0))
    builder.add_rock("rock", young=1e10, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    for name, x in (("left", 0.0), ("right", 2.0)):
        nose = [(x - 0.1, -3.0), (x + 0.1, -3.0), (x + 0.1, 0.0), (x - 0.1, 0.0)]
        builder.block(name=name, vertices=nose, fixed=True)
        builder.measured_reaction(name, block=name)
    builder.block(name="beam", vertices=[(-0.1, 0.0), (2.9, 0.0), (2.9, 0.2), (-0.1, 0.2)])
    return builder


@pytest.mark.parametrize("read", [False, True])
def test_reactions_act_where_their_lines_pass_the_contacts(tmp_path: Path, read: bool):
    file = tmp_path / "run.vtkhdf"
    builder = beam()
    run = clast.simulate(builder.build(), end=0.5, step=5e-3, dynamic_ratio=0.0, output=file)
    found = {
        name: (at, force) for name, at, force in forces_in(clast.read(file) if read else run, -1)
    }
    # the tops of the noses are at 0, their centroids 1.5 m below
    for name in ("left", "right"):
        at, force = found[name]
        assert abs(at[1]) < 1e-4 and force[1] > 0.0
        arm = at - run.model.reactions.about[run.reaction_name.index(name)] - run.origin
        moment = arm[0] * force[1] - arm[1] * force[0]
        assert moment == pytest.approx(run.reaction(name).moment[-1], abs=1e-6 * force[1])
    arrows = {one.label.split(":")[0]: one for one in reaction_arrows(run, -1, 3.0)}
    for name, arrow in arrows.items():
        push = arrow.tip - arrow.tail
        assert push @ found[name][1] == pytest.approx(np.hypot(*push) * np.hypot(*found[name][1]))
    picture = clast.plot_results(run, tmp_path / "beam.svg", reactions=True).read_text()
    assert "right: " in picture


def linked() -> clast.ModelBuilder:
    """Return two bars: on a hinge, on a torsion spring that yields, and a tie that breaks."""
    builder = clast.ModelBuilder(title="Bars", gravity=(0.0, -10.0))
    builder.add_rock("steel", young=2e11, poisson=0.3, density=7800.0)
    builder.add_joint(friction_angle=0.0)
    builder.block(vertices=[(-1, 1), (3, 1), (3, 1.2), (-1, 1.2)], name="ground", fixed=True)
    for name, x in (("one", 0.0), ("other", 1.0)):
        bar = [(x, -0.05), (x + 1, -0.05), (x + 1, 0.05), (x, 0.05)]
        builder.block(vertices=bar, name=name)
    builder.link(name="hinge", at=(0, 0), block="one", x="rigid", y="rigid")
    keys = {"rotation": 1e4, "yield_moment": 10.0, "contacts": False}
    builder.link(name="knee", at=(1, 0), blocks=("one", "other"), x="rigid", y="rigid", **keys)
    builder.link(name="tie", at=(2, 0), block="other", y=1e4, rupture=1e-3)
    return builder


def test_links_are_drawn_where_they_are_by_their_state(tmp_path: Path):
    file = tmp_path / "run.vtkhdf"
    run = clast.simulate(linked().build(), end=0.2, step=2e-3, output=file)
    again = clast.read(file)
    for results in (run, again):
        assert states_of(results, 0).tolist() == [1, 1, 1]
        assert states_of(results, -1).tolist() == [1, 2, 3]
        labels = [one.get_label() for one in handles_of_links(results, -1)]
        assert labels == ["link", "link, yielded", "link, broken"]
        places = places_of(results, -1)
        # what is rigid keeps both of its points together; the ground does not move
        assert np.abs(places[:2, 0] - places[:2, 1]).max() < 1e-6
        assert places[0, 1].tolist() == pytest.approx([0.0, 0.0])
        assert places[2, 0, 1] < -1e-3
    drawn = clast.plot_results(again, tmp_path / "links.svg").read_text()
    for colour in ("#0b6b50", "#8e24aa", "#c0143c"):
        assert colour in drawn
    before = clast.plot_results(again, tmp_path / "first.svg", frame=0).read_text()
    assert "#8e24aa" not in before


def test_the_summary_counts_links_by_state_and_says_when_they_give_way(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    from clast.cli.result_commands import info

    file = tmp_path / "run.vtkhdf"
    run = clast.simulate(linked().build(), end=0.2, step=2e-3, output=file)
    assert [(one.kind, one.what) for one in run.events] == [("yielded", "knee"), ("broke", "tie")]
    info(file)
    printed = capsys.readouterr().out
    assert "1 intact, 1 yielded, 1 broken" in printed
    assert "link 'knee' yields (rotation)" in printed and "link 'tie' breaks (across)" in printed


def test_linked_blocks_that_may_overlap_are_no_overlap():
    run = clast.simulate(linked().build(), end=0.3, step=2e-3)
    assert not [one for one in run.report.warnings if "overlap" in one]
