"""Pages name what exists: files, verification problems, commands, keys, public names."""

from __future__ import annotations

import re
import subprocess
import sys
from itertools import chain
from pathlib import Path

import pytest
import yaml

import clast

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
WRITTEN = [DOCS / name for name in ("index.md", "tutorial.md", "solver-performance.md")]
PAGES = [*WRITTEN, *chain.from_iterable((DOCS / d).glob("*.md") for d in ("how-to", "theory"))]

SOURCE = re.compile(r"`((?:src|tools|tests|cases|benchmarks)/[\w/.-]+)`")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_files_that_a_page_names_exist(page):
    named = set(SOURCE.findall(page.read_text("utf-8")))
    missing = sorted(name for name in named if not (ROOT / name).exists())
    assert not missing, f"{page.relative_to(ROOT)} names files that do not exist"


def test_functions_that_pages_name_are_in_their_files():
    pairs = {
        pair
        for page in PAGES
        for pair in re.findall(r"`(\w+)`\s+in\s+`(src/[\w/.]+\.py)`", page.read_text("utf-8"))
    }
    assert len(pairs) > 8
    for name, path in pairs:
        assert re.search(rf"\b{name}\b", (ROOT / path).read_text("utf-8")), (name, path)


def test_theory_names_files_at_all():
    found = {page.stem: SOURCE.findall(page.read_text("utf-8")) for page in PAGES}
    for page in (DOCS / "theory").glob("*.md"):
        assert found[page.stem], page


def test_problems_that_pages_name_exist():
    from clast.verification import PROBLEMS
    from clast.verification.catalogue import GROUPS

    known = {*GROUPS, *(problem.name for problem in PROBLEMS)}
    for page in PAGES:
        named = re.findall(r"`clast verify ([a-z][\w-]*)`", page.read_text("utf-8"))
        assert set(named) <= known, page


def test_every_problem_verifies_something_on_a_theory_page():
    from clast.verification import PROBLEMS

    text = "".join(page.read_text("utf-8") for page in (DOCS / "theory").glob("*.md"))
    named = set(re.findall(r"`clast verify ([a-z][\w-]*)`", text))
    assert {problem.name for problem in PROBLEMS} - named == set()


def test_the_papers_steps_are_all_there():
    page = (DOCS / "theory" / "paper-steps.md").read_text("utf-8")
    rows = re.findall(r"^\| \((\d+)\)(?:–\((\d+)\))? \|", page, re.MULTILINE)
    steps = chain.from_iterable(range(int(a), int(b or a) + 1) for a, b in rows)
    assert list(steps) == list(range(1, 18))
    code = (ROOT / "src" / "clast" / "step" / "modified.py").read_text("utf-8")
    marked = {int(n) for n in re.findall(r"\((\d+)\) ", "".join(re.findall(r"#.*", code)))}
    assert marked >= {*range(4, 15), 16}


@pytest.mark.parametrize("kind", ["case", "result"])
def test_a_reference_is_what_reads_the_file(kind: str):
    written = subprocess.run(
        [sys.executable, str(ROOT / "tools" / f"{kind}_reference.py"), "-"],
        capture_output=True,
        text=True,
        check=True,
    )
    page = (DOCS / "reference" / f"{kind}-file.md").read_text("utf-8")
    assert page == written.stdout, "run: make reference"


def test_the_schema_beside_it_is_what_clast_prints():
    printed = subprocess.run(
        [sys.executable, "-m", "clast", "schema"], capture_output=True, text=True, check=True
    )
    kept = (DOCS / "reference" / "case-file.schema.json").read_text("utf-8")
    assert kept == printed.stdout, "run: make reference"


def test_the_api_page_has_every_public_name():
    page = (DOCS / "reference" / "api.md").read_text("utf-8")
    shown = set(re.findall(r"^::: clast\.(\w+)$", page, re.MULTILINE))
    assert shown == set(clast.__all__) - {"studies", "__version__"}


def test_the_page_of_commands_has_every_command():
    helped = subprocess.run(
        [sys.executable, "-m", "clast", "--help"], capture_output=True, text=True, check=True
    )
    # commands stand in groups, behind the options
    commands = set(re.findall(r"^  ([a-z]+)  ", helped.stdout.partition("Make:")[2], re.M))
    page = (DOCS / "reference" / "commands.md").read_text("utf-8")
    assert set(re.findall(r"^\| `clast ([a-z]+)", page, re.MULTILINE)) == commands
    assert len(commands) >= 10


def test_every_page_is_in_the_navigation():
    site = yaml.safe_load((ROOT / "mkdocs.yml").read_text("utf-8"))

    def pages(entries):
        for entry in entries:
            if isinstance(entry, str):
                yield entry
            else:
                for inner in entry.values():
                    yield from pages(inner)

    listed = list(pages(site["nav"]))
    present = sorted(str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md"))
    assert sorted(listed) == present


def test_decisions_are_numbered_once_and_listed():
    pages = sorted((DOCS / "decisions").glob("0*.md"))
    index = (DOCS / "decisions" / "index.md").read_text("utf-8")
    numbers = [page.name[:4] for page in pages]
    assert len(set(numbers)) == len(numbers)
    for page in pages:
        assert page.read_text("utf-8").startswith(f"# {int(page.name[:4])}. "), page.name
        assert f"]({page.name})" in index, page.name


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md"])
def test_links_of_what_is_not_on_the_site_lead_somewhere(name):
    links = re.findall(r"\]\(([^)#:]+)\)", (ROOT / name).read_text("utf-8"))
    assert len(links) >= 4
    assert [link for link in links if not (ROOT / link).exists()] == []
