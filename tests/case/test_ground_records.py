"""[ground_motion] with records in files: units, components, base lines, what comes after."""

from __future__ import annotations

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.inputs.records.conversion import from_velocity
from scenes.command_line import clast_command
from scenes.records import GAL, INTERVAL, at2_text, csv_text, knet_text

CASE = """
schema = 1
time = {step = 1e-3, end = 0.39}
rock.granite = {young = 5e9, poisson = 0.2, density = 2500.0}

[[block]]
name = "base"
vertices = [[-2, -1], [3, -1], [3, 0], [-2, 0]]

[[fixed_point]]
at = [-2, -1]
[[fixed_point]]
at = [3, -1]

[ground_motion]
acts = "base"
"""
FILES = {
    "record.at2": at2_text(),
    "short.at2": at2_text().replace("40,", "30,").rsplit("\n", 3)[0] + "\n",
    "record.ns": knet_text(),
    "g.csv": csv_text(GAL / 980.665),
    "gal.csv": csv_text(GAL),
    "si.csv": csv_text(0.01 * GAL),
    "two.csv": "0 0 0\n0.01 1 2\n0.02 0 0\n",
    "wrong.at2": at2_text().replace("40,", "44,"),
    "slow.csv": csv_text(np.sin(np.arange(40.0))),
    "uneven.csv": "0,0\n0.1,1\n0.3,0\n",
    "offset.csv": csv_text(0.01 * GAL + 3.0),
    "named.csv": "t [s],a [g]\n" + csv_text(GAL / 980.665)[4:],
}
FIRST = 0.01 * GAL


def case_of(folder, motion):
    """Return the file of a case with keys of [ground_motion], beside all records."""
    for name, text in FILES.items():
        (folder / name).write_text(text, "utf-8")
    path = folder / "case.toml"
    path.write_text(CASE + motion + "\n", "utf-8")
    return path


def model_of(folder, motion):
    return Case.from_toml(case_of(folder, motion)).model()


def record_of(folder, motion):
    return model_of(folder, motion).ground_motion.accelerogram


@pytest.mark.parametrize(
    "motion",
    [
        'file = "record.at2"',
        'file = "record.at2"\nformat = "at2"\nquantity = "acceleration"\nunit = "g"',
        'file = "record.ns"',
        'file = "record.ns"\nunit = "cm/s2"',
        'file = "g.csv"\nunit = "g"',
        'file = "gal.csv"\nunit = "gal"',
        'file = "gal.csv"\nunit = "m/s2"\nscale = 0.01',
        'file = "si.csv"',
        'file = "g.csv"\nscale = 9.80665',
    ],
)
def test_the_same_motion_however_it_is_given(tmp_path, motion):
    record = record_of(tmp_path, motion)
    assert np.abs(record.time - INTERVAL * np.arange(40)).max() < 1e-12
    assert np.abs(record.acceleration[:, 0] - FIRST).max() < 1e-12
    assert not record.acceleration[:, 1].any()


def test_the_way_of_a_g_record_and_of_a_gal_record_is_the_same(tmp_path):
    one = record_of(tmp_path, 'file = "record.at2"')
    other = record_of(tmp_path, 'file = "gal.csv"\nunit = "gal"')
    assert np.abs(one.displacement(0.3) - other.displacement(0.3)).max() < 1e-12


def test_a_direction_and_a_second_component(tmp_path):
    slanted = record_of(tmp_path, 'file = "record.at2"\ndirection = [3, -4]')
    assert slanted.acceleration == pytest.approx(np.outer(FIRST, [0.6, -0.8]), abs=1e-12)
    both = record_of(tmp_path, 'file = "record.at2"\nvertical = {file = "gal.csv", unit = "gal"}')
    assert both.acceleration == pytest.approx(np.outer(FIRST, [1.0, 1.0]), abs=1e-12)
    upwards = 'file = "g.csv"\nunit = "g"\nvertical = {file = "g.csv", scale = 0.5}'
    assert record_of(tmp_path, upwards).acceleration[:, 1] == pytest.approx(0.5 * FIRST)
    said = 'file = "gal.csv"\nunit = "gal"\nvertical = {file = "record.at2"}'
    assert record_of(tmp_path, said).acceleration[:, 1] == pytest.approx(FIRST)
    columns = record_of(tmp_path, 'file = "two.csv"\nunit = "cm/s2"')
    assert columns.acceleration[1].tolist() == [0.01, 0.02]


def test_a_shorter_component_goes_on_without_acceleration(tmp_path):
    model = model_of(tmp_path, 'file = "record.at2"\nvertical = {file = "short.at2"}')
    record = model.ground_motion.accelerogram
    assert record.acceleration[:30, 1] == pytest.approx(FIRST[:30], abs=1e-12)
    assert record.acceleration[30:].tolist() == [[a, 0.0] for a in record.acceleration[30:, 0]]
    said = "the vertical component ends 10 value(s) before the other: 0 m/s2 from there on"
    assert f"[ground_motion] {said}" in model.notes


def test_a_velocity_record(tmp_path):
    motion = 'file = "slow.csv"\nquantity = "velocity"\nunit = "cm/s"'
    record = record_of(tmp_path, motion)
    time, velocity = INTERVAL * np.arange(40), 0.01 * np.sin(np.arange(40.0))
    expected = from_velocity(time, velocity[:, None]).acceleration[:, 0]
    assert record.acceleration[::2, 0] == pytest.approx(expected)
    for instant in (0.005, 0.1, 0.3333):
        line = np.interp(instant, time, velocity)
        assert record.velocity(instant)[0] == pytest.approx(line, abs=1e-14)


def test_a_base_line_and_an_end_at_rest(tmp_path):
    plain = record_of(tmp_path, 'file = "offset.csv"\nunit = "m/s2"')
    assert plain.velocity(0.39)[0] > 1.0
    straight = record_of(tmp_path, 'file = "offset.csv"\nunit = "m/s2"\nbaseline = "linear"')
    assert abs(straight.velocity(0.39)[0]) < 0.1
    motion = 'file = "offset.csv"\nunit = "m/s2"\nbaseline = "highpass:5"\nafter = "stop"'
    model = model_of(tmp_path, motion)
    record = model.ground_motion.accelerogram
    assert record.time[-1] == pytest.approx(1.39)
    assert record.velocity(1.39) == pytest.approx([0.0, 0.0], abs=1e-15)
    assert any("from 0.39 to 1.39 s, the ground is brought to rest" in note for note in model.notes)
    lists = 'time = [0, 0.1, 0.3]\nacceleration = [0, 1, 0]\nafter = "stop"'
    assert record_of(tmp_path, lists).velocity(1.3) == pytest.approx([0.0, 0.0], abs=1e-15)


def test_notes_say_what_was_read_and_where_the_ground_ends(tmp_path):
    model = model_of(tmp_path, 'file = "record.ns"')
    assert model.notes[0] == (
        "[ground_motion] record.ns: k-net, 40 values every 0.01 s, acceleration in gal, as the "
        "file says"
    )
    record = model.ground_motion.accelerogram
    speed, way = record.velocity(0.39)[0], record.displacement(0.39)[0]
    assert model.notes[1] == (
        f"the ground motion ends at 0.39 s with a velocity of ({speed:.3g}, 0) m/s and a "
        f"displacement of ({way:.3g}, 0) m"
    )


def test_a_case_with_records_is_written_and_read_again(tmp_path):
    motion = 'file = "g.csv"\nunit = "g"\nvertical = {file = "gal.csv", unit = "gal"}'
    path = case_of(tmp_path, f'{motion}\nbaseline = "linear"\nafter = "stop"')
    written = Case.from_toml(path).to_toml()
    path.write_text(written, "utf-8")
    assert 'vertical = {file = "gal.csv", unit = "gal"}' in written
    assert Case.from_toml(path).model().ground_motion.accelerogram.acceleration.any()


REFUSED = {
    "no unit for a format": ('file = "si.csv"\nformat = "csv"', ["[ground_motion] unit", '"g"']),
    "unit of another quantity": (
        'file = "si.csv"\nunit = "cm"',
        ["[ground_motion] unit: cm is not a valid unit of acc", 'quantity = "displacement"'],
    ),
    "unknown base line": ('file = "si.csv"\nbaseline = "cubic"', ["baseline", "highpass:0.1"]),
    "base line beyond": (
        'file = "si.csv"\nunit = "g"\nbaseline = "highpass:0.1"',
        ["[ground_motion] baseline", "has no corner at 0.1 Hz"],
    ),
    "wrong NPTS": ('file = "wrong.at2"', ["[ground_motion] file, ", "wrong.at2: line 4", "44"]),
    "wrong NPTS, vertical": (
        'file = "record.at2"\nvertical = {file = "wrong.at2"}',
        ["[ground_motion] vertical, ", "wrong.at2: line 4"],
    ),
    "no vertical file": (
        'file = "record.at2"\nvertical = {file = "nowhere.at2"}',
        ["[ground_motion] vertical, ", "there is no such file"],
    ),
    "other interval": (
        'file = "record.at2"\nvertical = {file = "slow2.csv", unit = "g"}',
        ["[ground_motion] vertical", "every 0.02 s"],
    ),
    "no direction": ('file = "record.at2"\ndirection = [0, 0]', ["direction", "[1, 0]"]),
    "direction of columns": (
        'file = "two.csv"\nunit = "g"\ndirection = [1, 0]',
        ["[ground_motion] direction", "two components"],
    ),
    "vertical of columns": (
        'file = "two.csv"\nunit = "g"\nvertical = {file = "g.csv"}',
        ["[ground_motion] vertical", "two components"],
    ),
    "unit of lists": (
        'time = [0, 1]\nacceleration = [0, 1]\nunit = "g"',
        ["[ground_motion] unit", "belongs to a record in a file"],
    ),
    "gap": ('file = "uneven.csv"\nunit = "g"', ["uneven.csv: line 3", "fill the gap"]),
    "instant three times": (
        "time = [0, 0.1, 0.1, 0.1, 0.2]\nacceleration = [0, 1, 2, 3, 0]",
        ["instant 3, 0.1 s, is not after instant 2"],
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals_name_table_key_and_remedy(tmp_path, name):
    motion, phrases = REFUSED[name]
    path = case_of(tmp_path, motion)
    (tmp_path / "slow2.csv").write_text("0,0\n0.02,1\n0.04,0\n", "utf-8")
    with pytest.raises(CaseError) as refused:
        Case.from_toml(path).model()
    message = str(refused.value)
    assert message.startswith(str(path)) and "\n  " in message
    for phrase in phrases:
        assert phrase in message


def test_an_instant_that_stands_twice_is_a_jump(tmp_path):
    record = record_of(tmp_path, "time = [0, 0.1, 0.1, 0.2]\nacceleration = [1, 1, -1, -1]")
    assert record.velocity(0.1)[0] == pytest.approx(0.1, abs=1e-15)
    assert record.velocity(0.2)[0] == pytest.approx(0.0, abs=1e-15)
    assert record.displacement(0.2)[0] == pytest.approx(0.01, abs=1e-15)


def test_columns_without_any_new_key_are_read_as_ever(tmp_path):
    record = record_of(tmp_path, 'file = "uneven.csv"\nscale = 3.0')
    assert record.time.tolist() == [0.0, 0.1, 0.3]
    assert record.acceleration.tolist() == [[0.0, 0.0], [3.0, 0.0], [0.0, 0.0]]


WARNED = {
    "offset": ('file = "offset.csv"\nunit = "m/s2"', ["% of its peak", 'baseline = "linear"']),
    "g in gal": (
        'file = "g.csv"\nunit = "gal"\nscale = 0.01',
        ["no more than", ("nobody would feel")],
    ),
    "gal in g": ('file = "gal.csv"\nunit = "g"', ["more than any earthquake"]),
    "heading": ('file = "named.csv"\nunit = "gal"', ["says that accelerations are in g"]),
    "coarse": ('file = "record.at2"', ["longer than half the interval", "0.005"]),
    "short": ('file = "record.at2"\nafter = "stop"', ["ends at 1.39 s, before the run at 3 s"]),
    "hold": ('file = "offset.csv"\nunit = "m/s2"', ["which the ground keeps until 3 s"]),
}


def test_wrong_npts_ends_the_command_with_exit_code_2(tmp_path):
    result = clast_command("check", case_of(tmp_path, 'file = "wrong.at2"'))
    assert result.exit_code == 2
    assert "NPTS is 44, but 40 values follow" in " ".join(result.stderr.split())
    assert "Traceback" not in result.output


@pytest.mark.parametrize("name", WARNED)
def test_doubts_are_warned_of(tmp_path, name):
    motion, phrases = WARNED[name]
    loaded = Case.from_toml(case_of(tmp_path, motion), ["time.end=3", "time.step=0.006"])
    warnings = "\n".join(loaded.examine().warnings)
    for phrase in phrases:
        assert phrase in warnings


def test_a_sound_record_is_not_warned_of(tmp_path):
    # with steps of 1 ms vibrations of its 7.7 Hz would lose 20 % in the record
    loaded = Case.from_toml(case_of(tmp_path, 'file = "record.at2"'), ["time.step=2e-4"])
    said = [text for text in loaded.examine().warnings if "ground" in text or "record" in text]
    assert said == []
