"""Readers of records: the same motion from every format, and what they refuse."""

from __future__ import annotations

import importlib.util
import subprocess
import sys

import numpy as np
import pytest

from clast.errors import CaseError
from clast.inputs.records.components import component
from clast.inputs.records.formats import format_of, read_at2
from clast.inputs.records.series import STANDARD_GRAVITY
from scenes.records import GAL, INTERVAL, at2_text, csv_text, knet_text


def samples(tmp_path, name, text, **wanted):
    (tmp_path / name).write_text(text, "utf-8")
    return component(tmp_path / name, **wanted).samples


def test_an_at2_of_twelve_lines():
    assert len(at2_text().splitlines()) == 12


@pytest.mark.parametrize(
    ("name", "text", "unit"),
    [
        ("record.at2", at2_text(), None),
        ("record.AT2", at2_text(), "g"),
        ("old.at2", at2_text().replace("NPTS=   40, DT=   .0100 SEC,", "40 .0100 NPTS, DT"), None),
        ("unknown.dat", at2_text(), None),
        ("record.EW2", knet_text(), None),
        ("unknown.txt", knet_text(), "cm/s2"),
        ("g.csv", csv_text(GAL * 0.01 / STANDARD_GRAVITY), "g"),
        ("gal.csv", csv_text(GAL), "gal"),
        ("cm.csv", csv_text(GAL), "cm/s2"),
        ("m.csv", csv_text(0.01 * GAL), "m/s2"),
    ],
)
def test_the_same_motion_from_every_format(tmp_path, name, text, unit):
    found = samples(tmp_path, name, text, unit=unit)
    assert found.acceleration.shape == (40, 1)
    assert np.abs(found.time - INTERVAL * np.arange(40)).max() < 1e-12
    assert np.abs(found.acceleration[:, 0] - 0.01 * GAL).max() < 1e-12
    assert np.abs(GAL).max() > 500.0


def test_sac_gives_the_same_motion_in_single_precision(tmp_path):
    sac = pytest.importorskip("obspy.io.sac")
    path = tmp_path / "record.sac"
    sac.SACTrace(data=GAL.astype(np.float32), delta=INTERVAL).write(str(path))
    found = component(path, unit="gal").samples
    assert np.abs(found.acceleration[:, 0] - 0.01 * GAL).max() < 1e-6 * 9.0
    assert np.abs(found.time - INTERVAL * np.arange(40)).max() < 1e-12
    with pytest.raises(CaseError, match="does not give the unit"):
        component(path)


def test_sac_without_obspy_says_what_to_install(tmp_path, monkeypatch):
    path = tmp_path / "record.sac"
    path.write_bytes(b"\0" * 700)
    monkeypatch.setitem(sys.modules, "obspy.io.sac", None)
    with pytest.raises(CaseError, match=r"clast\[records\]"):
        component(path, unit="g")


@pytest.mark.skipif(importlib.util.find_spec("obspy") is None, reason="needs obspy")
@pytest.mark.parametrize("content", [b"", b"x" * 100, b"no record " * 200, b"\0" * 632])
def test_what_is_no_sac_is_refused(tmp_path, content):
    path = tmp_path / "record.sac"
    path.write_bytes(content)
    with pytest.raises(CaseError, match=r"record\.sac"):
        component(path, unit="g")


@pytest.mark.parametrize(
    ("line", "quantity", "unit"),
    [
        ("VELOCITY TIME SERIES IN UNITS OF CM/S", "velocity", "cm/s"),
        ("DISPLACEMENT TIME SERIES IN UNITS OF CM", "displacement", "cm"),
        ("ACCELERATION TIME HISTORY IN UNITS OF G", "acceleration", "g"),
        ("MADE BY HAND", None, None),
    ],
)
def test_the_heading_of_at2_says_quantity_and_unit(tmp_path, line, quantity, unit):
    path = tmp_path / "record.vt2"
    text = at2_text().replace("ACCELERATION TIME SERIES IN UNITS OF G", line)
    path.write_text(text, "utf-8")
    found = read_at2(path)
    assert (found.quantity, found.unit) == (quantity, unit)
    assert format_of(path) == "at2"


def test_a_note_says_what_was_read(tmp_path):
    (tmp_path / "record.at2").write_text(at2_text(), "utf-8")
    note = component(tmp_path / "record.at2").note
    assert note == ("record.at2: at2, 40 values every 0.01 s, acceleration in g, as the file says")


AT2, KNET = at2_text(), knet_text()
CSV = csv_text(0.01 * GAL)
BROKEN = {
    "at2: NPTS too large": ("a.at2", AT2.replace("40,", "41,"), {}, ["line 4", "41", "40 values"]),
    "at2: NPTS too small": ("a.at2", AT2.replace("40,", "39,"), {}, ["NPTS is 39", "cut short"]),
    "at2: cut short": ("a.at2", AT2[:-30], {}, ["line 4", "NPTS is 40, but 39"]),
    "at2: no NPTS": ("a.at2", AT2.replace("NPTS", "N"), {}, ["its heading has no line", "NPTS="]),
    "at2: NPTS of half a value": ("a.at2", AT2.replace("40,", "4.5,"), {}, ["NPTS is 4.5"]),
    "at2: no interval": ("a.at2", AT2.replace(".0100", "0.0"), {}, ["DT is 0.0", "above 0"]),
    "at2: NaN": ("a.at2", AT2.replace("0.0000000000000000E+00", "NaN", 1), {}, ["line 5: 'NaN'"]),
    "at2: stuck together": (
        "a.at2",
        AT2.replace("E-01 ", "E-01", 1),
        {},
        ["is not a finite number"],
    ),
    "at2: empty": ("a.at2", "\n \n", {}, ["is empty", "five a line"]),
    "at2: junk": ("a.at2", b"\xff\xfe\x00junk", {}, ["is not a text file"]),
    "at2: another unit": ("a.at2", AT2, {"unit": "gal"}, ["unit: is gal", "says g"]),
    "at2: another quantity": (
        "a.at2",
        AT2,
        {"quantity": "velocity"},
        ["quantity: is velocity", "says acceleration"],
    ),
    "at2: no unit": ("a.at2", AT2.replace("UNITS OF G", ""), {}, ["unit: is missing", '"g"']),
    "k-net: cut heading": ("a.ns", KNET.replace("Memo.\n", ""), {}, ["line 17", "'Memo'"]),
    "k-net: no frequency": ("a.ns", KNET.replace("100Hz", "Hz"), {}, ["line 11", "100Hz"]),
    "k-net: no scale": ("a.ns", KNET.replace("(gal)/8000", ""), {}, ["line 14", "(gal)"]),
    "k-net: scale by zero": ("a.ns", KNET.replace("/8000", "/0"), {}, ["line 14"]),
    "k-net: wrong duration": ("a.ns", KNET.replace("(s)  1", "(s)  9"), {}, ["line 12", "900"]),
    "k-net: a slip": ("a.ns", KNET + "12O\n", {}, ["line 23: '12O'"]),
    "k-net: empty": ("a.ns", "", {}, ["is empty", "17 lines"]),
    "csv: no unit": ("a.csv", CSV, {}, ["unit: is missing", '"m/s2", "g", "cm/s2", "gal"']),
    "csv: a gap": ("a.csv", CSV.replace("\n0.05,", "\n#,"), {"unit": "g"}, ["line 8", "gap"]),
    "csv: time stands": ("a.csv", CSV.replace("\n0.05,", "\n0.04,"), {"unit": "g"}, ["line 7"]),
    "csv: time falls": ("a.csv", CSV.replace("\n0.05,", "\n0.01,"), {"unit": "g"}, ["rise"]),
    "csv: NaN": ("a.csv", CSV + "0.4,nan\n", {"unit": "g"}, ["line 42: '0.4,nan'"]),
    "csv: one line": ("a.csv", "0,1\n", {"unit": "g"}, ["at least 2 instants"]),
    "csv: empty": ("a.csv", "", {"unit": "g"}, ["holds no numbers"]),
    "csv: junk": ("a.csv", b"\x89PNG\xff\x00", {"unit": "g"}, ["is not a text file"]),
    "csv: unit of a velocity": (
        "a.csv",
        CSV,
        {"unit": "cm/s"},
        ["unit: cm/s is not a valid unit of acceleration", 'quantity = "velocity"'],
    ),
    "csv: velocity that begins fast": (
        "a.csv",
        "0,1\n1,1\n2,0\n",
        {"unit": "m/s", "quantity": "velocity"},
        ["a.csv", "begins with 1 m/s", "must start from rest"],
    ),
    "nowhere": ("b.csv", None, {"unit": "g"}, ["there is no such file"]),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_records_are_refused(name, tmp_path):
    file, content, wanted, phrases = BROKEN[name]
    if content is not None:
        data = content if isinstance(content, bytes) else content.encode()
        (tmp_path / file).write_bytes(data)
    with pytest.raises(CaseError) as refused:
        component(tmp_path / file, **wanted)
    message = str(refused.value)
    assert len(message) < 1000
    assert refused.value.remedy
    for phrase in phrases:
        assert phrase in message


@pytest.mark.slow
def test_reading_needs_no_pydantic():
    code = (
        "import sys, clast.inputs.records.components, clast.inputs.records.conversion; "
        "sys.exit('pydantic' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
