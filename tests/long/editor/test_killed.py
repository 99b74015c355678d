"""Whatever kills the editor, the case file is whole."""

import os
import random
import signal
import time
from pathlib import Path

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.document import Document
from clast.editor.edits import Edit
from scenes.edited import children, started, state_of, until

LOST_MOST = 2.0
"""Of the work before the end, s."""


def save_without_end(document: Document, told: int) -> None:
    number = 0
    while True:
        number += 1
        document.edit([Edit("set", ("title",), f'"{number % 10}{"x" * 4000}"')], document.version)
        document.save()
        os.write(told, b".")


def test_kills_at_any_time_leave_a_whole_file(tmp_path):
    file, delays = tmp_path / "slope.toml", random.Random(1)
    texts = {TEMPLATES["slope"]}
    for number in range(10):
        file.write_text(TEMPLATES["slope"], "utf-8")
        document = Document(file)
        document.edit([Edit("set", ("title",), f'"{number}{"x" * 4000}"')], document.version)
        texts.add(document.text)
    file.write_text(TEMPLATES["slope"], "utf-8")
    for _ in range(60):
        told, telling = os.pipe()
        writer = os.fork()
        if writer == 0:
            save_without_end(Document(file), telling)
        os.close(telling)
        assert os.read(told, 1) == b"."
        time.sleep(0.05 * delays.random())
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)
        os.close(told)
        assert file.read_text("utf-8") in texts - {TEMPLATES["slope"]}


@pytest.mark.parametrize("seed", range(6))
def test_a_killed_editor_leaves_a_whole_file_with_all_but_the_last_work(tmp_path, seed):
    """Killed at some time while somebody types; what was typed longer ago than 2 s is there."""
    file, draw, typed = tmp_path / "slope.toml", random.Random(seed), {}
    file.write_text(TEMPLATES["slope"], "utf-8")
    with started(file) as (editor, address):
        process = children(editor.pid)
        version, end = 0, time.monotonic() + 1.0 + 2.0 * draw.random()
        while time.monotonic() < end:
            edits = [{"do": "set", "place": ["title"], "toml": f'"{len(typed)}{"x" * 2000}"'}]
            told = state_of(address, "/edit", version=version, edits=edits)
            version, typed[told["text"]] = told["version"], time.monotonic()
            time.sleep(draw.choice([0.02, 0.05, 0.6]))
        killed = time.monotonic()
        editor.kill()
        editor.wait()
        until(lambda: not any(Path(f"/proc/{one}").exists() for one in process), 20.0)
    text = file.read_text("utf-8")
    last = [one for one, when in typed.items() if killed - when > LOST_MOST]
    assert text in typed or not last
    assert not last or typed[text] >= typed[last[-1]]
    assert [one.name for one in tmp_path.glob("*.toml")] == ["slope.toml"]
