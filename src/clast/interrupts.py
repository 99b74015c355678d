"""The interrupt key, held back until a step is done.

In the middle of a step it would hit a kernel that is being loaded, or a frame half written.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def held_back() -> Iterator[Callable[[], None]]:
    """Hold back KeyboardInterrupt in the block; yield what raises it if the key was pressed.

    The key pressed a second time is not held back.  Where somebody else handles it, or outside the
    main thread, nothing changes.
    """
    pressed = 0

    def hold(_number: int, _frame: object) -> None:
        nonlocal pressed
        pressed += 1
        if pressed > 1:
            raise KeyboardInterrupt

    def let_go() -> None:
        if pressed:
            raise KeyboardInterrupt

    ours = threading.current_thread() is threading.main_thread()
    if not ours or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield let_go
        return
    signal.signal(signal.SIGINT, hold)
    try:
        yield let_go
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
