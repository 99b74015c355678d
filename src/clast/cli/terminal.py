"""Output to the terminal: tables, JSON, messages, exit codes; no foreign control character."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from clast.spelling import visible, without_long_words

if TYPE_CHECKING:
    from rich.table import Table

PIPE_WIDTH = 100
"""Width of tables where there is no terminal, characters."""
MISSED, BAD_INPUT, STOPPED, SIGNALLED = 1, 2, 3, 128
"""Exit codes: a verification failed, bad input, a run that could not go on (its partial results are
kept), and the base to which systems add the number of the signal that ended a program: 130 for the
key."""


def table_of(
    title: str,
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    words: Container[int] = (0,),
    caption: str = "",
) -> Table:
    """Return texts as a table; columns of ``words`` stand left and wrap, numbers do neither.

    Without ``headings`` all are words.
    """
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=Text(title) if title else None,
        title_justify="left",
        caption=Text(caption) if caption else None,
        caption_justify="left",
        show_header=bool(headings),
    )
    rows = [[str(cell) for cell in row] for row in rows]
    for number, heading in enumerate(headings):
        cells = [row[number] for row in rows]
        is_words = number in words
        parts = [part for cell in cells for part in (cell.split() if is_words else [cell])]
        least = max(map(len, parts), default=0)
        table.add_column(
            heading,
            justify="left" if is_words else "right",
            min_width=min(least, 20) if is_words else least,
            overflow="fold",
        )
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def two_columns(title: str, rows: Mapping[str, str]) -> Table:
    """Return names and texts as a table without headings; names without a text are left out."""
    return table_of(title, (), [row for row in rows.items() if row[1]])


def print_table(table: Table) -> None:
    """Print a table, as wide as the terminal, or as PIPE_WIDTH where there is none."""
    from rich.console import Console
    from rich.text import Text

    cells = (cell for column in table.columns for cell in column.cells)
    for text in (table.title, table.caption, *cells):
        if isinstance(text, Text):
            text.plain = visible(text.plain)
    width = None if sys.stdout.isatty() else PIPE_WIDTH
    # names of the user are no markup
    Console(width=width, markup=False, emoji=False).print(table)


@contextmanager
def status() -> Iterator[Callable[[str], None]]:
    """Yield a function that shows the progress, where stderr is a terminal.

    Compilation meanwhile is shown beside it, and by lines where there is no terminal.
    """
    from rich.console import Console
    from rich.text import Text

    from clast.compute.compilation import COMPILATION
    from clast.run.progress import compilation_text, compilation_told

    console = Console(stderr=True)
    if not console.is_terminal:
        with compilation_told(say):
            yield lambda _: None
        return
    doing = "starting"
    with console.status(doing) as line:

        def show(what: str) -> None:
            nonlocal doing
            doing = what
            line.update(Text(doing))

        def compiling(module: str | None) -> None:
            more = f"; {compilation_text(module)}" if module else ""
            line.update(Text(doing + more))

        with COMPILATION.telling(compiling):
            yield show


@contextmanager
def progress_bar(what: str) -> Iterator[Callable[[int, int, str], None]]:
    """Yield a function that shows how many of how many are done, and a text behind it.

    Where there is no terminal it shows nothing.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.progress import TimeRemainingColumn as Left

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _done, _of, _text: None
        return
    percent, left = TextColumn("{task.percentage:>3.0f}%"), TextColumn("left; {task.description}")
    columns = BarColumn(bar_width=24), percent, TimeElapsedColumn(), Left(), left
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=None)

        def show(done: int, of: int, text: str = "") -> None:
            bar.update(task, completed=done, total=of, description=f"{what} {text}")

        yield show


def print_json(content: Any) -> None:
    """Print JSON; numbers that JSON does not know become null."""
    typer.echo(visible(json.dumps(_plain(content), indent=2, ensure_ascii=False)))


def print_line(content: Any) -> None:
    """Print JSON on one line, as a program reads it that waits for lines."""
    typer.echo(visible(json.dumps(_plain(content), ensure_ascii=False)))


def _plain(value: Any) -> Any:
    """Return a value made of types that JSON knows."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def warn(warnings: Iterable[str]) -> None:
    """Print warnings on stderr, each on a line of its own."""
    for warning in warnings:
        say(f"warning: {warning}")


def say(message: str) -> None:
    """Print a message for the user on stderr."""
    typer.echo(visible(without_long_words(message)), err=True)


def tell(message: str) -> None:
    """Print the requested output on stdout."""
    typer.echo(visible(message))
