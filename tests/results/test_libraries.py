"""Recordings as objects of pandas and xarray."""

import sys

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.exports.csv_tables import write_csv


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


@pytest.fixture(scope="module")
def tied():
    """Return a run with a bolt that yields at once, a link, two rocks and a named joint."""
    builder = clast.ModelBuilder(title="tied", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_rock("other", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("seat", friction_angle=20.0, between=[("table", "brick")])
    builder.block(
        name="table", rock="rock", vertices=[(-2, -1), (3, -1), (3, 0), (-2, 0)], fixed=True
    )
    builder.block(name="brick", rock="other", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="hung", rock="rock", vertices=[(2, 1), (2.5, 1), (2.5, 1.5), (2, 1.5)])
    builder.link(name="hook", at=(2.25, 1.5), block="hung", x="rigid", y="rigid")
    builder.point_load(block="brick", at=(0.5, 0.5), force=(1e4, 0.0))
    return clast.simulate(builder.build(), step=1e-3, end=0.01, every=5e-3)


def test_pandas_has_words_and_units_where_csv_has_them(tied, tmp_path):
    pandas = pytest.importorskip("pandas")
    found = tied.to_pandas()
    last = found["contacts"][found["contacts"]["frame"] == 2]
    table = tied.contacts(2)
    modes = np.array(["open", "slide", "lock"])[table.mode]
    assert list(last["mode"]) == list(modes) and "slide" in modes
    assert set(last["joint"]) == {"seat"}
    assert set(last["vertex_block"]) | set(last["edge_block"]) == {"table", "brick"}
    units = found["contacts"].attrs["units"]
    assert (units["slip"], units["normal_force"], units["mode"]) == ("m", "N/m", "")
    blocks = found["blocks"]
    assert list(blocks.loc[0, "fixed"]) == [True, False, False]
    assert list(blocks.loc[2, "rock"]) == ["rock", "other", "rock"]
    assert blocks.attrs["units"]["sigma_yy"] == "Pa" and blocks.attrs["units"]["time"] == "s"
    # along and across, not x and y; as the table and its CSV file
    links = found["links"]
    assert set(links["state"]) == {"intact"} and set(links["link"]) == {"hook"}
    assert links["force_along"].to_numpy() == pytest.approx(tied.link("hook").force[:, 0])
    write_csv(tied, tmp_path / "out")
    written = pandas.read_csv(tmp_path / "out" / "links.csv")
    assert list(written) == list(links) and list(written["state"]) == list(links["state"])


def test_xarray_has_links_units_and_the_meaning_of_states(tied):
    pytest.importorskip("xarray")
    found = tied.to_xarray()
    force = found["link_force"].sel(link="hook", link_component="across")
    assert force.values == pytest.approx(tied.link("hook").force[:, 1])
    state = found["link_state"].attrs
    words = dict(zip(state["flag_values"], state["flag_meanings"].split(), strict=True))
    assert words == {0: "not_installed", 1: "intact", 2: "yielded", 3: "broken"}
    assert all("units" in one.attrs for one in found.data_vars.values())
    assert found["stress"].attrs == {
        "long_name": "stress (xx, yy, xy), tension positive", "units": "Pa",
    }  # fmt: skip
    assert found["energy_friction"].attrs["long_name"] == "energy friction: lost"


def test_frames_have_their_stage():
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="table", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], fixed=True)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    stages = [clast.Stage(name=name, until="time", time=4e-3) for name in ("settle", "hold")]
    run = clast.simulate(builder.build(), step=1e-3, end=0.02, every=2e-3, stages=stages)
    assert set(run.frame_stages) == {"settle", "hold"}
    frames = run.to_pandas()
    assert list(frames["blocks"]["stage"].loc[:, "brick"]) == list(run.frame_stages)
    own = frames["contacts"].groupby("frame")["stage"].first()
    assert all(stage == run.frame_stages[frame] for frame, stage in own.items())
    assert list(run.to_xarray()["stage"].values) == list(run.frame_stages)
