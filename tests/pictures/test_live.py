"""The page of a run that goes on: who is let in, what it may ask for; that the run never waits."""

import http.client
import json
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlsplit

import numpy as np
import pytest

import clast
from clast.case.resume import result_file
from clast.case.templates import TEMPLATES
from clast.errors import CaseError
from clast.pictures.live.feed import Feed
from clast.pictures.live.guarded import PAGES_MAX
from clast.pictures.live.leader import LivePage
from clast.pictures.live.server import LiveServer
from clast.run.run_state import Halt
from clast.run.schedule import Progress
from scenes.live_runs import live_command


@pytest.fixture
def served(wall):
    """Return a server of the page of a wall, and what it has been asked for."""
    orders = []
    feed = Feed(wall(4, 5).path)
    feed.say({"time": 1.0, "paused": False})
    feed.look()
    server = LiveServer(("127.0.0.1", 0), feed, orders.append)
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    yield server, orders
    server.shutdown()
    server.server_close()


def ask(server, path, body=None, **headers):
    """Return status and text of an answer; ``headers`` replace those of a page that may ask."""
    usual = {"Host": f"127.0.0.1:{server.port}", "Authorization": f"Bearer {server.token}"}
    given = {name: value for name, value in {**usual, **headers}.items() if value is not None}
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    connection.putrequest("POST" if body is not None else "GET", path, skip_host=True)
    for name, value in given.items():
        connection.putheader(name, value)
    if body is not None:
        connection.putheader("Content-Length", str(len(body)))
    connection.endheaders(body.encode() if body is not None else None)
    answer = connection.getresponse()
    found = answer.status, answer.read().decode()
    connection.close()
    return found


WRONG = [
    ({"Authorization": None}, 401),
    ({"Authorization": "Bearer "}, 401),
    ({"Authorization": "Bearer 0123456789abcdefghijklmnopqrstuv"}, 401),
    ({"Authorization": "Bearer \xfc"}, 401),
    ({"Host": None}, 403),
    ({"Host": "evil.example"}, 403),
    ({"Host": "evil.example:{port}"}, 403),
    ({"Host": "127.0.0.1"}, 403),
    ({"Host": "127.0.0.1:1"}, 403),
    ({"Host": "127.0.0.1.evil.example:{port}"}, 403),
    ({"Host": "192.168.0.7:{port}"}, 403),
    ({"Origin": "http://evil.example"}, 403),
    ({"Origin": "http://evil.example:{port}"}, 403),
    ({"Origin": "https://127.0.0.1:{port}"}, 403),
    ({"Origin": "http://127.0.0.1:1"}, 403),
    ({"Origin": "null"}, 403),
    ({"Origin": ""}, 403),
]


@pytest.mark.parametrize(("headers", "status"), WRONG)
def test_who_is_not_let_in(served, headers, status):
    server, orders = served
    headers = {k: v and v.replace("{port}", str(server.port)) for k, v in headers.items()}
    for path in ("/scene", "/events?from=0", "/page", "/do"):
        body = '{"do": "end"}' if path == "/do" else None
        found, text = ask(server, path, body, **headers)
        assert (path, found) == (path, status)
        assert orders == [] and "A wall" not in text


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_who_knows_the_token_sees_all(served, host):
    server, orders = served
    name = f"{host}:{server.port}"
    own = {"Host": name, "Origin": f"http://{name}"}
    status, text = ask(server, "/scene", **own)
    assert status == 200 and json.loads(text)["title"] == "A wall"
    assert json.loads(text)["next"] == 6
    assert ask(server, "/do", '{"do": "pause"}', **own)[0] == 200 and orders == ["pause"]
    status, text = ask(server, "/page", **own)
    assert status == 200 and "connect-src 'none'" in text and "A wall" in text


def test_the_page_itself_tells_nothing_and_may_be_asked_for_without_a_token(served):
    server, _ = served
    status, text = ask(server, "/", Authorization=None)
    assert status == 200 and "connect-src 'self'" in text
    assert "A wall" not in text and server.token not in text
    assert server.address == f"http://127.0.0.1:{server.port}/#token={server.token}"


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        ("/do", "", 400),
        ("/do", "no JSON", 400),
        ("/do", "[]", 400),
        ("/do", '{"do": "rm"}', 400),
        ("/do", '{"do": ["end"]}', 400),
        ("/elsewhere", '{"do": "end"}', 400),
        ("/do", " " * 2000, 413),
        ("/../etc/passwd", None, 404),
        ("/scene/", None, 404),
        ("/events?from=-1", None, 400),
        ("/events?from=7", None, 400),
        ("/events?from=x", None, 400),
    ],
)
def test_what_is_no_question(served, path, body, status):
    server, orders = served
    assert ask(server, path, body)[0] == status
    assert orders == []


def events(server, first=0):
    """Return the events of a page that looks on, as they come."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    connection.request(
        "GET", f"/events?from={first}", headers={"Authorization": f"Bearer {server.token}"}
    )
    answer = connection.getresponse()
    assert answer.status == 200
    while True:
        kind = answer.readline().decode().removeprefix("event: ").strip()
        data = answer.readline().decode().removeprefix("data: ")
        answer.readline()
        yield kind, json.loads(data)


def test_frames_come_behind_those_that_a_page_has(served):
    server, _ = served
    stream = events(server, 4)
    kind, part = next(stream)
    assert kind == "frames" and part["next"] == 6 and len(part["times"]) == 2
    assert next(stream)[0] == "words"
    assert next(stream) == ("status", {"time": 1.0, "paused": False})
    server.feed.say({"paused": True})
    assert next(stream) == ("status", {"time": 1.0, "paused": True})


def test_pages_are_counted_and_not_too_many(served):
    server, _ = served
    streams = [events(server) for _ in range(PAGES_MAX)]
    for stream in streams:
        next(stream)
    assert server.pages == PAGES_MAX
    assert ask(server, "/events?from=0")[0] == 503


# A run ------------------------------------------------------------------------------------------


def test_many_that_ask_at_once_are_eight(served):
    server, _ = served
    answers, start = [], threading.Barrier(3 * PAGES_MAX)

    def look() -> None:
        one = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
        start.wait()
        one.request("GET", "/events?from=0", headers={"Authorization": f"Bearer {server.token}"})
        answers.append((one.getresponse(), one))

    threads = [threading.Thread(target=look) for _ in range(3 * PAGES_MAX)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    found = sorted(answer.status for answer, _ in answers)
    assert found == [200] * PAGES_MAX + [503] * 2 * PAGES_MAX
    assert server.pages == PAGES_MAX


@pytest.mark.parametrize(
    "sent", [b"GET / HTTP/1.1\r\nX: ", b"POST /do HTTP/1.1\r\nContent-Length: 900\r\n\r\n"]
)
def test_a_request_has_one_limit_of_time_in_however_many_pieces(served, monkeypatch, sent):
    """A letter every now and then does not keep a place for ever."""
    monkeypatch.setattr("clast.pictures.live.guarded.TIMEOUT", 0.5)
    server, _ = served
    began = time.monotonic()
    with socket.create_connection(("127.0.0.1", server.port)) as one:
        one.sendall(sent)
        one.settimeout(0.05)
        while time.monotonic() - began < 5.0:
            try:
                one.sendall(b"a")
                if not one.recv(100):
                    break
            except TimeoutError:
                continue
            except OSError:
                break
    assert 0.3 < time.monotonic() - began < 3.0
    assert ask(server, "/")[0] == 200


def falling(tmp_path, name="run.vtkhdf", **more):
    """Return what makes the run of a block that falls for 200 steps."""
    builder = clast.ModelBuilder(title="A block that falls", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="table", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], fixed=True)
    builder.block(name="falling", vertices=[(-0.5, 0.01), (0.5, 0.01), (0.5, 1), (-0.5, 1)])
    return lambda **keys: clast.simulate(
        builder.build(), step=1e-3, end=0.2, every=0.02, output=tmp_path / name, **keys, **more
    )


class Client:
    """A browser's side, in short."""

    def __init__(self, page):
        parts = urlsplit(page.address)
        self.port, self.token = parts.port, parts.fragment.removeprefix("token=")

    def do(self, what):
        assert ask(self, "/do", json.dumps({"do": what}))[0] == 200

    def scene(self):
        return json.loads(ask(self, "/scene")[1])

    def until(self, condition, seconds=60.0):
        end = time.monotonic() + seconds
        while True:
            scene = self.scene()
            if scene is not None and condition(scene):
                return scene
            assert time.monotonic() < end, scene and scene["status"]
            time.sleep(0.05)


@contextmanager
def led(tmp_path, script):
    """Run with a page that ``script`` leads from a thread of its own; yield the run."""
    page = LivePage(tmp_path / "run.vtkhdf")
    faults = []

    def lead():
        try:
            script(Client(page))
        except BaseException as fault:
            faults.append(fault)
            page._order("end")

    page._order("pause")  # nothing happens before the client is there
    thread = threading.Thread(target=lead)
    thread.start()
    try:
        yield falling(tmp_path)(progress=page)
    finally:
        thread.join()
        page.close()
        assert faults == []


def test_a_page_pauses_steps_and_lets_the_run_go_on(tmp_path):
    plain = falling(tmp_path, "plain.vtkhdf")()
    seen = []

    def script(client):
        client.until(lambda scene: scene["status"].get("paused"))
        for count in (1, 2, 3):
            client.do("step")
            scene = client.until(lambda scene, n=count: scene["status"].get("steps") == n)
            seen.append(scene["status"])
        # each of the steps is a frame, as soon as it is made
        seen.append(client.until(lambda scene: len(scene["times"]) == 4)["times"])
        client.do("go")

    with led(tmp_path, script) as run:
        assert [status["steps"] for status in seen[:3]] == [1, 2, 3]
        assert all(status["paused"] for status in seen[:3])
        assert seen[3] == pytest.approx([0.0, 0.001, 0.002, 0.003])
        assert run.report.finished and run.report.steps == plain.report.steps == 200
        # the run is the same to the bit; the steps that were asked for are frames beside the others
        assert (run.vertices(-1) == plain.vertices(-1)).all()
        assert set(plain.times) < set(run.times) and len(run.times) == len(plain.times) + 3


def test_a_pause_and_the_end_say_where_the_run_is(tmp_path):
    page = LivePage(tmp_path / "run.vtkhdf")
    try:
        told = []
        page._tell = lambda: told.append(page._where["steps"])
        places = [
            Progress(time=1e-3 * k, end=1.0, step=1e-3, steps=k, contacts=4, penetration=0.0)
            for k in range(10)
        ]
        halt = SimpleNamespace(keep_frame=lambda: None, let_go=lambda: page._order("go"))
        for place in places[:6]:  # within a moment: all but the first are not told
            page(place)
        page._order("pause")
        halt.where = lambda: places[5]
        page.lead(halt)
        assert told[-1] == 5
        for place in places[6:]:
            page(place)
        assert told[-1] == 5
        page.over()
        assert told[-1] == 9
    finally:
        page.close()


def test_a_page_has_a_checkpoint_written_that_the_run_goes_on_from(tmp_path):
    plain = falling(tmp_path, "plain.vtkhdf")()

    def script(client):
        client.until(lambda scene: scene["status"].get("paused"))
        client.do("checkpoint")
        client.until(lambda scene: "no step" in scene["status"]["said"])
        client.do("step")
        client.until(lambda scene: scene["status"].get("steps") == 1)
        client.do("checkpoint")
        client.until(lambda scene: "t = 0.001 s" in scene["status"]["said"])
        client.do("end")

    with led(tmp_path, script) as run:
        assert not run.report.finished
        assert run.report.outcome == "ended from its page at t = 0.001 s"
        assert run.checkpoint == tmp_path / "run.checkpoint.h5"
    assert clast.read(tmp_path / "run.vtkhdf").report.outcome == run.report.outcome
    assert plain.report.finished


@pytest.mark.parametrize("hangs", ["reads nothing", "asks nothing", "has gone"])
@pytest.mark.one_in(3)
def test_a_browser_that_hangs_or_has_gone_stops_nothing(tmp_path, hangs):
    page = LivePage(tmp_path / "run.vtkhdf")
    client = Client(page)
    hanging = []

    def connect():
        for _ in range(4):
            one = socket.create_connection(("127.0.0.1", client.port))
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
            if hangs != "asks nothing":
                head = f"Host: 127.0.0.1:{client.port}\r\nAuthorization: Bearer {client.token}"
                one.sendall(f"GET /events?from=0 HTTP/1.1\r\n{head}\r\n\r\n".encode())
            if hangs == "has gone":
                one.close()
            hanging.append(one)

    connect()
    try:
        run = falling(tmp_path)(progress=page)
        assert run.report.finished and run.report.steps == 200
        client.until(lambda scene: len(scene["times"]) == len(run.times))
    finally:
        page.close()
        for one in hanging:
            one.close()


def test_a_process_of_the_page_that_hangs_or_is_killed_stops_nothing(tmp_path):
    page = LivePage(tmp_path / "run.vtkhdf")
    page._process.send_signal(19)  # SIGSTOP: it reads its pipe no more
    try:
        for _ in range(20_000):  # more than a pipe holds
            page._tell()
        assert falling(tmp_path)(progress=page).report.finished
    finally:
        page.close()


def test_a_run_that_is_paused_goes_on_when_the_process_of_its_page_dies(tmp_path):
    page = LivePage(tmp_path / "run.vtkhdf")
    page._order("pause")
    threading.Timer(1.0, page._process.kill).start()
    run = falling(tmp_path)(progress=page)
    page.close()
    assert run.report.finished


def test_an_earlier_file_of_the_name_is_not_shown(wall, tmp_path):
    feed = Feed(wall(2, 2).path)
    feed.look()
    assert feed.scene() == "null"
    feed.say({"paused": False})
    feed.look()
    assert json.loads(feed.scene())["next"] == 6


def test_a_run_that_ends_is_not_said_to_be_killed(wall):
    feed = Feed(wall(2, 2).path)
    feed.say({"paused": False})
    feed.end()
    assert feed.status["over"] and not feed.status["killed"]


def test_a_leader_costs_a_step_next_to_nothing(tmp_path):
    page = LivePage(tmp_path / "run.vtkhdf")
    where = Progress(time=0.0, end=1.0, step=1e-3, steps=0, contacts=0, penetration=0.0)
    halt = Halt(let_go=lambda: None, keep_frame=lambda: None, checkpoint=str, where=lambda: where)
    try:
        begun = time.process_time()
        for _ in range(100_000):
            page.lead(halt)
        assert time.process_time() - begun < 1.0  # 10 us a step: a step takes 100 and more
    finally:
        page.close()


def test_a_run_that_is_resumed_has_its_page(tmp_path):
    """The page shows the frames before the checkpoint and those after it."""

    def script(client):
        client.until(lambda scene: scene["status"].get("paused"))
        client.do("step")
        client.until(lambda scene: scene["status"].get("steps") == 1)
        client.do("end")

    with led(tmp_path, script) as run:
        pass
    assert not run.report.finished and len(run.times) == 2
    target = result_file(run.checkpoint)
    assert target == tmp_path / "run.vtkhdf"
    assert result_file(run.checkpoint, "b.vtkhdf") == Path("b.vtkhdf")
    page = LivePage(target)
    client, seen = Client(page), []

    def look():
        paused = client.until(lambda scene: scene["status"].get("paused"))
        seen.append(paused["status"])
        client.do("go")

    page._order("pause")  # before its first step it has a place already
    thread = threading.Thread(target=look)
    thread.start()
    try:
        whole = clast.resume(run.checkpoint, model=run.model, progress=page)
        thread.join()
        scene = client.until(lambda scene: len(scene["times"]) == len(whole.times))
    finally:
        page.close()
    told = {key: seen[0][key] for key in ("time", "end", "step", "steps", "stage", "paused")}
    assert told == {
        "time": pytest.approx(1e-3),
        "end": pytest.approx(0.2),
        "step": pytest.approx(1e-3),
        "steps": 1,
        "stage": "",
        "paused": True,
    }
    assert whole.report.finished
    assert scene["times"] == pytest.approx(clast.read(target).times.tolist())


@pytest.mark.slow
def test_the_commands_give_the_address_of_the_page(tmp_path):
    """clast run --live and clast resume --live say where it is, and end when nobody looks."""
    case = tmp_path / "block.toml"
    case.write_text(TEMPLATES["incline"], encoding="utf-8")
    for command in (
        ["run", "block.toml", "--set", "time.end=0.01", "--set", "output.checkpoint_every=0.005"],
        ["resume", "block.checkpoint.h5", "--set", "time.end=0.02"],
    ):
        done = subprocess.run(
            [sys.executable, "-m", "clast", *command, "--live"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        assert "live: http://127.0.0.1:" in done.stderr and "#token=" in done.stderr
    assert clast.read(tmp_path / "block.vtkhdf").times[-1] == pytest.approx(0.02)


@pytest.mark.slow
def test_a_page_that_waits_for_a_first_frame_hears_that_its_run_was_killed(tmp_path):
    with live_command(tmp_path) as (run, address):
        client = Client(SimpleNamespace(address=address))
        run.kill()
        status, end = 200, time.monotonic() + 30.0
        while status == 200 and time.monotonic() < end:
            status, text = ask(client, "/scene")
        assert status == 503 and "killed before its first frame" in text


def test_a_port_that_is_taken(tmp_path):
    with (
        socket.create_server(("127.0.0.1", 0)) as taken,
        pytest.raises(CaseError, match="the page cannot be served at"),
    ):
        LivePage(tmp_path / "run.vtkhdf", f"127.0.0.1:{taken.getsockname()[1]}")


def test_a_part_of_the_frames_is_what_the_whole_has(wall):
    feed = Feed(wall(3, 3).path)
    feed.say({"paused": False})
    feed.look()
    whole, (part, count) = json.loads(feed.scene()), feed.part(2)
    part = json.loads(part)
    assert count == 6 and part["times"] == whole["times"][2:]
    assert part["contacts"]["count"] == whole["contacts"]["count"][2:]
    assert np.isfinite(part["motion"]["x"]["high"])


READS = """
import threading, time
from types import SimpleNamespace
from h5py._objects import phil
from clast.pictures.live import feed as feeds
begun = threading.Event()
def reads(*_):
    with phil:
        begun.set()
        time.sleep(1.0)
    return {}
feeds.scene_of, feed = reads, feeds.Feed(None)
feed._results = SimpleNamespace(times=[])
threading.Thread(target=feed.scene, daemon=True).start()
begun.wait()
feed.close()
"""


def test_a_process_ends_while_its_result_file_is_read():
    subprocess.run([sys.executable, "-c", READS], timeout=60, check=True)
