"""A server for browsers on this machine that know its token: who may ask, and how it answers.

A page of somebody else in the same browser may ask this server as well: its requests have its own
``Origin``, and where it has had its name point here, that name as ``Host``.  Both are looked at
before anything else, and the token, which stands behind the ``#`` of the address and is sent to no
server by itself, before anything is said of a run or a case.
"""

from __future__ import annotations

import hmac
import io
import secrets
import time
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from socket import socket
from threading import Condition
from typing import Any

TIMEOUT = 10.0
"""How long a browser may take to read an answer, or for the whole of a request, s."""
PAGES_MAX = 8
"""Pages that look on at the same time."""
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class GuardedServer(ThreadingHTTPServer):
    """Serves pages with a token at an address; port 0 is one that is free."""

    daemon_threads = True
    block_on_close = False

    def __init__(
        self, at: tuple[str, int], handler: type[GuardedHandler], changed: Condition
    ) -> None:
        self.changed = changed
        """Of what pages are told."""
        self.token = secrets.token_urlsafe(24)
        self.pages = 0
        """Pages that look on."""
        self.left = time.monotonic()
        """When the last of them went."""
        super().__init__(at, handler)
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
        with self.changed:
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


class GuardedHandler(BaseHTTPRequestHandler):
    """Answers one browser."""

    server: GuardedServer
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # else a body waits 40 ms for the receipt of its head
    timeout = TIMEOUT
    most_bytes = 1000
    """Greatest length of a request."""
    framed = "DENY"
    """Which pages may show these within them, as X-Frame-Options says it."""

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

    def posted(self) -> bytes | None:
        """Return the body of a request; None where it is refused, as too long or not allowed."""
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > self.most_bytes:
            self.close_connection = True
            most = f"at most {self.most_bytes} bytes"
            self.refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, most)
            return None
        body = self.rfile.read(int(length))
        return body if self.is_from_here() and self.has_token() else None

    # --- who may ask -------------------------------------------------------------------------

    def is_from_here(self) -> bool:
        """Refuse names that are not this server's, and pages of others."""
        origin = self.headers.get("Origin")
        if not self.server.knows(self.headers.get("Host", "")):
            self.refuse(HTTPStatus.FORBIDDEN, "this is not the name of this server")
            return False
        if origin is not None and not (
            origin.startswith("http://") and self.server.knows(origin.removeprefix("http://"))
        ):
            self.refuse(HTTPStatus.FORBIDDEN, "requests from other pages are refused")
            return False
        return True

    def has_token(self) -> bool:
        """Refuse who does not know the token."""
        given = self.headers.get("Authorization", "").removeprefix("Bearer ")
        if hmac.compare_digest(given.encode(), self.server.token.encode()):
            return True
        self.refuse(HTTPStatus.UNAUTHORIZED, "the address lacks its token, or has another")
        return False

    # --- answers -----------------------------------------------------------------------------

    def stream(self, tell: Callable[[], None]) -> None:
        """Send news, which ``tell`` does, until they end or the browser has gone."""
        if not self.server.looks_on(1):
            connected = f"{PAGES_MAX} viewers are connected already"
            self.refuse(HTTPStatus.SERVICE_UNAVAILABLE, connected)
            return
        self.close_connection = True
        try:
            self.head(HTTPStatus.OK, "text/event-stream", None)
            tell()
        except OSError:
            pass  # the browser has gone, or reads too slowly: it asks again from where it was
        finally:
            self.server.looks_on(-1)

    def event(self, kind: str, data: str) -> None:
        """Send one piece of news in a stream of them."""
        self.wfile.write(f"event: {kind}\ndata: {data}\n\n".encode())

    def refuse(self, status: HTTPStatus, why: str) -> None:
        """Answer that something cannot be had, and why."""
        self.send(status, "text/plain; charset=utf-8", why)

    def send(self, status: HTTPStatus, kind: str, text: str | bytes) -> None:
        """Send a whole answer."""
        body = text.encode() if isinstance(text, str) else text
        self.head(status, kind, len(body))
        self.wfile.write(body)

    def head(self, status: HTTPStatus, kind: str, length: int | None) -> None:
        """Send the head of an answer, of no ``length`` where its end is not known."""
        self.send_response(status)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        for name, value in {**HEADERS, "X-Frame-Options": self.framed}.items():
            self.send_header(name, value)
        self.end_headers()

    def version_string(self) -> str:
        """Name no versions."""
        return "clast"

    def log_message(self, format: str, *args: Any) -> None:
        """Log no requests."""
