"""The tool that compares digits: it sees the smallest change, and nothing where there is none."""

from __future__ import annotations

import json
from dataclasses import replace

import digit_scenes
import digits
import pytest

import clast

KEY = digits.Key("incline", "convex", "penalty", 1)


def incline(friction_angle: float = 20.0) -> digit_scenes.Built:
    return digit_scenes.Built(
        build=lambda: digit_scenes.incline(friction_angle), step=2e-3, steps=8
    )


@pytest.mark.parametrize("process", digits.PROCESSES)
@pytest.mark.parametrize("law", digits.LAWS)
def test_a_run_repeated_has_the_same_digits(process, law):
    first, again = (digits.digits_of(incline(), process, law) for _ in range(2))
    assert first.ended == "finished"
    assert first.digest == again.digest
    assert not list(digits.differences({KEY: first}, {KEY: again}))


def test_the_smallest_change_is_seen_and_measured():
    was = digits.digits_of(incline(20.0), "convex", "penalty")
    now = digits.digits_of(incline(20.0 + 1e-9), "convex", "penalty")
    (said,) = digits.differences({KEY: was}, {KEY: now})
    assert "incline / convex / penalty" in said
    assert "vertices" in said
    assert "moved " in said
    assert "finished, now" not in said


def test_threads_that_disagree_are_told():
    one = digits.digits_of(incline(), "convex", "penalty")
    found = {KEY: one, replace(KEY, threads=2): one}
    assert not list(digits.disagreements(found))
    found[replace(KEY, threads=2)] = replace(one, digest="0")
    (said,) = digits.disagreements(found)
    assert "incline / convex / penalty / 2 differs from 1" in said


def test_a_run_that_stops_counts_as_far_as_it_came():
    stopped = digits.digits_of(digit_scenes.SCENES["wall-30-5ms"], "modified", "penalty")
    assert stopped.ended == "stopped"
    assert stopped.numbers["steps"] > 0
    assert "vertices" in stopped.parts
    assert "more energy" in stopped.words


def test_what_cannot_be_run_is_no_crash_of_the_tool():
    def overlapping() -> clast.ModelBuilder:
        builder = digit_scenes.begun()
        builder.block(vertices=digit_scenes.box(0.0, 0.0))
        builder.block(vertices=digit_scenes.box(0.5, 0.0))
        return builder

    def broken() -> clast.ModelBuilder:
        raise AttributeError("a name that is gone")

    for build, ended in ((overlapping, "refused"), (broken, "crashed")):
        scene = digit_scenes.Built(build=build, step=1e-3, steps=2)
        found = digits.digits_of(scene, "convex", "penalty")
        assert found.ended == ended
        assert found.words
        assert not found.parts


@pytest.mark.slow
def test_a_changed_digit_in_the_file_fails(tmp_path, capsys):
    file = tmp_path / "digits.json"
    asked = ["--only", "case-heap", "--threads", "1"]
    assert digits.main(["--write", str(file), *asked]) == 0
    assert "no differences" in capsys.readouterr().out
    kept = json.loads(file.read_text())
    kept["case-heap"]["modified"]["penalty"]["1"]["digest"] = "0"
    kept["case-heap"]["modified"]["penalty"]["1"]["numbers"]["moved"] *= 1.1
    file.write_text(json.dumps(kept))
    assert digits.main(["--against", str(file), *asked]) == 1
    said = capsys.readouterr().out
    assert "case-heap / modified / penalty / 1" in said
    assert "9.1e-02" in said
    assert "1 differences" in said


def test_every_scene_has_a_case():
    """Models that clast refuses would have no digits: two laws and three processes of each."""
    for name, scene in digit_scenes.SCENES.items():
        if "1600" not in name:
            assert scene.case("convex", "penalty").model().block_count > 1, name
