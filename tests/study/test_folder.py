"""The folder of a study: what is found in it that was damaged, changed, or put there by others."""

from pathlib import Path

import pytest

import clast
from clast.errors import CaseError
from clast.study.folder import DONE, NO_RESULT, StudyFolder

PHI = "joint.default.friction_angle"


def made(path: Path, **changes) -> StudyFolder:
    """Return the folder of a sweep of two runs, each with its result."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2600.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="base", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], fixed=True)
    builder.measured_point("A", (0.5, 0.5), block="base")
    builder.line_load((0, 1), (1, 1), (0.0, -1.0))
    given = {"vary": {PHI: [20.0, 30.0]}, "measure": {"u": "displacement(A)"}, "fail": "u > 1"}
    study = clast.Study(builder.case(step=0.01, end=0.01), **{**given, **changes})
    folder = StudyFolder.made(path, study.case, study.described())
    for run in (1, 2):
        with folder.making(run) as part:
            folder.write_result(part, whole(folder, run))
    return folder


def whole(folder: StudyFolder, number: int, **changes) -> dict:
    """Return the result of a run."""
    values, measures = {PHI: folder.values(number)[0]}, {"u": 0.5 * number}
    found = {"run": number, "parameters": values, "status": DONE, "measures": measures}
    return {**found, "fails": False, **changes}


def test_results_are_found_again(tmp_path):
    folder = made(tmp_path / "out")
    assert [one["measures"]["u"] for one in folder.results()] == [0.5, 1.0]
    assert list(folder.missing(lambda run: True)) == []


def test_a_run_without_a_result_needs_no_measures(tmp_path):
    folder = made(tmp_path / "out")
    one = {"run": 2, "parameters": {PHI: 30.0}, "status": NO_RESULT, "reason": "too steep"}
    folder.write_result(folder.place(2), one)
    assert [one["status"] for one in folder.results()] == [DONE, NO_RESULT]


def test_files_of_others_are_no_runs(tmp_path):
    folder = made(tmp_path / "out")
    (folder.path / "runs/.DS_Store").write_text("")
    (folder.path / "runs/0000/.nfs0001").write_text("")
    (folder.path / "runs/0000/00000003x").mkdir()
    with folder.driven():
        assert [one["run"] for one in folder.results()] == [1, 2]


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("schema = 1", "schema = 2", "is of schema 2"),
        ('kind = "sweep"', "kind = 3", "kind has to be a text, not 3"),
        ('kind = "sweep"', "", "lacks the key 'kind'"),
        ("case =", "cases =", "there is no key 'cases'"),
        ("n = 2", "n = 2.5", "n has to be a whole number"),
        ("together = false", 'together = "no"', "together has to be true or false"),
        ('fail = "u > 1"', "fail = 1", "fail has to be a text"),
        ('is = "values([20.0, 30.0])"', "is = 20", "is has to be a text"),
        (f'paths = ["{PHI}"]', f'paths = "{PHI}"', "paths has to be a list"),
        ("[[vary]]", "[vary]", "vary has to be a list"),
        ("schema = 1", "schema = = 1", "is not TOML"),
    ],
)
def test_a_description_that_was_edited_is_refused(tmp_path, old, new, what):
    file = made(tmp_path / "out").path / "study.toml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    with pytest.raises(CaseError, match=r"study\.toml") as refused:
        StudyFolder.opened(tmp_path / "out")
    assert what in str(refused.value) and refused.value.remedy


def test_a_case_that_was_edited_is_refused(tmp_path):
    """Its runs would be among those of another case."""
    folder = made(tmp_path / "out")
    assert StudyFolder.opened(folder.path).base.rock["rock"].young == 1e9
    file = folder.path / folder.study.case
    file.write_text(file.read_text().replace("1000000000.0", "2000000000.0"))
    with pytest.raises(CaseError, match="has changed since the study was begun"):
        _ = StudyFolder.opened(folder.path).base


def test_a_file_of_the_case_that_was_edited_is_refused(tmp_path):
    table = "t,ax\n0,0\n1,1\n"
    (tmp_path / "ground.csv").write_text(table)
    folder = made(tmp_path / "first")
    text = (folder.path / folder.study.case).read_text()
    text += '\n[ground_motion]\nacts = "body-force"\nfile = "ground.csv"\n'
    (tmp_path / "case.toml").write_text(text)
    study = clast.Study(
        tmp_path / "case.toml", vary={PHI: [20.0]}, measure={"u": "displacement(A)"}
    )
    again = StudyFolder.made(tmp_path / "out", study.case, study.described())
    assert StudyFolder.opened(again.path).base.ground_motion is not None
    (copied,) = (again.path / "base").rglob("*ground.csv")
    copied.write_text(table.replace("1,1", "1,2"))
    with pytest.raises(CaseError, match="or a file beside it"):
        _ = StudyFolder.opened(again.path).base


def test_a_folder_that_cannot_be_written_is_said(tmp_path, monkeypatch):
    folder = made(tmp_path / "out")

    def locked(self, mode="r", *given, **named):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", locked)
    with pytest.raises(CaseError, match="cannot be written: Permission denied"), folder.driven():
        pass
