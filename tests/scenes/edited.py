"""A case file in the editor, with the server of its window."""

import threading
from contextlib import contextmanager

from clast.editor.server import EditServer


@contextmanager
def edited_file(path):
    """Yield the server of the window of a case file, which saves as the hand rests."""
    server, stop = EditServer(("127.0.0.1", 0), path), threading.Event()
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
    for one in threads:
        one.join()
    server.server_close()
