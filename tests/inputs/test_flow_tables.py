"""[flow] and its boundaries and wells: what they are on blocks, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.actions.flow import water_at
from clast.errors import ClastError
from scenes import wet_rock

SETS = ((0.0, 1.0), (90.0, 1.0))
LEFT = '[[flow_boundary]]\nname = "left"\nwhere = {side = "left"}\nhead = 6.0\n'
RIGHT = '[[flow_boundary]]\nname = "right"\nwhere = {side = "right"}\nhead = 2.0\n'
FULL = 'state = "transient"\ncoupling = "full"\n'


def wet(more: str) -> clast.Model:
    return wet_rock.cut(10.0, *SETS, more="[flow]\n" + more)


def inflow(model: clast.Model, name: str) -> float:
    """Return what flows into the rock at a boundary or well, m2/s."""
    water = water_at(model, 0.0)
    mine = water.conditions.part == model.flow.names.index(name)
    solved = water.solved
    into = solved.given + water.conditions.inflow - solved.outflow - solved.runoff
    return float(into[mine].sum())


def test_faces_of_no_boundary_give_water_off_where_rock_is_bare():
    model = wet(LEFT)
    (note,) = [one for one in model.notes if one.startswith("flow")]
    assert "10 m 'left' (head)" in note
    assert "10 m bare" in note
    assert "20 m tight" in note


def test_rain_is_that_on_the_horizontal_and_runs_off_where_it_cannot_enter():
    top = '[[flow_boundary]]\nname = "rain"\nwhere = {{side = "top"}}\nrain = {0}\n'
    for rain in (1e-9, 1e-3):
        model = wet(RIGHT + top.format(rain))
        water = water_at(model, 0.0)
        assert water.conditions.inflow.sum() == pytest.approx(10.0 * rain, rel=1e-12)
        entered = inflow(model, "rain")
        drained = -inflow(model, "right")
        assert entered == pytest.approx(drained, rel=1e-9)
        if rain < 1e-6:
            assert water.solved.runoff.sum() == pytest.approx(0.0, abs=1e-20)
            assert entered == pytest.approx(10.0 * rain, rel=1e-9)
        else:
            assert 0.0 < entered < 1e-2 * 10.0 * rain


def test_wells_take_what_they_are_told_and_drains_take_what_comes():
    pump = '[[well]]\nname = "well"\nat = [5.3, 3.4]\nrate = -1e-9\n'
    assert inflow(wet(LEFT + RIGHT + pump), "well") == pytest.approx(-1e-9, rel=1e-9)
    drain = '[[well]]\nname = "well"\nline = [[4.0, 2.0], [7.0, 2.1]]\npressure = 0.0\n'
    model = wet(LEFT + RIGHT + drain)
    assert len(model.flow.wells[0].at) == 3
    assert inflow(model, "well") < 0.0
    # above the water a well would give water; a drain takes what comes, here none
    high = '[[well]]\nname = "well"\nat = [5.3, 8.4]\npressure = 1e4\n'
    assert inflow(wet(LEFT + RIGHT + high), "well") > 0.0
    assert inflow(wet(LEFT + RIGHT + high + "only_outflow = true\n"), "well") == 0.0


def test_flux_enters_over_the_length_of_its_boundary():
    flux = '[[flow_boundary]]\nname = "in"\nwhere = {edges = [[[0, 2], [0, 6]]]}\nflux = 1e-9\n'
    model = wet(RIGHT + flux)
    water = water_at(model, 0.0)
    on = water.conditions.inflow > 0.0
    assert on.any()
    length = water.conditions.inflow.sum() / 1e-9
    # whole faces between joints
    assert 3.0 - 1e-9 <= length <= 4.0 + 1e-9
    assert inflow(model, "in") == pytest.approx(length * 1e-9, rel=1e-9)


def test_the_same_from_a_script():
    table = wet_rock.cut(10.0, *SETS, more="[flow]\n" + LEFT + RIGHT)
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, aperture=2e-4)
    for one in wet_rock.polygons_of(table):
        builder.block(vertices=one.tolist())
    builder.flow = {"viscosity": 1e-3}
    builder.flow_boundary("left", side="left", head=6.0)
    builder.flow_boundary("right", side="right", head=2.0)
    model = builder.build()
    assert inflow(model, "left") == pytest.approx(inflow(table, "left"), rel=1e-12)
    text = builder.to_toml(end=1.0, step=1e-2)
    again = clast.Case.from_text(text, "case").model()
    assert inflow(again, "left") == inflow(model, "left")


WELL = '[[well]]\nname = "w"\n'


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("viscosity = 1.3\n", "looks like cP"),
        ("viscosity = 1.0\n", "looks like cP"),
        ("viscosity = 1e-6\n", "looks like m2/s"),
        ("bulk_modulus = 2.0\n", "looks like GPa"),
        ("longest = 1e-6\n", "channels, of 1000000 at most"),
        ("passes = 5\n", 'belongs to coupling = "full"'),
        ('state = "transient"\ncoupling = "steady"\n', 'does not go with state = "transient"'),
        (LEFT.replace("head = 6.0", "rain = 10.0"), "more than any rain"),
        (LEFT + LEFT, "there are two flows with that name"),
        ("density = 1.0\n", "looks like t/m3"),
        ('state = "hydrostatic"\n', "level"),
        ("level = 3.0\n", "belongs to water at rest"),
        ('initial = "dry"\n', 'belongs to state = "transient"'),
        ('coupling = "full"\n', 'does not go with state = "steady"'),
        (FULL, "opens and closes the joint"),
        ('state = "transient"\ninitial = "hydrostatic"\n', "level"),
        ('state = "hydrostatic"\nlevel = 3.0\n' + LEFT, "water at rest has no boundaries"),
        (
            LEFT + LEFT.replace('"left"\nw', '"two"\nw').replace("6.0", "3.0"),
            "as well, with another",
        ),
        ('[[flow_boundary]]\nwhere = {opening = "cave"}\nseepage = true\n', "no opening 'cave'"),
        ('[[flow_boundary]]\nwhere = {side = "left"}\n', "has neither head"),
        (LEFT + "pressure = 1.0\n", "has head and pressure"),
        (
            "[[flow_boundary]]\nwhere = {edges = [[[20, 0], [20, 9]]]}\nhead = 1\n",
            "no joint with an",
        ),
        (WELL + "at = [5.77, 3.91]\npressure = 0.0\n", "is not on a joint"),
        (WELL + "line = [[5.75, 3.85], [5.8, 3.9]]\npressure = 0.0\n", "crosses no joint"),
        (WELL + "at = [5.3, 3.4]\n", "has neither pressure"),
        (WELL + "at = [5.3, 3.4]\nrate = 1.0\nonly_outflow = true\n", "does not go with a rate"),
        ('[[measured_flow]]\nname = "a"\nof = "lefd"\n' + LEFT, "'left'"),
        (LEFT + "[[water]]\nlevel = 3.0\n", "in which .flow. lets water flow"),
        (
            LEFT.replace("head = 6.0", 'amplitude = "low"')
            + "[amplitude.low]\ntime = [0, 1]\nvalue = [-5, -6]\n",
            "below all joints",
        ),
    ],
)
def test_broken_flows_are_refused(more, said):
    with pytest.raises(ClastError, match=said) as fault:
        wet(more)
    assert fault.value.remedy


WRONG = {
    "[flow]\n": {
        "viscosity": ("0", "-1e-3", "nan", "inf", '"thin"'),
        "density": ("0", "nan", "1e30"),
        "bulk_modulus": ("0", "nan"),
        "longest": ("0", "-1", "nan"),
        "passes": ("0", "2.5"),
        "state": ('"quick"', "3"),
        "coupling": ('"both"',),
        "confined": ('"yes"', "1"),
        "level": ('"high"',),
        "visosity": ("1e-3",),
    },
    '[flow]\n[[flow_boundary]]\nwhere = {side = "left"}\n': {
        "head": ("nan", '"six"', "1e30"),
        "flux": ("inf",),
        "rain": ("-1e-8",),
        "seepage": ("false",),
        "amplitude": ('"none"',),
        "name": ("3",),
    },
    "[flow]\n[[flow_boundary]]\nhead = 6.0\n": {
        "where": (
            "{}",
            '"left"',
            '{side = "west"}',
            '{side = "left", opening = "x"}',
            "{polygon = [[0, 0], [1, 1]]}",
            "{polygon = []}",
            "{edges = []}",
            "{edges = [[0, 0], [0, 9]]}",
            "{edges = [[[5, 5], [6, 5]]]}",
        ),
    },
    "[flow]\n" + LEFT + WELL + "pressure = 0.0\n": {
        "at": ("[5.3]", "[nan, 3]", '"left"'),
        "line": ("[[1, 1], [1, 1]]", "[[1, 1]]"),
    },
    "[flow]\n" + LEFT + WELL + "at = [5.3, 3.4]\n": {
        "pressure": ("nan",),
        "rate": ("inf",),
        "head": ('"x"',),
    },
    "[flow]\n" + LEFT + '[[measured_flow]]\nname = "m"\n': {"of": ("3", '"none"')},
    "[flow]\n" + LEFT + '[[stage]]\nname = "a"\n': {
        "flow_boundary": ('"left"', "{left = 4.0}", '{left = {head = "x"}}', "{left = {}}"),
        "flow": ('"transient"', "{state = 3}", '{state = "transient", x = 1}'),
    },
}
"""Table -> its keys with values that they cannot have."""


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [(one, key, each) for one, keys in WRONG.items() for key in keys for each in keys[key]],
)
def test_values_that_keys_cannot_have_are_refused_by_their_names(table, key, value):
    with pytest.raises(ClastError) as fault:
        case = wet_rock.case_of(10.0, *SETS, more=table + f"{key} = {value}\n")
        case.model()
        case.schedule()
    told = str(fault.value)
    assert key in told
    assert "pydantic" not in told and "Input should" not in told


def test_other_processes_refuse_water_in_the_equations_of_blocks():
    stiff = wet_rock.CUT.replace("aperture = 2e-4", "aperture = 2e-4\nnormal_stiffness = 1e10")
    text = stiff.format(boundary=[[0, 0], [4, 0], [4, 4], [0, 4]]) + wet_rock.SET.format(0.0, 1.0)
    case = text + '[method]\nprocess = "open-close"\n[flow]\n' + FULL
    with pytest.raises(ClastError, match='by the process "convex" alone'):
        clast.Case.from_text(case, "case").run()


def test_water_needs_somewhere_to_go():
    """Seepage is on bare rock: all tight, a flux has nowhere to go."""
    tight = "".join(
        f'[[flow_boundary]]\nname = "{side}"\nwhere = {{side = "{side}"}}\nimpermeable = true\n'
        for side in ("top", "left", "right", "bottom")
    )
    well = '[[well]]\nname = "well"\nat = [5.3, 3.4]\nrate = 1e-9\n'
    with pytest.raises(ClastError, match="nowhere to go: 1e-09 m2/s for 200 m of joints"):
        wet(tight + well)


def test_a_flow_without_apertures_and_boundaries_without_a_flow_are_refused():
    text = wet_rock.CUT.replace("aperture = 2e-4", "")
    case = text.format(boundary=[[0, 0], [4, 0], [4, 4], [0, 4]]) + wet_rock.SET.format(0.0, 1.0)
    with pytest.raises(ClastError, match="no joint between two blocks has an aperture"):
        clast.Case.from_text(case + "[flow]\n", "case").model()
    with pytest.raises(ClastError, match=r"there is no \[flow\]"):
        clast.Case.from_text(case + LEFT, "case").model()
    tilted = case.replace("[0.0, -9.81]", "[1.0, -9.81]").replace(
        "angle = 30.0", "angle = 30.0\naperture = 1e-4"
    )
    with pytest.raises(ClastError, match="gravity straight down"):
        clast.Case.from_text(tilted + "[flow]\n", "case").model()


def test_tilted_blocks_without_gravity_are_confined():
    model = wet(RIGHT.replace("head", "pressure"))
    assert not model.flow.confined
    text = wet_rock.CUT.replace("-9.81", "0.0").format(boundary=[[0, 0], [4, 0], [4, 4], [0, 4]])
    text += wet_rock.SET.format(20.0, 1.0) + "[flow]\n"
    text += LEFT.replace("head", "pressure") + RIGHT.replace("head", "pressure")
    water = water_at(clast.Case.from_text(text, "case").model(), 0.0)
    pressure = water.solved.pressure
    on = water.conditions.part < 2
    assert np.ptp(pressure) == pytest.approx(4.0, rel=1e-9)
    assert on.any()


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"flow_boundary": {"lefd": {"head": 1.0}}}, "no flow boundary 'lefd'"),
        ({"flow_boundary": {"left": {"head": 1.0, "rain": 1.0}}}, "has head and rain"),
        ({"flow": {"state": "slow"}}, "state"),
        ({"install": ["drian"]}, "no bolt, kind of bolt or well 'drian'"),
        ({"loads": ["lefd"]}, "'left'"),
    ],
)
def test_broken_stages_of_a_flow_are_refused(keys, said):
    boundary = LEFT + '[[well]]\nname = "drain"\nat = [5.3, 3.4]\npressure = 0.0\n'
    case = wet_rock.case_of(10.0, *SETS, more="[flow]\n" + boundary)
    with pytest.raises(ClastError, match=said) as fault:
        case.with_(stage=[{"name": "one", "until": "time", "time": 1.0, **keys}]).run()
    assert fault.value.remedy


def test_a_stage_without_a_flow_or_without_gravity_changes_none():
    stage = {"name": "one", "until": "time", "time": 1.0}
    with pytest.raises(ClastError, match="no water flows"):
        wet_rock.case_of(4.0, *SETS).with_(stage=[{**stage, "flow": {"state": "steady"}}]).run()
    case = wet_rock.case_of(4.0, *SETS, more="[flow]\n" + LEFT.replace("head", "pressure"))
    case = case.with_(gravity=[0.0, 0.0])
    with pytest.raises(ClastError, match="there is no gravity, and so no head of 'left'"):
        case.with_(stage=[{**stage, "flow_boundary": {"left": {"head": 1.0}}}]).run()
