"""The window of a case file over HTTP: its content, and the changes that the hand makes in it."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from pydantic import BaseModel, ConfigDict, ValidationError

from clast.case.case_file import Case, json_schema
from clast.case.checking import Checked
from clast.editor.document import Document, OutOfStep
from clast.editor.edits import Edit
from clast.editor.page import editor_text
from clast.editor.running import Runs, StudyAsked
from clast.editor.starting import started, templates
from clast.editor.underlay import (
    PICTURE_ENDINGS,
    Underlays,
    drawn,
    keep,
    picture,
    shown_under,
    stamps_under,
)
from clast.editor.worker import Worker, as_json
from clast.errors import CaseError
from clast.inputs.declaring.validation_messages import UDEC
from clast.pictures.live.feed import Feed
from clast.pictures.live.guarded import GuardedServer
from clast.pictures.live.server import JSON, PAGE, Handler

REST, LOOK = 0.3, 0.5
"""The file gets the text when the hand has rested so long, and is looked at so often, s."""
CHECK_REST = 0.1
"""Blocks are cut and checked when the hand has rested so long, s, or as long as the last took."""
LIFE = 5.0
"""A sign of life goes to every window at least so often, s."""
BYTES_MAX = 5_000_000
"""Greatest length of a text from a window."""
TEXT_EDITOR = "text editor"
"""Leads where all windows look on."""


class NoSuchRequest(LookupError):
    """A request that a window never makes."""


class Asked(BaseModel):
    """A request of a window, of one version of the text."""

    model_config = ConfigDict(extra="forbid", strict=True)

    version: int
    edits: list[Edit] = []
    text: str = ""
    gesture: str = ""
    number: int = 0
    study: StudyAsked | None = None


class EditServer(GuardedServer):
    """Serves the window of a case file; raises CaseError where there is no such file."""

    def __init__(self, at: tuple[str, int], path: Path, settings: Sequence[str] = ()) -> None:
        self.document = Document(path)
        self.stamp = 0
        """Counts the news for windows."""
        self.trouble = ""
        """Why the file could not be read or written."""
        self.runs, self.run_news = Runs(path, self._tell_of_runs), 0
        """The runs, and a count of news of them."""
        self.leads, self._windows = "", Counter[str]()
        """The window that edits, others look on; "" for the one that asks first."""
        self._touched = 0.0
        self._state = (-1, "")
        self._under = stamps_under(path)
        super().__init__(at, EditHandler, threading.Condition(threading.RLock()))
        self.worker = Worker(str(path), self.changed, self._tell, settings)
        """Cuts and checks the text, with other values if these are set."""

    @property
    def feed(self) -> Feed:
        """The frames of the run that windows show."""
        return self.runs.feed

    def order(self, order: str) -> None:
        """Hand a request of the page of a run on to it."""
        self.runs.order(order)

    def _run(self, version: int, study: StudyAsked | None = None) -> None:
        """Run the text, which a window has to know, or a study of it."""
        self.document.edit((), version)
        self.runs.start(self.document.text, study.words() if study is not None else ())

    def do(self, way: str, asked: Asked) -> None:
        """Carry out a request of a window; raises CaseError where it cannot be done.

        Raises NoSuchRequest where there is no such way.
        """
        document, version = self.document, asked.version
        # fields of browsers know one end of lines only
        text = asked.text.replace("\n", "\r\n") if "\r\n" in document.text else asked.text
        ways: dict[str, Callable[[], None]] = {
            "/edit": lambda: document.edit(asked.edits, version, asked.gesture),
            "/move": lambda: document.edit(asked.edits, version, asked.gesture),
            "/text": lambda: document.replace(text, version, asked.gesture),
            "/begin": lambda: document.replace(started(document.path, asked.text), version),
            "/undo": lambda: document.undo(version),
            "/redo": lambda: document.redo(version),
            "/save": document.save,
            "/write": document.write,
            "/keep-mine": document.keep_mine,
            "/keep-theirs": document.keep_theirs,
            "/cut": self.worker.ask,
            "/stop-cut": self.worker.stop,
            "/start": lambda: self._run(version, asked.study),
            "/stop": lambda: self.runs.order("end"),
            "/look": lambda: self.runs.show(asked.number),
        }
        if way not in ways:
            raise NoSuchRequest
        with self.changed:
            try:
                ways[way]()
            finally:
                self._touched = time.monotonic()
                self.run_news += 1
                self._tell()

    def looks(self, window: str, change: int) -> None:
        """Count who looks on; the first window edits, until it goes or another takes over."""
        with self.changed:
            self._windows[window] += change
            if not self._windows[self.leads]:
                self.leads = "" if change < 0 else window
            self._tell()

    def lets(self, window: str) -> bool:
        """Return whether a window edits; it does from then on where none did."""
        with self.changed:
            if not self.leads and self._windows[window]:
                self.take_over(window)
            return self.leads in ("", window)

    def take_over(self, window: str) -> None:
        """Let a window edit, and all others look on."""
        with self.changed:
            self.leads = window
            self._tell()

    @property
    def counts(self) -> tuple[int, int]:
        """Counts of news of the case, and of runs."""
        return self.stamp, self.run_news

    def _tell_of_runs(self) -> None:
        with self.changed:
            self.run_news += 1
            self.changed.notify_all()

    def lines(self) -> list[Any]:
        """Return both ends of all lines that cut the rock mass, m; none where they are faulty."""
        with suppress(CaseError):
            case = Case.from_text(self.document.text, str(self.document.path))
            return [[round(x, 4) for x in line] for line in case.lines().reshape(-1, 4).tolist()]
        return []

    def state(self) -> dict[str, Any]:
        """Return the content of a window, without the schema, which never changes."""
        with self.changed:
            worker = self.worker
            return {
                **_shown(self.document, worker),
                "stamp": self.stamp,
                "sections": worker.sections,
                "trouble": self.trouble,
                "is_cutting": worker.is_busy,
                "off": worker.off,
                "leads": self.leads,
                "under": self._under,
            }

    def news(self) -> str:
        """Return the state as JSON, which is made once for all windows."""
        with self.changed:
            if self._state[0] != self.stamp:
                self._state = (self.stamp, as_json(self.state()))
            return self._state[1]

    def watch(self, stop: threading.Event) -> None:
        """Look at the file and save the text while the hand rests, until told to stop."""
        looked = time.monotonic()
        while not stop.wait(REST / 3):
            now = time.monotonic()
            with self.changed:
                if now - looked > LOOK:
                    looked = now
                    self._attempt(self.document.look)
                    self.worker.look()
                    self._look_under()
                if now - self._touched > REST:
                    self._attempt(self.document.save)
        with self.changed:
            self._attempt(self.document.save)

    def judge(self, stop: threading.Event) -> None:
        """Have the newest text checked whenever the hand rests, until told to stop."""
        worker = self.worker
        while not stop.is_set():
            with self.changed:
                text, rested = self.document.text, time.monotonic() - self._touched
                wait = min(CHECK_REST, worker.seconds) - rested if worker.wants(text) else REST
                if wait > 0:
                    self.changed.wait(wait)
                    continue
            worker.check(text)

    def _look_under(self) -> None:
        """Tell windows where drawings and pictures under the section have changed."""
        seen, self._under = self._under, stamps_under(self.document.path)
        if seen != self._under:
            self._tell()

    def _attempt(self, what: Callable[[], None]) -> None:
        """Look or save; windows are told the result."""
        document = self.document
        before = (document.version, document.filed, document.conflict, self.trouble)
        try:
            what()
            self.trouble = ""
        except CaseError as error:
            self.trouble = str(error)
        if before != (document.version, document.filed, document.conflict, self.trouble):
            self._tell()

    def _tell(self) -> None:
        self.stamp += 1
        self.changed.notify_all()


class ViewServer(EditServer):
    """Serves windows that look on while a text editor writes the file; nothing is changed there."""

    def __init__(self, at: tuple[str, int], path: Path, settings: Sequence[str] = ()) -> None:
        super().__init__(at, path, settings)
        self.looks(TEXT_EDITOR, 1)

    def take_over(self, window: str) -> None:
        """Refuse a window that would edit: raises CaseError."""
        name = self.document.path.name
        raise CaseError("is only shown here", where=name, remedy=f"clast edit {name} edits it")


class EditHandler(Handler):
    """Answers one browser; the page of a run is part of the window."""

    server: EditServer
    most_bytes = BYTES_MAX
    framed = "SAMEORIGIN"
    page_at = "/run"
    stays = False

    def pages(self) -> dict[str, Callable[[str], None]]:
        """Return what answers without the token: a report, shown in a frame, has its secret."""
        window = {"/": lambda _: self.send(HTTPStatus.OK, PAGE, editor_text(self._name))}
        return {**super().pages(), **window, "/report": self._report}

    def answers(self) -> dict[str, Callable[[str], None]]:
        """Return what answers who has the token: the case, news of it, and what is drawn."""
        return {
            **super().answers(),
            "/case": lambda _: self._answer(schema=json_schema(), templates=templates(), udec=UDEC),
            "/news": lambda _: self._news(),
            "/section": lambda _: self.send(HTTPStatus.OK, JSON, self.server.worker.section),
            "/underlays": lambda _: self._underlays(),
            "/under": lambda name: self._under(unquote(name)),
            "/ran": lambda _: self._ran(),
        }

    def do_POST(self) -> None:
        """Carry out a request of a window; answer with the case after it."""
        body, server = self.posted(), self.server
        if body is None:
            return
        try:
            if self.path == "/take-over":
                server.take_over(self._window)
            elif not server.lets(self._window):
                what, remedy = "is edited in another window", "take over there, or look on here"
                raise CaseError(what, where=self._name, remedy=remedy)
            elif self.path == "/do":
                self.order(body)
                return
            elif self.path == "/underlays":
                keep(server.document.path, Underlays.model_validate_json(body))
                self._underlays()
                return
            else:
                server.do(self.path, Asked.model_validate_json(body))
        except NoSuchRequest:
            self.refuse(HTTPStatus.NOT_FOUND, "there is no such request")
        except ValidationError:
            self.refuse(HTTPStatus.BAD_REQUEST, "this is no request of a window")
        except CaseError as error:
            if self.path == "/do":  # the page of a run knows no case
                self.refuse(HTTPStatus.CONFLICT, str(error))
            else:
                self._answer(refused=str(error), late=isinstance(error, OutOfStep))
        else:
            # what moves shows its lines at once: blocks come when it rests
            self._answer(**({"lines": server.lines()} if self.path == "/move" else {}))

    def _underlays(self) -> None:
        """Answer with what is under the section."""
        self.send(HTTPStatus.OK, JSON, as_json(shown_under(self.server.document.path)))

    def _ran(self) -> None:
        """Answer with the text that ran."""
        shown = self.server.runs.shown
        self.send(HTTPStatus.OK, JSON, as_json({"text": "" if shown is None else shown.text}))

    def _under(self, name: str) -> None:
        """Answer with a picture under the section, lines of a drawing, or what is wrong with it."""
        case, is_picture = self.server.document.path, name.lower().endswith(PICTURE_ENDINGS)
        try:
            found = picture(case, name) if is_picture else (JSON, as_json(drawn(case, name)))
        except CaseError as error:
            found = JSON, as_json({"trouble": str(error)})
        self.send(HTTPStatus.OK, *found)

    def _report(self, secret: str) -> None:
        """Answer with the page of a study; a frame has no other way to show what it knows."""
        runs = self.server.runs
        page = runs.shown.report if runs.shown is not None and runs.knows(secret) else None
        if page is None:
            self.refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        else:
            self.send(HTTPStatus.OK, PAGE, page.read_bytes())

    @property
    def _window(self) -> str:
        """The name that a window gave itself."""
        return self.headers.get("Window", "")

    @property
    def _name(self) -> str:
        return self.server.document.path.name

    def _answer(self, **more: Any) -> None:
        """Answer with the content of a window, and more."""
        news = self.server.news()
        text = f"{news[:-1]},{as_json(more)[1:]}" if more else news
        self.send(HTTPStatus.OK, JSON, text)

    def _news(self) -> None:
        self.server.looks(self._window, 1)
        self.stream(self._send_news_of_case)
        self.server.looks(self._window, -1)

    def _send_news_of_case(self) -> None:
        server, seen = self.server, (-1, -1)
        while True:
            with server.changed:
                server.changed.wait_for(lambda: server.counts != seen, LIFE)  # noqa: B023
                (case, runs), before, seen = server.counts, seen, server.counts
                news = {} if runs == before[1] else {"runs": as_json(server.runs.as_dict())}
                # a sign of life where nothing is new
                if case != before[0] or not news:
                    news["case"] = server.news()
            for kind, content in news.items():
                self.event(kind, content)


def _shown(document: Document, worker: Worker) -> dict[str, Any]:
    """Return a document as a window shows it; ``content`` is None where its text is not TOML."""
    content, literals, spans, places, file = None, {}, [], None, str(document.path)
    with suppress(CaseError):
        values, places = document.read
        # JSON has no dates, and no numbers without end
        plain = json.dumps(values, default=str)
        content = json.loads(plain, parse_constant=lambda number: str(float(number)))
        spans = list(places.spans())
        literals = {
            json.dumps(place, ensure_ascii=False, separators=(",", ":")): raw
            for place, one in places.values.items()
            if (raw := document.text[one.start : one.end])[0] not in "\"'[{tf"
        }
    # values that are set may make a case of a text that is none
    trouble = None if worker.settings else document.trouble
    said = worker.told
    if trouble is not None or worker.text != document.text:
        where = trouble.where.removeprefix(f"{file}: ") if trouble else ""
        faults = trouble.faults if trouble else ()
        said = Checked(document.text, file, content or {}, faults, where).as_dict(places)
    return {
        "checked": False,
        **said,
        "refused_as_case": trouble is not None,
        "content": content,
        "literals": literals,
        "spans": spans,
        "version": document.version,
        "text": document.text,
        "undo": document.steps,
        "unsaved": document.unsaved,
        "conflict": document.conflict,
    }


def serve(server: EditServer, say: Callable[[str], None]) -> None:
    """Serve the window of a case file until Ctrl-C; ``say`` gets its address."""
    stop = threading.Event()
    threads = [threading.Thread(target=one, args=(stop,)) for one in (server.watch, server.judge)]
    for one in threads:
        one.start()
    try:
        say(server.address)
        server.serve_forever(0.1)
    except KeyboardInterrupt:
        pass
    finally:
        stop.set()
        server.worker.close()
        for one in threads:
            one.join()
        server.runs.close()
        server.server_close()
