"""The page of a report: headings, sentences, tables, pictures and runs to play, in one file.

It asks no network.  Figures need matplotlib; without it the page says so and has the tables alone.
"""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

from clast.errors import CaseError
from clast.pictures.page.document import page_text, write_html
from clast.pictures.page.scene import scene_of
from clast.study.description import Description
from clast.study.distributions import value_text
from clast.study.folder import StudyFolder, make_folder

STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;"
    "color:#222}h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}"
    "table{border-collapse:collapse;font-size:13px;margin:.6rem 0}td,th{border:1px solid #ccc;"
    "padding:3px 9px;text-align:right}td:first-child,th:first-child{text-align:left}"
    "td.text{text-align:left}td:not(.text){white-space:nowrap}img{max-width:100%;vertical-align:top}"
    ".answer{font-size:1.15rem;border-left:4px solid #1f6f8b;padding:.4rem .9rem;"
    "background:#f4f7f8}.figures{display:flex;flex-wrap:wrap;gap:1rem;align-items:flex-start}"
    ".figures img{flex:1 1 24rem;min-width:0;max-width:min(100%,30rem)}"
    ".figures.wide img{flex:0 1 auto;max-width:100%}"
    "iframe{width:100%;height:46rem;border:1px solid #ccc}.remark{color:#666;font-size:13px}"
    ".table{overflow-x:auto}th.text{text-align:left}p{overflow-wrap:anywhere}"
    "@media (prefers-color-scheme:dark){body{background:#17181c;color:#e2e2e2}"
    "td,th,iframe{border-color:#44464d}.answer{background:#22252b}.remark{color:#a0a0a0}"
    ".figures img{background:#fff;border-radius:4px}}"
)


@dataclass
class Page:
    """The parts of a page, as they are put together."""

    title: str
    folder: Path = Path()
    """Folder of the study."""
    parts: list[str] = field(default_factory=list)
    """HTML."""

    @classmethod
    def of(cls, folder: StudyFolder, kind: str) -> Page:
        """Return the page of a study, without any part; its figures have a folder."""
        page = cls(f"{folder.base.title or 'Study'}: {kind}", folder.path)
        make_folder(page.pictures)
        return page

    @property
    def pictures(self) -> Path:
        """The folder of its figures."""
        return self.folder / "figures"

    def write(self) -> Path:
        """Write the page into the folder of its study; return its path."""
        return write_html(self.text(), self.folder / "report.html")

    def say(self, text: str, kind: str = "") -> None:
        """Add a paragraph."""
        self.parts.append(f"<p{f' class={kind}' if kind else ''}>{escape(text)}</p>")

    def remark(self, text: str) -> None:
        """Add a paragraph in small letters."""
        self.say(text, "remark")

    def head(self, text: str) -> None:
        """Add a heading."""
        self.parts.append(f"<h2>{escape(text)}</h2>")

    def table(self, heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add a table."""
        listed = [*rows]
        texts = [isinstance(one, str) for one in listed[0]] if listed else [False] * len(heads)
        head = "".join(
            f"<th{' class=text' if is_text else ''}>{escape(one)}</th>"
            for one, is_text in zip(heads, texts, strict=True)
        )
        body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>\n" for row in listed)
        self.parts.append(f'<div class="table"><table><tr>{head}</tr>\n{body}</table></div>')

    def figures(
        self, draw: Callable[[], Iterable[tuple[Path, str]]], kind: str = "figures"
    ) -> None:
        """Add figures (PNG) side by side, each with its caption, or a note on the missing one.

        ``kind`` is their CSS class.
        """
        try:
            drawn = "".join(
                f'<img alt="{escape(text)}" src="data:image/png;base64,'
                f'{b64encode(path.read_bytes()).decode()}">'
                for path, text in draw()
            )
        except CaseError as error:
            self.remark(f"{error.what}. {error.remedy}")
        else:
            self.parts.append(f'<div class="{kind}">{drawn}</div>')

    def parameters(self, study: Description, units: Mapping[str, str], head: str) -> None:
        """Add the table of the parameters that vary."""
        rows = [
            [one.name, ", ".join(one.paths), str(one.distribution), units[one.name]]
            for one in study.vary
        ]
        self.table(["parameter", "keys", head, "unit"], rows)

    def run(self, run: Any, title: str) -> None:
        """Add the page that plays a run, with a title for those who do not see it."""
        # Bytes that contacts of a run take before they are compressed
        inner = escape(page_text(scene_of(run, 6e6)))
        self.parts.append(f'<iframe title="{escape(title)}" srcdoc="{inner}"></iframe>')

    def text(self) -> str:
        """Return the page."""
        title = escape(self.title)
        return (
            '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width"><title>{title} - clast'
            f"</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n"
            + "\n".join(self.parts)
            + "\n</body></html>\n"
        )


def file_stem(name: str) -> str:
    """Return the name of a measure as the beginning of a file name."""
    return "".join(sign if sign.isalnum() or sign in "-_" else "_" for sign in name)


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return f'<td class="text">{escape(value)}</td>'
    if isinstance(value, tuple | list):
        return f"<td>{escape(value_text(tuple(value)))}</td>"
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "<td>-</td>"
    number = f"{value:.5g}" if isinstance(value, float) else str(value).lower()  # true and false
    return f"<td>{number}</td>"
