"""Recordings as objects of pandas and xarray."""

import sys

import numpy as np
import pytest

import clast
from clast.errors import CaseError


@pytest.fixture(scope="module")
def run():
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="table", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], fixed=True)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.measured_point("A", (0.5, 0.5), block="brick")
    builder.measured_point("B", (0.9, 0.9), block="brick")
    return clast.simulate(builder.build(), step=1e-3, end=0.01, every=5e-3)


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_what_is_missing_is_said_with_what_to_install(run, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(
        CaseError, match=rf"{name} is not installed\s*install it: pip install 'clast\[{name}\]'"
    ):
        getattr(run, f"to_{name}")()


def test_tables_of_pandas(run):
    pytest.importorskip("pandas")
    found = run.to_pandas()
    blocks = found["blocks"]
    assert (
        blocks.loc[(2, "brick"), "stress_yy" if "stress_yy" in blocks else "sigma_yy"]
        == (run.field("sigma_yy", 2)[1])
    )
    assert len(blocks) == 3 * 2 and set(blocks["rock"]) == {"rock"}
    history = found["history"]
    own = history[history["point"] == "B"]
    assert own["displacement_y"].to_numpy() == pytest.approx(run.history("B").displacement[:, 1])
    assert found["energy"]["kinetic"].to_numpy() == pytest.approx(run.energy["kinetic"])
    contacts = found["contacts"]
    assert set(contacts["vertex_block"]) <= {"table", "brick"}
    assert len(contacts) == sum(len(run.contacts(k)) for k in range(3))


def test_a_dataset_of_xarray(run):
    pytest.importorskip("xarray")
    found = run.to_xarray()
    assert dict(found.sizes) == {
        "frame": 3, "block": 2, "component": 2, "stress_component": 3, "vertex": 8,
        "instant": 11, "step_number": 10, "point": 2, "reaction": 1,
    }  # fmt: skip
    one = found["stress"].sel(block="brick", stress_component="yy").isel(frame=-1)
    assert float(one) == run.field("sigma_yy", -1)[1]
    assert found["vertices"].values == pytest.approx(run.field("vertices"))
    moved = found["point_displacement"].sel(point="A", component="y").values
    assert moved == pytest.approx(run.history("A").displacement[:, 1])
    assert found["energy_kinetic"].values == pytest.approx(run.energy["kinetic"])
    assert np.array_equal(found["instant_time"], run.energy["time"])
