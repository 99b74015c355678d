"""Units as headings write them, times not in seconds, numbers that overflow, foreign files."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.inputs.records.series import unit_of_heading

UNITS = {
    "cm/s2": ["CM/SEC**2", "cm/s/s", "CM/SEC/SEC", "cm/s^2", "CM/SEC2", "(CM/SEC/SEC)", "cm/s²"],
    "m/s2": ["M/S^2", "m/s/s", "M/SEC**2, NPTS", "[m/s2]", "m s-2", "M/SEC/SEC."],
    "mm/s2": ["MM/S**2"],
    "g": ["G", "g, DT in s"],
    "gal": ["GAL", "gals"],
    "cm/s": ["CM/SEC", "cm/s"],
    "m": ["M"],
    None: ["MG", "%g", "in/s2", "m/s3", "ft/s/s", "furlong", "g/10"],
}


@pytest.mark.parametrize(("unit", "text"), [(u, one) for u, some in UNITS.items() for one in some])
def test_units_as_headings_write_them(unit, text):
    assert unit_of_heading(["STATION", f"ACCELERATION TIME SERIES IN UNITS OF {text}"]) == unit


CASE = """
schema = 1
time = {step = 2e-3, end = 0.05}
rock.stone = {young = 5e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[[block]]
name = "floor"
vertices = [[-2, -1], [3, -1], [3, 0], [-2, 0]]
[[fixed_point]]
at = [-2, -1]
[[fixed_point]]
at = [3, -1]
[ground_motion]
acts = "base"
"""


def shaken(tmp_path, name: str, text: str, keys: str = "") -> Case:
    (tmp_path / name).write_text(text, "utf-8")
    (tmp_path / "case.toml").write_text(f'{CASE}file = "{name}"\n{keys}')
    return Case.from_toml(tmp_path / "case.toml")


AT2 = """MADE UP
NO STATION
ACCELERATION TIME SERIES IN UNITS OF {unit}
NPTS= 6, DT= {step}
0.0 20.0 80.0 -60.0 -40.0 0.0
"""


@pytest.mark.parametrize("unit", ["CM/SEC**2", "CM/S/S", "GAL"])
def test_the_motion_of_a_record_in_cm_per_s2(tmp_path, unit):
    motion = shaken(tmp_path, "r.at2", AT2.format(unit=unit, step=".01 SEC")).model().ground_motion
    assert np.abs(motion.accelerogram.acceleration[:, 0]).max() == pytest.approx(0.8)


def test_an_unknown_unit_is_asked_for_and_the_answer_is_taken(tmp_path):
    text = AT2.format(unit="FURLONGS/S/S", step=".01 SEC")
    with pytest.raises(CaseError, match='unit = one of "m/s2"'):
        shaken(tmp_path, "r.at2", text).model()
    shaken(tmp_path, "r.at2", text, 'unit = "cm/s2"').model()


def test_a_unit_of_velocity_for_an_acceleration_does_not_make_it_one(tmp_path):
    text = AT2.format(unit="CM/S", step=".01 SEC")
    with pytest.raises(CaseError) as error:
        shaken(tmp_path, "r.at2", text).model()
    assert "quantity =" not in str(error.value)
    shaken(tmp_path, "r.at2", text, 'unit = "cm/s2"').model()


ROWS = "".join(f"{{}},{k % 3 - 1}\n" for k in range(8))


def rows(times, heading: str = "") -> str:
    return heading + ROWS.format(*times)


@pytest.mark.parametrize(
    ("heading", "phrase"),
    [
        ("t [ms],a\n", "times are in ms"),
        ("time_ms,ax\n", "times are in ms"),
        ("Time (msec);a\n", "times are in msec"),
        ("# Zeit in min, a\n", "times are in min"),
        ("index,a\n", "counts the values"),
        ("# No., a\n", "counts the values"),
        ("n\ta\n", "counts the values"),
    ],
)
@pytest.mark.parametrize("keys", ["", 'unit = "m/s2"'])
def test_times_that_are_no_seconds_are_refused(tmp_path, heading, phrase, keys):
    text = rows(np.arange(8) * 5, heading)
    text = text.replace(",", ";") if ";" in heading else text
    with pytest.raises(CaseError, match=phrase):
        shaken(tmp_path, "r.csv", text, keys).model()


@pytest.mark.parametrize(("step", "phrase"), [(1, "counts the values"), (5, "is in ms")])
@pytest.mark.parametrize("keys", ["", 'unit = "m/s2"'])
def test_times_a_second_or_more_apart_are_asked_about(tmp_path, step, phrase, keys):
    said = shaken(tmp_path, "r.csv", rows(np.arange(8) * step), keys).examine().warnings
    assert any(phrase in one for one in said)
    fine = shaken(tmp_path, "r.csv", rows(np.arange(8) * 0.01, "time (s), a (m/s2)\n"), keys)
    assert not any("r.csv has a value every" in one for one in fine.examine().warnings)


def test_an_interval_in_ms_is_refused(tmp_path):
    with pytest.raises(CaseError, match="not in seconds"):
        shaken(tmp_path, "r.at2", AT2.format(unit="G", step="10. MSEC")).model()


@pytest.mark.parametrize("value", [1e308, -1e200, 1e-308])
@pytest.mark.parametrize("interval", [1e-2, 1e-300, 1e300])
@pytest.mark.parametrize("quantity", ["acceleration", "velocity", "displacement"])
def test_numbers_that_overflow_end_in_a_message(tmp_path, value, interval, quantity):
    unit = {"acceleration": "g", "velocity": "m/s", "displacement": "m"}[quantity]
    keys = f'quantity = "{quantity}"\nunit = "{unit}"\nbaseline = "linear"\n'
    text = "".join(f"{k * interval!r},{(k % 2) * value!r}\n" for k in range(8))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            shaken(tmp_path, "r.csv", text, keys).examine()
        except CaseError as error:
            assert re.search("far too large|cannot be a record", str(error))


SECRET = "root:hunter2:0:0:4711 secret\n"


@pytest.mark.parametrize("text", [SECRET, f"1234 {SECRET}", f"0 1\n0.1 2\n12 {SECRET}"])
@pytest.mark.parametrize("form", ["csv", "at2", "k-net"])
def test_nothing_of_a_foreign_file_is_repeated(tmp_path, text, form):
    with pytest.raises(CaseError) as error:
        shaken(tmp_path, "passwd", text, f'format = "{form}"').model()
    assert "hunter2" not in str(error.value)
    assert "secret" not in str(error.value)
