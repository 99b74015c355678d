"""Sheets of paper for pictures: sizes in inches, text, axes, saving."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures.figure_options import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = "#262626"
"""Text and outlines."""
FAINT = "#8c8c8c"
"""For earlier positions, and for text beside a point."""

NAME_BOX = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75}
"""Ground of names, so that they can be read on anything."""

TEXT: dict[str, Any] = {"fontsize": 9.0, "color": INK}
"""Labels of axes and colour bars."""
SMALL: dict[str, Any] = {"fontsize": 8.0, "color": INK}
"""Text within axes, and beside keys."""
LEGEND: dict[str, Any] = {"fontsize": 8.0, "labelcolor": INK, "frameon": False}
"""Legends."""

LEFT, RIGHT, BELOW = 0.75, 0.25, 0.55
"""Margins for the labels of the axes, inches."""
TITLE_SIZE, TEXT_SIZE, SMALL_SIZE = 11.0, 9.0, 8.0
"""Sizes of type, points."""
LINE = 0.2
"""Height of a line of text, inches."""
BAR, BAR_LABELS = 0.16, 0.95
"""Width of a colour bar and of its labels, inches."""
UPRIGHT = 2.2
"""Height of axes from which the colour bar stands beside them, inches."""
ROOM = (1.0, 0.8)
"""Least width and height of axes, inches."""


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Where the parts of a picture are, inches from the lower left corner."""

    size: tuple[float, float]
    """Width and height of the sheet."""
    title: tuple[str, ...]
    """Lines of the title."""
    axes: tuple[float, float, float, float]
    """Left, bottom, width, height of the axes."""
    bar: tuple[float, float, float, float]
    """Left, bottom, width, height of the colour bar."""
    upright: bool
    """True where the colour bar stands beside the axes, False where it lies below."""
    legend: float
    """Bottom of the upper line of the legend."""

    @property
    def room(self) -> tuple[float, float]:
        """Width and height of the axes."""
        return self.axes[2], self.axes[3]

    def parts(self, box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        """Return a box in parts of the width and the height of the sheet."""
        width, height = self.size
        return box[0] / width, box[1] / height, box[2] / width, box[3] / height


FILMS = (".gif", ".mp4")
"""Endings of films alone; .webp is one of pictures as well."""
Part = tuple[Floats, Floats]
"""Lower left and upper right corner of the picture, m, (2,) each."""


def lay_out(
    part: Part, look: Look, title: str, handles: list[Any], bars: int, keys_below: int = 0
) -> tuple[Sheet, Keys]:
    """Return the sheet of a picture of a part, and its legend."""
    extent = part[1] - part[0]
    extent = np.maximum(extent, 1e-3 * extent.max())
    if look.inches is None:
        width, height = extent
        scale = min((9.5 if width > 2.5 * height else 6.5) / width, 6.8 / height)
        # slender things keep room for their labels; the rest of the axes stays empty
        size = max(2.4, float(scale * width)), max(1.3, float(scale * height))
        keys, narrowest = Keys(handles, max(size[0], 4.0)), 4.2
    else:
        keys, narrowest = Keys(handles, look.inches[0] - LEFT - RIGHT), 0.0
        size = axes_in(look.inches, extent, title, keys.lines + keys_below, bars)
    return sheet_for(size, title, keys.lines + keys_below, bars, narrowest), keys


def axes_in(
    sheet: tuple[float, float | None], extent: Floats, title: str, legend_lines: int, bars: int
) -> tuple[float, float]:
    """Return width and height of the axes on a sheet of a size in inches.

    A height of None is as much as something ``extent`` (2,) m wide and high needs.
    """
    width, height = sheet
    lines = len(wrapped(title, min(width - LEFT - 0.5, 6.5), TITLE_SIZE))
    around = 0.12 + LINE * legend_lines + BELOW + 0.32 + LINE * (lines + 1)
    across = width - LEFT - RIGHT - (BAR + BAR_LABELS) * bars
    slope = extent[1] / extent[0]
    up = float(np.clip(across * slope, 1.3, 2.0 * width)) if height is None else height - around
    if up < UPRIGHT:  # the colour bar lies below
        across = width - LEFT - RIGHT
        lying = 1.3 if height is None else height - around - 0.75 * bars
        up = min(max(lying, across * slope), 0.99 * UPRIGHT) if height is None else lying
    if across < ROOM[0] or up < ROOM[1]:
        least = LEFT + RIGHT + (BAR + BAR_LABELS) * bars + ROOM[0], around + 0.75 * bars + ROOM[1]
        raise CaseError(
            f"{2.54 * width:.3g} cm x {2.54 * (height or up + around):.3g} cm are too small",
            where="size",
            remedy=f"give {2.54 * least[0] + 0.05:.1f} x {2.54 * least[1] + 0.05:.1f} cm or more",
        )
    return across, up


def sheet_for(
    axes: tuple[float, float], title: str, legend_lines: int, bars: int = 1, narrowest: float = 4.2
) -> Sheet:
    """Return a sheet with axes of a size in inches, a title, lines of legend, colour bars or 0.

    ``narrowest`` is the least that axes and colour bars are given, inches.
    """
    across, up = axes
    upright = up >= UPRIGHT
    beside = (BAR + BAR_LABELS) * bars if upright else 0.0
    width = LEFT + max(narrowest, across + beside) + RIGHT
    lines = wrapped(title, min(width - LEFT - 0.5, 6.5), TITLE_SIZE)
    under = 0.12 + LINE * legend_lines
    bottom = under + BELOW + (0.0 if upright else 0.75 * bars)
    if upright:
        tall = min(up, 4.0)
        bar = (LEFT + across + 0.2, bottom + 0.5 * (up - tall), BAR, tall)
    else:
        long = min(across, 5.0)
        bar = (LEFT + 0.5 * (across - long), under + 0.5, long, BAR)
    return Sheet(
        size=(width, bottom + up + 0.32 + LINE * (len(lines) + 1)),
        title=tuple(lines),
        axes=(LEFT, bottom, across, up),
        bar=bar,
        upright=upright,
        legend=0.12 + LINE * max(0, legend_lines - 1),
    )


def empty_part(low: Floats, high: Floats) -> CaseError:
    """Return the error for a part that shows nothing between two corners (2,), m."""
    return CaseError(
        "no block lies in this area",
        where="zoom",
        remedy=f"the blocks lie between ({low[0]:.6g}, {low[1]:.6g}) and "
        f"({high[0]:.6g}, {high[1]:.6g}) m",
    )


class Keys:
    """The legend, in as many lines as it needs below axes that are ``width`` inches wide."""

    def __init__(self, handles: list[Any], width: float) -> None:
        for handle in handles:
            label = wrapped(handle.get_label(), width + 0.5 * RIGHT - 0.33, SMALL_SIZE)
            handle.set_label("\n".join(label))
        labels = [handle.get_label().split("\n") for handle in handles]
        longest = max((len(line) for lines in labels for line in lines), default=0)
        self._handles = handles
        self._columns = max(1, int(width / (0.45 + 0.075 * longest)))
        if self._columns == 1:
            self.lines = sum(map(len, labels))
        else:
            self.lines = -(-len(handles) // self._columns)

    def draw(self, figure: Figure, sheet: Sheet) -> None:
        """Draw it at the lower end of a sheet."""
        width, height = sheet.size
        figure.legend(
            handles=self._handles,
            loc="upper left",
            bbox_to_anchor=(sheet.axes[0] / width, (sheet.legend + 0.2) / height),
            ncols=self._columns,
            **LEGEND,
            borderpad=0.0,
            borderaxespad=0.0,
            handlelength=2.0,
            columnspacing=1.6,
            labelspacing=0.5,
        )


def check_installed() -> None:
    """Raise CaseError where matplotlib is not installed."""
    try:
        import matplotlib.figure  # noqa: F401
    except ImportError as error:
        raise CaseError(
            "pictures need matplotlib, which is not installed",
            remedy="install it: pip install 'clast[plot]'",
        ) from error


def dots_for(blocks: int) -> int:
    """Return the dots per inch of a picture of so many blocks."""
    return 160 if blocks <= 500 else 220


def new_figure(size: tuple[float, float], dots: float) -> Figure:
    """Return an empty white figure of a size in inches, with dots per inch."""
    check_installed()
    from matplotlib.figure import Figure

    return Figure(figsize=size, dpi=dots, facecolor="white")


def seen(low: Floats, high: Floats, box: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return the range that axes of a size in inches show of (low, high) and around it, m."""
    middle, extent = 0.5 * (low + high), 1.04 * (high - low)
    half = 0.5 * float(np.max(extent / box)) * np.array(box)
    return middle - half, middle + half


def view(axes: Axes, low: Floats, high: Floats, box: tuple[float, float]) -> None:
    """Show (low, high) in m, as ``seen`` gives it, on axes of a size in inches."""
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel("x (m)", **TEXT)
    axes.set_ylabel("y (m)", **TEXT)
    axes.locator_params(axis="x", nbins=max(2, int(box[0] / 0.6)), steps=[1, 2, 5, 10])
    axes.locator_params(axis="y", nbins=max(2, int(box[1] / 0.4)), steps=[1, 2, 5, 10])
    style(axes)


def style(axes: Axes) -> None:
    """Draw axes thin and small, without a frame at the top and on the right."""
    axes.tick_params(
        which="both", labelsize=SMALL_SIZE, color=FAINT, labelcolor=INK, width=0.6, length=3
    )
    axes.tick_params(which="minor", length=1.5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.get_offset_text().set_fontsize(SMALL_SIZE)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_linewidth(0.6)
        spine.set_color(FAINT)
        spine.set_visible(name in ("left", "bottom"))


def label_logarithms(axes: Axes) -> None:
    """Write numbers beside axes that are logarithmic, as many as there is room for."""
    from matplotlib import ticker

    def plain(value: float, _: int) -> str:
        if not value > 0.0:  # a tick that the axis has no place for
            return ""
        if 1e-3 <= value < 1e4:
            return f"{value:g}"
        exponent = int(np.floor(np.log10(value) + 1e-9))
        return rf"${value / 10.0**exponent:g} \times 10^{{{exponent}}}$"

    for axis, scale, (low, high) in (
        (axes.xaxis, axes.get_xscale(), axes.get_xlim()),
        (axes.yaxis, axes.get_yscale(), axes.get_ylim()),
    ):
        if scale != "log":
            continue
        axis.set_minor_locator(ticker.LogLocator(subs="auto"))
        axis.set_minor_formatter(ticker.NullFormatter())
        first, last = np.log10((low, high))
        if np.floor(last) - np.ceil(first) >= 1:
            axis.set_major_formatter(ticker.LogFormatterMathtext())
            continue
        axis.set_major_formatter(ticker.FuncFormatter(plain))
        axis.set_major_locator(
            ticker.MaxNLocator(4, steps=[1, 2, 5, 10])
            if last - first < 0.7
            else ticker.LogLocator(subs=(1.0, 2.0, 5.0))
        )


def wrapped(text: str, width: float, size: float) -> list[str]:
    """Return the lines of a text that is ``width`` inches wide in type of ``size`` points."""
    return textwrap.wrap(text, max(12, letters_in(width, size))) or [""]


def letters_in(width: float, size: float) -> int:
    """Return how many letters of type of ``size`` points a line ``width`` inches wide holds."""
    return int(width * 72.0 / (0.56 * size))


def cut_to(text: str, width: float, size: float) -> str:
    """Return a text, or its beginning, that fits ``width`` inches in type of ``size`` points."""
    most = max(6, letters_in(width, size))
    return text if len(text) <= most else text[: most - 1] + "…"


def literal(text: str) -> str:
    """Return a text of the user's such that matplotlib takes no part of it for a formula."""
    return text.replace("$", r"\$")


def head(figure: Figure, left: float, lines: Sequence[str], below: str) -> None:
    """Write the lines of a title at the top of a figure, and a line in small type below it."""
    width, height = figure.get_size_inches()
    bold: dict[str, Any] = {"fontsize": TITLE_SIZE, "fontweight": "bold", "color": INK}
    for number, line in enumerate((*map(literal, lines), below)):
        up = height - 0.1 - LINE * (number + 0.5)
        looks = bold if number < len(lines) else TEXT
        figure.text(left / width, up / height, line, va="center", **looks)


def write(axes: Axes, text: str, at: Any, zorder: float, **words: Any) -> None:
    """Write small text about a point (2,), m, readable on anything; ``words`` as for matplotlib."""
    looks = {**SMALL, "ha": "center", "va": "center", "bbox": NAME_BOX, **words}
    axes.annotate(text, (float(at[0]), float(at[1])), zorder=zorder, **looks)


def colour_bar(
    figure: Figure,
    drawn: Any,
    box: tuple[float, float, float, float],
    label: str,
    extend: str,
    orientation: str = "horizontal",
) -> Any:
    """Explain in a box, in parts of the figure, how artists are coloured; return the bar."""
    bar = figure.colorbar(drawn, cax=figure.add_axes(box), orientation=orientation, extend=extend)
    bar.set_label(label, **TEXT)
    bar.ax.tick_params(labelsize=SMALL_SIZE, color=FAINT, labelcolor=INK, width=0.6, length=3)
    bar.outline.set(linewidth=0.5, edgecolor=FAINT)
    return bar


def save(figure: Figure, path: Path) -> Path:
    """Write a figure in the format that the name's ending says; return the path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    formats = sorted(FigureCanvasAgg(figure).get_supported_filetypes())
    if path.suffix.lower() in FILMS:
        what = f"a picture is not written as '{path.suffix}', the ending of a film"
        raise CaseError(what, where=str(path), remedy=f"clast film FILE {path} writes films")
    if path.suffix.lower().lstrip(".") not in formats:
        raise CaseError(
            f"pictures cannot be written as '{path.suffix or path.name}'",
            where=str(path),
            remedy=f"end the name in one of: {', '.join('.' + name for name in formats)}",
        )
    try:
        figure.savefig(path)
    except OSError as error:
        raise CaseError(
            f"the picture cannot be written: {error.strerror}",
            where=str(path),
            remedy="name a file in a directory that exists and may be written",
        ) from error
    return path
