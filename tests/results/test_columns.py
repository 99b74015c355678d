"""What pandas makes a frame of: mappings of columns of one length."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    """A block hung from a bolt under water, with a measured point."""
    builder = clast.ModelBuilder(title="hung")
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    builder.block(name="b", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.add_bolt_kind("bar", stiffness=1e7, yield_force=1e5)
    builder.bolt((0.5, 0.5), (0.5, -0.5), kind="bar", name="one")
    builder.bolt((0.7, 0.5), (0.7, -0.5), kind="bar", name="two")
    builder.water(level=0.5, name="lake")
    builder.measured_point("A", (0.5, 0.5), block="b")
    path = tmp_path_factory.mktemp("columns") / "hung.vtkhdf"
    return clast.simulate(builder, step=1e-3, end=0.02, output=path)


def as_columns(table: Any) -> dict[str, np.ndarray]:
    """Return the columns as pandas takes them from a dict, all of one length."""
    assert isinstance(table, dict)
    columns = {name: np.asarray(table[name]) for name in table}
    assert {column.shape for column in columns.values()} == {(len(table),)}
    return columns


def test_tables_are_columns(run: clast.Run):
    for frame in (0, -1):
        columns = as_columns(run.bolts(frame))
        assert list(columns) == ["name", "force", "elongation", "state"]
        assert list(columns["name"]) == ["one", "two"]
        assert columns["state"].tolist() == [1, 1]
    for table in (run.history("A"), run.energy, run.steps, run.contacts(-1), run.block("b")):
        as_columns(table)
    as_columns(run.bolt_history("one"))
    read = clast.read(run.output).bolts(-1)
    assert as_columns(read)["force"].tolist() == run.bolts(-1).force.tolist()
    assert read.name == ("one", "two")
    assert repr(read) == "FrameBolts(2: 2 intact)"


def test_no_bolts_are_no_rows():
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1)], fixed=True)
    run = clast.simulate(builder, step=1e-3, end=2e-3)
    assert len(run.bolts(-1)) == 0
    assert all(len(column) == 0 for column in as_columns(run.bolts(-1)).values())


def test_water_says_what_it_is(run: clast.Run):
    (water,) = run.water
    said = repr(water)
    assert said.startswith("Water('lake', under a level; ")
    assert "array" not in said
    assert len(said) < 120
    assert repr(clast.read(run.output).water) == f"({said},)"
    assert repr(water.faces) == f"WetFaces({len(water.faces.edge)} parts of edges)"
    assert repr(water.joints) == f"WetJoints({len(water.joints.edge)} parts of joints)"
