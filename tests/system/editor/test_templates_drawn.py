"""Templates drawn from nothing in the window of a case, as a person does it."""

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.trajectory.campaign import portion
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")


@pytest.fixture
def empty(drawing, tmp_path):
    """Return the hand in the window of an empty file, and the file."""
    hand = drawing("")
    hand.page.locator(".level select").select_option("rare")
    return hand, tmp_path / "case.toml"


def drawn(hand, path):
    """Return the case that the file has when the hand rests."""
    until(hand.page, "!clastEditor.state.unsaved && clastEditor.state.faults.length === 0")
    return Case.from_text(path.read_text("utf-8"), str(path))


def differing(case, template):
    """Return the keys in which a case is not that of a template, with both values."""
    expected = Case.from_text(TEMPLATES[template], "case.toml").model_dump()
    found = case.model_dump()
    return {key: (found[key], one) for key, one in expected.items() if found[key] != one}


def assert_runs_as(path, template, *settings):
    """Compare every table of a run of a drawn file with that of the template, bit for bit."""
    texts = path.read_text("utf-8"), TEMPLATES[template]
    tables = [Case.from_text(text, "case.toml", settings).run().to_pandas() for text in texts]
    assert tables[0].keys() == tables[1].keys() > {"blocks", "contacts", "steps", "history"}
    for name, expected in tables[1].items():
        assert tables[0][name].equals(expected), name
    assert tables[1]["history"]["displacement_y"].abs().max() > 0.0
    return tables[1]


CABLES = (
    ("24.33,9.24", "18.42,8.19"),
    ("23.21,11.47", "15.33,10.08"),
    ("21.07,15.77", "10.23,13.85"),
    ("19.95,18.00", "7.14,15.74"),
    ("17.85,22.20", "2.09,19.42"),
)


def test_the_slope(empty):
    hand, path = empty
    hand.choose()
    hand.fill(title="Slope in bedding, with water and cables", plane="strain", damping="adaptive")
    hand.add("time")
    hand.fill(step="2e-3", end="1.0")
    hand.add("rock", "sandstone")
    hand.fill(young="5e9", poisson="0.25", density="2500.0")
    hand.add("joint", "default")
    hand.fill(friction_angle="40.0")
    hand.add("joint", "bedding")
    hand.fill(friction_angle="38.0")
    hand.page.focus("#section canvas[tabindex]")
    hand.keys.press("2")
    hand.type("0,3", "32,3", "@3<90", "26,6")
    hand.click(17.0, 24.0)
    hand.click(0.0, 24.0)
    hand.keys.press("Enter")
    hand.rest()
    hand.fill(rock="sandstone")
    hand.tool("support", "domain: fixed sides")
    for x, y in ((16.0, 3.2), (0.2, 14.0), (31.8, 4.5)):
        hand.click(x, y)
        hand.rest()
    hand.tool("joint set")
    hand.type("25.5, 7", "@5<-35", "3.5")
    hand.fill(name="bedding", joint="bedding")
    hand.tool("outline", "region: polygon")
    hand.type("-0.2,24.9", "25.5,6.9", "25.5,25", "")
    hand.fill(name="beds")
    hand.tool("joint set")
    hand.type("3,3", "@5<60", "4.5")
    hand.fill(name="cross joints", within="beds", seed="7")
    hand.drop("origin")
    hand.form_of("spacing", "spread {...}")
    hand.fill(distribution="normal", mean="4.5", sd="0.5")
    hand.add("amplitude", "rise")
    hand.fill(time=["0", "0.2"], value=["0", "1"])
    hand.tool("water", "water: line")
    hand.type("0,22", "14,20")
    hand.click(26.0, 6.0)
    hand.keys.press("Enter")
    hand.rest()
    hand.fill(acts_on="joints")
    hand.form_of("amplitude", "text")
    hand.fill(amplitude="rise")
    for name in ("dry", "cables", "water"):
        hand.add("stage")
        hand.fill(name=name)
    hand.fill(loads=["rise"])
    hand.choose("stage", 0)
    hand.fill(dynamic_ratio="0.0", reset_displacement=True)
    hand.add("bolt_kind", "cable")
    hand.fill(stiffness="1e7", yield_force="2e5", pretension="5e4")
    for number, (start, end) in enumerate(CABLES, 1):
        hand.tool("bolt", "bolt")
        hand.type(start, end)
        hand.fill(name=f"cable {number}", stage="cables")
    hand.tool("more", "measured point")
    hand.type("16.8,23.8")
    hand.fill(name="crest")
    hand.add("output")
    hand.fill(every="0.05")
    assert not differing(drawn(hand, path), "slope")
    assert len(assert_runs_as(path, "slope")["bolts"]) > 1000


HEADING = (
    (-3, -0.5), (3, -0.5), (3, 0), (2.853, 0.927), (2.427, 1.763), (1.763, 2.427), (0.927, 2.853),
    (0, 3), (-0.927, 2.853), (-1.763, 2.427), (-2.427, 1.763), (-2.853, 0.927), (-3, 0),
)  # fmt: skip


def test_the_lined_tunnel(empty):
    hand, path = empty
    hand.choose()
    hand.fill(title="Tunnel dug in two parts, bolted, sprayed and shaken", plane="strain")
    hand.add("time")
    hand.fill(step="1e-2", end="1.0")
    hand.add("rock", "gneiss")
    hand.fill(young="5e9", poisson="0.25", density="2700.0")
    for name, angle in (("default", "35"), ("foliation", "30"), ("joints", "35"), ("bond", "35")):
        hand.add("joint", name)
        stiff = ("2e10", "4e9") if name != "bond" else ("5e10", "5e9")
        hand.fill(friction_angle=angle, normal_stiffness=stiff[0], shear_stiffness=stiff[1])
    hand.fill(cohesion="5e5", tensile_strength="5e5")
    hand.tool("outline", "domain: boundary")
    hand.type("-12,-12", "@24,0", "@0,24", "@-24,0", "")
    hand.fill(rock="gneiss", smallest_block="0.2")
    hand.tool("support", "domain: fixed sides")
    for x, y in ((0.0, -11.0), (-11.0, 0.0), (11.0, 0.0)):
        hand.click(x, y)
        hand.rest()
    for name, angle, spacing in (("foliation", 35, "2"), ("joints", -62, "2.2")):
        hand.tool("joint set")
        hand.type("0.9,-0.3", f"@3<{angle}", spacing)
        hand.fill(name=name, joint=name)
    hand.tool("opening", "opening: polygon")
    hand.type(*(f"{x},{y}" for x, y in HEADING), "")
    hand.fill(name="heading")
    hand.tool("opening", "opening: box")
    hand.type("-3,-3", "@6,2.5")
    hand.fill(name="bench")
    for name in ("settled", "heading", "bolts", "bench", "shotcrete", "earthquake"):
        hand.add("stage")
        hand.fill(name=name)
        if name != "earthquake":
            hand.fill(dynamic_ratio="0.0")
    hand.fill(step="2e-3", dynamic_ratio="1.0", ground_motion=True, until="time", time="0.6")
    hand.form_of("damping", "rayleigh {...}")
    hand.fill(mass="0.5", stiffness="1e-4")
    hand.choose("stage", 0)
    hand.fill(reset_displacement=True)
    hand.choose("stage", 1)
    hand.fill(excavate=["heading"], release="0.6")
    hand.choose("stage", 3)
    hand.fill(excavate=["bench"], release="0.5")
    for stage, opening in ((2, "heading"), (4, "bench")):
        hand.choose("stage", stage)
        hand.form_of("release", "named values")
        hand.name_value("release", opening, "1.0")
    hand.add("bolt_kind", "swellex")
    hand.fill(stiffness="2e7", yield_force="1.2e5", rupture_elongation="0.1", pretension="1e4")
    hand.tool("bolt", "bolt pattern")
    hand.click(0.0, 1.5)
    hand.type("4", "1.3")
    hand.fill(to="180", anchorage="grouted", free_length="0.3", stage="bolts")
    hand.tool("lining", "lining: polyline")
    for x, y in ((3, -3), *HEADING[2:], (-3, -3)):
        hand.click(x, y)
    hand.keys.press("Enter")
    hand.rest()
    hand.fill(name="shotcrete", thickness="0.2", segment="0.8", young="1.5e10", stage="shotcrete")
    hand.fill(tension="2e6", compression="2.5e7", joint="bond")
    hand.add("ground_motion")
    hand.instead("time")
    hand.fill(acts="body-force", time=["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"])
    hand.fill(acceleration=["0", "1.5", "0", "-3.0", "0", "1.5", "0"])
    hand.tool("more", "measured point")
    hand.type("0,3.05")
    hand.fill(name="crown")
    hand.add("in_situ")
    hand.fill(vertical="overburden", k0="0.7", datum="100")
    hand.add("method")
    hand.fill(integrator="midpoint")
    hand.add("output")
    hand.fill(every="0.05")
    assert not differing(drawn(hand, path), "lined-tunnel")
    tables = assert_runs_as(path, "lined-tunnel", "time.end=0.1", "stage.6.time=0.1")
    assert tables["blocks"]["stage"].nunique() == 6 and len(tables["linings"]) > 1000


def test_the_wall(empty):
    hand, path = empty
    hand.choose()
    hand.fill(title="Brick wall with a window under a lintel")
    hand.add("time")
    hand.fill(step="5e-3", end="0.5", dynamic_ratio="0.0")
    for name, young, density in (("brick", "5e9", "1800"), ("concrete", "3e10", "2400")):
        hand.add("rock", name)
        hand.fill(young=young, poisson="0.2", density=density)
    hand.add("joint", "mortar")
    hand.fill(friction_angle="35", cohesion="0.0")
    hand.add("joint", "default")
    hand.fill(friction_angle="35")
    hand.tool("outline", "domain: boundary")
    hand.type("-0.6,-0.3", "@7.2,0", "@0,0.3", "6,0", "@0,3.6", "@-6,0", "0,0", "-0.6,0", "")
    hand.fill(rock="brick")
    hand.tool("support", "domain: fixed sides")
    hand.click(3.0, -0.2)
    hand.rest()
    hand.tool("more", "block pattern")
    hand.type("0,0", "@6,3.6", "@0.6,0.3")
    hand.fill(joint="mortar")
    hand.tool("opening", "opening: box")
    hand.type("2.1,0.9", "3.9,2.1")
    hand.fill(name="window", excavated=True)
    hand.tool("outline", "region: polygon")
    hand.type("1.8,2.1", "4.2,2.1", "4.2,2.4", "@-2.4,0", "")
    hand.fill(name="lintel", rock="concrete", joint="mortar", one_block=True)
    hand.tool("more", "measured point")
    hand.type("3,2.25")
    hand.fill(name="lintel")
    hand.add("output")
    hand.fill(every="0.05")
    assert not differing(drawn(hand, path), "wall")
    assert len(assert_runs_as(path, "wall", "time.end=0.1")["steps"]) == 20


SURFACES = {
    "rock": {"roughness": "3.0", "speed_scaling": "9.0"},
    "talus": {"friction_angle": "35", "rolling_resistance": "0.05", "roughness": "5.0"},
    "road": {"normal_restitution": "0.40", "tangential_restitution": "0.90"},
}
RESTITUTIONS = {
    "rock": ("normal(0.40, 0.04)", "normal(0.88, 0.03, high=1)"),
    "talus": ("normal(0.32, 0.04)", "normal(0.82, 0.04, high=1)"),
}


def test_the_rockfall(empty):
    hand, path = empty
    hand.choose()
    hand.fill(title="Rockfall above a road")
    for name, keys in SURFACES.items():
        hand.add("surface", name)
        hand.fill(**keys)
        if name in RESTITUTIONS:
            normal, tangential = RESTITUTIONS[name]
            hand.vary(normal_restitution=normal, tangential_restitution=tangential)
    hand.tool("outline", "rockfall: profile")
    hand.type("0,60", "20,55", "26,38", "40,30", "46,12", "45,8", "70,1", "73,0", "83,0")
    hand.type("100,-3", "120,-3", "")
    hand.fill(surface=[*"rock rock talus rock rock talus talus road talus talus".split()])
    hand.tool("more", "source: line")
    hand.type("16,56.5", "20,55.5")
    hand.fill(name="edge", rocks="200")
    hand.vary(volume="lognormal(0.5, 0.3, low=0.05, high=3)", elongation="uniform(1, 1.8)")
    hand.vary(velocity="uniform(1, 3)", spin="uniform(-1, 0)")
    hand.tool("more", "barrier")
    hand.type("71")
    hand.fill(name="fence", height="3.0", capacity="500e3")
    hand.tool("more", "collector")
    hand.type("78")
    hand.fill(name="road")
    drawn_case, template = drawn(hand, path), Case.from_text(TEMPLATES["rockfall"], "case.toml")
    assert not differing(drawn_case, "rockfall")
    numbers = range(template.campaign().count)
    rows, arrays = portion(drawn_case.campaign(), numbers)
    expected_rows, expected = portion(template.campaign(), numbers)
    assert rows == expected_rows and len(rows) == 200
    for name, values in expected.items():
        assert np.array_equal(arrays[name], values), name
