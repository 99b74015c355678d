"""Every snippet of the tutorial and the how-to pages does what the page says.

A page is worked through from top to bottom in an empty folder: TOML with a title is the file of
that name, TOML without one is laid over the incline template and must be a valid case, shell lines
are commands of clast, Python shares its names from block to block.
"""

from __future__ import annotations

import re
import runpy
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import clast

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted([DOCS / "tutorial.md", *(DOCS / "how-to").glob("*.md")])

BLOCK = re.compile(
    r"^(?P<indent> *)```(?P<language>\w+)(?P<options>[^\n]*)\n(?P<text>.*?)^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)
TITLE = re.compile(r'title="([^"]*)"')
README = DOCS.parent / "README.md"
STUDY = re.compile(r"clast\.(Study|fit|target|factor_of_safety|collapse_load)\(")
"""Code that makes studies, which may start processes: it is started as a script as well."""
INSTALLATION = "Installation"
"""Title of the shell block that is not run here: the tests themselves need it done."""
SHOWN = {"text"}
"""Languages that are shown, not run: what a command prints."""


class Snippet(NamedTuple):
    language: str
    title: str
    text: str
    line: int


def snippets(page: Path) -> list[Snippet]:
    """Return the code blocks of a page in their order."""
    content = page.read_text("utf-8")
    found = []
    for match in BLOCK.finditer(content):
        title = TITLE.search(match["options"])
        text = re.sub(f"^{match['indent']}", "", match["text"], flags=re.MULTILINE)
        line = content.count("\n", 0, match.start()) + 2
        found.append(Snippet(match["language"], title[1] if title else "", text, line))
    return found


def command(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a shell line that calls clast, in this process."""
    words = shlex.split(line, comments=True)
    assert words[0] == "clast", f"not a command of clast: {line}"
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("clast", run_name="__main__")
    assert ended.value.code in (0, None), line


def laid_over(tables: dict[str, Any], content: dict[str, Any]) -> dict[str, Any]:
    """Return the content with tables of a fragment in the place of its own.

    A table with a law of its own stands in the place of a whole one: other laws have other keys.
    """
    both = dict(content)
    for key, value in tables.items():
        old = content.get(key)
        nested = isinstance(old, dict) and isinstance(value, dict) and "law" not in value
        both[key] = laid_over(value, old) if nested else value
    return both


def check_fragment(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Check that a part of a case file makes a valid case of the incline template."""
    if not (folder / "template.toml").exists():
        command("clast new template", monkeypatch)
    whole = tomllib.loads((folder / "template.toml").read_text("utf-8"))
    case = clast.Case.validated(laid_over(tomllib.loads(text), whole), "fragment")
    case.method(case.model())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
@pytest.mark.one_in(3)
def test_every_snippet_of_a_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": page.stem}
    for snippet in snippets(page):
        if snippet.language == "python":
            text = "\n" * (snippet.line - 1) + snippet.text
            exec(compile(text, str(page), "exec", dont_inherit=True), names)
        elif snippet.language == "toml" and snippet.title:
            (tmp_path / snippet.title).write_text(snippet.text, "utf-8")
        elif snippet.language == "toml":
            check_fragment(snippet.text, tmp_path, monkeypatch)
        elif snippet.language == "sh" and snippet.title != INSTALLATION:
            for line in snippet.text.splitlines():
                command(line, monkeypatch)
        else:
            assert snippet.language in {*SHOWN, "sh"}, f"{page.name}:{snippet.line}"
    text = "".join(one.text for one in snippets(page) if one.language == "python")
    if STUDY.search(text):
        started(text, tmp_path)


def started(text: str, folder: Path) -> None:
    """Start Python code as a script; check that it ends well, and runs once and not again."""
    (folder / "script.py").write_text('print("the script begins")\n' + text, "utf-8")
    ended = subprocess.run(
        [sys.executable, "script.py"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("the script begins") == 1


def test_the_script_of_the_readme_can_be_started(tmp_path):
    texts = [one.text for one in snippets(README) if one.language == "python"]
    assert texts
    started("".join(texts), tmp_path)


def test_pages_have_snippets():
    assert len(PAGES) >= 6
    assert all(snippets(page) for page in PAGES)
