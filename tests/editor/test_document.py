"""A case file under the hand: steps back and forth, saving, and other hands on the same file."""

import os
import random
import signal
import time
import tomllib
from contextlib import suppress

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from clast.case.templates import TEMPLATES
from clast.editor.document import Document, OutOfStep, Step
from clast.editor.edits import Edit
from clast.errors import CaseError
from scenes.odd_toml import ODD, at, changed, places, without_empty

STEP = ("time", "step")


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(TEMPLATES["slope"], "utf-8", newline="")
    return path


def set_step(document, value, gesture=""):
    document.edit([Edit("set", STEP, value)], document.version, gesture)


def test_opening_and_saving_change_nothing(file):
    before = file.stat().st_mtime_ns
    document = Document(file)
    document.look()
    document.save()
    assert document.trouble is None
    assert file.stat().st_mtime_ns == before
    assert document.version == 0


def test_steps_are_undone_and_done_again(file):
    document = Document(file)
    texts = [document.text]
    for number in range(250):
        set_step(document, f"{number + 1}e-3")
        texts.append(document.text)
    for text in reversed(texts[:-1]):
        document.undo(document.version)
        assert document.text == text
    for text in texts[1:]:
        document.redo(document.version)
        assert document.text == text
    document.redo(document.version)
    assert document.text == texts[-1]


def test_what_one_gesture_changes_is_one_step(file):
    document = Document(file)
    for value in ("2", "2e", "2e-3", "2e-4"):
        try:
            set_step(document, value, "typing")
        except CaseError:
            assert value == "2e"
    set_step(document, "3e-4", "typing again")
    assert document.steps == (2, 0)
    document.undo(document.version)
    assert at(tomllib.loads(document.text), STEP) == 2e-4
    document.undo(document.version)
    assert document.text == TEMPLATES["slope"]


def test_several_changes_are_made_together_or_not_at_all(file):
    document = Document(file)
    wrong = [Edit("set", STEP, "1e-4"), Edit("remove", ("time", "nothing"))]
    with pytest.raises(CaseError, match=r"time\.nothing: there is no such value"):
        document.edit(wrong, 0)
    assert (document.text, document.version) == (TEMPLATES["slope"], 0)


def test_an_old_version_is_refused(file):
    document = Document(file)
    set_step(document, "1e-4")
    for late in (document.undo, document.redo, lambda version: document.replace("", version)):
        with pytest.raises(OutOfStep, match="version 1, not 0"):
            late(0)


@pytest.mark.parametrize("value", ["-1.0", '"fast"'])
def test_the_file_keeps_the_last_text_that_is_a_case(file, value):
    document = Document(file)
    set_step(document, "1e-3")
    document.save()
    kept = file.read_bytes()
    set_step(document, value)
    document.save()
    assert "step" in str(document.trouble)
    assert document.unsaved
    assert file.read_bytes() == kept
    document.replace(document.text + "[", document.version)
    document.save()
    assert "is not TOML" in str(document.trouble)
    assert file.read_bytes() == kept
    document.write()
    assert file.read_text("utf-8") == document.text
    document.undo(document.version)
    document.undo(document.version)
    document.save()
    assert file.read_bytes() == kept


def test_saving_keeps_permissions_and_links(file, tmp_path):
    file.chmod(0o640)
    link = tmp_path / "link.toml"
    link.symlink_to(file)
    document = Document(link)
    set_step(document, "1e-3")
    document.save()
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert file.read_text("utf-8") == document.text
    assert sorted(one.name for one in tmp_path.iterdir()) == ["link.toml", "slope.toml"]


def test_a_write_that_fails_leaves_the_file(file, monkeypatch):
    def full(*_):
        raise OSError(28, "no space left")

    document, before = Document(file), file.read_bytes()
    set_step(document, "1e-3")
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(CaseError, match="no space left"):
        document.save()
    assert document.unsaved
    assert file.read_bytes() == before


def test_a_file_that_may_not_be_written_is_left(file, monkeypatch):
    document, before = Document(file), file.read_bytes()
    set_step(document, "1e-3")
    monkeypatch.setattr(os, "access", lambda *_: False)  # whoever may write everything
    with pytest.raises(CaseError, match="must not be written to"):
        document.save()
    assert file.read_bytes() == before


def test_what_others_write_is_one_step(file):
    document = Document(file)
    set_step(document, "1e-3")
    document.save()
    file.write_text(TEMPLATES["wall"], "utf-8")
    document.look()
    assert document.text == TEMPLATES["wall"]
    document.undo(document.version)
    assert at(tomllib.loads(document.text), STEP) == 1e-3
    document.undo(document.version)
    document.save()
    assert file.read_text("utf-8") == TEMPLATES["slope"]


@pytest.mark.parametrize("chosen", ["mine", "theirs"])
def test_two_hands_at_once_are_told_and_nothing_is_lost(file, chosen):
    document = Document(file)
    set_step(document, "1e-3")
    mine = document.text
    file.write_text(TEMPLATES["wall"], "utf-8")
    with pytest.raises(CaseError, match="was changed by somebody else"):
        document.write()
    document.save()
    assert document.conflict == TEMPLATES["wall"]
    assert file.read_text("utf-8") == TEMPLATES["wall"]
    assert document.text == mine
    (document.keep_mine if chosen == "mine" else document.keep_theirs)()
    document.save()
    assert document.conflict is None
    assert file.read_text("utf-8") == (mine if chosen == "mine" else TEMPLATES["wall"])
    if chosen == "theirs":
        document.undo(document.version)
        assert document.text == mine


def test_the_same_change_by_two_hands_is_no_conflict(file):
    document = Document(file)
    set_step(document, "1e-3")
    file.write_text(document.text, "utf-8", newline="")
    document.look()
    assert not document.unsaved
    assert document.conflict is None


def test_a_file_that_is_gone_or_no_text_leaves_the_window(file):
    document = Document(file)
    file.write_bytes(b"\xff\x00")
    with pytest.raises(CaseError, match=r"is not a text file \(byte 0\)"):
        document.look()
    file.unlink()
    with pytest.raises(CaseError, match="there is no such file"):
        document.look()
    assert document.text == TEMPLATES["slope"]
    set_step(document, "1e-3")
    document.save()
    assert file.read_text("utf-8") == document.text


@given(st.text("ab\n", max_size=12), st.text("ab\n", max_size=12))
def test_a_step_leads_to_the_text_and_back(before, after):
    step = Step.between(before, after)
    assert step.taken(before) == after
    assert step.back().taken(after) == before


# random hands ------------------------------------------------------------------------------------

VALUES = ["1", "2.50", '"a # b"', "true", "[1, 2]", "[]", "[[0, 1], [2, 3]]"]
OPERATIONS = "set new insert remove rename undo redo save outside kill".split()


def edit_of(do: str, content: dict, chance: random.Random) -> Edit | None:
    """Return an edit at a place drawn from those where it can be made."""
    place, value = chance.choice(list(places(content))), chance.choice(VALUES)
    there = at(content, place)
    if do == "new" and isinstance(there, dict):
        return Edit("set", (*place, f"k{chance.randrange(50)}"), value)
    if do == "rename" and isinstance(place[-1], str):
        return Edit("rename", place, f"renamed {chance.random()}")
    if do == "insert" and isinstance(there, list):
        is_tables = any(isinstance(one, dict) for one in there)
        return None if is_tables else Edit("insert", (*place, chance.randint(0, len(there))), value)
    if do == "set" and isinstance(there, dict) and isinstance(place[-1], int):
        return None  # an entry of [[block]] stays a table
    return Edit(do, place, value) if do in ("set", "remove") else None


class AnyText(Document):
    """The text of no case, which is saved all the same."""

    trouble = None


def killed_while_saving(document: Document, after: float) -> None:
    """Have a process write the text, and kill it so many seconds after its beginning."""
    writer = os.fork()
    if writer == 0:
        with suppress(BaseException):
            document.write()
        os._exit(0)
    time.sleep(after)
    os.kill(writer, signal.SIGKILL)
    os.waitpid(writer, 0)


def work(path, operations: list[str], seed: int) -> None:
    """Let a hand work at a file, with another on its values alone beside it."""
    path.write_text(ODD, "utf-8", newline="")
    document, chance = AnyText(path), random.Random(seed)
    past, future = [ODD], []
    for do in operations:
        content, version = tomllib.loads(document.text), document.version
        edit = edit_of(do, content, chance) if content else None
        if do == "undo":
            document.undo(version)
            if len(past) > 1:
                future.append(past.pop())
        elif do == "redo":
            document.redo(version)
            if future:
                past.append(future.pop())
        elif do == "outside":
            document.save()
            path.write_text(f"# by another\n{document.text}", "utf-8", newline="")
            document.look()
            past, future = [*past, f"# by another\n{past[-1]}"], []
        elif do == "kill":
            saved = path.read_bytes().decode()
            killed_while_saving(document, 2e-3 * chance.random())
            kept = path.read_bytes().decode()
            assert kept in (saved, document.text)
            document, past, future = AnyText(path), [kept], []
        elif do == "save":
            document.save()
            assert path.read_bytes().decode() == document.text
        elif edit is not None:
            document.edit([edit], version)
            written = without_empty(tomllib.loads(document.text))
            assert written == without_empty(changed(content, edit)), edit
            if document.version != version:
                past, future = [*past, document.text], []
        assert document.text == past[-1]
        tomllib.loads(path.read_bytes().decode())
    while document.steps[0]:
        document.undo(document.version)
    assert document.text == past[0]
    document.save()
    assert path.read_bytes().decode() == past[0]


HANDS = st.lists(st.sampled_from(OPERATIONS), min_size=15, max_size=60)


@settings(max_examples=6, phases=[Phase.generate])
@given(HANDS, st.integers(0, 2**32))
def test_random_hands(tmp_path_factory, operations, seed):
    work(tmp_path_factory.getbasetemp() / "random.toml", operations, seed)


@pytest.mark.slow
@settings(max_examples=400, phases=[Phase.generate])
@given(HANDS, st.integers(0, 2**32))
def test_ten_thousand_operations_of_random_hands(tmp_path_factory, operations, seed):
    work(tmp_path_factory.getbasetemp() / "random.toml", operations, seed)
