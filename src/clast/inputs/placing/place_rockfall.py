"""From [rockfall] and its tables to the ground and all that falls on it: places, checks, names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path

import numpy as np

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.declaring import text as case_text
from clast.inputs.rockfall import (
    BarrierTable,
    CollectorTable,
    RockfallTable,
    SourceTable,
    Surface,
)
from clast.model import ranges
from clast.model.model import Bools, Floats, Model
from clast.trajectory.campaign import Campaign
from clast.trajectory.ground import Face, Ground, ground_of, height_below
from clast.trajectory.rock import moments
from clast.trajectory.standing import SEAM, Blocks, Line, air_lines

WIDEST = 1e5
"""Largest profile, m: on a larger one, round-off is no longer small beside a rock."""
SOURCE = "give one: name, at = [x, y], rocks = 1000, volume = 0.5"


@dataclass(frozen=True, kw_only=True)
class RockfallInputs:
    """The tables of a case about rockfall."""

    table: RockfallTable
    surfaces: Mapping[str, Surface]
    sources: Sequence[SourceTable]
    barriers: Sequence[BarrierTable]
    collectors: Sequence[CollectorTable]
    blocks: Blocks | None
    """Blocks of the case, where it has some."""
    gravity: tuple[float, float]
    folder: Path

    def campaign(self) -> Campaign:
        """Return the profile and all that falls on it; raises ModelError with the remedy."""
        profile, names = self.table.line(self.folder)
        standing, moving = self._blocks()
        if standing is None and profile is None:
            what, remedy = "has neither profile nor file", "give points [[x, y], ...]"
            raise ModelError(what, where="[rockfall]", remedy=f"{remedy}, or blocks to fall on")
        lines = lines_of(profile, standing)
        named = [surfaces_of(one, names, standing) for one in lines]
        points = lines[0].points
        self._check(points, named)
        origin = 0.5 * (points.min(axis=0) + points.max(axis=0))
        lines = [Line(points=one.points - origin, owner=one.owner) for one in lines]
        decks = [one.decks() for one in self.surfaces.values()]
        known = {name: number for number, name in enumerate(self.surfaces)}
        faces = [
            Face(points=one.points, surface=[known[name] for name in names])
            for one, names in zip(lines, named, strict=True)
        ]
        bare = ground_of(faces[0], faces[1:], np.array(decks), np.empty(0), np.empty(0))
        self._check_heights(bare, origin)
        walls = [self._wall(one, bare, origin) for one in self.barriers]
        for number, (foot, end) in enumerate(walls):
            surface = len(decks)
            decks.append(self.barriers[number].wall.decks())
            points = np.array([foot, end, foot])
            faces.append(Face(points=points, surface=[surface] * 2, barrier=number))
        places = self._stations(lines[0].points, origin)
        capacity = [one.capacity or np.inf for one in self.barriers]
        owner = np.concatenate([*(one.owner for one in lines), np.full(2 * len(walls), -1)])
        stations = np.array([x for x, _ in places])
        return Campaign(
            ground=ground_of(faces[0], faces[1:], np.array(decks), np.array(capacity), stations),
            origin=origin,
            profile=lines[0].points,
            surfaces=(*self.surfaces, *(one.name for one in self.barriers)),
            barriers=tuple(one.name for one in self.barriers),
            barrier_lines=np.array(walls).reshape(-1, 2, 2),
            stations=tuple(name for _, name in places),
            blocks=None if standing is None else standing.about(origin),
            face_block=np.maximum(owner, -1),
            sources=tuple(
                one.source(origin, None if one.file is None else moving) for one in self.sources
            ),
            gravity=np.array(self.gravity, np.float64),
            seed=self.table.seed,
            time_limit=self.table.time_limit,
        )

    def _blocks(self) -> tuple[Blocks | None, Blocks | None]:
        """Return the blocks that stand, and those of a run that move; None where there are none."""
        runs = [one for one in self.sources if one.file is not None]
        if not runs:
            return self.blocks, None
        if len(runs) > 1:
            what = f"'{shortened(runs[1].name)}' names a run, as another source does"
            raise ModelError(what, where="source, file", remedy="take blocks of one run")
        file = self.folder / str(runs[0].file)
        blocks = blocks_of_run(file)
        speed = np.hypot(blocks.velocity[:, 0], blocks.velocity[:, 1])
        moves = (speed > runs[0].faster_than) & ~blocks.fixed
        where = f"source '{shortened(runs[0].name)}'"
        if not moves.any():
            what = f"no block of {file.name} moves faster than {runs[0].faster_than:g} m/s"
            raise ModelError(what, where=where, remedy="lower faster_than, or run the case longer")
        moving, standing = blocks.where(moves), blocks.where(~moves)
        _check_convex(moving, where)
        return standing if standing.name else None, moving

    def _wall(self, one: BarrierTable, bare: Ground, origin: Floats) -> tuple[Floats, Floats]:
        """Return the foot and the top of a barrier, m, (2,) each."""
        lean, top = np.radians(one.inclination), bare.start[:, 1].max() + 1.0
        x = one.x - origin[0]
        foot = np.array([x, height_below(bare, x, top)])
        return foot, foot + one.height * np.array([np.sin(lean), np.cos(lean)])

    def _stations(self, line: Floats, origin: Floats) -> list[tuple[float, str]]:
        """Return the places at which rocks are measured, m, rising, with their names."""
        low, high, count = line[0, 0], line[-1, 0], self.table.stations
        equal = low + (high - low) * (np.arange(count) + 0.5) / count
        named = [(one.x, one.name) for one in self.collectors]
        named += [(one.x, one.name) for one in self.barriers]
        places = [(float(x - origin[0]), name) for x, name in named]
        return sorted([*((float(x), "") for x in equal), *places])

    def _check_heights(self, bare: Ground, origin: Floats) -> None:
        """Raise ModelError for a source deeper below the profile than a rock is large, or aloft."""
        for source in self.sources:
            size = source.largest_volume ** (1.0 / 3.0)
            for end in source.line or (source.at,):
                if end is None:
                    continue
                x, y = np.array(end) - origin
                where = f"source '{shortened(source.name)}'"
                if y > WIDEST:
                    what = f"is at y = {end[1]:g}, far above the profile"
                    raise ModelError(what, where=where, remedy="give it in metres")
                if np.isnan(height_below(bare, x, y + size)):
                    ground = height_below(bare, x, np.inf) + origin[1]
                    what = (
                        f"is at y = {end[1]:g}, below the profile, which is at {ground:.4g} there"
                    )
                    raise ModelError(what, where=where, remedy="raise it")

    def _check(self, points: Floats, named: Sequence[Sequence[str]]) -> None:
        """Raise ModelError for names that do not exist or are there twice, and odd places."""
        if not self.sources:
            raise ModelError("is missing, so nothing falls", where="[[source]]", remedy=SOURCE)
        for name in dict.fromkeys(chain.from_iterable(named)):
            if name not in self.surfaces:
                what = f"there is no surface '{shortened(name)}'"
                remedy = spelling.advice(name, list(self.surfaces), kind="surface")
                if self.blocks is not None:
                    remedy += "; blocks have the surface that is called as their rock"
                raise ModelError(what, where="[rockfall], surface", remedy=remedy)
        ranges.check_names("source", [one.name for one in self.sources])
        placed = [("barrier", one.name, [one.x]) for one in self.barriers]
        placed += [("collector", one.name, [one.x]) for one in self.collectors]
        ranges.check_names("station", [name for _, name, _ in placed])
        for source in self.sources:
            ends = source.line or (source.at,)
            placed.append(("source", source.name, [end[0] for end in ends if end]))
        low, high, size = points[0, 0], points[-1, 0], float(np.ptp(points, axis=0).max())
        if size > WIDEST:
            what, remedy = f"is {size:.3g} m wide or high", "give it in metres, without outliers"
            raise ModelError(what, where="[rockfall], profile", remedy=remedy)
        if self.gravity[1] > 0.0:
            raise ModelError("points up", where="gravity", remedy="rocks need it downwards: -9.8")
        for kind, name, places in placed:
            for x in places:
                if not low < x < high:
                    reach = f"which reaches from {low:g} to {high:g}"
                    what = f"is at x = {x:g}, beside the profile, {reach}"
                    where = f"{kind} '{shortened(name)}'"
                    raise ModelError(what, where=where, remedy="move it, or lengthen the profile")


def lines_of(profile: Floats | None, standing: Blocks | None) -> list[Line]:
    """Return the lines that rocks fall on: a profile, and the outline of blocks on it."""
    if standing is not None:
        return air_lines(profile, standing)
    assert profile is not None
    return [Line(points=profile, owner=-1 - np.arange(len(profile) - 1))]


def surfaces_of(line: Line, names: Sequence[str], standing: Blocks | None) -> list[str]:
    """Return the surface of each segment: that of the profile, or the rock of its block."""
    rocks = () if standing is None else standing.rock
    return [rocks[k] if k >= 0 else names[-1 - k] for k in line.owner.tolist()]


def _check_convex(blocks: Blocks, where: str) -> None:
    """Raise ModelError for a block that cannot be followed as a rock."""
    import shapely

    for name, outline in zip(blocks.name, blocks.outline, strict=True):
        polygon = shapely.Polygon(outline)
        if polygon.convex_hull.area > (1.0 + 1e-6) * polygon.area:
            what = f"the block '{shortened(name)}' moves, but is not convex"
            raise ModelError(what, where=where, remedy="cut it into convex blocks before the run")


def blocks_of_model(model: Model) -> Blocks:
    """Return the blocks of a model at its start, without those that are not there yet."""
    count = model.block_count
    blocks = Blocks(
        name=model.block_name,
        rock=tuple(model.rocks[k].name for k in model.block_rock.tolist()),
        outline=tuple(model.polygon(k) for k in range(count)),
        density=model.density,
        velocity=model.velocity[:, :3],
        fixed=model.fixed,
    )
    return blocks.where(~model.absent)


def blocks_of_run(file: Path) -> Blocks:
    """Return the blocks at the end of a run, from its result file; raises CaseError for none.

    Spins are means over the last interval of frames.
    """
    from clast.results.frames import absent_in_frame
    from clast.results.result_reader import read_results

    run = read_results(file)
    rocks = [run.rock_name[k] for k in run.block_rock.tolist()]
    given = case_text.parse(run.case_text, file.name).get("rock", {})
    density = {name: table.get("density", np.nan) for name, table in given.items()}
    vertices = run.vertices(-1)
    outline = tuple(vertices[low:high] for low, high in pairwise(run.block_start.tolist()))
    spin = np.zeros(len(rocks))
    if len(run.times) > 1:
        turned = run.field("rotation", -1) - run.field("rotation", -2)
        spin = turned / (run.times[-1] - run.times[-2])
    there: Bools = ~absent_in_frame(run, -1)
    size = float(np.sqrt(np.median([moments(one)[0] for one in outline])))
    blocks = Blocks(
        name=run.block_name,
        rock=tuple(rocks),
        outline=outline,
        density=np.array([density.get(name, np.nan) for name in rocks]),
        velocity=np.column_stack([run.field("velocity", -1), spin]),
        fixed=run.fixed,
        seam=SEAM * size,
    )
    return blocks.where(there)
