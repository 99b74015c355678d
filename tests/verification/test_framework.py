"""The frame of the problems: choosing, verdicts, tables, report."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest

from clast import verification
from clast.errors import CaseError, RunStopped
from clast.inputs.method import PROCESSES
from clast.verification import PROBLEMS, Verdict, cells
from clast.verification.catalogue import GROUPS, MODULES
from clast.verification.problem import Bracket, KnownFailure
from clast.verification.problems.blocks.spin import spin
from clast.verification.report import anchor
from clast.verification.variants import LAGGED

DOCS = Path(__file__).parents[2] / "docs"


def problem(measure, *comparison, **changes):
    """Return a problem with a comparison, "relative" or "absolute"."""
    return dataclasses.replace(
        spin, examine=lambda trial: getattr(trial, measure)(*comparison), **changes
    )


def test_names_are_unique_and_found():
    names = [each.name for each in PROBLEMS]
    assert len(set(names)) == len(names)
    assert [each.name for each in verification.problems(["spin", "incline"])] == ["spin", "incline"]
    assert len(verification.problems()) == len(PROBLEMS)


def test_groups_are_names_too():
    assert tuple(verification.problems(["cutting"])) == GROUPS["cutting"]
    both = verification.problems(["chords", "cutting"])
    assert both[0].name == "chords" and len(both) == len(GROUPS["cutting"])
    assert not set(GROUPS) & {each.name for each in PROBLEMS}


def test_every_file_of_a_group_is_in_the_table():
    folder = Path(verification.__file__).parent / "problems"
    files = {(path.parent.name, path.stem) for path in folder.glob("*/[a-z]*.py")}
    assert files == {(group, n) for group, names in MODULES.items() for n in names.split()}
    # that of water has the whole table of flow in joints
    assert {len(found) for found in GROUPS.values()} <= set(range(6, 22))


def test_an_unknown_name_is_refused_with_a_suggestion():
    with pytest.raises(CaseError, match="inclime") as error:
        verification.run(["inclime"])
    assert "did you mean 'incline'?" in str(error.value)


@pytest.mark.parametrize("each", PROBLEMS, ids=lambda each: each.name)
def test_the_page_has_every_problem_as_it_is(each):
    page = (DOCS / "verification.md").read_text(encoding="utf-8")
    for text in (each.title, each.text, each.formula, each.source, each.left_out):
        assert text in page, "make verify writes the page anew"
    assert (DOCS / "images" / "verification" / f"{each.name}.png").exists()


@pytest.mark.parametrize("each", PROBLEMS, ids=lambda each: each.name)
def test_problems_are_complete(each):
    assert each.text.endswith(".") and each.formula and each.source
    assert set(each.quick) <= set(each.variants)
    assert len({variant.name for variant in each.variants}) == len(each.variants)
    assert each.set_up().block_count > 0


@pytest.mark.parametrize("each", PROBLEMS, ids=lambda each: each.name)
def test_problems_say_which_processes_are_left_out_and_why(each):
    run_with = {variant.process["name"] for variant in each.variants}
    apart = each in (*GROUPS["cutting"], *GROUPS["rockfall"])
    missing = set() if apart else set(PROCESSES) - run_with
    said = [part.split(": ", 1) for part in each.left_out.split("; ") if ": " in part]
    assert {name for names, _ in said for name in names.split(" and ")} == missing
    assert all(why for _, why in said)


def test_variants_are_narrowed_by_process_and_law():
    choose = verification.narrowed(verification.every, ["convex"], ["augmented-lagrangian"])
    (stack,) = map(choose, verification.problems(["stack"]))
    assert [variant.name for variant in stack.variants] == ["convex, augmented Lagrangian"]
    with pytest.raises(CaseError, match="no process 'convx'"):
        verification.narrowed(verification.every, ["convx"])


def test_a_failure_that_is_known_and_gone_is_named():
    known = KnownFailure(LAGGED, "way", "because")
    each = problem("absolute", "way at 2 s", "m", 0.0, 0.0, 0.1, "why", known_failures=(known,))
    assert verification.fixed_failures([each.findings(LAGGED)]) == [known]


def test_relative_error_passes_within_its_tolerance():
    row = problem("relative", "way", "m", 1.001, 1.0, 0.002, "why").run(LAGGED)[0]
    assert (row.error, row.verdict) == (pytest.approx(0.001), Verdict.PASS)
    assert cells(row)[2:6] == ("1.001 m", "1 m", "0.1 %", "0.2 %")


@pytest.mark.parametrize(
    ("ends", "error", "verdict"),
    [
        ((0.99, 1.02), 0.0, Verdict.PASS),
        ((1.02, 0.99), 0.0, Verdict.PASS),
        ((1.01, 1.03), 0.01, Verdict.PASS),
        ((0.95, 0.97), -0.03, Verdict.MISS),  # the middle is 0.04 away, the tolerance 0.03
    ],
)
def test_a_bracket_has_no_error_within_itself(ends, error, verdict):
    row = problem("relative", "limit", "m", Bracket(*ends), 1.0, 0.03, "why").run(LAGGED)[0]
    assert (row.error, row.verdict) == (pytest.approx(error), verdict)
    assert row.computed == pytest.approx(0.5 * sum(ends))
    assert cells(row)[2] == f"{min(ends):g} to {max(ends):g} m"
    assert row.as_dict()["bracket"] == sorted(ends)
    assert row.tolerance == pytest.approx(0.03 - 0.5 * abs(ends[1] - ends[0]))


@pytest.mark.parametrize("computed", [1.003, 0.997, math.nan, math.inf])
def test_a_miss(computed):
    row = problem("relative", "way", "m", computed, 1.0, 0.002, "why").run(LAGGED)[0]
    assert row.verdict is Verdict.MISS
    assert verification.misses([row]) == [row]


def test_a_known_failure_is_no_miss():
    known = KnownFailure(LAGGED, "way", "because")
    each = problem("absolute", "way at 2 s", "m", 1.0, 0.0, 0.1, "why", known_failures=(known,))
    row = each.run(LAGGED)[0]
    assert (row.verdict, row.known_failure) == (Verdict.KNOWN, "because")
    assert verification.misses([row]) == []
    assert row.as_dict()["verdict"] == "known to fail"


def test_a_run_that_stops_is_a_miss():
    def stop(trial):
        raise RunStopped("it flew apart", None)

    row = dataclasses.replace(spin, examine=stop).run(LAGGED)[0]
    assert (row.verdict, row.reason) == (Verdict.MISS, "it flew apart")


def test_the_method_of_a_variant_is_that_of_a_case_file():
    model = spin.set_up()
    method = LAGGED.method(model, p=1e9, max_displacement=0.01)
    assert method.contact_law.normal_stiffness == 1e9
    assert (method.critdis, method.fixed_point_stiffness) == (0.005, 100.0 * 50e9)


def test_report_has_a_page_and_a_figure(tmp_path):
    findings = verification.examine(["patch"], choose=verification.quick)
    written = verification.write_report(findings, tmp_path)
    page = (tmp_path / "verification.md").read_text(encoding="utf-8")
    assert (tmp_path / "verification.html").read_text(encoding="utf-8").count("<h2") == 1
    assert all(path.stat().st_size > 0 for path in written)
    assert "![Patch test](images/verification/patch.png)" in page
    assert f"(#{anchor('Patch test')})" in page
