"""Bolts in pictures: lines, their legend, and what a bolt bore over time."""

from pathlib import Path

import numpy as np

import clast
from clast.pictures.supports import handles_of_bolts
from clast.results import FrameBolts


def bolts() -> FrameBolts:
    force, state = np.array([2e4, 1e4, 0.0, 0.0, 0.0]), np.array([1, 2, 3, 0, 4])
    row = {"force": force, "elongation": np.zeros(5), "state": state}
    return FrameBolts(("a", "b", "c", "d", "e"), np.zeros((10, 2)), np.repeat(np.arange(5), 2), row)


def test_the_legend_tells_states_and_largest_forces():
    labels = [handle.get_label() for handle in handles_of_bolts(bolts())]
    assert labels == [
        "bolt, not installed",
        "bolt, up to 20 kN/m",
        "bolt, yielded, up to 10 kN/m",
        "bolt, broken",
    ]


def test_frames_and_histories_are_drawn(tmp_path: Path):
    builder = clast.ModelBuilder(title="Three bolts", gravity=(0.0, -10.0))
    builder.add_rock("rock", young=1e12, poisson=0.2, density=2500.0)
    builder.block(vertices=[(-2, 1), (2, 1), (2, 2), (-2, 2)], name="beam", fixed=True)
    builder.block(vertices=[(-1, -1), (1, -1), (1, 0), (-1, 0)], name="box")
    builder.add_bolt_kind("strong", stiffness=1e6)
    builder.add_bolt_kind("soft", stiffness=1e6, yield_force=1e4)
    builder.add_bolt_kind("brittle", stiffness=1e6, rupture_elongation=0.02)
    for x, kind in ((-0.5, "strong"), (0, "soft"), (0.5, "brittle")):
        builder.bolt((x, -0.5), (x, 1.5), kind=kind, name=kind)
    run = clast.simulate(builder, end=0.15, step=2e-3)
    frame = clast.plot_results(run, tmp_path / "frame.svg")
    drawn = frame.read_text()
    for colour in ("#0b6b50", "#8e24aa", "#c0143c"):
        assert colour in drawn
    curve = clast.plot_bolt_history(run, tmp_path / "brittle.svg", "brittle")
    assert "#c0143c" in curve.read_text()
    clast.plot_results(run, tmp_path / "frame.png")
    clast.plot_bolt_history(run, tmp_path / "soft.png", "soft")
