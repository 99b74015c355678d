"""A run that is shown in a browser while it goes on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clast.cli.terminal import say
from clast.errors import CaseError, RunStopped, shortened

if TYPE_CHECKING:
    from clast.pictures.live.leader import LivePage
    from clast.run.schedule import Progress


@contextmanager
def followed(
    output: Path, wanted: bool, at: str, progress: bool
) -> Iterator[bool | Callable[[Progress], None]]:
    """Yield the watcher of a run: the page of ``output``, if it is wanted.

    The page stays, when the run is over, as long as somebody looks at it.
    """
    if not wanted:
        yield progress
        return
    from clast.pictures.live.leader import LivePage

    page = LivePage(output, _address(at), wants_line=progress)
    say(f"live: {page.address}")
    try:
        try:
            yield page
        except (RunStopped, typer.Exit) as end:
            if isinstance(end, RunStopped) or page.has_ended:
                _stay(page)
            raise
        _stay(page)
    finally:
        page.close()


def _stay(page: LivePage) -> None:
    """Leave the page to those who look at it."""
    page.over()
    if page.is_watched():
        page.wait()


def _address(written: str) -> str:
    """Return where the page is to be; raises CaseError for a bad address."""
    from clast.pictures.live.leader import HERE

    host, colon, port = (written or HERE).rpartition(":")
    if not (colon and host and port.isdecimal() and int(port) < 2**16):
        raise CaseError(
            f"'{shortened(written)}' is not a valid address",
            where="--live-at",
            remedy="write host and port, e.g. 127.0.0.1:8080; for viewers on other machines "
            "give the address of this one in their network",
        )
    return f"{host}:{port}"
