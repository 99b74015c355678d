"""``python -m clast.editor.bound ARGUMENTS``: a command of clast that ends with who started it.

A line on its input, or the end of it, is what the interrupt key is on a terminal.
"""

from __future__ import annotations

import os
import runpy
import signal
import threading


def _hear() -> None:
    os.read(0, 1)
    os.kill(os.getpid(), signal.SIGINT)


if __name__ == "__main__":
    threading.Thread(target=_hear, daemon=True).start()
    runpy.run_module("clast", run_name="__main__", alter_sys=True)
