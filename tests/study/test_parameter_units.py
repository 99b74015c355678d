"""Units of parameters: of the keys that they set, as the reference of the case file has them."""

import pytest

from clast.case.case_file import json_schema
from clast.pictures.study.figures import Bar
from clast.study.description import parameters_of
from clast.study.parameters import ParameterPlaces, unit_of_key, units_of, with_units

CASE = {
    "time": {"step": 0.01, "end": 1.0},
    "joint": {"a": {"cohesion": 1e4, "friction_angle": 30.0}, "b": {"cohesion": 2e4}},
}


@pytest.fixture(scope="module")
def schema():
    return json_schema()


@pytest.mark.parametrize(
    ("keys", "unit"),
    [
        (("joint", "plane", "cohesion"), "Pa"),
        (("joint", "plane", "friction_angle"), "°"),
        (("joint", "plane", "shear_stiffness"), "Pa/m"),
        (("rock", "rock", "poisson"), ""),
        (("gravity", 1), "m/s2"),
        (("block", 0, "vertices", 2, 1), "m"),
        (("water", 0, "level"), "m"),
        (("domain", "seed"), ""),
        (("joint_set", 0, "spacing"), "m"),
        (("joint_set", 0, "spacing", "mean"), "m"),
        (("joint_set", 0, "angle_spread", "kappa"), ""),
        (("stage", 1, "joint", "plane", "cohesion"), "Pa"),
        (("method", "contact_law", "normal_stiffness"), "N/m per m"),
        (("damping", "mass"), "1/s"),
        (("nothing", "of", "it"), ""),
    ],
)
def test_a_key_has_the_unit_of_its_meaning(schema, keys, unit):
    assert unit_of_key(schema, keys) == unit


def test_parameters_have_units_where_all_their_keys_have_the_same():
    vary = parameters_of(
        {
            "c: joint.a.cohesion": "normal(1e4, 1e3)",
            "both: joint.a.friction_angle, joint.b.friction_angle": "normal(30, 2)",
            "mixed: time.end, joint.b.cohesion": "uniform(1, 2)",
            "share: joint.a.tensile_strength": "uniform(1, 2)",
            "factor: time.step": "times(uniform(1, 2))",
        }
    )
    units = units_of(ParameterPlaces.of(CASE, vary))
    assert units == {"c": "Pa", "both": "°", "mixed": "", "share": "Pa", "factor": ""}
    assert with_units(["c", "mixed"], units) == ["c, Pa", "mixed"]


def test_forces_of_bolts_at_a_distance_are_of_one_bolt():
    of_one = {"young": 2e11, "area": 1e-3, "out_of_plane_spacing": 3.0, "pretension": 1e5}
    case = {**CASE, "bolt_kind": {"bar": of_one, "cable": {"stiffness": 1e7, "pretension": 1e5}}}
    vary = parameters_of(
        {f"{name}: bolt_kind.{name}.pretension": "uniform(1, 2)" for name in ("bar", "cable")}
    )
    units = units_of(ParameterPlaces.of(case, vary))
    assert units == {"bar": "N", "cable": "N per metre of thickness"}


@pytest.mark.parametrize(
    ("unit", "caption"),
    [("Pa", "c\n9000 to 12000 Pa"), ("°", "c\n9000 to 12000°"), ("", "c\n9000 to 12000")],
)
def test_a_bar_of_a_tornado_names_the_unit_of_its_parameter(unit, caption):
    bar = Bar(label="c", low=0.1, high=0.2, ends=(9e3, 1.2e4), unit=unit)
    assert bar.caption == caption
