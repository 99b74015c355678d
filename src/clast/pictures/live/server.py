"""The page of a run over HTTP, for browsers on this machine that know its token.

A page of somebody else in the same browser may ask this server as well: its requests have its own
``Origin``, and where it has had its name point here, that name as ``Host``.  Both are looked at
before anything else, and the token, which stands behind the ``#`` of the address and is sent to no
server by itself, before anything is said of the run.
"""

from __future__ import annotations

import hmac
import io
import json
import secrets
import time
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from socket import socket
from typing import Any
from urllib.parse import parse_qs, urlsplit

from clast.errors import CaseError
from clast.pictures.live.feed import Feed
from clast.pictures.live.leader import ORDERS
from clast.pictures.page.document import live_text

TIMEOUT = 10.0
"""How long a browser may take to read an answer, or for the whole of a request, s."""
STATUS_INTERVAL, STATUS_INTERVAL_AFTER = 5.0, 1.0
"""A sign of life goes to every page at least so often, s; more often when the run is over."""
PAGES_MAX = 8
"""Pages that look on at the same time."""
REQUEST_BYTES_MAX = 1000
"""Greatest length of a request."""


HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class LiveServer(ThreadingHTTPServer):
    """Serves the page of a run at an address; port 0 is one that is free."""

    daemon_threads = True
    block_on_close = False

    def __init__(self, at: tuple[str, int], feed: Feed, order: Callable[[str], None]) -> None:
        self.feed = feed
        self.order = order
        self.token = secrets.token_urlsafe(24)
        self.pages = 0
        """Pages that look on."""
        self.left = time.monotonic()
        """When the last of them went."""
        super().__init__(at, Handler)
        self.host, self.port = str(at[0]), int(self.server_address[1])

    @property
    def address(self) -> str:
        """The address for a browser."""
        host = "127.0.0.1" if _is_any(self.host) else self.host
        return f"http://{host}:{self.port}/#token={self.token}"

    def knows(self, host: str) -> bool:
        """Return whether a name and port are this server's: numbers cannot point elsewhere."""
        name, _, port = host.rpartition(":")
        if port != str(self.port):
            return False
        return name in ("localhost", self.host) or (_is_any(self.host) and _is_number(name))

    def looks_on(self, change: int) -> bool:
        """Count pages that look on; False for one more than there may be."""
        with self.feed.changed:
            if self.pages + change > PAGES_MAX:
                return False
            self.pages += change
            self.left = time.monotonic()
            return True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of browsers that went away."""


def _is_any(host: str) -> bool:
    return _is_number(host) and ip_address(host).is_unspecified


def _is_number(host: str) -> bool:
    try:
        ip_address(host.strip("[]"))
    except ValueError:
        return False
    return True


class _Request(io.RawIOBase):
    """A request of a browser: one limit of time, however many pieces it comes in."""

    def __init__(self, connection: socket) -> None:
        self._connection = connection
        self.until = 0.0
        """When the request has to be there."""

    def readable(self) -> bool:
        """Return True."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read the bytes that are there; raises TimeoutError where the time is over."""
        left = self.until - time.monotonic()
        if left <= 0.0:
            raise TimeoutError
        self._connection.settimeout(left)
        try:
            return self._connection.recv_into(buffer)
        finally:
            self._connection.settimeout(TIMEOUT)


class Handler(BaseHTTPRequestHandler):
    """Answers one browser."""

    server: LiveServer
    protocol_version = "HTTP/1.1"
    timeout = TIMEOUT

    def setup(self) -> None:
        """Read requests with a limit of time."""
        super().setup()
        self.rfile.close()
        self._request = _Request(self.connection)
        self.rfile = io.BufferedReader(self._request)

    def handle_one_request(self) -> None:
        """Answer a request that is whole in time."""
        self._request.until = time.monotonic() + TIMEOUT
        super().handle_one_request()

    def do_GET(self) -> None:
        """Answer with the page, its content, or news as they come."""
        parts = urlsplit(self.path)
        answers: dict[str, Callable[[str], None]] = {
            "/scene": lambda _: self._answer("application/json", self.server.feed.scene),
            "/page": lambda _: self._answer("text/html; charset=utf-8", self.server.feed.page),
            "/events": self._events,
        }
        if not self._is_from_here():
            return
        if parts.path == "/":
            self._send(HTTPStatus.OK, "text/html; charset=utf-8", live_text())
        elif parts.path not in answers:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        elif self._has_token():
            answers[parts.path](parts.query)

    def do_POST(self) -> None:
        """Hand on a request of a page to the run."""
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > REQUEST_BYTES_MAX:
            self.close_connection = True
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {REQUEST_BYTES_MAX} bytes")
            return
        body = self.rfile.read(int(length))
        if not self._is_from_here() or not self._has_token():
            return
        try:
            order = json.loads(body)["do"]
        except (ValueError, KeyError, TypeError):
            order = None
        if self.path != "/do" or order not in ORDERS:
            self._refuse(HTTPStatus.BAD_REQUEST, f"ask for one of: {', '.join(ORDERS)}")
            return
        self.server.order(order)
        self._send(HTTPStatus.OK, "application/json", "{}")

    # --- who may ask -------------------------------------------------------------------------

    def _is_from_here(self) -> bool:
        """Refuse names that are not this server's, and pages of others."""
        origin = self.headers.get("Origin")
        if not self.server.knows(self.headers.get("Host", "")):
            self._refuse(HTTPStatus.FORBIDDEN, "this is not the name of this server")
            return False
        if origin is not None and not (
            origin.startswith("http://") and self.server.knows(origin.removeprefix("http://"))
        ):
            self._refuse(HTTPStatus.FORBIDDEN, "requests from other pages are refused")
            return False
        return True

    def _has_token(self) -> bool:
        """Refuse who does not know the token."""
        given = self.headers.get("Authorization", "").removeprefix("Bearer ")
        if hmac.compare_digest(given.encode(), self.server.token.encode()):
            return True
        self._refuse(HTTPStatus.UNAUTHORIZED, "the address lacks its token, or has another")
        return False

    # --- answers -----------------------------------------------------------------------------

    def _answer(self, kind: str, text: Callable[[], str]) -> None:
        try:
            self._send(HTTPStatus.OK, kind, text())
        except CaseError as error:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, str(error))

    def _events(self, query: str) -> None:
        """Send news as they come, until the run is over or the browser has gone."""
        server, given = self.server, parse_qs(query).get("from", ["0"])[0]
        if not given.isdecimal() or int(given) > server.feed.frames:
            self._refuse(HTTPStatus.BAD_REQUEST, f"there are {server.feed.frames} frames")
            return
        if not server.looks_on(1):
            connected = f"{PAGES_MAX} viewers are connected already"
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, connected)
            return
        self.close_connection = True
        try:
            self._head(HTTPStatus.OK, "text/event-stream", None)
            self._send_news(int(given))
        except OSError:
            pass  # the browser has gone, or reads too slowly: it asks again from where it was
        finally:
            server.looks_on(-1)

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
                self._event("frames", part)
            # Time between two sendings of curves, s
            if over or time.monotonic() - curves_sent > 2.0:
                count, text = feed.words()
                curves_sent = time.monotonic()
                if count != sent:
                    sent = count
                    self._event("words", text)
            # a page that shows the end has all of it
            self._event("status", json.dumps(status))

    def _event(self, kind: str, data: str) -> None:
        self.wfile.write(f"event: {kind}\ndata: {data}\n\n".encode())

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._send(status, "text/plain; charset=utf-8", why)

    def _send(self, status: HTTPStatus, kind: str, text: str) -> None:
        body = text.encode()
        self._head(status, kind, len(body))
        self.wfile.write(body)

    def _head(self, status: HTTPStatus, kind: str, length: int | None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.end_headers()

    def version_string(self) -> str:
        """Name no versions."""
        return "clast"

    def log_message(self, format: str, *args: Any) -> None:
        """Log no requests."""
