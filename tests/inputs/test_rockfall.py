"""Tables of rockfall: the profile from a file, distributions, and broken inputs."""

import copy

import numpy as np
import pytest

import clast
from clast.trajectory.ground import FRICTION, RESTITUTION, SLIDING, STICKING

CASE = {
    "rockfall": {"profile": [[0, 10], [10, 8], [30, 0], [60, 0]], "surface": ["rock"]},
    "surface": {"rock": {"normal_restitution": 0.4, "tangential_restitution": 0.8}},
    "source": [{"name": "edge", "at": [2, 12], "rocks": 5, "volume": 0.5}],
}


def case_with(**tables):
    content = copy.deepcopy(CASE)
    for key, value in tables.items():
        content[key] = {**content[key], **value} if isinstance(value, dict) else value
    return clast.Case.validated(content, "rocks.toml")


def test_a_surface_with_tangential_restitution_alone_slides_with_its_angle() -> None:
    decks = case_with().campaign().ground.decks[0]
    assert decks[RESTITUTION, 0] == 0.4
    assert decks[STICKING, 0] == pytest.approx(0.2)
    assert decks[SLIDING, 0] == pytest.approx(0.2 / 0.8)
    rough = {"rock": {"normal_restitution": 0.4, "friction_angle": 30.0}}
    decks = case_with(surface=rough).campaign().ground.decks[0]
    assert decks[STICKING, 0] == 1.0
    assert decks[FRICTION, 0] == decks[SLIDING, 0] == pytest.approx(np.tan(np.radians(30.0)))


def test_values_of_a_distribution_have_its_mean_and_spread() -> None:
    spread = {"rock": {"normal_restitution": "normal(0.4, 0.05)", "friction_angle": 30.0}}
    deck = case_with(surface=spread).campaign().ground.decks[0, RESTITUTION]
    assert deck.mean() == pytest.approx(0.4, abs=1e-6)
    assert deck.std() == pytest.approx(0.05, rel=1e-2)


def test_a_profile_is_read_from_a_table_with_materials(tmp_path) -> None:
    rows = "x,y,material\n30,0,rock\n10,8,soil\n0,10,\n"
    (tmp_path / "profile.csv").write_text(rows)
    text = (
        'schema = 1\n[rockfall]\nfile = "profile.csv"\n'
        "[surface.rock]\nnormal_restitution = 0.4\nfriction_angle = 30.0\n"
        "[surface.soil]\nnormal_restitution = 0.3\nfriction_angle = 30.0\n"
        '[[source]]\nname = "a"\nat = [2, 12]\nrocks = 1\nvolume = 1.0\n'
    )
    (tmp_path / "case.toml").write_text(text)
    campaign = clast.load(tmp_path / "case.toml").campaign()
    assert (campaign.profile + campaign.origin).tolist() == [[0, 10], [10, 8], [30, 0]]
    assert [campaign.surfaces[k] for k in campaign.ground.surface] == ["soil", "rock"]


def test_a_profile_is_read_from_lines_of_a_drawing(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 6
    drawing.modelspace().add_lwpolyline([(10, 8), (30, 0)], dxfattribs={"layer": "rock"})
    drawing.modelspace().add_line((10, 8), (0, 10), dxfattribs={"layer": "soil"})
    drawing.saveas(tmp_path / "profile.dxf")
    content = {**CASE, "rockfall": {"file": str(tmp_path / "profile.dxf")}}
    content["surface"] = {"rock": CASE["surface"]["rock"], "soil": CASE["surface"]["rock"]}
    campaign = clast.Case.validated(content, "rocks.toml").campaign()
    assert (campaign.profile + campaign.origin).tolist() == [[0, 10], [10, 8], [30, 0]]
    assert [campaign.surfaces[k] for k in campaign.ground.surface] == ["soil", "rock"]


ROCK = CASE["surface"]["rock"]
SOURCE = CASE["source"][0]
RUN = {"name": "failed", "file": "none.vtkhdf"}
FENCE = {"name": "fence", "x": 40.0, "height": 2.0}
BROKEN = {
    "no profile": ({"rockfall": {"profile": None, "surface": []}}, "neither profile nor file"),
    "surfaces alone": ({"rockfall": {"profile": None}}, "is given without a profile"),
    "profile and file": ({"rockfall": {"file": "a.csv"}}, "has profile and file"),
    "no volume": ({"source": [{**SOURCE, "volume": None}]}, "volume"),
    "volume of a block": ({"source": [{**RUN, "volume": 2.0}]}, "blocks of a run"),
    "speed of no run": ({"source": [{**SOURCE, "faster_than": 2.0}]}, "no file of a run"),
    "one point": ({"rockfall": {"profile": [[0, 0]]}}, "has 1 point"),
    "a point twice": ({"rockfall": {"profile": [[0, 0], [0, 0], [1, 0]]}}, "point 2 at the place"),
    "a loop": (
        {"rockfall": {"profile": [[0, 0], [4, 4], [4, 0], [0, 4], [9, 9]]}},
        "crosses or touches itself",
    ),
    "surfaces": ({"rockfall": {"surface": ["rock", "rock"]}}, "2 surface(s) for 3 segment(s)"),
    "a surface's name": ({"rockfall": {"surface": ["rack"]}}, "there is no surface 'rack'"),
    "restitution": ({"surface": {"rock": {**ROCK, "normal_restitution": 1.2}}}, "from 0 to 1"),
    "a tail": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "normal(0.9, 0.1)"}}},
        "truncate it",
    ),
    "a word": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "norml(0.9, 0.1)"}}},
        "there is no distribution 'norml'",
    ),
    "no friction": ({"surface": {"rock": {"normal_restitution": 0.4}}}, "neither tangential"),
    "no place": ({"source": [{**SOURCE, "at": None}]}, "neither at nor line"),
    "no source": ({"source": []}, "nothing falls"),
    "beside": ({"source": [{**SOURCE, "at": [-5, 3]}]}, "beside the profile"),
    "shape": ({"source": [{**SOURCE, "shape": [[0, 0], [0, 1], [1, 0]]}]}, "not a convex polygon"),
    "no rocks": ({"source": [{**SOURCE, "rocks": 0}]}, "rocks"),
    "text for speed": ({"source": [{**SOURCE, "velocity": ["fast", 0.0]}]}, "velocity"),
    "a barrier beside": ({"barrier": [{**FENCE, "x": 61.0}]}, "beside the profile"),
    "capacity": ({"barrier": [{**FENCE, "capacity": -1.0}]}, "capacity"),
    "names": ({"barrier": [FENCE], "collector": [{"name": "fence", "x": 4}]}, "fence"),
    "a barrier twice": ({"barrier": [FENCE, FENCE]}, "there are two stations with that name"),
    "a wall that holds": (
        {"barrier": [{**FENCE, "capacity": 1e5, "restitution": 0.5}]},
        "is given, but only walls have it",
    ),
    "shape and corners": (
        {"source": [{**SOURCE, "shape": [[0, 0], [1, 0], [0, 1]], "corners": 5}]},
        "all rocks have the shape",
    ),
    "a source below": ({"source": [{**SOURCE, "at": [2, -50]}]}, "below the profile, which is at"),
    "millimetres": ({"rockfall": {"profile": [[0, 0], [1e15, 0]]}}, "1e+15 m wide or high"),
    "gravity": ({"gravity": [0.0, 9.8]}, "points up"),
    "seed": ({"rockfall": {"seed": -1}}, "seed"),
    "a number in quotes": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "0.4"}}},
        "'0.4' is not a distribution",
    ),
    "a list in quotes": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "[0.3, 0.4]"}}},
        "write a number without quotes",
    ),
    "no spread": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "normal(0.4)"}}},
        "normal lacks sd",
    ),
    "an instruction": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "import os"}}},
        "is not a valid distribution",
    ),
    "texts": (
        {"surface": {"rock": {**ROCK, "normal_restitution": "discrete(['a'])"}}},
        "values that are not numbers",
    ),
    "no roughness": (
        {"surface": {"rock": {**ROCK, "roughness_spacing": 1.0}}},
        "without roughness",
    ),
    "no facets": (
        {"surface": {"rock": {**ROCK, "roughness": 3.0, "roughness_spacing": 0.0}}},
        "must be above 0",
    ),
    "percent": ({"surface": {"rock": {**ROCK, "tangential_restitution": 80}}}, "from 0 to 1"),
    "a lever": ({"surface": {"rock": {**ROCK, "rolling_resistance": -1.0}}}, "from 0 to 1000"),
    "an angle": ({"surface": {"rock": {**ROCK, "friction_angle": 90.0}}}, "from 0 to 89.9"),
    "two places": ({"source": [{**SOURCE, "line": [[1, 12], [2, 12]]}]}, "has at and line"),
    "half a place": ({"source": [{**SOURCE, "at": [2]}]}, "number 2 is missing"),
    "aloft": ({"source": [{**SOURCE, "at": [2, 1e9]}]}, "far above the profile"),
    "tonnes": ({"source": [{**SOURCE, "density": 2.7}]}, "from 100 to 100000"),
    "two corners": ({"source": [{**SOURCE, "corners": 2}]}, "from 3 to 60"),
    "flat": ({"source": [{**SOURCE, "elongation": 0.5}]}, "from 1 to 20"),
    "no direction": ({"source": [{**SOURCE, "velocity": 3.0}]}, "must be a list"),
    "mass": ({"source": [{**SOURCE, "mass": 500.0}]}, "there is no such key"),
    "sources twice": ({"source": [SOURCE, SOURCE]}, "two sources with that name"),
    "a tower": ({"barrier": [{**FENCE, "height": 1e9}]}, "must be 1000 or less"),
    "a floor": ({"barrier": [{**FENCE, "inclination": 90.0}]}, "must be below 89"),
    "no height": ({"barrier": [{**FENCE, "height": 0.0}]}, "must be above 0"),
    "no surface": ({"rockfall": {"surface": []}}, "names 0 surface(s) for 3 segment(s)"),
    "upright": ({"rockfall": {"profile": [[0, 1], [0, 9]]}}, "begins and ends at the same x"),
    "no number": ({"rockfall": {"profile": [[0, float("nan")], [1, 2]]}}, "a finite number"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_tables_are_refused_in_words(name: str) -> None:
    tables, said = BROKEN[name]
    with pytest.raises(clast.ClastError) as refused:
        case_with(**tables).campaign()
    assert said in str(refused.value)
    assert "rocks.toml" in str(refused.value)
    assert "pydantic" not in str(refused.value)


def test_tables_without_a_profile_and_runs_without_blocks_are_refused() -> None:
    with pytest.raises(clast.CaseError, match=r"there is no \[rockfall\]"):
        clast.Case.validated({key: CASE[key] for key in ("surface", "source")} | BASE, "x")
    with pytest.raises(clast.CaseError, match="clast rockfall"):
        case_with().run()


def test_an_empty_file_is_no_profile(tmp_path) -> None:
    (tmp_path / "profile.csv").write_text("")
    with pytest.raises(clast.CaseError, match="begin it with a heading, such as x,y"):
        case_with(
            rockfall={"profile": None, "surface": [], "file": str(tmp_path / "profile.csv")}
        ).campaign()


def test_a_source_without_its_run_is_refused() -> None:
    with pytest.raises(clast.CaseError, match=r"none.vtkhdf: there is no such file"):
        case_with(source=[RUN]).campaign()


BASE = {"time": {"step": 1e-3, "end": 1.0}, "rock": {}}


def test_a_builder_writes_what_a_case_file_says() -> None:
    builder = clast.ModelBuilder()
    builder.add_rock("granite", young=5e10, poisson=0.2, density=2700.0)
    builder.block(vertices=[(0, -2), (60, -2), (60, -1), (0, -1)], fixed=True)
    builder.rockfall = CASE["rockfall"]
    builder.add_surface("rock", **ROCK)
    builder.source(**SOURCE)
    builder.barrier(**FENCE)
    builder.collector("road", 50.0)
    case = clast.Case.from_text(builder.to_toml(), "x")
    assert case.campaign().count == 5
    assert case.campaign().barriers == ("fence",)
