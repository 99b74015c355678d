"""`clast edit` as it is started and ended."""

import signal
import subprocess
import sys
import time

from clast.case.templates import TEMPLATES
from scenes.edited import children, memory, rock_text, started, state_of, until


def changed(address, version, place, toml):
    """Change a value; return the state of the window."""
    edits = [{"do": "set", "place": place, "toml": toml}]
    return state_of(address, "/edit", version=version, edits=edits)


def test_the_interrupt_key_saves_and_ends(tmp_path):
    file = tmp_path / "slope.toml"
    file.write_text(TEMPLATES["slope"], "utf-8")
    with started(file) as (running, address):
        assert changed(address, 0, ["title"], '"changed"')["version"] == 1
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 0
    assert 'title = "changed"' in file.read_text("utf-8")


def test_memory_stays_below_its_limit_over_a_thousand_edits(tmp_path):
    """Of server and worker together, pages that they share counted once."""
    file = tmp_path / "rock.toml"
    file.write_text(rock_text(140.0, 110.0), "utf-8")
    with started(file) as (running, address):
        both = (running.pid, *children(running.pid))
        first = version = 0
        for number in range(1000):
            spacing = f"1.5{number % 97:02d}"
            version = changed(address, version, ["joint_set", 0, "spacing"], spacing)["version"]
            while number % 10 == 0 and not state_of(address)["checked"]:
                time.sleep(0.02)
            if number == 200:
                first = sum(memory(one) for one in both)
        assert state_of(address)["blocks"] or state_of(address)["is_cutting"]
        last = sum(memory(one) for one in both)
        assert last < 400e6
        assert last < 1.05 * first


def refusal(folder, *arguments):
    command = [sys.executable, "-m", "clast", "edit", *arguments]
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert ended.returncode == 2
    assert "Traceback" not in ended.stderr
    return ended.stderr


def test_where_no_case_can_be_is_told(tmp_path):
    assert "none/a.toml: there is no such file" in refusal(tmp_path, "none/a.toml")
    assert "none.txt: there is no such file" in refusal(tmp_path, "none.txt")
    assert "none.toml: there is no such file" in refusal(tmp_path, "--view", "none.toml")


def test_without_a_name_the_cases_here_are_named(tmp_path):
    assert "clast edit new.toml" in refusal(tmp_path)
    (tmp_path / "slope.toml").write_text("")
    assert "'slope.toml'" in refusal(tmp_path)


def test_neither_pictures_nor_cad_are_loaded_for_the_window():
    code = "import sys, clast.editor.server; print({'matplotlib', 'ezdxf'} & {*sys.modules})"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ended.stdout.strip() == "set()", ended.stderr


def test_a_case_that_is_not_there_is_begun_and_a_second_editor_has_its_own(tmp_path):
    one, other = tmp_path / "one.toml", tmp_path / "other.toml"
    with started(one) as (_, address), started(other) as (_, beside):
        assert state_of(address)["text"] == ""
        state_of(address, "/begin", version=0, text="slope")
        until(one.exists)
        assert state_of(beside)["text"] == ""
    assert one.read_text("utf-8") == TEMPLATES["slope"]
    assert not other.exists()


def test_a_window_is_served_at_an_address_of_ones_own(tmp_path):
    file = tmp_path / "slope.toml"
    file.write_text(TEMPLATES["slope"], "utf-8")
    with started(file, "--at", "127.0.0.2:0") as (_, address):
        assert address.startswith("http://127.0.0.2:")
        assert state_of(address)["text"] == TEMPLATES["slope"]
        port = address.split(":")[2].split("/")[0]
        told = refusal(tmp_path, "slope.toml", "--at", f"127.0.0.2:{port}")
    assert "cannot be served" in told and "name another address or port" in told
    assert "is not a valid address" in refusal(tmp_path, "slope.toml", "--at", "here")
    assert "whoever reads" in refusal(tmp_path, "slope.toml", "--at", "256.0.0.1:0")
