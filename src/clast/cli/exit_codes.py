"""Exit codes of the commands.

0 done, 1 a verification failed, 2 bad input, 3 a run that could not go on (its partial results are
kept), 130 interrupted, 143 and 129 ended by SIGTERM and SIGHUP.
"""

from __future__ import annotations

import signal

MISSED = 1
BAD_INPUT = 2
STOPPED = 3
SIGNALLED = 128
"""Systems add this to the number of the signal that ended a program: 130 for the interrupt key."""


def interrupted_by(error: BaseException) -> int:
    """Return the exit code of a program that a signal, SIGINT if no other, has ended."""
    key = error.__cause__ if isinstance(error, SystemError) else error
    return SIGNALLED + int(getattr(key, "number", signal.SIGINT))
