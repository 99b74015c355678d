"""Bolts of patterns where joints lie by chance: none is refused."""

import pytest

import clast

CASE = """
schema = 1
plane = "strain"
gravity = [0, -9.81]
time = {step = 1e-2, end = 1.0, dynamic_ratio = 0.0}
rock.stone = {young = 5e9, poisson = 0.25, density = 2700.0}
joint.default = {friction_angle = 35.0}
bolt_kind.bar = {stiffness = 4e7}
domain.boundary = [[-8, -4], [8, -4], [8, 8], [-8, 8]]
domain.fixed_sides = ["left", "right", "bottom", "top"]
opening = [{name = "room", shape = "box", corner = [-2, -2], size = [4, 3]}]
joint_set = [{name = "bedding", angle = 0, spacing = 50, origin = [0, JOINT]}]

[[bolt_pattern]]
name = "roof"
opening = "room"
kind = "bar"
length = 4
spacing = 1
from = 80
to = 100
anchorage = "ANCHORAGE"FREE
stage = "bolts"

[[stage]]
name = "dig"
excavate = ["room"]
release = 0.5

[[stage]]
name = "bolts"
release = {room = 1.0}
"""
ENDS, GROUTED = ("ends", ""), ("grouted", "\nfree_length = 0.3")


def case_of(joint: float, anchorage: tuple[str, str]) -> clast.Case:
    """Return a room below a joint at a height, m, with a bolt straight up in the middle."""
    text = CASE.replace("JOINT", str(joint)).replace("ANCHORAGE", anchorage[0])
    return clast.Case.from_text(text.replace("FREE", anchorage[1]), "case")


@pytest.mark.parametrize("anchorage", [ENDS, GROUTED])
def test_a_bolt_that_crosses_no_joint_carries_nothing(anchorage: tuple[str, str]):
    run = case_of(6.0, anchorage).run()
    model = run.model
    assert not len(model.bolts.ends) and len(model.bolts) == 1
    assert any("cross no joint and carry nothing: roof-1" in note for note in model.notes)
    assert [stage.outcome for stage in run.stages] == 2 * ["equilibrium"]
    assert not run.bolt_history("roof-1").force.any()


@pytest.mark.parametrize("anchorage", [ENDS, GROUTED])
def test_a_toe_just_behind_a_joint_belongs_to_the_block_before_it(anchorage: tuple[str, str]):
    """The bolt ends at y = 5: 1.9 mm behind the joint it does not cross, 10 mm it does."""
    springs = [
        len(case_of(5.0 - behind, anchorage).model().bolts.ends) for behind in (-0.01, 0.0019, 0.01)
    ]
    assert springs == [0, 0, 1]


def test_a_single_bolt_that_crosses_no_joint_is_refused():
    text = CASE.replace("JOINT", "6").replace("ANCHORAGE", "ends").replace("FREE", "")
    bolt = '[[bolt]]\nname = "alone"\nkind = "bar"\nstart = [0, 1.5]\nend = [0, 3]\n'
    with pytest.raises(clast.ClastError, match="'alone': crosses no joint: all of it is in block"):
        clast.Case.from_text(text + bolt, "case").model()
