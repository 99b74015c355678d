"""Docstrings name their subjects: the numbers of tools/english.py are held, and tried."""

import importlib.util
from pathlib import Path

import pytest

TOOL = Path(__file__).resolve().parents[2] / "tools" / "english.py"
MOST = 0.5
"""Occurrences of "what" per 1,000 words of docstrings; 8.7 when counting began."""
MOST_PRIVATE = 25
"""Sentences with private words; may only become fewer."""


@pytest.fixture(scope="module")
def english():
    import sys

    spec = importlib.util.spec_from_file_location("english", TOOL)
    module = importlib.util.module_from_spec(spec)
    sys.modules["english"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["english"]


@pytest.mark.slow  # reads the whole package
def test_docstrings_say_what_they_are_about(english):
    found = list(english.docstrings())
    whats, words = english.rates(found)["all"]
    assert 1e3 * whats / words < MOST
    private = [text for one in found for text in one.sentences(english.PRIVATE)]
    assert len(private) <= MOST_PRIVATE, "\n".join(private)


def test_counts_are_those_of_docstrings_alone(english, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "a.py").write_text(
        '"""What acts.  Loads are\nnot."""\n'
        'LIMIT = "what is no docstring"\n"""Largest load.  It bears what comes."""\n'
        'def one():\n    """Return the begun."""\n    return "what"\n',
        encoding="utf-8",
    )
    found = list(english.docstrings(tmp_path))
    assert [one.line for one in found] == [1, 4, 6]
    assert english.rates(found) == {"all": (2, 14), "run": (2, 14)}
    assert [list(one.sentences(english.WHAT)) for one in found] == [
        ["What acts."],
        ["It bears what comes."],
        [],
    ]
    assert [list(one.sentences(english.PRIVATE)) for one in found] == [
        [],
        ["It bears what comes."],
        ["Return the begun."],
    ]
