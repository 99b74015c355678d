"""Earlier keys of case files and scripts: they mean the same, and say what they are called now."""

import pytest

import clast
from clast.case.case_file import Case, json_schema
from clast.errors import CaseError
from clast.study.variables.parameters import places

PRESENT = """
gravity_amplitude = "ramp"
[time]
step = 1e-3
end = 0.01
[rock.stone]
young = 1e9
poisson = 0.2
density = 2500.0
[amplitude.ramp]
time = [0.0, 1.0]
value = [0.5, 1.0]
[[block]]
name = "base"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[fixed_point]]
at = [0, 0]
[[point_load]]
at = [0.5, 1.0]
force = [1.0, 0.0]
amplitude = "ramp"
[[moment]]
block = "base"
moment = 1.0
amplitude = "ramp"
[[water]]
level = 0.5
acts_on = "faces"
amplitude = "ramp"
"""
EARLIER = (
    PRESENT.replace("gravity_amplitude", "gravity_factor")
    .replace("[amplitude.ramp]", "[table.ramp]")
    .replace('amplitude = "ramp"', 'factor = "ramp"')
)
NOW = (
    "table is called amplitude, gravity_factor is called gravity_amplitude, "
    "factor is called amplitude now; the earlier names will be removed in the next version"
)


def refused(text: str, *settings: str) -> str:
    with pytest.raises(CaseError) as found:
        Case.from_text(text, "x", settings)
    return str(found.value)


def test_an_earlier_case_file_is_the_same_case_and_is_warned_of_once():
    present, earlier = clast.Case.from_toml(PRESENT), clast.Case.from_toml(EARLIER)
    assert earlier.to_toml() == present.to_toml()
    assert earlier.model().factors[0].value.tolist() == [0.5, 1.0]
    assert not any("is called" in text for text in present.examine().warnings)
    assert [text for text in earlier.examine().warnings if "is called" in text] == [NOW]


@pytest.mark.parametrize("text", [PRESENT, EARLIER], ids=["present", "earlier"])
def test_settings_and_parameters_of_studies_take_either_name(text: str):
    for setting in ("table.ramp.value=[0, 3]", "amplitude.ramp.value=[0, 3]"):
        case = Case.from_text(text, "x", [setting])
        assert case.amplitude["ramp"].value == [0.0, 3.0]
    for setting in ("point_load.1.factor=rmap", "point_load.1.amplitude=rmap"):
        assert Case.from_text(text, "x", [setting]).point_load[0].amplitude == "rmap"
    content = Case.from_text(text, "x").model_dump(by_alias=True, exclude_unset=True)
    assert places(content, "table.ramp.value.1") == places(content, "amplitude.ramp.value.1")
    assert places(content, "moment.1.factor") == places(content, "moment.1.amplitude")


def test_refusals_name_the_keys_that_the_file_has():
    falls = ("time = [0.0, 1.0]", "time = [1.0, 0.0]")
    assert refused(EARLIER.replace(*falls)).startswith("x: [table.ramp] time: instant 2")
    assert refused(PRESENT.replace(*falls)).startswith("x: [amplitude.ramp] time: instant 2")
    assert refused(EARLIER.replace('factor = "ramp"\n[[mom', "factor = 3\n[[mom")).startswith(
        "x: [[point_load]] 1 factor: must be a text"
    )


def test_tables_of_both_names_are_put_together_and_keys_of_both_names_are_refused():
    both = PRESENT + "[table.late]\ntime = [0, 1]\nvalue = [0, 1]\n"
    assert list(Case.from_text(both, "x").amplitude) == ["ramp", "late"]
    twice = PRESENT + "[table.ramp]\ntime = [0, 1]\nvalue = [0, 1]\n"
    assert "there is no such key" in refused(twice)
    assert "gravity_factor: there is no such key" in refused('gravity_factor = "ramp"' + PRESENT)


def test_the_schema_has_earlier_keys_as_deprecated():
    schema = json_schema()
    assert schema["properties"]["table"]["deprecated"] is True
    assert schema["$defs"]["Water"]["properties"]["factor"]["deprecated"] is True
    assert "deprecated" not in schema["properties"]["amplitude"]


def test_a_script_is_warned_of_earlier_names():
    builder = clast.ModelBuilder()
    with pytest.warns(DeprecationWarning, match="add_table is called add_amplitude now"):
        assert builder.add_table("ramp", [0, 1], [0, 1]) == "ramp"
    with pytest.warns(DeprecationWarning, match="factor is called amplitude now"):
        builder.point_load((0.5, 0.5), (1.0, 0.0), factor="ramp")
    with pytest.warns(DeprecationWarning, match="gravity_factor is called gravity_amplitude now"):
        builder.gravity_factor = "ramp"
    assert builder.gravity_amplitude == "ramp"
