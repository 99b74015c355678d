"""A case file in the editor, with the server of its window."""

import http.client
import json
import threading
import time
from contextlib import contextmanager

from clast.editor.server import EditServer


@contextmanager
def edited_file(path, kind=EditServer, **more):
    """Yield the server of the window of a case file, which saves as the hand rests."""
    server, stop = kind(("127.0.0.1", 0), path, **more), threading.Event()
    threads = [
        threading.Thread(target=server.watch, args=(stop,), daemon=True),
        threading.Thread(target=server.judge, args=(stop,), daemon=True),
        threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True),
    ]
    for one in threads:
        one.start()
    yield server
    server.shutdown()
    stop.set()
    server.worker.close()
    for one in threads:
        one.join()
    server.server_close()


def until(condition, seconds=120.0):
    """Wait until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def asked(address, path, body=None, **headers):
    """Return status, headers and text of an answer of the editor at an address."""
    place, _, token = address.removeprefix("http://").partition("/#token=")
    connection = http.client.HTTPConnection(place, timeout=60)
    content = None if body is None else json.dumps(body)
    headers = {"Authorization": f"Bearer {token}", **headers}
    connection.request("GET" if body is None else "POST", path, content, headers)
    answer = connection.getresponse()
    found = answer.status, answer.headers, answer.read().decode()
    connection.close()
    return found


def rock_text(width, height):
    """Return a case of some width times height / 2.8 blocks, m."""
    return f"""
title = "Rock"
time = {{step = 1e-3, end = 0.01}}
rock.stone = {{young = 1e9, poisson = 0.2, density = 2500.0}}
[domain]
boundary = [[0, 0], [{width}, 0], [{width}, {height}], [0, {height}]]
fixed_sides = ["bottom"]
[[joint_set]]
name = "beds"
angle = 5.0
spacing = 1.5
[[joint_set]]
name = "cross"
angle = 85.0
spacing = 1.9
"""
