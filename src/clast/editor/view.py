"""`clast edit --view`: the section of a case beside the text editor that writes it."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterable
from http import HTTPStatus
from pathlib import Path

from clast.editor.checking import Checked, checks
from clast.editor.page import view_text
from clast.editor.section import section_of
from clast.inputs.declaring.text import read_text
from clast.pictures.live.guarded import GuardedHandler, GuardedServer

LIFE = 5.0
"""A sign of life goes to every window at least so often, s."""


class ViewServer(GuardedServer):
    """Serves the section of a case file to windows that look on."""

    def __init__(self, at: tuple[str, int], path: Path) -> None:
        self.path = path
        self.news = "null"
        """The newest section, JSON."""
        self.stamp = 0
        """Counts sections."""
        super().__init__(at, ViewHandler, threading.Condition())

    def show(self, checked: Checked) -> None:
        """Show the newest findings about the file."""
        news = json.dumps(section_of(checked), allow_nan=False, separators=(",", ":"))
        with self.changed:
            self.news, self.stamp = news, self.stamp + 1
            self.changed.notify_all()


class ViewHandler(GuardedHandler):
    """Answers one browser."""

    server: ViewServer

    def do_GET(self) -> None:
        """Answer with the window, or with sections as they come."""
        if not self.is_from_here():
            return
        if self.path == "/":
            self.send(HTTPStatus.OK, "text/html; charset=utf-8", view_text(self.server.path.name))
        elif self.path != "/news":
            self.refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        elif self.has_token():
            self.stream(self._tell)

    def _tell(self) -> None:
        server, seen = self.server, 0
        while True:
            with server.changed:
                is_new = server.changed.wait_for(lambda: server.stamp != seen, LIFE)  # noqa: B023
                seen, news = server.stamp, server.news
            self.event("section" if is_new else "alive", news if is_new else "null")


def view(
    path: Path, at: tuple[str, int], say: Callable[[str], None], settings: Iterable[str] = ()
) -> None:
    """Serve the section of a case file until Ctrl-C; ``say`` gets its address."""
    read_text(path)  # a file that is not there is refused at once
    server = ViewServer(at, path)
    threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True).start()
    try:
        say(server.address)
        for checked in checks(path, settings):
            if checked is not None:
                server.show(checked)
    except KeyboardInterrupt:
        pass
    finally:
        server.shutdown()
        server.server_close()
