"""Signals that ask a run to end, held back until a step is done.

In the middle of a step they would hit a kernel that is being loaded, or a frame half written.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
"""The interrupt key, the signal that systems send before they kill, and the end of the terminal."""


class Interrupted(KeyboardInterrupt):
    """A signal that asks to end."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


class EndedFromPage(KeyboardInterrupt):
    """Who watches a run has asked it to end."""

    number = signal.SIGINT
    how = "ended from its page"


def interrupt(number: int, _frame: FrameType | None) -> NoReturn:
    """Raise Interrupted."""
    raise Interrupted(number)


@contextmanager
def heard() -> Iterator[None]:
    """Let signals that would end the process at once raise Interrupted in the block.

    A signal that is ignored, as nohup asks for, or has a handler of somebody else stays as it is.
    """
    with _handled(interrupt, _is_usual):
        yield


@contextmanager
def held_back() -> Iterator[Callable[[], None]]:
    """Hold back signals to end in the block; yield a function that raises Interrupted if one came.

    The second signal is not held back.  Where somebody else handles it, or outside the main
    thread, nothing changes.  A signal that would have ended the process, and was not
    ``heard``, ends it after the block.
    """
    came: list[int] = []

    def hold(number: int, _frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:
            raise Interrupted(number)

    def let_go() -> None:
        if came:
            raise Interrupted(came[0])

    def wanted(number: int) -> bool:
        return _is_usual(number) or signal.getsignal(number) is interrupt

    with _handled(hold, wanted) as before:
        yield let_go
    if came and before[came[0]] is signal.SIG_DFL:
        signal.raise_signal(came[0])


@contextmanager
def _handled(
    handler: Callable[[int, FrameType | None], None], wanted: Callable[[int], bool]
) -> Iterator[dict[int, object]]:
    """Give those signals that are ``wanted`` another handler in the block; yield the old ones."""
    ours = threading.current_thread() is threading.main_thread()
    numbers = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]
    before = {n: signal.getsignal(n) for n in numbers if ours and wanted(n)}
    for number in before:
        signal.signal(number, handler)
    try:
        yield dict(before)
    finally:
        for number, usual in before.items():
            signal.signal(number, usual)


def _is_usual(number: int) -> bool:
    return signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler)
