"""The results of a run: histories, energy, a report, and one .vtkhdf file that ParaView opens.

A run writes through ``RunRecorder``, which gives a ``Run``; a file is read again by
``read_results``.  The layout of the file is described in ``clast.results.schema``.
"""

from __future__ import annotations

from clast.results.recorder import RunRecorder
from clast.results.recording import Frame, Recording, Run
from clast.results.result_reader import Results, read_results, summary
from clast.results.result_tables import (
    BlockHistory,
    BoltHistory,
    FrameBolts,
    FrameContacts,
    PointHistory,
)
from clast.results.run_report import Report

read = read_results
"""The public name of ``read_results``: ``clast.read("out.vtkhdf")``."""

__all__ = [
    "BlockHistory",
    "BoltHistory",
    "Frame",
    "FrameBolts",
    "FrameContacts",
    "PointHistory",
    "Recording",
    "Report",
    "Results",
    "Run",
    "RunRecorder",
    "read",
    "read_results",
    "summary",
]
