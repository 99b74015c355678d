"""What a run leaves behind: histories, energy, a report, and one .vtkhdf file that ParaView opens.

A run writes through :class:`RunRecorder`, which gives a :class:`Run`; a file is read again by
:func:`read_results`.  The layout of the file is described in :mod:`clast.results.layout`.
"""

from __future__ import annotations

from clast.results.reading import FrameContacts, Results, read_results, summary
from clast.results.recorder import RunRecorder
from clast.results.run import PointHistory, Report, Run

__all__ = [
    "FrameContacts",
    "PointHistory",
    "Report",
    "Results",
    "Run",
    "RunRecorder",
    "read_results",
    "summary",
]
