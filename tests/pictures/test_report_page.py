"""Reports of runs: verdicts in sentences, tables in engineering units, broken requests."""

import re

import pytest

import clast
from clast.errors import CaseError
from clast.model.stage_records import FAILS, Mover, StageRecord
from clast.pictures.report_page import stage_in_words, write_report


def text_of(page: str) -> str:
    """Return the words of a page without its figures."""
    return re.sub(r"\s+", " ", re.sub(r"<style>.*?</style>|<[^>]+>", " ", page, flags=re.DOTALL))


def test_a_report_has_forces_of_bolts_linings_and_reactions(sprayed, tmp_path):
    path = write_report(sprayed, tmp_path / "tunnel.html")
    page = path.read_text("utf-8")
    words = text_of(page)
    lining = sprayed.lining_name[0]
    largest = 1e-3 * float(max(sprayed.lining(lining).moment[-1]))
    assert f"{largest:.4g}" in words
    assert "Linings" in words and lining in words and "Displacements" in words
    assert page.count("<figure>") == page.count("data:image/") >= 2
    # nothing comes from elsewhere, and no script runs
    assert "http" not in re.sub(r'xmlns[^"]*"[^"]*"', "", text_of(page))
    assert "default-src 'none'" in page and "<script" not in page


def test_each_stage_has_a_sentence_and_each_support_its_reaction(parted, tmp_path):
    words = text_of(write_report(parted, tmp_path / "report.html").read_text("utf-8"))
    _, y = 1e-3 * parted.reaction(parted.reaction_name[0]).force[-1]
    assert f"{y:.4g}" in words
    for stage in parted.stages:
        assert stage_in_words(stage) in words.replace("&#x27;", "'")


def test_a_stage_that_fails_is_said_to_fail():
    record = StageRecord(
        name="dig <b>",
        start=0.0,
        end=1.0,
        steps=3,
        outcome=FAILS,
        force_ratio=0.2,
        mover=Mover(),
        seconds=1.0,
    )
    assert stage_in_words(record).endswith("There is no equilibrium.")


def test_names_in_a_case_are_text(tmp_path):
    builder = clast.ModelBuilder(title="<script>alert(1)</script>")
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="<i>", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], fixed=True)
    builder.block(name="b", vertices=[(0, 1), (1, 1), (1, 2), (0, 2)])
    run = clast.simulate(builder.build(), end=0.01, step=0.005)
    page = write_report(run, tmp_path / "names.html").read_text("utf-8")
    assert "<script>" not in page and "&lt;script&gt;" in page


def test_a_report_with_another_ending_is_refused(parted, tmp_path):
    with pytest.raises(CaseError, match=r"end the name in \.html"):
        write_report(parted, tmp_path / "report.pdf")
    assert not list(tmp_path.iterdir())
