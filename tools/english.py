"""Counts words in docstrings that keep a sentence from saying what it is about, by folder.

    python tools/english.py           counts of "what" per 1,000 words of docstrings, by folder
    python tools/english.py --list    the sentences, and those with private words, with their places

"What" in the place of a noun ("what acts", "what a cut came to") hides the subject: loads, the
report of a cut.  Private words and participles used as nouns ("the begun") are known to their
writer alone.
"""

from __future__ import annotations

import argparse
import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "clast"
WORD = re.compile(r"[A-Za-z']+")
WHAT = re.compile(r"\bwhat\b", re.IGNORECASE)
PRIVATE = re.compile(
    r"\bbears\b|\bbore\b|\bis gone\b|\bare gone\b|\bgive back\b|\bnumbers that are none\b"
    r"|\bthe (begun|told|found|done|solved|ended|asked|chosen)\b(?=[ ,.;:)]*$|[,.;:)])",
    re.IGNORECASE,
)
"""Words for carries, carried, excavated, return, NaN; and participles in the place of nouns."""


@dataclass(frozen=True, kw_only=True)
class Docstring:
    """A docstring of the package, of a module, a class, a function, a field or a constant."""

    file: str
    line: int
    text: str

    @property
    def folder(self) -> str:
        """First folder of its file, "." for a file of the package itself."""
        return self.file.split("/")[0] if "/" in self.file else "."

    @property
    def words(self) -> int:
        """Number of words."""
        return len(WORD.findall(self.text))

    def sentences(self, pattern: re.Pattern[str]) -> Iterator[str]:
        """Yield the sentences in which a pattern occurs."""
        for one in re.split(r"(?<=[.?!])\s+(?=[A-Z`])|\n\s*\n", self.text):
            if pattern.search(one):
                yield " ".join(one.split())


def docstrings(package: Path = PACKAGE) -> Iterator[Docstring]:
    """Yield every docstring below a folder."""
    for path in sorted(package.rglob("*.py")):
        file = path.relative_to(package).as_posix()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            body = getattr(node, "body", None)
            for one in body if isinstance(body, list) else ():
                text = one.value if isinstance(one, ast.Expr) else None
                if isinstance(text, ast.Constant) and isinstance(text.value, str):
                    yield Docstring(file=file, line=one.lineno, text=text.value)


def rates(found: Iterable[Docstring]) -> dict[str, tuple[int, int]]:
    """Return the numbers of "what" and of words by folder, and of all as "all"."""
    whats: Counter[str] = Counter()
    words: Counter[str] = Counter()
    for one in found:
        for folder in (one.folder, "all"):
            whats[folder] += len(WHAT.findall(one.text))
            words[folder] += one.words
    return {folder: (whats[folder], words[folder]) for folder in sorted(words)}


def main() -> None:
    """Print the counts, and with --list the sentences."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--list", action="store_true", help="print the sentences")
    found = list(docstrings())
    for folder, (whats, words) in rates(found).items():
        print(f"{folder:14} {whats:5} of {words:6} words, {1e3 * whats / words:5.2f} per 1,000")  # noqa: T201
    for pattern in (WHAT, PRIVATE) if parser.parse_args().list else ():
        for one in found:
            for sentence in one.sentences(pattern):
                print(f"{one.file}:{one.line}: {sentence}")  # noqa: T201


if __name__ == "__main__":
    main()
