"""Commands on result files: info, plot, page, report, film, export."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

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
from clast.cli.terminal import print_json, print_table, progress_bar, tell, two_columns
from clast.cli.terminal_tables import print_measured, print_points, print_stages
from clast.errors import CaseError, shortened

if TYPE_CHECKING:
    from clast.results import Results
    from clast.study.rockfall.results import RockfallResults


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
    events, report = results.events, results.report
    lines = [str(one) for one in events[:EVENTS_MAX]]
    if len(events) > EVENTS_MAX:
        lines.append(f"and {len(events) - EVENTS_MAX} more: clast info --json has all")
    rows = {
        "outcome": content["outcome"],
        "frames": f"{content['frames']}, from {first:.6g} to {last:.6g} s",
        "blocks": f"{content['blocks']} ({content['fixed_blocks']} fixed)",
        "vertices": f"{content['vertices']}",
        "rocks": ", ".join(content["rocks"]),
        "joints": ", ".join(content["joints"]),
        **texts(results.about),
        "largest displacement": f"{content['largest_displacement']:.6g} m",
        "contacts at the end": f"{content['contacts']}",
        **{
            f"{kind} at the end": ", ".join(f"{n} {state}" for state, n in content[kind].items())
            for kind in ("bolts", "links")
        },
        **{f"lining {name}": _lining(one) for name, one in content["linings"].items()},
        "events": "\n".join(lines),
        "fields": ", ".join(content["fields"]),
        "size": f"{content['size_bytes'] / 1e6:.3g} MB",
        "warnings": "\n".join(report.warnings if report else ()),
        "version": content["version"],
        "made with": ", ".join(f"{k} {v}" for k, v in content["versions"].items() if k != "clast"),
    }
    print_table(two_columns(content["title"], rows))
    print_stages(results.stages)
    print_points(content["measured_points"])
    print_measured(content)


def _lining(extremes: dict[str, Any]) -> str:
    """Return the extremes along a lining, in words."""
    parts = [
        f"{letter} {1e-3 * extremes[f'least_{key}']:.4g} to "
        f"{1e-3 * extremes[f'largest_{key}']:.4g} {unit}"
        for letter, key, unit in (
            ("N", "normal_force", "kN/m"),
            ("Q", "shear_force", "kN/m"),
            ("M", "moment", "kN m/m"),
        )
    ]
    used = extremes["utilisation"]
    return ", ".join([*parts, *([] if used is None else [f"utilisation {100.0 * used:.3g} %"])])


EVENTS_MAX = 8
"""Events that are shown, at most."""


PictureFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Picture; the file's name with .png if absent."),
]
ColourField = Annotated[
    str,
    typer.Option(
        help="Colour of the blocks: displacement, velocity (_x, _y), rotation, sigma_xx, _yy, _xy, "
        "_1, _3, max_shear, rock, block, none; joint: that of edges; slip, opening, mobilised, "
        "sliding, utilisation (shear over strength), worn: state of the joints; pressure, head, "
        "flow, aperture, saturation: water that flows in them."
    ),
]
ContactArrows = Annotated[
    bool | None,
    typer.Option(
        "--contacts/--no-contacts",
        help="Draw contact forces as arrows; not beside water in joints, if absent.",
    ),
]
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
WaterLayer = Annotated[
    bool, typer.Option("--water/--no-water", help="Draw levels and pressures of water.")
]
Magnification = Annotated[
    str,
    typer.Option(
        metavar="N", help="Draw displacements so many times as large; auto: so that they are seen."
    ),
]
FramePair = Annotated[
    str, typer.Option(metavar="A,B", help="Draw two frames side by side, in one scale.")
]
HistoryNames = Annotated[
    str,
    typer.Option(
        metavar="A,B",
        help="Draw histories over time: of points, convergences, bolts, contacts, reactions, "
        "links, linings, energy, steps.",
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
    contacts: ContactArrows = None,
    reactions: ReactionArrows = False,
    limits: Limits = "",
    zoom: Zoom = "",
    size: PictureSize = "",
    dpi: DotsPerInch = None,
    layers: Layers = "",
    water: WaterLayer = True,
    magnify: Magnification = "1",
    compare_frames: FramePair = "",
    history: HistoryNames = "",
    against: Abscissa = "time",
    point: PointName = "",
    bolt: BoltName = "",
    interaction: LiningName = "",
) -> None:
    """Draw a frame, or histories of points, bolts and supports."""
    from clast.pictures.histories import plot_histories
    from clast.pictures.linings import plot_interaction
    from clast.pictures.plot import (
        Look,
        plot_bolt_history,
        plot_history,
        plot_results,
        plot_two_frames,
    )
    from clast.results import read_results

    look = Look(
        limits=numbers("--limits", limits, 2),
        zoom=numbers("--zoom", zoom, 4),
        size=numbers("--size", size, 1, 2),
        dpi=dpi,
        layers=tuple(words(layers)),
        water=water,
        magnify=_factor(magnify),
    )
    target = output or file.with_suffix(".png")
    results = read_results(file)

    def number() -> int:
        return frame_asked(results, frame, time, stage)

    def draw_frame() -> object:
        arrows: dict[str, Any] = {"contacts": contacts, "reactions": reactions}
        return plot_results(results, target, frame=number(), field=field, look=look, **arrows)

    def draw_two_frames() -> object:
        pair = _two_frames(compare_frames)
        return plot_two_frames(results, target, pair, field=field, look=look)

    others: dict[str, tuple[str, Callable[[], object]]] = {
        "--point": (point, lambda: plot_history(results, target, point)),
        "--bolt": (bolt, lambda: plot_bolt_history(results, target, bolt)),
        "--history": (history, lambda: plot_histories(results, target, words(history), against)),
        "--interaction": (
            interaction,
            lambda: plot_interaction(results, target, interaction, frame=number()),
        ),
        "--compare-frames": (compare_frames, draw_two_frames),
    }
    given = [option for option, (value, _) in others.items() if value]
    if len(given) > 1:
        raise CaseError(
            "each of these is a separate picture",
            where=", ".join(given),
            remedy="give one at a time",
        )
    draw = others[given[0]][1] if given else draw_frame
    draw()
    tell(f"picture: {target}")


def _factor(written: str) -> Any:
    """Return the number of --magnify, or its text as it is, which a look takes or refuses."""
    try:
        return float(written)
    except ValueError:
        return written


def _two_frames(pair: str) -> tuple[int, int]:
    """Return the two frame numbers of an option, as "0,-1"."""
    first, second = numbers("--compare-frames", pair, 2)
    for number in (first, second):
        if number != int(number):
            what, remedy = f"{number:g} is not a frame number", "give two whole numbers, e.g. 0,-1"
            raise CaseError(what, where="--compare-frames", remedy=remedy)
    return int(first), int(second)


def page(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Result file of a run, or folder of a rockfall.")
    ],
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

    target, size = output or file.with_suffix(".html"), _bytes("--budget", budget)
    if rocks := _rocks_in(file):
        from clast.study.rockfall.page import write_page as write_paths

        target = write_paths(rocks, output)
    else:
        write_page(read_results(file), target, budget=size)
    tell(f"page: {target} ({target.stat().st_size / 1e6:.3g} MB); open it in a browser")


def _rocks_in(folder: Path) -> RockfallResults | None:
    """Return the paths of rocks in a folder, None where it is none of rockfall."""
    if not folder.is_dir():
        return None
    from clast.study.description import ROCKFALL
    from clast.study.folder import STUDY, StudyFolder
    from clast.study.rockfall.results import RockfallResults

    there = StudyFolder.opened(folder) if (folder / STUDY).is_file() else None
    return RockfallResults.of(there) if there and there.study.kind == ROCKFALL else None


def report(
    file: ResultFile,
    output: Annotated[
        Path | None, typer.Argument(metavar="OUTPUT", help="Report; FILE-report.html if absent.")
    ] = None,
) -> None:
    """Write a report for a client. Has figures, tables and verdicts, to be printed."""
    from clast.pictures.report_page import write_report
    from clast.results import read_results

    target = write_report(read_results(file), output or file.with_name(f"{file.stem}-report.html"))
    tell(f"report: {target}; a browser prints it or saves it as PDF")


def _bytes(option: str, written: str) -> float:
    """Return a size such as 12MB in bytes."""
    units = {"": 1.0, "B": 1.0, "KB": 1e3, "MB": 1e6, "GB": 1e9}
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?)\s*([KMG]?B?)\s*", written.upper())
    if match is None or match[2] not in units or float(match[1]) <= 0.0:
        what = f"'{shortened(written)}' is not a valid size"
        raise CaseError(what, where=option, remedy="write e.g. 12MB or 500kB")
    return float(match[1]) * units[match[2]]


def film(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Argument(metavar="OUTPUT", help=".mp4, .webp or .gif; FILE with .mp4 if absent."),
    ] = None,
    field: ColourField = "displacement",
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
    water: WaterLayer = True,
    magnify: Magnification = "1",
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
        water=water,
        magnify=_factor(magnify),
    )
    pace = FilmSpeed(fps=fps, speed=speed)
    target = output or file.with_suffix(".mp4")
    results = read_results(file)
    with progress_bar("drawing") as show:
        write_film(
            results, target, stage=stage, look=look, speed=pace, watch=lambda k, of: show(k, of, "")
        )
    tell(f"film: {target} ({target.stat().st_size / 1e6:.3g} MB)")


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
            help="Only these of blocks, vertices, contacts, channels, histories, measured_flows, "
            "flow, convergences, measured_contacts, linings, links, reactions, bolts, energy, "
            "steps, stages, events.",
        ),
    ] = "",
) -> None:
    """Write frames and histories for other programs."""
    from clast import exports
    from clast.results import read_results

    named = any(one is not None for one in (frame, time, stage))
    if named and every:
        what = "a frame and --all are both given"
        raise CaseError(what, where="--all", remedy="leave one of them out")
    if tables and to != "csv":
        what = f"{to} has no tables"
        raise CaseError(what, where="--tables", remedy="leave it out: --to csv has")
    results = read_results(file)
    frames: Sequence[int] | None = None if every or to != "dxf" else (-1,)
    if named:
        frames = [frame_asked(results, frame, time, stage)]
    count = len(results.times) if frames is None else len(frames)
    endings = {"csv": "-tables", "vtu": ".vtu" if count == 1 else ".pvd", "dxf": ".dxf"}
    target = output or file.with_name(f"{file.stem}{endings[to]}")
    if to == "csv":
        written = _write_csv(results, target, frames, words(tables))
    else:
        write = exports.write_vtu if to == "vtu" else exports.write_dxf
        written = write(results, target, frames)
    tell(f"wrote {written[0]}" + (f" and {len(written) - 1} more" if len(written) > 1 else ""))


def _write_csv(
    results: Results, path: Path, frames: Sequence[int] | None, tables: Sequence[str]
) -> list[Path]:
    """Write tables; say which of them are left out."""
    from clast.exports import TABLES, write_csv

    written = write_csv(results, path, frames, tables or None)
    missing = {*(tables or TABLES)} - {file.stem for file in written}
    # most systems have none of these, and nobody misses them
    present = {
        "bolts": results.bolt_name,
        "links": results.link_name,
        "linings": results.lining_joint_name,
        "measured_contacts": results.measured_contact_name,
        "convergences": results.convergence_name,
        **dict.fromkeys(("channels", "flow"), results.flow_name),
        "measured_flows": results.measured_flow_name,
        "stages": results.frame_stages,
        "events": results.events,
    }
    missing -= {name for name, entries in present.items() if not entries}
    if missing:
        tell(f"left out, nothing is recorded of: {', '.join(sorted(missing))}")
    return written
