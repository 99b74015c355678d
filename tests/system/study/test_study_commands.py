"""clast study on the command line: what it prints and writes, and what it refuses."""

from __future__ import annotations

import csv
import json
import re
import shlex
from pathlib import Path

import pytest

import clast
from scenes.command_line import clast_command, good

PHI = "joint.plane.friction_angle"
U = "u=displacement(A)"


@pytest.fixture(autouse=True)
def _here(slab, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def refused(*words: str) -> str:
    done = clast_command(*words)
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output
    return done.output


def test_a_factor_of_safety_is_printed_and_its_folder_is_whole(slab):
    out = good("study", "fos", "slab.toml", "--refine", "2", "-o", "fos")
    assert "factor of safety 1.18" in out
    report = Path("fos/report.html").read_text(encoding="utf-8")
    assert "http://" not in re.sub(r"http://www\.w3\.org\S*", "", report)
    assert report.count("<iframe") == 2 and "data:image/png" in report
    with Path("fos/trials.csv").open() as file:
        trials = list(csv.DictReader(file))
    failed = [int(one["trial"]) for one in trials if one["verdict"] == "fails"]
    for number in failed:
        place = Path(f"fos/runs/0000/{number:08d}")
        assert (place / "failing.png").exists()
    good("check", f"fos/runs/0000/{failed[0]:08d}/case.toml")
    found = json.loads(good("study", "resume", "fos", "--json"))
    assert found["low"] < slab.factor() < found["high"] and found["settled"]
    assert len(found["trials"]) == len(trials)


def test_parts_of_an_array_are_collected():
    words = ["study", "montecarlo", "slab.toml", "--vary", f"{PHI}=normal(30, 4)", "--measure", U]
    words += ["--fail", "fails()", "-n", "8", "--seed", "2", "-o", "out"]
    for part in ("2/2", "1/2"):
        assert "study collect out" in good(*words, "--array", part)
    found = json.loads(good("study", "collect", "out", "--json"))
    assert found["done"] == 8 and found["no_result"] == 0
    chance = found["probability_of_failure"]
    assert 0.0 <= chance["low"] <= chance["value"] <= chance["high"] <= 1.0
    report = Path("out/report.html").read_text(encoding="utf-8")
    assert "Worst run" in report and "<iframe" in report
    assert f'<td class="text">{PHI}, °</td>' in report
    good("check", "out/runs/0000/00000003/case.toml")


def test_a_sweep_prints_where_its_measures_are_least_and_largest():
    out = good("study", "sweep", "slab.toml", "--vary", f"{PHI}=[30, 25]", "--measure", U,
               "-o", "out", "--workers", "1")  # fmt: skip
    assert "mean" not in out and "median" not in out
    least, largest = (line.split() for line in out.splitlines() if " u " in line)
    assert least[3] == "least" and least[7:10:2] == ["1", "30"]
    assert largest[3] == "largest" and largest[7:10:2] == ["2", "25"]
    found = json.loads(good("study", "collect", "out", "--json"))
    u = found["measures"]["u"]
    assert u["least"]["run"] == 1 and u["least"]["parameters"] == {PHI: 30}
    assert u["largest"]["value"] > u["least"]["value"]


def test_results_are_written_as_parquet():
    parquet = pytest.importorskip("pyarrow.parquet")
    good("study", "sweep", "slab.toml", "--vary", f"{PHI}=[30, 34]", "--measure", U,
         "-o", "out", "--array", "1/1")  # fmt: skip
    good("study", "collect", "out", "--parquet")
    table = parquet.read_table("out/results.parquet").to_pydict()
    assert table["run"] == [1, 2] and table[PHI] == [30.0, 34.0]


def test_a_table_is_a_data_frame():
    pytest.importorskip("pandas")
    made = clast.Study(
        "slab.toml", vary={PHI: [30.0, 95.0, 34.0]}, measure={"u": "displacement(A)"}
    )
    frame = made.run("out", array=(1, 1)).to_pandas()
    assert list(frame.index) == [1, 2, 3] and list(frame[PHI]) == [30.0, 95.0, 34.0]
    assert list(frame["u"].isna()) == [False, True, False]


def test_indices_of_sensitivity_are_printed():
    """The force across a plane that holds goes with the weight, not with its strength."""
    pytest.importorskip("SALib")
    words = (
        "study montecarlo slab.toml --vary 'joint.plane.cohesion=uniform(20e3, 30e3)' "
        "--vary 'rock.rock.density=uniform(2500, 2700)' --measure 'N=normal_force(plane)' "
        "--sampling saltelli -n 16 --workers 1 -o out --json"
    )
    found = json.loads(good(*shlex.split(words)))["sensitivity"]["N"]
    assert list(found) == ["rock.rock.density", "joint.plane.cohesion"]
    assert found["rock.rock.density"]["total"] > 0.5
    assert found["joint.plane.cohesion"]["total"] == pytest.approx(0.0, abs=1e-6)
    assert "plus or minus of total" in Path("out/report.html").read_text(encoding="utf-8")


VARY = f"--vary '{PHI}=normal(30, 4)'"
NO_STRENGTH = "--set joint.plane.friction_angle=0 --set joint.plane.cohesion=0"
SHORT = "--set method.process=modified --set time.step=1e-5 --set time.end=3e-5"
OF_FACTORS = {
    "--by pga --joints plane": "joints is for strength reduction",
    "--by 'load jack'": "no load 'jack'",
    "--by gravity --set 'gravity=[0.0, 0.0]'": "no gravity",
    "--by pga --set joint.plane.cohesion=0": "do not come to rest",
    "--by pga --set 'seismic_coefficient=[0.1, 0.0]'": "already has a seismic coefficient",
    "--tolerance 2": "not a valid tolerance",
    "--set joint.plane.friction_angle=-1": "friction_angle",
    NO_STRENGTH: "no joint has a friction angle",
    SHORT: "give it passes",
    "-o slab.toml": "cannot be made",
    "-o slab.toml/out": "cannot be made",
    "-o .": "not empty",
}
"""Options of clast study fos slab.toml -> message."""
OF_SAMPLES = {
    "--fail 'w > 1'": "measure 'w'",
    "-n 2000000000": "lower it",
    "--sampling lhs": "sampling",
    "--replicates 3": "replicates",
    "--seed -1": "not a valid seed",
    "--correlate a,b": "correlation",
    f"--correlate {PHI},joint.plane.cohesion,0.3": "does not vary",
    "--array 3/2": "is not part of an array",
    "--array x": "is not part of an array",
    "--scheduler tcp://127.0.0.1:1 --array 1/2": "exclude each other",
    "--workers 0": "--workers",
    f"{VARY}": "given twice",
    "--measure u": "is not understood",
    "--measure 'v=displacement(B)'": "'B'",
    "--measure 'v=displacement(A, x, late)'": "no time 'late'",
    "--measure 'v=contact(C, slip)'": "measured contact",
    "--measure 'v=bolt_yields(B)'": "no bolt at all",
    "--measure \"v=reaction('fixed blocks', z)\"": "part 'z'",
    "--measure 'F=factor_of_safety()' --tolerance 0": "not a valid tolerance",
    "--measure 'F=factor_of_safety()' --joints plan": "did you mean 'plane'",
}
"""Options of clast study montecarlo that varies and measures something -> message."""
OF_VALUES = {
    f"montecarlo --vary {PHI}": "is not understood",
    f"montecarlo --vary '{PHI}=normal(30, -4)'": "sd -4",
    f"montecarlo --vary '{PHI}=normal(95, 1, low=94, high=96)'": "friction_angle",
    "montecarlo --vary 'joint.plane.friction=normal(30, 4)'": "friction",
    f"sweep --vary '{PHI}=range(20, 40, 0.5)'": "how many",
    f"sweep --vary {PHI}=[95]": "the first run cannot",
    f"sweep --vary '{PHI}=[30, 34]' --vary joint.plane.cohesion=[1e3] --together": "lists of 2, 1",
}
"""Kind of study, and what varies -> message."""
REFUSED = {
    "fos slap.toml": "no such file",
    f"montecarlo slab.toml {VARY}": "the study measures nothing",
    f"fit slab.toml --observe slab.toml {VARY}": "column",
    "resume nowhere": "not a folder of a study",
    "collect .": "not a folder of a study",
    **{f"fos slab.toml {words}": what for words, what in OF_FACTORS.items()},
    **{f"montecarlo slab.toml {VARY} --measure '{U}' {w}": what for w, what in OF_SAMPLES.items()},
    **{f"{words} --measure '{U}' slab.toml": what for words, what in OF_VALUES.items()},
}


@pytest.mark.parametrize(("words", "what"), REFUSED.items())
def test_what_cannot_be_done_is_said(words, what):
    assert what in refused("study", *shlex.split(words))
    assert not Path("build").exists() or not any(Path("build").rglob("result.json"))


def test_a_study_begins_with_the_warnings_of_its_case():
    words = ["--vary", f"{PHI}=[30]", "--measure", U, "--array", "1/1", "-o", "out"]
    done = clast_command("study", "sweep", "slab.toml", "--set", "method.critdis=2.0", *words)
    assert done.exit_code == 0, done.output
    assert done.stderr.count("warning: critdis is 2 m") == 1


def test_a_refused_study_leaves_its_folder_to_the_next():
    words = ["study", "sweep", "slab.toml", "--measure", U, "--array", "1/1", "-o", "out"]
    refused(*words, "--vary", f"{PHI}=[95]")
    assert not Path("out").exists()
    # without cohesion the slab slides at once, which is known when the folder has been made
    refused(
        "study", "fos", "slab.toml", "--by", "pga", "--set", "joint.plane.cohesion=0", "-o", "out"
    )
    assert Path("out/study.toml").exists()
    good(*words, "--vary", f"{PHI}=[30]")
    assert "another study" in refused(*words, "--vary", f"{PHI}=[31]")


def test_a_study_without_any_result_says_so():
    words = ["study", "sweep", "slab.toml", "--vary", f"{PHI}=[30, 34]", "--measure"]
    good(*words, "u=displacement(A, x, 99)", "--array", "1/1", "-o", "out")
    done = clast_command("study", "collect", "out")
    assert done.exit_code == 1 and "no run has a result" in done.output
    assert "before 99 s" in done.output
