"""A case file in the editor, with the server of its window."""

import http.client
import json
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

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
    server.runs.close()
    server.server_close()


@contextmanager
def started(file, *options):
    """Yield the process of an editor that was started for a file, and its address."""
    command = [sys.executable, "-m", "clast", "edit", file.name, *options]
    running = subprocess.Popen(command, cwd=file.parent, stderr=subprocess.PIPE, text=True)
    try:
        line = next(one for one in running.stderr if "edit: " in one)
        yield running, line.split("edit: ")[1].strip()
    finally:
        running.kill()
        running.wait()
        running.stderr.close()


def until(condition, seconds=120.0):
    """Wait until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def asked(address, path, body=None, **headers):
    """Return status, headers and text of an answer of the editor at an address."""
    place, _, token = address.removeprefix("http://").partition("/#token=")
    connection = http.client.HTTPConnection(place, timeout=120)
    content = None if body is None else json.dumps(body)
    headers = {"Authorization": f"Bearer {token}", **headers}
    connection.request("GET" if body is None else "POST", path, content, headers)
    answer = connection.getresponse()
    found = answer.status, answer.headers, answer.read().decode()
    connection.close()
    return found


def children(process):
    """Return the processes that a process has started."""
    return [*map(int, Path(f"/proc/{process}/task/{process}/children").read_text().split())]


def memory(process):
    """Return the memory of a process, bytes, with its part of what it shares with others."""
    lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("Pss:"))


def state_of(address, path="/case", **body):
    """Return the state of the window at an address, after a request."""
    return json.loads(asked(address, path, body or None)[2])


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
