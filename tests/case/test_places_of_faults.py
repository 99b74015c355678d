"""Places of faults and remarks: keys of the case file, and points in the section."""

import copy
import pickle

import pytest

from clast.case.case_file import Case
from clast.errors import CaseError, ModelError, Remark
from clast.inputs.declaring.places import place_of, points_at, points_in

BLOCKS = """
schema = 1
time = {step = 1e-3, end = 0.01}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[[block]]
name = "base"
vertices = [[0, 0], [4, 0], [4, 1], [0, 1]]
fixed = true
[[block]]
name = "top"
vertices = [[1, 1], [3, 1], [3, 2], [1, 2]]
[[measured_point]]
name = "foot"
at = [2, 0.5]
block = "base"
"""
ROCK = """
schema = 1
time = {step = 1e-3, end = 0.01}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0}
[domain]
boundary = [[0, 0], [8, 0], [8, 6], [0, 6]]
smallest_edge = 0.05
[[trace]]
points = [[0, 2], [8, 3]]
[[trace]]
points = [[2, 0], [2.01, 6]]
[[trace]]
points = [[5, 4], [6, 5]]
"""


def error_of(text: str) -> CaseError:
    with pytest.raises(CaseError) as caught:
        Case.from_text(text, "x").examine()
    return caught.value


def test_a_fault_of_the_file_has_the_place_that_pydantic_has():
    error = error_of(BLOCKS.replace("friction_angle = 30.0", "friction_angle = 95.0"))
    assert (error.place, error.at) == (("joint", "default", "friction_angle"), ())
    both = error_of(BLOCKS.replace("young = 1e9", "young = 0.0").replace("end = 0.01", "end = -1"))
    assert [one.place for one in both.faults] == [("time", "end"), ("rock", "stone", "young")]


def test_a_fault_of_the_model_has_a_place_and_the_points_that_it_names():
    beside = error_of(BLOCKS.replace("at = [2, 0.5]", "at = [9, 9]"))
    assert isinstance(beside, ModelError)
    assert beside.where == "x: measured point 'foot' at (9, 9)"
    assert (beside.place, beside.at) == (("measured_point", 0, "at"), ((9.0, 9.0),))
    crossed = error_of(
        BLOCKS.replace("[[0, 0], [4, 0], [4, 1], [0, 1]]", "[[0, 0], [4, 1], [4, 0], [0, 1]]")
    )
    assert (crossed.place, crossed.at) == (("block", 0), ((2.0, 0.5),))


def test_a_fault_that_names_no_point_is_at_its_value_or_its_table():
    unknown = error_of(BLOCKS.replace('block = "base"', 'block = "bsae"'))
    assert unknown.place == ("measured_point", 0, "block")
    assert unknown.at == ((2.0, 0.5),)
    crossed = ROCK.replace("[[0, 0], [8, 0], [8, 6], [0, 6]]", "[[0, 0], [8, 6], [8, 0], [0, 6]]")
    assert error_of(crossed).place == ("domain", "boundary")
    assert error_of(crossed).at == ((4.0, 3.0),)


def test_several_faults_of_a_group_are_told_together():
    head = "[[measured_point]]\nname = "
    more = f'{head}"far"\nat = [20, 0]\n{head}"on"\nat = [2, 1]\n'
    error = error_of(BLOCKS.replace("at = [2, 0.5]", "at = [9, 9]") + more)
    assert error.what.startswith("3 things to put right\n  measured point 'foot' at (9, 9): ")
    assert [one.place for one in error.faults] == [("measured_point", k, "at") for k in range(3)]
    assert [one.at for one in error.faults] == [((9.0, 9.0),), ((20.0, 0.0),), ((2.0, 1.0),)]
    assert error.faults[2].remedy.startswith("name the one that it moves with")


def test_places_do_not_depend_on_the_order_of_the_tables():
    head, _, point = BLOCKS.partition("[[measured_point]]")
    second = '[[measured_point]]\nname = "first"\nat = [2, 1.5]\n[[measured_point]]'
    wrong = point.replace("at = [2, 0.5]", "at = [9, 9]")
    assert error_of(head + second + wrong).place == ("measured_point", 1, "at")


def test_warnings_and_notes_are_texts_with_places():
    soft = BLOCKS.replace("young = 1e9", "young = 1e5")
    (small,) = (one for one in Case.from_text(soft, "x").examine().warnings if "young is" in one)
    assert isinstance(small, Remark)
    assert small.place == ("rock", "stone", "young")
    (cut,) = (one for one in Case.from_text(ROCK, "x").examine().notes if "border no block" in one)
    assert (cut.place, len(cut.at)) == (("domain",), 1)
    assert 5.0 <= cut.at[0][0] <= 6.0
    for same in (copy.deepcopy(cut), pickle.loads(pickle.dumps(cut))):
        assert (same, same.place, same.at) == (cut, cut.place, cut.at)


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ("measured point 'foot' at (0, 33)", ("measured_point", 0)),
        ("block 2 'top', vertex 3 at (1, 2)", ("block", 1)),
        ("block 'top' is 0.1 m wide", ("block", 1)),
        ("block 7 'none'", ()),
        ("rock 'stone', poisson", ("rock", "stone", "poisson")),
        ("[time] end", ("time", "end")),
        ("nothing is fixed", ()),
        ("12 words", ()),
    ],
)
def test_words_lead_to_keys(words, place):
    content = Case.from_text(BLOCKS, "x").model_dump(by_alias=True, exclude_unset=True)
    found = place_of(words, content, Case)
    assert found[: len(place)] == place
    assert bool(found) == bool(place)


def test_stresses_and_accelerations_are_no_points():
    assert points_in("gravity is (0, 9.8) m/s2, (-1e3, 2) Pa, (1, 0) m at (1.5, -2e3)") == (
        (1.5, -2e3),
    )


def test_points_of_a_value_are_those_of_the_file():
    content = Case.from_text(ROCK, "x").model_dump(by_alias=True, exclude_unset=True)
    assert points_at(("trace", 1), content, Case) == ((2.0, 0.0), (2.01, 6.0))
    assert points_at(("domain", "smallest_edge"), content, Case)[2] == (8.0, 6.0)
    assert points_at(("rock", "stone"), content, Case) == ()
