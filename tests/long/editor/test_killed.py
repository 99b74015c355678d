"""Whatever kills the editor, the case file is whole."""

import os
import random
import signal
import time

from clast.case.templates import TEMPLATES
from clast.editor.document import Document
from clast.editor.edits import Edit


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
