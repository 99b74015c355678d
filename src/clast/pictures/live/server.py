"""The page of a run over HTTP, for browsers on this machine that know its token."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs

from clast.errors import CaseError
from clast.pictures.live.feed import Feed
from clast.pictures.live.guarded import GuardedHandler, GuardedServer
from clast.pictures.live.leader import ORDERS
from clast.pictures.page.document import live_text

PAGE, JSON = "text/html; charset=utf-8", "application/json"
STATUS_INTERVAL, STATUS_INTERVAL_AFTER = 5.0, 1.0
"""A sign of life goes to every page at least so often, s; more often when the run is over."""


class LiveServer(GuardedServer):
    """Serves the page of a run at an address; port 0 is one that is free."""

    def __init__(self, at: tuple[str, int], feed: Feed, order: Callable[[str], None]) -> None:
        self.feed = feed
        self.order = order
        super().__init__(at, Handler, feed.changed)


class Handler(GuardedHandler):
    """Answers one browser."""

    server: Any
    """A LiveServer, or another that has a feed and takes orders."""
    page_at = "/"
    stays = True
    """Whether who looks on hears signs of life after the end of the run."""

    def pages(self) -> dict[str, Callable[[str], None]]:
        """Return what answers without the token: path -> answer to what follows its ``?``."""
        return {self.page_at: lambda _: self.send(HTTPStatus.OK, PAGE, live_text())}

    def answers(self) -> dict[str, Callable[[str], None]]:
        """Return what answers who has the token, as ``pages`` does."""
        feed = self.server.feed
        return {
            "/scene": lambda _: self.content(JSON, feed.scene),
            "/page": lambda _: self.content(PAGE, feed.page),
            "/events": self._events,
        }

    def do_GET(self) -> None:
        """Answer with a page, its content, or news as they come."""
        path, _, query = self.path.partition("?")
        if not self.is_from_here():
            return
        if path in self.pages():
            self.pages()[path](query)
        elif path not in self.answers():
            self.refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        elif self.has_token():
            self.answers()[path](query)

    def do_POST(self) -> None:
        """Hand on a request of a page to the run."""
        body = self.posted()
        if body is not None:
            self.order(body)

    def order(self, body: bytes) -> None:
        """Hand on a request to the run where it is one."""
        try:
            order = json.loads(body)["do"]
        except (ValueError, KeyError, TypeError):
            order = None
        if self.path != "/do" or order not in ORDERS:
            self.refuse(HTTPStatus.BAD_REQUEST, f"ask for one of: {', '.join(ORDERS)}")
            return
        self.server.order(order)
        self.send(HTTPStatus.OK, JSON, "{}")

    # --- answers -----------------------------------------------------------------------------

    def content(self, kind: str, text: Callable[[], str | bytes]) -> None:
        """Answer with a text, or that it is not there yet."""
        try:
            self.send(HTTPStatus.OK, kind, text())
        except CaseError as error:
            self.refuse(HTTPStatus.SERVICE_UNAVAILABLE, str(error))

    def _events(self, query: str) -> None:
        """Send news as they come, until the run is over or the browser has gone."""
        server, given = self.server, parse_qs(query).get("from", ["0"])[0]
        if not given.isdecimal() or int(given) > server.feed.frames:
            self.refuse(HTTPStatus.BAD_REQUEST, f"there are {server.feed.frames} frames")
            return
        self.stream(lambda: self._send_news(int(given)))

    def _send_news(self, first: int) -> None:
        """Send frames from ``first`` on, curves and report where they grow, and a sign of life."""
        feed, seen, sent, curves_sent = self.server.feed, -1, -1, 0.0
        while True:
            with feed.changed:
                beat = STATUS_INTERVAL_AFTER if feed.is_over else STATUS_INTERVAL
                feed.changed.wait_for(lambda: feed.version != seen, beat)  # noqa: B023
                seen, over, status = feed.version, feed.is_over, feed.status
            if first < feed.frames:
                part, first = feed.part(first)
                self.event("frames", part)
            # Time between two sendings of curves, s
            if over or time.monotonic() - curves_sent > 2.0:
                count, text = feed.words()
                curves_sent = time.monotonic()
                if count != sent:
                    sent = count
                    self.event("words", text)
            # a page that shows the end has all of it
            self.event("status", json.dumps(status))
            if over and not self.stays:
                return
