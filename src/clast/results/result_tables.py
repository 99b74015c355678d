"""Tables of results: as they grow while a run goes, and as they are read.

Tables have columns of equal length by name, as pandas and polars take them::

    pandas.DataFrame(run.history("A"))
    pandas.DataFrame(run.energy)
    pandas.DataFrame(run.bolts(-1))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast import spelling, thumbnails
from clast.errors import CaseError
from clast.model.arrays import connected, following, no_floats, no_ints
from clast.model.model import Floats, Ints
from clast.results.schema import (
    BOLT_STATES,
    BOLT_TABLE,
    CHANNEL_TABLE,
    CONTACTS,
    HISTORY,
    LINING_STATES,
    LINING_TABLE,
    PLANE,
    TABLES,
    TENSOR,
    TableSchema,
)

PARTS = {len(parts): parts for parts in (PLANE, TENSOR)}
"""Names of the columns of vectors and of stresses, by their number."""


FIRST_ROWS, MORE_ROWS = 256, 2048
"""Rows of the first buffer of a table, and of the others."""


class GrowingTable:
    """Rows of one kind, in buffers one behind the other: a long run has none that are copied."""

    def __init__(self, row: np.dtype[Any]) -> None:
        self._full: list[NDArray[Any]] = []
        self._before = 0
        self._buffer = np.zeros(FIRST_ROWS, row)
        self._count = 0

    def append(self, row: tuple[Any, ...]) -> None:
        """Add one row, its entries in the order of the columns."""
        if self._count == len(self._buffer):
            self._put_by(self._buffer)
        self._buffer[self._count] = row
        self._count += 1

    def extend(self, rows: NDArray[Any]) -> None:
        """Add rows as another table gave them."""
        self._put_by(self._buffer[: self._count])
        self._full.append(np.array(rows, self._buffer.dtype))
        self._before += len(rows)

    def since(self, first: int) -> NDArray[Any]:
        """Return the rows from ``first`` on, shape (t - first,)."""
        if first >= self._before:
            return self._buffer[first - self._before : self._count]
        return self.rows[first:]

    @property
    def rows(self) -> NDArray[Any]:
        """All rows so far, shape (t,): one buffer from then on, for none to be kept twice."""
        if not self._full:
            return self._buffer[: self._count]
        if self._count or len(self._full) > 1:
            self._put_by(self._buffer[: self._count])
            self._full = [np.concatenate(self._full)]
        return self._full[0]

    def __len__(self) -> int:
        return self._before + self._count

    def _put_by(self, rows: NDArray[Any]) -> None:
        """Keep rows, and go on with a new buffer."""
        self._full.append(rows)
        self._before += len(rows)
        self._buffer, self._count = np.zeros(MORE_ROWS, self._buffer.dtype), 0


class Columns(dict[str, NDArray[Any]]):
    """A table: column name -> array (rows,).  Iterating gives the names, ``len`` the rows.

    Columns, and vectors of which there are columns, are attributes as well, of shape (rows,) or
    (rows, parts).  The schema has their units and meanings (docs/reference/result-file.md).
    """

    def __init__(self, rows: NDArray[Any], schema: TableSchema | None = None, of: str = "") -> None:
        super().__init__()
        self.rows = rows
        self._schema = schema.name if schema else ""  # tables are sent to other processes
        self.of = of
        """Name of its point, bolt, ...; "" for a table of the run."""
        names = {one.name: one.names for one in schema.columns} if schema else {}
        for name in rows.dtype.names or ():
            values = rows[name]
            if values.ndim == 1:
                self[name] = values
                continue
            parts = [f"{name}_{part}" for part in PARTS[values.shape[1]]]
            self.update(zip(names.get(name, parts), values.T, strict=True))

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("__"):  # asked by copy, pickle, numpy
            raise AttributeError(name)
        try:
            return self[name]
        except CaseError as error:
            raise AttributeError(str(error)) from None

    def __missing__(self, name: str) -> NDArray[Any]:
        rows = self.__dict__.get("rows")
        vectors = () if rows is None else rows.dtype.names or ()
        if rows is None or name not in vectors:
            known = [*self, *(one for one in vectors if one not in self)]
            remedy = spelling.advice(str(name), known, kind="column")
            raise CaseError(f"{type(self).__name__} has no column '{name}'", remedy=remedy)
        column: NDArray[Any] = rows[name]
        return column

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self)} rows: {', '.join(self)})"

    @property
    def schema(self) -> TableSchema | None:
        """The table of the schema that it is; None for one that is put together from others."""
        return next((one for one in (*TABLES, CHANNEL_TABLE) if one.name == self._schema), None)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column that has one."""
        return self.schema.units if self.schema else {}

    @property
    def drawn(self) -> tuple[str, ...]:
        """Columns that a notebook draws over time."""
        return self.schema.drawn if self.schema else ()

    def in_words(self) -> dict[str, NDArray[Any]]:
        """Return the columns, with words in place of numbers that have them: states and modes."""
        words = self.schema.words if self.schema else {}
        return {
            name: np.asarray(words[name], object)[values] if name in words else values
            for name, values in self.items()
        }

    def _title(self) -> str:
        if self.schema is None:
            return type(self).__name__
        kind = self.schema.of.meaning if self.schema.of else self.schema.name
        return f"{kind[0].upper()}{kind[1:]} {self.of}".strip()

    def _repr_html_(self) -> str:
        units = self.units
        heads = {name: f"{name} ({units[name]})" if units.get(name) else name for name in self}
        lines = {heads[name]: self[name] for name in self.drawn if name in self}
        drawing = thumbnails.curves(self["time"], lines) if lines else ""
        shown = {heads[name]: values for name, values in self.in_words().items()}
        title = thumbnails.side_by_side(self._title(), drawing, [("rows", len(self))])
        return title + thumbnails.table(shown)


class PointHistory(Columns):
    """How one measured point moved, a row at the start and after every step; t rows."""

    time: Floats
    displacement: Floats
    velocity: Floats
    rotation: Floats


class BlockHistory(PointHistory):
    """How one block moved, its centroid being the point, a row per frame; t rows.

    It has the columns of a measured point, and the stress (xx, yy, xy), Pa, tension positive.
    """

    stress: Floats

    def __init__(
        self,
        rows: NDArray[Any],
        name: str,
        number: int,
        vertices: Floats,
        stage: tuple[str, ...] = (),
    ) -> None:
        super().__init__(rows)
        self.stage = stage
        """Name of the stage of each row; empty where the run has no stages."""
        self.name = name
        self.number = number
        """Its index among the blocks, from 0."""
        self.vertices = vertices
        """Its vertices, m, shape (t, k, 2)."""

    @property
    def drawn(self) -> tuple[str, ...]:
        """Columns that a notebook draws over time."""
        return HISTORY.drawn

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column."""
        return {**HISTORY.units, **{f"stress_{part}": "Pa" for part in TENSOR}}

    def _title(self) -> str:
        return f"Block {self.name}"

    def __repr__(self) -> str:
        return f"BlockHistory('{self.name}', {len(self)} rows: {', '.join(self)})"


class BoltHistory(Columns):
    """The force of one bolt, a row at the start and after every step; t rows.

    A grouted bolt has the force and the elongation of the joint where it carries most.
    """

    time: Floats
    force: Floats
    elongation: Floats
    state: Ints

    @property
    def state_name(self) -> str:
        """The last state in words."""
        return BOLT_STATES[int(self.state[-1])]


class ContactHistory(Columns):
    """History of a measured contact, a row after every step; t rows."""

    time: Floats
    normal: Floats
    shear: Floats
    opening: Floats
    slip: Floats
    sliding: Floats


class ConvergenceHistory(Columns):
    """Approach of two measured points, m, a row at the start and after every step; t rows."""

    time: Floats
    convergence: Floats


class FlowHistory(Columns):
    """Water at a boundary, well or opening, a row at the start and after every step; t rows."""

    time: Floats
    into_rock: Floats
    out_of_rock: Floats

    @property
    def inflow(self) -> Floats:
        """Flow out of the rock less flow into it, m2/s, (t,): into an opening."""
        return np.asarray(self["out_of_rock"] - self["into_rock"])


class ReactionHistory(Columns):
    """Reaction of a support, a row at the start, which is zero, and after every step; t rows."""

    time: Floats
    force: Floats
    moment: Floats
    position: Floats


@dataclass(frozen=True, repr=False)
class LiningHistory:
    """Forces and moments along a lining of k joints, at the start and after every step; t rows.

    ``normal_force``, ``shear_force``, ``moment``, ``utilisation`` and ``state`` have shape (t, k).
    N is positive in tension, Q is the force to the left on the part before a joint, M is positive
    where it stretches the left face: that of the opening, seen counter-clockwise.
    """

    along: Floats
    """Where the joints are along the middle of the lining, m, shape (k,)."""
    face: Ints
    """Vertices beside each of them, outside and inside, shape (k, 2)."""
    section: Floats
    """Thickness, m, tensile and compressive strength, Pa, infinite for none, shape (k, 3)."""
    rows: list[NDArray[Any]]

    def __repr__(self) -> str:
        return f"LiningHistory({len(self.along)} joints, {len(self.time)} rows)"

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return np.asarray(self.rows[0]["time"])

    def __getattr__(self, name: str) -> NDArray[Any]:
        """Return a column of all joints, shape (t, k)."""
        if name not in (LINING_TABLE.row.names or ()):
            raise AttributeError(f"LiningHistory has no column '{name}'")
        return np.stack([rows[name] for rows in self.rows], axis=1)

    def _repr_html_(self) -> str:
        last = {"along (m)": self.along}
        for one in LINING_TABLE.columns[:-1]:
            last[f"{one.name} ({one.unit})" if one.unit else one.name] = getattr(self, one.name)[-1]
        last["state"] = np.asarray(LINING_STATES, object)[self.state[-1]]
        ends = {"largest normal_force": np.max, "smallest": np.min}
        lines = {f"{name} (N/m)": end(self.normal_force, axis=1) for name, end in ends.items()}
        rows = [("joints", len(self.along)), ("rows", len(self.time))]
        drawing = thumbnails.curves(self.time, lines)
        return thumbnails.side_by_side("Lining, table of the last instant", drawing, rows) + (
            thumbnails.table(last)
        )


BOLT_OF_FRAME = np.dtype([("name", "O"), *BOLT_TABLE.row.descr[1:]])


class FrameBolts(Columns):
    """The k bolts of one frame, a row each, and the q points that they lie along."""

    force: Floats
    elongation: Floats
    state: Ints

    def __init__(self, name: tuple[str, ...], points: Floats, bolt: Ints, row: Any) -> None:
        rows = np.zeros(len(name), BOLT_OF_FRAME)
        rows["name"] = name
        for column in BOLT_TABLE.columns if name else ():
            rows[column.name] = row[column.name]
        super().__init__(rows, BOLT_TABLE)
        self.points = points
        """Points from head to toe of one bolt after the other, m, shape (q, 2)."""
        self.bolt = bolt
        """Bolt of each point, shape (q,)."""

    @property
    def name(self) -> tuple[str, ...]:
        """Name of each bolt."""
        return tuple(self["name"])

    @property
    def drawn(self) -> tuple[str, ...]:
        """No columns: these are the bolts of one instant."""
        return ()

    def _title(self) -> str:
        return "Bolts"

    def __repr__(self) -> str:
        counts = np.bincount(self.state, minlength=len(BOLT_STATES))
        counted = [f"{n} {name}" for n, name in zip(counts, BOLT_STATES, strict=True) if n]
        return f"FrameBolts({len(self)}: {', '.join(counted)})"


class FrameContacts(Columns):
    """The contacts of one frame that carry a force, a row each; m rows.

    A shear force acts on the vertex along the direction of the edge.  Slip is positive where the
    block of the vertex has moved to the left as seen from the block of the edge; it has the same
    sign seen from the other block.
    """

    position: Floats
    normal: Floats
    normal_force: Floats
    shear_force: Floats
    vertex: Ints
    edge: Ints
    mode: Ints
    joint: Ints
    opening: Floats
    slip: Floats
    worn: Floats
    strength: Floats

    def __init__(self, rows: NDArray[Any], block_start: Ints) -> None:
        super().__init__(rows, CONTACTS)
        for end in ("vertex", "edge"):
            self[f"{end}_block"] = np.searchsorted(block_start, self[end], side="right") - 1

    @property
    def vertex_block(self) -> Ints:
        """Block of the vertex: its index, shape (m,)."""
        return self["vertex_block"]

    @property
    def edge_block(self) -> Ints:
        """Block of the edge: its index, shape (m,)."""
        return self["edge_block"]

    @property
    def force(self) -> Floats:
        """Force on the invading vertex's block, N/m, shape (m, 2)."""
        # Polygons run counter-clockwise: the edge's direction is its outward normal turned left.
        along = np.column_stack([-self.normal[:, 1], self.normal[:, 0]])
        return np.asarray(
            self.normal_force[:, None] * self.normal + self.shear_force[:, None] * along
        )

    def __repr__(self) -> str:
        total = float(self.normal_force.sum()) if len(self) else 0.0
        return f"FrameContacts({len(self)} rows, normal forces {total:.4g} N/m: {', '.join(self)})"


@dataclass(frozen=True, kw_only=True)
class Channels:
    """Channels of water of a model, k of them."""

    edge: Ints = no_ints(2)
    """Edges on either side, shape (k, 2)."""
    share: Floats = no_floats(2, 2)
    """Where either edge (k, face) has its ends, as the first one runs, shape (k, 2, 2)."""
    node: Ints = no_ints(2)
    """Nodes at the ends, shape (k, 2)."""
    place: Floats = no_floats(2)
    """Middle of each boundary, opening or well by the number of its name, m; NaN without one."""
    line: Floats = no_floats(2, 2)
    """Lines of boundaries whose head presses on them, m, shape (s, 2, 2)."""
    of_line: Ints = no_ints()
    """Boundary of each of them, by the number of its name, shape (s,)."""
    weight: float = 0.0
    """Weight of water, N/m3; 0 without gravity."""


class FrameFlow(Columns):
    """The water of one frame in channels that are not excavated, a row each; k rows."""

    start: Floats
    end: Floats
    pressure: Floats
    saturation: Floats
    aperture: Floats
    flow: Floats
    wet: Floats
    first_node: Ints
    last_node: Ints
    left: Ints
    right: Ints

    def __init__(
        self, channels: Channels, values: Floats, vertices: Floats, block_start: Ints
    ) -> None:
        there = values[:, 4] > 0.0
        edge, share, values = channels.edge[there], channels.share[there], values[there]
        self.edge = edge
        """Edges on either side by their first vertices, shape (k, 2)."""
        rows = np.zeros(len(edge), CHANNEL_TABLE.row)
        first, last = vertices[edge], vertices[following(block_start)[edge]]
        faces = first[:, :, None] + share[..., None] * (last - first)[:, :, None]
        ends = faces.mean(axis=1)
        rows["start"], rows["end"] = ends[:, 0], ends[:, 1]
        for name, at in {"pressure": 0, "saturation": 2, "aperture": 4}.items():
            rows[name] = values[:, at : at + 2]
        rows["flow"], rows["wet"] = values[:, 6], values[:, 7]
        rows["first_node"], rows["last_node"] = channels.node[there].T
        owner = np.searchsorted(block_start, edge, side="right") - 1
        rows["left"], rows["right"] = owner.T
        super().__init__(rows, CHANNEL_TABLE)

    @property
    def water_table(self) -> tuple[Floats, ...]:
        """Lines through the points of channels with no pressure, m, (c, 2) each, x rising.

        There is one for each connected part of the joints under pressure; walls of openings and
        drains below water are not in it.
        """
        wet = np.flatnonzero(self["wet"] > 0.0)
        node = np.stack([self["first_node"], self["last_node"]], axis=1)[wet]
        if not len(wet):
            return ()
        pressed = self.rows["pressure"][wet] > 0.0
        part = connected(node[:, 0], node[:, 1], int(node.max()) + 1)[node[:, 0]]
        wholly = self["wet"][wet] >= 1.0
        cut = np.flatnonzero(~pressed.all(axis=1) | ~wholly)
        side = pressed[cut, 1].astype(np.int64)
        ends = np.stack([self.rows["start"], self.rows["end"]], axis=1)[wet[cut]]
        row = np.arange(len(cut))
        below, above = ends[row, side], ends[row, 1 - side]
        at = below + self["wet"][wet[cut], None] * (above - below)
        kept = ~self._under_water(at)
        at, cut = at[kept], cut[kept]
        lines = []
        for one in np.unique(part[cut]):
            points = np.unique(at[part[cut] == one], axis=0)
            lines.append(points)
        return tuple(lines)

    def _under_water(self, at: Floats) -> Any:
        """Return which points (c, 2), m, have joints under pressure above them, shape (c,)."""
        pressed = self.rows["pressure"].any(axis=1) & (self["wet"] >= 1.0)
        first, last = self.rows["start"][pressed], self.rows["end"][pressed]
        low, high = np.minimum(first[:, 0], last[:, 0]), np.maximum(first[:, 0], last[:, 0])
        across = last - first
        upright = high - low <= 1e-6 * np.abs(across[:, 1])
        slope = np.where(upright, 0.0, across[:, 1] / np.where(upright, 1.0, across[:, 0]))
        near = 1e-6 * np.hypot(*across.T)
        under = np.zeros(len(at), np.bool_)
        for number, (x, y) in enumerate(at):
            there = (low <= x) & (x <= high) & ~upright
            height = first[:, 1] + slope * (x - first[:, 0])
            under[number] = (there & (height > y + near)).any()
        return under

    def force_on(self, block: int) -> Floats:
        """Return the resultant of the water in joints on a block (x, y), N/m, (2,).

        That of pressures normal to the channels, on either face alike; outer faces are not in it.
        """
        along = self.rows["end"] - self.rows["start"]
        push = 0.5 * self["wet"] * self.rows["pressure"].sum(axis=1)
        leftward = push[:, None] * np.stack([-along[:, 1], along[:, 0]], axis=1)
        left, right = self["left"] == block, self["right"] == block
        return np.asarray(leftward[left].sum(axis=0) - leftward[right].sum(axis=0))

    def __repr__(self) -> str:
        most = float(self.rows["pressure"].max(initial=0.0))
        return f"FrameFlow({len(self)} channels, up to {most:.4g} Pa)"


def no_contacts() -> NDArray[Any]:
    """Return the rows of a frame without contacts."""
    return np.zeros(0, CONTACTS.row)
