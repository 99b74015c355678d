"""Paths of what varies, expressions of measures, and what is refused of both."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.study.description import Description, described, parameters_of
from clast.study.expressions import read
from clast.study.fitting.observations import FitSettings, Observation
from clast.study.parameters import ParameterPlaces, content_of, keys_of, places
from clast.study.sampling import Random

CASE = tomllib.loads(
    """
gravity = [0.0, -9.81]
[time]
step = 0.01
end = 1.0
[rock.rock]
young = 1e9
[joint.bedding]
friction_angle = 30.0
cohesion = 1e4
[joint."a.b"]
cohesion = 2e4
[[block]]
name = "one"
vertices = [[0, 0], [1, 0], [1, 1]]
[[block]]
vertices = [[0, 0], [1, 0], [1, 1]]
[[water]]
level = 3.0
[method]
process = "convex"
"""
)


@pytest.mark.parametrize(
    ("path", "keys"),
    [
        ("joint.bedding.cohesion", ("joint", "bedding", "cohesion")),
        ('joint."a.b".cohesion', ("joint", "a.b", "cohesion")),
        (" time . end ", ("time", "end")),
    ],
)
def test_a_path_has_keys(path: str, keys: tuple[str, ...]) -> None:
    assert keys_of(path) == keys


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("joint.*.cohesion", [("joint", "bedding", "cohesion"), ("joint", "a.b", "cohesion")]),
        ("water.1.level", [("water", 0, "level")]),
        ("block.one.fixed", [("block", 0, "fixed")]),
        ("block.2.vertices.3.1", [("block", 1, "vertices", 2, 0)]),
        ("joint.bedding.tensile_strength", [("joint", "bedding", "tensile_strength")]),
        ("output.every", [("output", "every")]),
        ("damping.mass", [("damping", "mass")]),
        ("seismic_coefficient", [("seismic_coefficient",)]),
        ("gravity.2", [("gravity", 1)]),
    ],
)
def test_a_path_leads_to_places(path: str, found: list[tuple[object, ...]]) -> None:
    assert places(CASE, path) == found


@pytest.mark.parametrize(
    ("path", "what"),
    [
        ("joint.beding.cohesion", "no 'joint.beding'"),
        ("joint.beding", "no 'joint.beding'"),
        ("rok.rock.young", "no 'rok'"),
        ("water.2.level", "no entry '2'"),
        ("water.sea.level", "no entry 'sea'"),
        ("block.0.fixed", "no entry '0'"),
        ("bolt.1.pretension", r"no \[\[bolt\]\]"),
        ("joint_set.1.spacing", r"no \[\[joint_set\]\]"),
        ("domain.seed", r"no \[domain\]"),
        ("in_situ.k0", r"no \[in_situ\]"),
        ("bolt_kind.bar.stiffness", r"no \[bolt_kind\.NAME\]"),
        ("seismic_coefficient.1", "no 'seismic_coefficient'"),
        ("method.contact_law.normal_stiffness", "no 'method.contact_law'"),
        ("time.end.value", "single value"),
        ("joint..cohesion", "not a path"),
        ("", "not a path"),
        ("time.", "not a path"),
    ],
)
def test_a_path_that_leads_nowhere_is_refused(path: str, what: str) -> None:
    with pytest.raises(CaseError, match=what) as refused:
        places(CASE, path)
    assert refused.value.remedy


def test_a_run_has_its_values_and_shares_the_rest() -> None:
    vary = parameters_of(
        {
            "phi: joint.bedding.friction_angle, joint.a.b.x": [20.0],
            "joint.bedding.cohesion": "times([0.5])",
            "method.process.passes": [3],
        }
    )
    with pytest.raises(CaseError, match=r"no 'joint\.a'"):
        ParameterPlaces.of(CASE, vary)
    vary = parameters_of({"phi: joint.*.friction_angle": 20.0, "joint.*.cohesion": "times(0.5)"})
    found = ParameterPlaces.of(CASE, vary).case((20.0, 0.5))
    assert found["joint"]["bedding"] == {"friction_angle": 20.0, "cohesion": 5e3}
    assert found["joint"]["a.b"] == {"friction_angle": 20.0, "cohesion": 1e4}
    assert found["block"] is CASE["block"]
    assert CASE["joint"]["bedding"]["cohesion"] == 1e4


@pytest.mark.parametrize(
    ("vary", "what"),
    [
        ({"joint.bedding.tensile_strength": "times(normal(1, 0.1))"}, "not a number of the case"),
        ({"joint.*.cohesion": [1.0], "joint.bedding.cohesion": [1.0]}, "is varied twice"),
        ({"joint.bedding.cohesion": "times(['a'])"}, "has to be a number"),
    ],
)
def test_parameters_that_contradict_the_case_are_refused(vary: dict, what: str) -> None:
    with pytest.raises(CaseError, match=what):
        ParameterPlaces.of(CASE, parameters_of(vary))


# Expressions -------------------------------------------------------------------------------------

FUNCTIONS = {"displacement": lambda name, part="": [0.0, 3.0, 2.0], "steps": lambda: 7}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("displacement(A)", 2.0),
        ("largest(displacement(A))", 3.0),
        ('displacement("block 1", x) > 1', True),
        ("not (steps() == 7 and u < 1)", True),
        ("1 < u < 3 or steps() > 100", True),
        ("-u**2 + 2*3/4", -2.5),
        ("max(u, steps(), 3)", 7.0),
        ("sin(30)", 0.5),
        ("abs(-u)", 2.0),
        ("9**9**9**9", math.inf),
        ("steps()**2 - u**-1", 48.5),
    ],
)
def test_expressions_have_values(text: str, value: object) -> None:
    found = read(text, "fail", ["u"], FUNCTIONS).value({"u": 2.0}, FUNCTIONS)
    assert found == pytest.approx(value) and isinstance(found, type(value))


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("crest > 0", "no measure 'crest'"),
        ("dispacement(A)", "no function 'dispacement'"),
        ("displacement(A) >", "not an expression"),
        ("displacement(1 + 2)", "needs a name"),
        ("__import__('os').system('x')", "not allowed in an expression"),
        ("u.real", "not allowed in an expression"),
        ("[u for u in u]", "not allowed in an expression"),
        ("lambda: u", "not allowed in an expression"),
        ("'text'", "not allowed in an expression"),
        ("u if u else u", "not allowed in an expression"),
        ("u @ u", "not allowed in an expression"),
        ("u is u", "not allowed in an expression"),
        ("largest()", "has no argument"),
        ("displacement(name=A)", "not allowed in an expression"),
        ("-" * 60 + "u", "nested too deeply"),
        ("u" * 2000, "not an expression"),
        ("", "not an expression"),
        (3, "not an expression"),
    ],
)
def test_what_is_no_expression_is_refused(text: object, what: str) -> None:
    with pytest.raises(CaseError, match=what) as refused:
        read(text, "fail", ["u"], FUNCTIONS)
    assert refused.value.where == "fail" and refused.value.remedy


def test_a_division_by_zero_has_no_value() -> None:
    with pytest.raises(CaseError, match="no value"):
        read("1/0", "fail", [], []).value({}, {})


def test_an_unknown_value_is_on_no_side_of_a_limit() -> None:
    """A run with it neither stands nor fails."""
    for text in ("(-1)**0.5 < 1", "sqrt(0 - u) > 0.05", "u < v"):
        with pytest.raises(CaseError, match=r"has no value: .* is NaN"):
            read(text, "fail", ["u", "v"], []).value({"u": 2.0, "v": math.nan}, {})
    with np.errstate(all="raise"):
        assert math.isnan(read("(-1)**0.5", "measure", [], []).value({}, {}))
    assert read("log(0*u) < 1", "fail", ["u"], []).value({"u": 2.0}, {})


# The study ---------------------------------------------------------------------------------------


def study(**changes: object) -> Description:
    given: dict[str, object] = {
        "kind": "montecarlo",
        "case": "base/case.toml",
        "vary": parameters_of({"a.b": "normal(1, 2)", "c": "lognormal(3, 1)"}),
        "correlate": (("a.b", "c", -0.4),),
        "measure": {"u": "displacement(A)"},
        "fail": "u > 0.1",
        "n": 20,
        "sampling": Random(7),
    }
    return Description(**{**given, **changes}).checked()  # type: ignore[arg-type]


def test_a_study_is_read_as_it_is_written() -> None:
    one = study()
    again = described(one.text, "study.toml")
    assert again.text == one.text and again.hash == one.hash
    assert [again.values(k) for k in (1, 20)] == [one.values(k) for k in (1, 20)]


@pytest.mark.parametrize(
    "changes",
    [
        {"n": 21},
        {"sampling": Random(8)},
        {"fail": "u > 0.2"},
        {"correlate": ()},
        {"measure": {"u": "speed(A)"}},
        {"case": "base/other.toml"},
    ],
)
def test_all_that_results_depend_on_is_in_the_hash(changes: dict[str, object]) -> None:
    assert study(**changes).hash != study().hash


def test_a_sweep_has_all_combinations_or_takes_lists_in_step() -> None:
    vary = parameters_of({"a": [1, 2], "b": "range(0, 1, 3)"})
    one = study(kind="sweep", vary=vary, correlate=())
    found = [one.values(k) for k in range(1, one.n + 1)]
    assert found == [(a, b) for a in (1, 2) for b in (0.0, 0.5, 1.0)]
    step = parameters_of({"a": [1, 2], "b": [5, 6]})
    one = study(kind="sweep", vary=step, correlate=(), together=True)
    assert [one.values(k) for k in (1, 2)] == [(1, 5), (2, 6)]


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"kind": "swep"}, "no kind"),
        ({"keep": "worst"}, "cannot keep"),
        ({"vary": ()}, "no parameter varies"),
        ({"measure": {}, "fail": ""}, "the study measures nothing"),
        ({"measure": {"u": "2 + 3"}, "fail": "u > 1"}, "the study measures nothing"),
        ({"measure": {"run": "end()"}}, "every table has"),
        ({"n": 0}, "not a valid number of runs"),
        ({"n": 2.5}, "not a valid number of runs"),
        ({"n": 10**10}, "more than"),
        ({"correlate": (("a.b", "d", 0.1),)}, "does not vary"),
        ({"correlate": (("a.b", "a.b", 0.1),)}, "is one"),
        ({"correlate": (("a.b", "c", 0.1), ("c", "a.b", 0.1))}, "given twice"),
        ({"correlate": (("a.b", "c", 1.5),)}, "not a valid correlation"),
        ({"vary": parameters_of({"a.b": [1], "c": "uniform(0, 1)"})}, "not a continuous"),
        ({"vary": parameters_of({"a.b": [1]}), "correlate": ()}, "is a list"),
        ({"kind": "sweep", "correlate": ()}, "is a distribution"),
        ({"fail": "u"}, "is a number"),
        ({"fail": "displacement(A)"}, "is a number"),
        ({"fail": "u > 1 or u"}, "is a number"),
        ({"fail": "1"}, "is a number"),
        ({"kind": "fit", "fit": FitSettings(rounds=0)}, "number of rounds"),
    ],
)
def test_studies_that_cannot_be_made_are_refused(changes: dict[str, object], what: str) -> None:
    with pytest.raises(CaseError, match=what):
        _ = study(**changes).condition


@pytest.mark.parametrize(
    "fail", ["fails()", "not u > 1", "u > 1 and fails()", "b or d", "1 < u < 2", "bolt_yields(B)"]
)
def test_conditions_are_true_or_false(fail: str) -> None:
    measure = {"u": "displacement(A)", "b": "u > 3", "d": "b and fails()"}
    assert study(measure=measure, fail=fail).condition is not None


def test_a_back_analysis_is_read_as_it_is_written() -> None:
    seen = (
        Observation(point='A "1"', part=0, value=0.25, time=0.5, sd=1e-3),
        Observation(point="B", part=1, value=-1e-7, sd=2e-3),
    )
    how = FitSettings(method="es-mda", members=20, rounds=2, seed=9)
    measure = {one.measure: one.measure for one in seen}
    given = {"kind": "fit", "fit": how, "observe": seen, "measure": measure, "fail": ""}
    one = study(**given)
    again = described(one.text, "study.toml")
    assert (again.text, again.observe, again.fit) == (one.text, seen, how)
    assert again.n == 20 * 3
    assert [list(one.calls()) for one in again.measures.values()] == [
        [("displacement", ['A "1"', "x", "0.5"])],
        [("displacement", ["B", "y"])],
    ]


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("displacement(A)", "m"),
        ("-largest(abs(speed(A, x)))", "m/s"),
        ("max(displacement(A), displacement(B))", "m"),
        ("displacement(A) - displacement(B)", "m"),
        ("u - displacement(B)", "m"),
        ("contact(C, normal)", "Pa"),
        ("contact(C, slip)", "m"),
        ("1000 * displacement(A)", ""),
        ("displacement(A) + rotation(A)", ""),
        ("displacement(A) > 0.1", ""),
        ("fails()", ""),
        ("factor_of_safety()", ""),
    ],
)
def test_measures_have_units_where_they_are_known(text, unit) -> None:
    study = Description(
        kind="sweep",
        vary=parameters_of({"time.end": [1.0]}),
        measure={"u": "displacement(A)", "v": text},
    ).checked()
    assert study.units == {"u": "m", "v": unit}


# Studies of a script -----------------------------------------------------------------------------


def slab() -> clast.Case:
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2600.0)
    builder.add_joint("plane", friction_angle=34.0)
    builder.block(name="base", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    builder.block(name="slab", vertices=corners, edge_joint=["plane", "", "", ""])
    builder.measured_point("A", (1, 1), block="slab")
    builder.point_load((0.5, 1.0), (0.0, -1e3), block="slab", name="load")
    return builder.case(step=0.01, end=0.02)


PHI = "joint.plane.friction_angle"


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"measure": {"u": "displacment(A)"}}, "did you mean 'displacement'"),
        ({"measure": {"u": "displacement(B)"}}, "no point or block 'B'"),
        ({"measure": {"u": "displacement(A, x, 5)"}}, "the run ends at 0.02 s"),
        ({"measure": {"u": "factor_of_safety(A)"}}, "is of no names"),
        ({"measure": "displacement(A)"}, "has no names with expressions"),
        ({"fail": "u > 0.1"}, "no measure 'u'"),
        ({"fail": "displacement(A)"}, "is a number, not a failure condition"),
        ({"vary": {"joint.plan.friction_angle": [30.0]}}, "plan"),
        ({"vary": {"joint.plane.friction_angel": [30.0]}}, "friction_angle"),
        ({"vary": {"joint.plane.friction_angel": "normal(30, 2)"}}, "friction_angle"),
        ({"vary": {"point_load.2.at": [[1.0, 1.0]]}}, "no entry '2'"),
        ({"vary": {"point_load.load.at": [1.0, 2.0]}}, "at"),
        ({"vary": {"point_load.load.at": [[1.0, 2.0, 3.0]]}}, "at"),
        ({"vary": {"point_load.load.at.3": [1.0]}}, "1 to 2"),
        ({"vary": PHI}, "has no paths with values"),
    ],
)
def test_a_misspelt_study_is_refused_when_it_is_made(changes: dict, what: str) -> None:
    with pytest.raises(CaseError) as refused:
        clast.Study(slab(), **{"vary": {PHI: [30.0]}, "measure": {"v": "end()"}, **changes})
    assert what in str(refused.value)


def test_a_place_is_varied_as_a_whole_or_by_a_coordinate() -> None:
    places = {"point_load.load.at": [[0.25, 1.0], (0.75, 1.0)]}
    whole = clast.Study(slab(), vary=places, measure={"v": "end()"}).described()
    assert whole.values(2) == ((0.75, 1.0),)
    again = described(replace(whole, case="base/case.toml").text, "study.toml")
    assert again.values(2) == whole.values(2) and again.n == 2
    part = clast.Study(slab(), vary={"point_load.1.at.1": [0.25, 0.75]}, measure={"v": "end()"})
    content = content_of(slab())
    by_part = ParameterPlaces.of(content, part.described().vary).case((0.75,))
    assert by_part == ParameterPlaces.of(content, whole.vary).case(((0.75, 1.0),))
    assert content["point_load"][0]["at"] == [0.5, 1.0]
