"""Commands on result files: info, plot, page, report, film, export."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from clast.cli.options import (
    AsJson,
    FrameNumber,
    FrameTime,
    Limits,
    ResultFile,
    StageName,
    Zoom,
    frame_asked,
    numbers,
    words,
)
from clast.cli.terminal import counting, print_json, print_table, tell, two_columns
from clast.cli.terminal_tables import print_points, print_stages
from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.model.stage_records import Event
    from clast.pictures.plot import Look
    from clast.results import Results


def info(file: ResultFile, as_json: AsJson = False) -> None:
    """Show the contents of a result file."""
    from clast.results import read_results, summary
    from clast.results.run_report import texts

    results = read_results(file, whole=sys.maxsize)
    content = summary(results)
    if as_json:
        print_json(content)
        return
    first, last = content["time"]
    warnings = results.report.warnings if results.report else ()
    rows = {
        "outcome": content["outcome"],
        "frames": f"{content['frames']}, from {first:.6g} to {last:.6g} s",
        "blocks": f"{content['blocks']} ({content['fixed_blocks']} fixed)",
        "vertices": f"{content['vertices']}",
        "rocks": ", ".join(content["rocks"]),
        **({"joints": ", ".join(content["joints"])} if content["joints"] else {}),
        **texts(results.about),
        "largest displacement": f"{content['largest_displacement']:.6g} m",
        "contacts at the end": f"{content['contacts']}",
        **{
            f"{kind} at the end": _states(content[kind])
            for kind in ("bolts", "links")
            if content[kind]
        },
        **{f"lining {name}": _lining(found) for name, found in content["linings"].items()},
        **({"events": _first(results.events)} if results.events else {}),
        "fields": ", ".join(content["fields"]),
        "size": f"{content['size_bytes'] / 1e6:.3g} MB",
        **({"warnings": "\n".join(warnings)} if warnings else {}),
        "version": content["version"],
        "made with": ", ".join(f"{k} {v}" for k, v in content["versions"].items() if k != "clast"),
    }
    print_table(two_columns(content["title"], rows))
    print_stages(results.stages)
    print_points(content["measured_points"])


def _states(counts: dict[str, int]) -> str:
    """Return how many bolts or links are in which state, in words."""
    return ", ".join(f"{count} {state}" for state, count in counts.items())


def _lining(found: dict[str, float | None]) -> str:
    """Return the extremes along a lining, in words."""
    parts = [
        f"{letter} {found[f'least_{key}']:.4g} to {found[f'largest_{key}']:.4g} {unit}"
        for letter, key, unit in (
            ("N", "normal_force", "N/m"),
            ("Q", "shear_force", "N/m"),
            ("M", "moment", "N m/m"),
        )
    ]
    used = found["utilisation"]
    return ", ".join([*parts, *([] if used is None else [f"utilisation {used:.3g}"])])


EVENTS = 8
"""Events that are shown at most."""


def _first(events: Sequence[Event]) -> str:
    """Return the first events, a line each, and how many more there are."""
    lines = [str(one) for one in events[:EVENTS]]
    more = len(events) - EVENTS
    return "\n".join([*lines, f"and {more} more: clast info --json has all"] if more > 0 else lines)


PictureFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Picture; the file's name with .png if absent."),
]
ColourField = Annotated[
    str,
    typer.Option(
        help="Colour of the blocks: displacement, velocity (_x, _y), rotation, sigma_xx, _yy, _xy, "
        "_1, _3, max_shear, rock, block, none; joint: that of edges; slip, opening, mobilised, "
        "sliding, utilisation (shear over strength), worn: state of the joints."
    ),
]
ContactArrows = Annotated[bool, typer.Option(help="Draw contact forces as arrows.")]
ReactionArrows = Annotated[
    bool, typer.Option("--reactions", help="Draw the reactions of supports as arrows.")
]
PictureSize = Annotated[
    str, typer.Option(metavar="W[,H]", help="Width and height of the picture, cm.")
]
DotsPerInch = Annotated[int | None, typer.Option(metavar="N", help="Dots per inch.")]
Layers = Annotated[
    str,
    typer.Option(
        metavar="A,B",
        help="Draw as well: chains, crosses, vectors, levels, scale, gravity; of linings "
        "normal-forces, shear-forces, moments.",
    ),
]
FramePair = Annotated[
    str, typer.Option(metavar="A,B", help="Draw two frames side by side, in one scale.")
]
HistoryNames = Annotated[
    str,
    typer.Option(
        metavar="A,B",
        help="Draw histories over time: of points, bolts, contacts, reactions, links, linings, "
        "energy, steps.",
    ),
]
Abscissa = Annotated[str, typer.Option(metavar="NAME", help="Abscissa of histories: time, or A:x.")]
PointName = Annotated[
    str, typer.Option(metavar="NAME", help="Draw the movement of this measured point over time.")
]
BoltName = Annotated[
    str, typer.Option(metavar="NAME", help="Draw the force of this bolt over time.")
]
LiningName = Annotated[
    str,
    typer.Option(metavar="NAME", help="Draw N and M of this lining with its interaction curve."),
]


def plot(
    file: ResultFile,
    output: PictureFile = None,
    frame: FrameNumber = None,
    time: FrameTime = None,
    stage: StageName = None,
    field: ColourField = "displacement",
    contacts: ContactArrows = True,
    reactions: ReactionArrows = False,
    limits: Limits = "",
    zoom: Zoom = "",
    size: PictureSize = "",
    dpi: DotsPerInch = None,
    layers: Layers = "",
    compare_frames: FramePair = "",
    history: HistoryNames = "",
    against: Abscissa = "time",
    point: PointName = "",
    bolt: BoltName = "",
    interaction: LiningName = "",
) -> None:
    """Draw a frame, or histories of points, bolts and supports."""
    from clast.pictures.plot import Look, plot_results
    from clast.results import read_results

    look = Look(
        limits=numbers("--limits", limits, 2),
        zoom=numbers("--zoom", zoom, 4),
        size=numbers("--size", size, 1, 2),
        dpi=dpi,
        layers=tuple(words(layers)),
    )
    target = output or file.with_suffix(".png")
    results = read_results(file)
    others = _other_pictures(look, field, against, lambda: frame_asked(results, frame, time, stage))
    asked = {
        "--point": point,
        "--bolt": bolt,
        "--history": history,
        "--interaction": interaction,
        "--compare-frames": compare_frames,
    }
    given = [option for option, value in asked.items() if value]
    if len(given) > 1:
        raise CaseError(
            "each of these is a separate picture",
            where=", ".join(given),
            remedy="give one at a time",
        )
    for option in given:
        others[option](results, target, asked[option])
    if not given:
        plot_results(
            results,
            target,
            frame=frame_asked(results, frame, time, stage),
            field=field,
            contacts=contacts,
            reactions=reactions,
            look=look,
        )
    tell(f"picture: {target}")


def _other_pictures(
    look: Look, field: str, against: str, number: Callable[[], int]
) -> dict[str, Callable[[Results, Path, str], object]]:
    """Return the pictures other than that of a frame, by their options; each takes its value.

    ``number`` finds the frame of an interaction curve.
    """
    from clast.pictures.histories import plot_histories
    from clast.pictures.linings import plot_interaction
    from clast.pictures.plot import plot_bolt_history, plot_history, plot_two_frames

    return {
        "--point": plot_history,
        "--bolt": plot_bolt_history,
        "--history": lambda results, target, names: plot_histories(
            results, target, words(names), against
        ),
        "--interaction": lambda results, target, name: plot_interaction(
            results, target, name, frame=number()
        ),
        "--compare-frames": lambda results, target, pair: plot_two_frames(
            results, target, _two_frames(pair), field=field, look=look
        ),
    }


def _two_frames(pair: str) -> tuple[int, int]:
    """Return the two frame numbers of an option, as "0,-1"."""
    first, second = numbers("--compare-frames", pair, 2)
    for number in (first, second):
        if number != int(number):
            raise CaseError(
                f"{number:g} is not a frame number",
                where="--compare-frames",
                remedy="give two whole numbers, e.g. 0,-1",
            )
    return int(first), int(second)


def page(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Argument(metavar="OUTPUT", help="Page; the file's name with .html if absent."),
    ] = None,
    budget: Annotated[
        str,
        typer.Option(metavar="SIZE", help="Limit of contact and joint data before compression."),
    ] = "12MB",
) -> None:
    """Write a page that plays a run in a browser. One file; no network needed."""
    from clast.pictures.page.document import write_page
    from clast.results import read_results

    target = output or file.with_suffix(".html")
    write_page(read_results(file), target, budget=_bytes("--budget", budget))
    tell(f"page: {target} ({target.stat().st_size / 1e6:.3g} MB); open it in a browser")


def report(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Argument(metavar="OUTPUT", help="Report; FILE-report.html if absent."),
    ] = None,
) -> None:
    """Write a report for a client. Has figures, tables and verdicts, to be printed."""
    from clast.pictures.report_page import write_report
    from clast.results import read_results

    target = write_report(read_results(file), output or file.with_name(f"{file.stem}-report.html"))
    tell(f"report: {target}; a browser prints it or saves it as PDF")


SIZES = {"": 1.0, "B": 1.0, "KB": 1e3, "MB": 1e6, "GB": 1e9}
"""Units of a size -> bytes."""


def _bytes(option: str, written: str) -> float:
    """Return a size such as 12MB in bytes."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d*)?)\s*([KMG]?B?)\s*", written.upper())
    if found is None or found[2] not in SIZES or float(found[1]) <= 0.0:
        raise CaseError(
            f"'{shortened(written)}' is not a valid size",
            where=option,
            remedy="write e.g. 12MB or 500kB",
        )
    return float(found[1]) * SIZES[found[2]]


def film(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Argument(metavar="OUTPUT", help=".mp4, .webp or .gif; FILE with .mp4 if absent."),
    ] = None,
    field: Annotated[
        str,
        typer.Option(help="Colour of the blocks or joints, as of clast plot."),
    ] = "displacement",
    stage: Annotated[str | None, typer.Option(metavar="NAME", help="Show only this stage.")] = None,
    fps: Annotated[float, typer.Option(metavar="N", help="Frames per second.")] = 25.0,
    speed: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="Simulated time per second of film, s: 1 is real time. If "
            "absent, every frame is one picture.",
        ),
    ] = None,
    limits: Limits = "",
    zoom: Zoom = "",
    size: Annotated[
        str, typer.Option(metavar="W[,H]", help="Width and height, pixels; about 1280 if absent.")
    ] = "",
) -> None:
    """Write a film of a run; MP4 needs the program ffmpeg."""
    from clast.pictures.film import FilmLook, FilmSpeed, write_film
    from clast.results import read_results

    look = FilmLook(
        field=field,
        size=numbers("--size", size, 1, 2),
        zoom=numbers("--zoom", zoom, 4),
        limits=numbers("--limits", limits, 2),
    )
    pace = FilmSpeed(fps=fps, speed=speed)
    target = output or file.with_suffix(".mp4")
    results = read_results(file)
    with counting("drawing") as watch:
        write_film(results, target, stage=stage, look=look, speed=pace, watch=watch)
    tell(f"film: {target} ({target.stat().st_size / 1e6:.3g} MB)")


Frames = Sequence[int] | None
"""Numbers of frames; None for all."""


def export(
    file: ResultFile,
    to: Annotated[
        Literal["csv", "vtu", "dxf"],
        typer.Option(help="Tables in a folder, polygons for ParaView, or drawings."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File, or folder of tables; named as FILE if absent."),
    ] = None,
    frame: FrameNumber = None,
    time: FrameTime = None,
    stage: StageName = None,
    every: Annotated[
        bool, typer.Option("--all", help="Write all frames, as csv and vtu do anyway.")
    ] = False,
    tables: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help="Only these of blocks, vertices, contacts, histories, measured_contacts, linings, "
            "links, reactions, bolts, energy, steps, stages, events.",
        ),
    ] = "",
) -> None:
    """Write frames and histories for other programs."""
    from clast.results import read_results

    write, one_ending, several_ending, default = FORMS[to]
    named = any(one is not None for one in (frame, time, stage))
    if named and every:
        raise CaseError(
            "a frame and --all are both given", where="--all", remedy="leave one of them out"
        )
    if tables and to != "csv":
        raise CaseError(
            f"{to} has no tables", where="--tables", remedy="leave it out: --to csv has"
        )
    results = read_results(file)
    frames = None if every else default
    if named:
        frames = [frame_asked(results, frame, time, stage)]
    count = len(results.times) if frames is None else len(frames)
    ending = one_ending if count == 1 else several_ending
    written = write(
        results, output or file.with_name(f"{file.stem}{ending}"), frames, words(tables)
    )
    tell(f"wrote {written[0]}" + (f" and {len(written) - 1} more" if len(written) > 1 else ""))


def _csv(results: Results, path: Path, frames: Frames, tables: Sequence[str]) -> list[Path]:
    from clast.exports import TABLES, write_csv

    written = write_csv(results, path, frames, tables or None)
    missing = {*(tables or TABLES)} - {file.stem for file in written}
    # most systems have none of these, and nobody misses them
    present = {
        "bolts": results.bolt_name,
        "links": results.link_name,
        "linings": results.lining_joint_name,
        "measured_contacts": results.measured_contact_name,
        "stages": results.frame_stages,
        "events": results.events,
    }
    missing -= {name for name, found in present.items() if not found}
    if missing:
        tell(f"left out, nothing is recorded of: {', '.join(sorted(missing))}")
    return written


def _vtu(results: Results, path: Path, frames: Frames, _: Sequence[str]) -> list[Path]:
    from clast.exports import write_vtu

    return write_vtu(results, path, frames)


def _dxf(results: Results, path: Path, frames: Frames, _: Sequence[str]) -> list[Path]:
    from clast.exports import write_dxf

    return write_dxf(results, path, frames)


FORMS: dict[
    str, tuple[Callable[[Results, Path, Frames, Sequence[str]], list[Path]], str, str, Frames]
] = {
    "csv": (_csv, "-tables", "-tables", None),
    "vtu": (_vtu, ".vtu", ".pvd", None),
    "dxf": (_dxf, ".dxf", ".dxf", (-1,)),
}
"""Name of a form -> its writer, the endings of names for one frame and several, default frames."""
