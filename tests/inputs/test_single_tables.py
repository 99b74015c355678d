"""Tables of which there is one, as a script gives them: by their keys, or by an object."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.errors import CaseError, ModelError
from clast.model.ground_motion import InertialForce, Still
from clast.rockmass import BlockRepair

TIME, SHAKE = [0.0, 0.5, 1.0], [0.0, 2.0, -1.0]


def box(**given: Any) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(**given)
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.fixed_point((0, 0))
    builder.fixed_point((2, 0))
    return builder


def test_keys_of_in_situ_make_what_the_objects_make():
    keys = {"stress": [-2e6, -1e6, 0], "boundary": "traction", "sides": ["left", "right"]}
    by_keys, by_object = box(in_situ=keys), box()
    by_object.in_situ = clast.InSituStress(
        stress=(-2e6, -1e6, 0.0), held=(0.0, 0.0), sides=("left", "right")
    )
    assert by_keys.build().in_situ == by_object.build().in_situ
    assert by_keys.to_toml() == by_object.to_toml()
    weighed = box(in_situ={"vertical": "overburden", "k0": 0.5})
    assert weighed.in_situ == clast.Overburden(k0=0.5)


@pytest.mark.parametrize("acts", ["body-force", "base"])
def test_keys_of_a_motion_make_what_the_objects_make(acts: str):
    record = clast.Accelerogram(np.array(TIME), np.stack([SHAKE, np.zeros(3)], axis=1))
    kind = {"body-force": clast.InertialForce, "base": clast.MovingBase}[acts]
    by_keys = box(ground_motion={"acts": acts, "time": np.array(TIME), "acceleration": SHAKE})
    by_object = box(ground_motion=kind(record))
    assert by_keys.to_toml() == by_object.to_toml()
    assert f'acts = "{acts}"' in by_keys.to_toml()


def test_a_script_reads_a_record_and_writes_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "shake.csv").write_text("t,ax\n0,0\n0.5,2\n1,-1\n")
    monkeypatch.chdir(tmp_path)
    builder = box(ground_motion={"acts": "body-force", "file": "shake.csv"})
    assert isinstance(builder.ground_motion, InertialForce)
    assert builder.ground_motion.accelerogram.acceleration[:, 0].tolist() == SHAKE
    again = clast.Case.from_toml(builder.to_toml()).model().ground_motion
    assert again.accelerogram.acceleration[:, 0].tolist() == SHAKE


@pytest.mark.parametrize(
    ("key", "given", "said"),
    [
        ("in_situ", {"stres": [0, 0, 0]}, r"\[in_situ\] stres: .*did you mean 'stress'\?"),
        ("in_situ", 5, "in_situ: 5 is not a valid in-situ stress"),
        ("in_situ", clast.Overburden(k0=1.0, held="roller"), r"\[in_situ\] held"),
        ("ground_motion", {"acts": "base"}, r"\[ground_motion\]: there is no accelerogram"),
    ],
)
def test_wrong_ones_are_refused_in_the_words_of_a_file_where_they_are_given(key, given, said):
    builder = box()
    with pytest.raises(ModelError, match=f"(?s){said}"):
        setattr(builder, key, given)
    with pytest.raises(ModelError, match=f"(?s){said}"):
        box(**{key: given})


def test_blocks_that_are_put_together_come_back_from_a_file():
    def apart(**given: Any) -> clast.ModelBuilder:
        builder = box(**given)
        builder.block(vertices=[(0, 1.001), (2, 1.001), (2, 2), (0, 2)], name="upper")
        return builder

    by_keys = apart(repair={"tolerance": 3e-3})
    by_object = apart(repair=BlockRepair(tolerance=3e-3))
    assert by_keys.to_toml() == by_object.to_toml()
    again = clast.Case.from_toml(by_keys.to_toml()).model()
    assert again.vertices.tobytes() == by_keys.build().vertices.tobytes()
    assert again.vertices.tobytes() != apart().build().vertices.tobytes()
    for wrong, said in (({"tolerance": -1}, "above 0"), (7, "7 does not describe a repair")):
        with pytest.raises(ModelError, match=rf"repair\]?.*{said}"):
            apart(repair=wrong)
    with pytest.raises(ModelError, match=r"\[repair\] tolerance: must be a number"):
        apart(repair=BlockRepair(tolerance="wide"))


class Own(Still):
    """A motion that no case file has a name for."""


def test_what_no_file_can_hold_is_run_and_not_written():
    builder = box(ground_motion=Own())
    assert isinstance(builder.build().ground_motion, Own)
    with pytest.raises(CaseError, match="Own is an object of a script"):
        builder.to_toml()
    stress = clast.InSituStress(stress=(0.0, -1e6, 0.0), held=(0.5, 0.0))
    builder = box(in_situ=stress)
    assert dataclasses.replace(builder.build().in_situ, voids=()) == stress
    with pytest.raises(CaseError, match="have no name in a file"):
        builder.to_toml()


def test_a_motion_that_another_replaces_leaves_no_note():
    keys = {"acts": "body-force", "time": TIME, "acceleration": SHAKE, "after": "stop"}
    builder = box(ground_motion=keys, notes=["drawn by hand"])
    builder.ground_motion = keys
    assert [note.split("[")[0] for note in builder.notes] == ["drawn by hand", ""]


def test_without_them_there_is_nothing():
    assert isinstance(box().ground_motion, Still)
    assert box().in_situ is None
    model = box().build()
    assert isinstance(model.ground_motion, Still)
    assert model.in_situ is None
    builder = box(in_situ=clast.Overburden(k0=0.5))
    builder.in_situ = None
    assert builder.build().in_situ is None
