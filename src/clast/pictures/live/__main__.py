"""The process of a live page: ``python -m clast.pictures.live RESULTS HOST:PORT``.

It says its address in the first line of its output, and in the others the requests of pages; its
input has the progress of the run.  Where the input ends, so has the run: it stays then as long as
pages look on.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

from clast.pictures.live.feed import Feed
from clast.pictures.live.server import LiveServer

END_AFTER, GO_AFTER = 3.0, 10.0
"""Time without a page that looks on, s, after which the server of a run that is over ends, and a
run that is paused goes on."""


def main() -> None:
    """Serve the page of the run that writes a result file."""
    path, at = sys.argv[1:]
    host, _, port = at.rpartition(":")
    feed = Feed(Path(path))
    try:
        server = LiveServer((host, int(port)), feed, _say)
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or str(error)
        fault = f"the page cannot be served at {at}: {why}"
        _say(json.dumps({"fault": fault, "remedy": "name another address or port"}))
        return
    _say(json.dumps({"address": server.address}))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    threading.Thread(target=_hear, args=(feed,), daemon=True).start()
    while not (feed.is_over and _is_alone(server, END_AFTER)):
        time.sleep(0.1)
        feed.look()
        if feed.status.get("paused") and _is_alone(server, GO_AFTER):
            _say("go")
            feed.say({"paused": False})
    feed.close()


def _is_alone(server: LiveServer, seconds: float) -> bool:
    """Return whether no page has looked on for a time, s."""
    return server.pages == 0 and time.monotonic() - server.left > seconds


def _say(line: str) -> None:
    """Say something to the run; where it has gone nobody hears it."""
    with suppress(OSError):
        print(line, flush=True)  # noqa: T201


def _hear(feed: Feed) -> None:
    """Read the messages of the run, until it is over."""
    for line in sys.stdin:
        try:
            feed.say(json.loads(line))
        except ValueError:
            continue  # half a line: the pipe was full
    feed.end()


main()
