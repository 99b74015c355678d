"""Tiers of tests: by folder, drawn by the commit, core tests within their time."""

from __future__ import annotations

from itertools import combinations

import pytest

from scenes import tiers

pytest_plugins = ["pytester"]


@pytest.mark.parametrize(
    ("file", "tier"),
    [
        ("test_house.py", "core"),
        ("contact/test_laws.py", "core"),
        ("case/records/test_units_and_times.py", "core"),
        ("chapter_that_comes_later/test_new.py", "core"),
        ("docs/test_snippets.py", "system"),
        ("run/test_stages.py", "system"),
        ("system/run/test_in_situ.py", "system"),
        ("long/compute/test_forks.py", "long"),
    ],
)
def test_the_folder_gives_the_tier(file: str, tier: str):
    assert tiers.tier_of(tiers.TESTS / file) == tier


def test_slow_tests_belong_to_the_tier_after_that_of_their_folder():
    assert [tiers.lifted(tier) for tier in tiers.TIERS] == ["system", "long", "long"]


@pytest.mark.parametrize(
    ("file", "may_have"),
    [
        ("contact/test_laws.py", ["core", "system"]),
        ("run/test_stages.py", ["system", "long"]),
        ("long/compute/test_forks.py", ["long"]),
    ],
)
def test_files_are_read_for_the_tiers_that_they_can_have(file: str, may_have: list[str]):
    assert [one for one in tiers.TIERS if tiers.can_have(tiers.TESTS / file, one)] == may_have


def test_files_that_begin_are_there():
    assert [one for one in tiers.LONGEST if not (tiers.TESTS / one).is_file()] == []
    assert set(tiers.EACH_BY_ITSELF) <= set(tiers.LONGEST)


def test_what_takes_longest_comes_first():
    given = ["contact/test_laws.py", "contact/test_faces.py", "long/run/test_threads.py"]
    given += ["run/test_stages.py", "long/compute/test_forks.py", "docs/test_snippets.py"]
    paths = [tiers.TESTS / one for one in given]
    order = sorted(paths, key=lambda one: tiers.longest_first(one, tiers.tier_of(one)))
    assert [given.index(tiers.name_of(one)) for one in order] == [2, 4, 5, 3, 1, 0]


def test_only_tests_that_share_nothing_go_to_processes_one_by_one():
    assert (
        tiers.one_process("tests/contact/test_laws.py::test_a[1]") == "tests/contact/test_laws.py"
    )
    alone = "tests/docs/test_snippets.py::test_every_snippet_of_a_page_runs[arch::a]"
    assert tiers.one_process(alone) == alone
    for file in tiers.EACH_BY_ITSELF:
        assert "fixture" not in (tiers.TESTS / file).read_text("utf-8")


def test_every_commit_draws_its_share_and_all_commits_draw_all():
    names = [f"tests/long/test_{k}.py" for k in range(400)]
    chosen = [{name for name in names if tiers.drawn(name, 4, str(by))} for by in range(40)]
    assert all(60 < len(some) < 140 for some in chosen)
    assert set().union(*chosen) == set(names)
    assert {name for name in names if tiers.drawn(name, 4, "0")} == chosen[0]
    assert all(tiers.drawn(name, 1, "0") for name in names)


@pytest.mark.parametrize("lengths", [(3, 2), (3, 3, 3), (4, 3, 2, 2), (2,) * 6])
def test_every_two_values_meet(lengths: tuple[int, ...]):
    options = [range(10 * k, 10 * k + n) for k, n in enumerate(lengths)]
    rows = tiers.pairwise(*options)
    for one, other in combinations(range(len(lengths)), 2):
        met = {(row[one], row[other]) for row in rows}
        assert len(met) == lengths[one] * lengths[other]
    longest = sorted(lengths)[-2:]
    assert len(rows) <= 1.5 * longest[0] * longest[1] + 2


BUSY = """
import time

def work(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass

times = iter([0.3, 0.0])

def test_quick(): work(0.0)
def test_always_long(): work(0.3)
def test_long_at_first(): work(next(times))
def test_waits(): time.sleep(0.3)
"""


@pytest.mark.slow
def test_a_core_test_that_is_long_twice_fails(pytester, monkeypatch):
    """One that is long at first, as where it loads a kernel, does not; nor one that waits."""
    monkeypatch.setattr(tiers, "LIMIT", 0.1)
    monkeypatch.setattr(tiers, "slowness", lambda: 1.0)
    monkeypatch.setattr(tiers, "TESTS", pytester.path)
    pytester.makeconftest((tiers.Path(__file__).parent / "conftest.py").read_text("utf-8"))
    pytester.makeini("[pytest]\nmarkers = slow\n  one_in(n)")
    pytester.makepyfile(test_busy=BUSY)
    done = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    done.assert_outcomes(passed=3, failed=1)
    done.stdout.fnmatch_lines(["*test_always_long took 0.3? s of processor time*"])
    done.stdout.fnmatch_lines(["core: 4 tests, *"])
    assert pytester.runpytest_inprocess("--no-core-limit").ret == 0


@pytest.mark.slow
def test_long_tests_are_drawn_and_tiers_come_in_order(pytester, monkeypatch):
    monkeypatch.setattr(tiers, "TESTS", pytester.path)
    monkeypatch.setenv("TESTS_DRAWN_BY", "abc")
    tiers.commit.cache_clear()
    pytester.makeconftest((tiers.Path(__file__).parent / "conftest.py").read_text("utf-8"))
    pytester.makeini("[pytest]\nmarkers = slow\n  one_in(n)")
    many = "import pytest\n@pytest.mark.parametrize('k', range(100))\ndef test_it(k): pass\n"
    for folder in ("long", "zone", "system"):
        (pytester.path / folder).mkdir()
        (pytester.path / folder / f"test_of_{folder}.py").write_text(many, "utf-8")
    done = pytester.runpytest_inprocess("--long-one-in", "10", "-v", "-p", "no:cacheprovider")
    tiers.commit.cache_clear()
    run = [line.split("/")[0] for line in done.outlines if "PASSED" in line]
    assert [run.count(one) for one in ("zone", "system")] == [100, 100]
    assert 3 <= run.count("long") <= 20
    assert run == sorted(run, key=["zone", "system", "long"].index)
