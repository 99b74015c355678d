"""Arguments and options that several commands have, and how their texts are read."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.results import Results

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]
ResultFile = Annotated[Path, typer.Argument(metavar="FILE", help="Result file of a run.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Replace a value of the case, e.g. time.end=2."
    ),
]
FrameNumber = Annotated[
    int | None, typer.Option("--frame", help="Number of the frame, from 0; -1 is the last.")
]
FrameTime = Annotated[
    float | None, typer.Option("--time", metavar="T", help="Time, s: the frame nearest to it.")
]
StageName = Annotated[
    str | None, typer.Option("--stage", metavar="NAME", help="Stage: its last frame.")
]
Limits = Annotated[
    str, typer.Option(metavar="LOW,HIGH", help="Ends of the colours, in m, m/s, degrees or Pa.")
]
Zoom = Annotated[str, typer.Option(metavar="X0,Y0,X1,Y1", help="Show only this part, m.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON for a program to read.")]
Verbose = Annotated[
    bool,
    typer.Option(
        "--verbose", "-v", help="Print all notes, steps, energies and times of the solver too."
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")]

Live = Annotated[
    bool, typer.Option("--live", help="Show the run in a browser on this machine, and steer it.")
]
LiveAt = Annotated[
    str,
    typer.Option(
        "--live-at",
        metavar="HOST:PORT",
        help="The same at this address, e.g. 127.0.0.1:8080; - for lines of JSON on stdout.",
    ),
]


HERE = "127.0.0.1:0"
"""This machine alone, and a port that is free."""


def address_of(written: str, option: str) -> str:
    """Return where a page is to be, as HOST:PORT; raises CaseError for a bad address."""
    host, colon, port = written.rpartition(":")
    if not (colon and host and port.isdecimal() and int(port) < 2**16):
        raise CaseError(
            f"'{shortened(written)}' is not a valid address",
            where=option,
            remedy="write host and port, e.g. 127.0.0.1:8080; for viewers on other machines "
            "give the address of this one in their network",
        )
    return f"{host}:{port}"


def _share(threads: int | None) -> None:
    """Have kernels share their work among ``threads``; they are not loaded yet."""
    if threads is not None:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)


Threads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        metavar="N",
        min=1,
        max=os.cpu_count(),
        callback=_share,
        help="Number of threads, 1 by default; the results do not depend on it. More than one pays "
        "off from some thousand blocks on, on an idle machine.",
    ),
]


def numbers(option: str, listed: str, *counts: int) -> Any:
    """Return the numbers of a list separated by commas, None for none; ``counts`` are allowed."""
    if not listed:
        return None
    try:
        numbers = tuple(float(word) for word in listed.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in counts:
        many = " or ".join(map(str, counts))
        raise CaseError(
            f"'{listed[:40]}' are not {many} numbers",
            where=option,
            remedy=f"write them with commas and without spaces, e.g. {option} "
            + ",".join(str(number) for number in range(counts[-1])),
        )
    return numbers


def frame_asked(
    results: Results, frame: int | None, time: float | None, stage: str | None = None
) -> int:
    """Return the number of the frame that --frame, --time or --stage asks for, else the last."""
    asked = {"--frame": frame, "--time": time, "--stage": stage}
    given = [option for option, value in asked.items() if value is not None]
    if len(given) > 1:
        raise CaseError(
            "a frame is chosen by number, time or stage, only one of them",
            where=given[-1],
            remedy="leave one of them out",
        )
    return results.frame(-1 if frame is None else frame, at=time, stage=stage).number


def words(listed: str) -> list[str]:
    """Return the words of a list separated by commas."""
    return [word.strip() for word in listed.split(",") if word.strip()]


def make_folder(folder: Path) -> None:
    """Make a folder to write pages into, or raise CaseError where something else is there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise CaseError(
            "is not a folder, or does not lie in one",
            where=str(folder),
            remedy="name a folder for the pages; it is made if it does not exist",
        ) from None
