"""Tables of results: as they grow while a run goes, and as they are read.

Tables have columns of equal length by name, as pandas and polars take them::

    pandas.DataFrame(run.history("A"))
    pandas.DataFrame(run.energy)
    pandas.DataFrame(run.bolts(-1))
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast import thumbnails
from clast.errors import CaseError
from clast.model.model import Floats, Ints
from clast.results.schema import (
    BOLT_STATES,
    BOLT_TABLE,
    CONTACTS,
    HISTORY,
    LINING_STATES,
    LINING_TABLE,
    PLANE,
    SLIP,
    STRENGTH,
    TABLES,
    TENSOR,
    WORN,
    TableSchema,
)

PARTS = {len(parts): parts for parts in (PLANE, TENSOR)}
"""Names of the columns of vectors and of stresses, by their number."""


FIRST_ROWS, MORE_ROWS = 256, 2048
"""Rows of the first buffer of a table, and of the others."""


def as_rows(rows: NDArray[Any], kind: np.dtype[Any]) -> NDArray[Any]:
    """Return rows with the columns of ``kind``; NaN where an earlier clast wrote none."""
    if rows.dtype.names == kind.names:
        return np.array(rows, kind)
    found = np.zeros(len(rows), kind)
    for name in kind.names or ():
        found[name] = rows[name] if name in (rows.dtype.names or ()) else math.nan
    return found


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
        self._full.append(as_rows(rows, self._buffer.dtype))
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
    """A table: column name -> array (rows,).  Iterating gives the names, ``len`` the rows."""

    def __init__(self, rows: NDArray[Any], schema: TableSchema | None = None, of: str = "") -> None:
        super().__init__()
        self.rows = rows
        self._schema = schema.name if schema else ""  # tables are sent to other processes
        self.of = of
        """Name of the point, bolt, ... that it tells of, "" for one of the run."""
        names = {one.name: one.names for one in schema.columns} if schema else {}
        for name in rows.dtype.names or ():
            values = rows[name]
            if values.ndim == 1:
                self[name] = values
                continue
            parts = [f"{name}_{part}" for part in PARTS[values.shape[1]]]
            self.update(zip(names.get(name, parts), values.T, strict=True))

    def __getattr__(self, name: str) -> NDArray[Any]:
        """Return a column, or a vector of which there are columns, (rows,) or (rows, parts)."""
        rows = self.__dict__.get("rows")
        if rows is None or name not in (rows.dtype.names or ()):
            raise AttributeError(f"{type(self).__name__} has no column '{name}'")
        found: NDArray[Any] = rows[name]
        return found

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self)} rows: {', '.join(self)})"

    @property
    def schema(self) -> TableSchema | None:
        """The table of the schema that it is; None for one that is put together from others."""
        return next((one for one in TABLES if one.name == self._schema), None)

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


class MotionTable(Columns):
    """How a point moved, a row per instant; t rows."""

    @property
    def drawn(self) -> tuple[str, ...]:
        """Columns that a notebook draws over time."""
        return HISTORY.drawn

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return self.rows["time"]

    @property
    def displacement(self) -> Floats:
        """Displacement (x, y) since the start, or since a stage has reset it, m, shape (t, 2)."""
        return self.rows["displacement"]

    @property
    def velocity(self) -> Floats:
        """Velocity (x, y), m/s, shape (t, 2)."""
        return self.rows["velocity"]

    @property
    def rotation(self) -> Floats:
        """Rotation of its block since then, rad, counter-clockwise, shape (t,)."""
        return self.rows["rotation"]


class PointHistory(MotionTable):
    """How one measured point moved, a row at the start and after every step; t rows.

    Columns: time, displacement_x, displacement_y, velocity_x, velocity_y, rotation.
    """


class BlockHistory(MotionTable):
    """How one block moved, its centroid being the point, a row per frame; t rows.

    Columns: time, displacement_x, displacement_y, velocity_x, velocity_y, rotation, stress_xx,
    stress_yy, stress_xy.
    """

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
        """Its name."""
        self.number = number
        """Its index among the blocks, from 0."""
        self.vertices = vertices
        """Its vertices, m, shape (t, k, 2)."""

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column."""
        return {**HISTORY.units, **{f"stress_{part}": "Pa" for part in TENSOR}}

    def _title(self) -> str:
        return f"Block {self.name}"

    @property
    def stress(self) -> Floats:
        """Stress (xx, yy, xy), Pa, tension positive, shape (t, 3)."""
        return self.rows["stress"]

    def __repr__(self) -> str:
        return f"BlockHistory('{self.name}', {len(self)} rows: {', '.join(self)})"


class BoltHistory(Columns):
    """The force of one bolt, a row at the start and after every step; t rows.

    Columns: time, force, elongation, state.  A grouted bolt has the force and the elongation of the
    joint where it carries most.
    """

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return self.rows["time"]

    @property
    def force(self) -> Floats:
        """Force, N/m, tension positive, shape (t,)."""
        return self.rows["force"]

    @property
    def elongation(self) -> Floats:
        """Elongation since the state without force at its installation, m, shape (t,)."""
        return self.rows["elongation"]

    @property
    def state(self) -> Ints:
        """0 not installed, 1 intact, 2 yielded, 3 broken, 4 lost with its block, shape (t,)."""
        return self.rows["state"]

    @property
    def state_name(self) -> str:
        """The last state in words."""
        return BOLT_STATES[int(self.state[-1])]


@dataclass(frozen=True, repr=False)
class LiningHistory:
    """Forces and moments along a lining of k joints, at the start and after every step; t rows.

    N is positive in tension, Q is the force to the left on what lies before a joint, M is positive
    where it stretches the left face: that of the opening, seen counter-clockwise.
    """

    along: Floats
    """Where the joints are along the middle of the lining, m, shape (k,)."""
    face: Ints
    """Vertices beside each of them, outside and inside, shape (k, 2)."""
    section: Floats
    """Thickness, m, tensile and compressive strength, Pa, infinite for none, of each, shape (k, 3);
    (0, 3) where an earlier clast wrote the results."""
    rows: list[NDArray[Any]]
    """The rows of each joint."""

    def __repr__(self) -> str:
        return f"LiningHistory({len(self.along)} joints, {len(self.time)} rows)"

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return np.asarray(self.rows[0]["time"])

    @property
    def normal_force(self) -> Floats:
        """Normal force N, N/m, shape (t, k)."""
        return self._of("normal_force")

    @property
    def shear_force(self) -> Floats:
        """Shear force Q, N/m, shape (t, k)."""
        return self._of("shear_force")

    @property
    def moment(self) -> Floats:
        """Moment M, N (N m per m), shape (t, k)."""
        return self._of("moment")

    @property
    def utilisation(self) -> Floats:
        """Share of the strength of the section that is used, NaN without strengths, (t, k)."""
        return self._of("utilisation")

    @property
    def state(self) -> Ints:
        """0 not installed, 1 intact, 2 cracked, 3 yielded, 4 lost, shape (t, k)."""
        return self._of("state")

    def _of(self, name: str) -> NDArray[Any]:
        return np.stack([rows[name] for rows in self.rows], axis=1)

    def _repr_html_(self) -> str:
        units = LINING_TABLE.units
        names = ("normal_force", "shear_force", "moment", "utilisation")
        last = {"along (m)": self.along}
        for name in names:
            last[f"{name} ({units[name]})" if units[name] else name] = self._of(name)[-1]
        last["state"] = np.asarray(LINING_STATES, object)[self.state[-1]]
        normal = self.normal_force
        lines = {
            "largest normal_force (N/m)": normal.max(axis=1),
            "smallest (N/m)": normal.min(axis=1),
        }
        rows = [("joints", len(self.along)), ("rows", len(self.time))]
        drawing = thumbnails.curves(self.time, lines)
        return thumbnails.side_by_side("Lining, table of the last instant", drawing, rows) + (
            thumbnails.table(last)
        )


class ContactHistory(Columns):
    """History of a measured contact, a row after every step; t rows.

    Columns: time, normal, shear (Pa), opening, opening_least, opening_most, slip, slip_least,
    slip_most (m; NaN while there is no contact), sliding (share of the length).
    """

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return self.rows["time"]


class ReactionHistory(Columns):
    """Reaction of a support, a row at the start and after every step; t rows.

    Columns: time, force, moment, position.  The first row is zero: nothing is borne yet.
    """

    @property
    def time(self) -> Floats:
        """Time, s, shape (t,)."""
        return self.rows["time"]

    @property
    def force(self) -> Floats:
        """Force (x, y) of the support on the blocks, mean of the step, N/m, shape (t, 2)."""
        return self.rows["force"]

    @property
    def moment(self) -> Floats:
        """Its moment about the point of the reaction, N, counter-clockwise, shape (t,)."""
        return self.rows["moment"]

    @property
    def position(self) -> Floats:
        """Point of its line of action nearest to that point, m, shape (t, 2); NaN: no force."""
        return self.rows["position"]


BOLT_OF_FRAME = np.dtype([("name", "O"), *BOLT_TABLE.row.descr[1:]])
"""One bolt of one frame."""


class FrameBolts(Columns):
    """The k bolts of one frame, a row each, and the q points that they lie along.

    Columns: name, force, elongation, state.
    """

    def __init__(
        self,
        *,
        name: tuple[str, ...],
        points: Floats,
        bolt: Ints,
        force: Floats,
        elongation: Floats,
        state: Ints,
    ) -> None:
        rows = np.zeros(len(name), BOLT_OF_FRAME)
        columns = {"name": name, "force": force, "elongation": elongation, "state": state}
        for key, values in columns.items():
            rows[key] = values
        super().__init__(rows)
        self.points = points
        """Points from head to toe of one bolt after the other, m, shape (q, 2)."""
        self.bolt = bolt
        """Bolt of each point, shape (q,)."""

    @property
    def name(self) -> tuple[str, ...]:
        """Name of each bolt."""
        return tuple(self["name"])

    @property
    def force(self) -> Floats:
        """Force of each bolt, N/m, tension positive, shape (k,)."""
        return self["force"]

    @property
    def elongation(self) -> Floats:
        """Elongation of each bolt, m, shape (k,)."""
        return self["elongation"]

    @property
    def state(self) -> Ints:
        """State of each bolt, as in BoltHistory, shape (k,)."""
        return self["state"]

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column that has one."""
        return BOLT_TABLE.units

    def in_words(self) -> dict[str, NDArray[Any]]:
        """Return the columns, with states in words."""
        return {**self, "state": np.asarray(BOLT_STATES, object)[self.state]}

    def _title(self) -> str:
        return "Bolts"

    def __repr__(self) -> str:
        counts = np.bincount(self.state, minlength=len(BOLT_STATES))
        said = [f"{n} {what}" for n, what in zip(counts, BOLT_STATES, strict=True) if n]
        return f"FrameBolts({len(self)}: {', '.join(said)})"


class FrameContacts(Columns):
    """The contacts of one frame that carry a force, a row each; m rows.

    Columns: position_x, position_y, normal_x, normal_y, normal_force, shear_force, vertex, edge,
    mode, joint, opening, slip, worn, strength, vertex_block, edge_block.
    """

    def __init__(self, rows: NDArray[Any], block_start: Ints) -> None:
        super().__init__(rows, CONTACTS)
        for end in ("vertex", "edge"):
            self[f"{end}_block"] = np.searchsorted(block_start, self[end], side="right") - 1

    @property
    def position(self) -> Floats:
        """Invading vertex, m, shape (m, 2)."""
        return self.rows["position"]

    @property
    def normal(self) -> Floats:
        """Outward unit normal of the edge, shape (m, 2)."""
        return self.rows["normal"]

    @property
    def normal_force(self) -> Floats:
        """Normal force, N/m, compression positive, shape (m,)."""
        return self.rows["normal_force"]

    @property
    def shear_force(self) -> Floats:
        """Shear force on the vertex along the edge's direction, N/m, shape (m,)."""
        return self.rows["shear_force"]

    @property
    def vertex(self) -> Ints:
        """Invading vertex, shape (m,)."""
        return self.rows["vertex"]

    @property
    def edge(self) -> Ints:
        """Entrance edge: index of its first vertex, shape (m,)."""
        return self.rows["edge"]

    @property
    def mode(self) -> Ints:
        """0 open, 1 slide, 2 lock, shape (m,)."""
        return self.rows["mode"]

    @property
    def joint(self) -> Ints:
        """Joint that the contact lies along: index into ``joint_name`` of the run, shape (m,).

        Raises CaseError where an earlier clast recorded the contacts, which did not keep it.
        """
        if "joint" not in self:
            raise no_joints()
        return self.rows["joint"]

    @property
    def opening(self) -> Floats:
        """Gap, m, negative where the contact is pressed, shape (m,).

        Raises CaseError where an earlier clast recorded the contacts, which did not keep it.
        """
        return self._since("opening", SLIP)

    @property
    def slip(self) -> Floats:
        """Slip since the contact was made, m, shape (m,).

        Positive where the vertex's block has moved to the left as seen from the block of the edge;
        it has the same sign seen from the other block.  Raises CaseError as ``opening`` does.
        """
        return self._since("slip", SLIP)

    @property
    def worn(self) -> Floats:
        """Share of the strength lost, 0 at the peak, 1 at the residual one, shape (m,).

        Raises CaseError as ``opening`` does.
        """
        return self._since("worn", WORN)

    @property
    def strength(self) -> Floats:
        """Shear strength N tan(phi) + c L in the last step, N/m, shape (m,).

        Raises CaseError as ``opening`` does.
        """
        return self._since("strength", STRENGTH)

    def _since(self, name: str, what: str) -> Floats:
        if name not in self:
            raise CaseError(
                f"these results are from an older version of clast, without {what}",
                remedy="run the case again",
            )
        return self.rows[name]

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
        forces: Floats = (
            self.normal_force[:, None] * self.normal + self.shear_force[:, None] * along
        )
        return forces

    def __repr__(self) -> str:
        total = float(self.normal_force.sum()) if len(self) else 0.0
        return f"FrameContacts({len(self)} rows, normal forces {total:.4g} N/m: {', '.join(self)})"


def no_joints(where: str = "") -> CaseError:
    """Return the error for results without the joints of edges and contacts."""
    return CaseError(
        "these results are from an older version of clast, without the joints of edges and "
        "contacts",
        where=where,
        remedy="run the case again",
    )


def no_contacts() -> NDArray[Any]:
    """Return the rows of a frame without contacts."""
    return np.zeros(0, CONTACTS.row)
