"""`clast edit` as it is started and ended."""

import http.client
import json
import signal
import subprocess
import sys
from urllib.parse import urlsplit

from clast.case.templates import TEMPLATES


def test_the_interrupt_key_saves_and_ends(tmp_path):
    file = tmp_path / "slope.toml"
    file.write_text(TEMPLATES["slope"], "utf-8")
    command = [sys.executable, "-m", "clast", "edit", "slope.toml"]
    running = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    try:
        line = next(one for one in running.stderr if "http://" in one)
        address = urlsplit(line[line.index("http://") :].strip())
        token = address.fragment.removeprefix("token=")
        connection = http.client.HTTPConnection(address.netloc, timeout=20)
        edits = [{"do": "set", "place": ["title"], "toml": '"changed"'}]
        connection.request(
            "POST",
            "/edit",
            json.dumps({"version": 0, "edits": edits}),
            {"Authorization": f"Bearer {token}"},
        )
        assert json.loads(connection.getresponse().read())["version"] == 1
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 0
    finally:
        running.kill()
        running.wait()
    assert 'title = "changed"' in file.read_text("utf-8")


def test_a_file_that_is_not_there_is_told(tmp_path):
    command = [sys.executable, "-m", "clast", "edit", "none.toml"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 2
    assert "none.toml: there is no such file" in ended.stderr
    assert "Traceback" not in ended.stderr
