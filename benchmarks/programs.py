"""The programs that peers.py compares: clast, Chipmunk (pymunk) and Box2D v3 (pyb2d3).

Each takes the same outlines and gives back where they are at the end.  Chipmunk and Box2D are
optional and looked for when they are asked for; their blocks are rigid, clast's deform.  Both run
in one thread, without damping, and with sleeping turned off: a wall that sleeps is not simulated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from time import perf_counter, process_time
from typing import Any, Protocol

import numpy as np

from benchmarks.bench import warm_up
from benchmarks.scenes import DENSITY, GRAVITY, SCENES, BenchSettings, method_for, model_of
from clast.compute.compilation import COMPILATION
from clast.model.model import Floats
from clast.run.schedule import Progress, Schedule
from clast.run.simulate import simulate

FRICTION = 0.5
"""tan(phi) of every contact."""
PEER_STEP, SUBSTEPS = 1e-3, 4
"""Step of the peers, s, and sub-steps of Box2D in it."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Blocks to be simulated; all quadrilaterals, counter-clockwise."""

    name: str
    """Name of the scene and number of free blocks."""
    free: Floats
    """Outlines of blocks that move, m, shape (n, 4, 2)."""
    fixed: Floats
    """Outlines of blocks that do not, m, shape (f, 4, 2)."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What a program made of a setting."""

    time: float
    """Simulated time, s: shorter than wanted where the limit of wall time was met."""
    seconds: float
    """Time of the processor for the steps, s; building and compilation are not counted."""
    free: Floats
    """Outlines at the end, m, shape (n, 4, 2)."""
    remark: str = ""
    """How the run ended where it did not reach its end."""


class Program(Protocol):
    """Something that can simulate a setting."""

    @property
    def name(self) -> str:
        """Name with the settings that matter."""
        ...

    @property
    def missing(self) -> str:
        """Python package that is needed and not installed, or an empty text."""
        ...

    def simulate(self, setting: Setting, end: float, limit: float) -> Outcome:
        """Simulate ``end`` seconds in ``limit`` seconds of wall time at most."""
        ...


@dataclass(frozen=True)
class Clast:
    """clast: convex process with a penalty law."""

    step: float
    """h, s."""
    share: float = 1.0
    """p/E."""
    travel: float = 1.0
    """max_displacement in units of the default."""
    missing: str = ""

    @property
    def name(self) -> str:
        """Name with step and stiffness."""
        return f"clast, h = {1e3 * self.step:g} ms, p = {self.share:g} E"

    def simulate(self, setting: Setting, end: float, limit: float) -> Outcome:
        """Simulate with compiled kernels."""
        settings = BenchSettings(step=self.step, share=self.share)
        warm_up([SCENES["wall"]], settings)
        model = model_of(setting.name, setting.free, setting.fixed)
        usual = method_for(model, settings)
        method = replace(usual, max_displacement=self.travel * usual.max_displacement)
        begun = perf_counter()

        def watch(_: Progress) -> None:
            if perf_counter() - begun > limit:
                raise KeyboardInterrupt

        compiled, used = COMPILATION.over_by_processor, process_time()
        run = simulate(model, method, Schedule(step=self.step, end=end, every=end), watch=watch)
        used = process_time() - used - (COMPILATION.over_by_processor - compiled)
        free = run.state.vertices[~model.fixed[model.vertex_block]]
        return Outcome(
            time=run.state.time,
            seconds=used,
            free=free.reshape(-1, 4, 2),
            remark="" if run.report.finished else f"stopped after {limit:g} s",
        )


@dataclass(frozen=True)
class Chipmunk:
    """Chipmunk through pymunk: impulses, solved by a number of iterations."""

    iterations: int
    """Iterations of the solver per step."""

    @property
    def name(self) -> str:
        """Name with iterations."""
        return f"Chipmunk, {self.iterations} iterations, h = {1e3 * PEER_STEP:g} ms"

    @property
    def missing(self) -> str:
        """The package, where it is not installed."""
        return "" if find_spec("pymunk") else "pymunk"

    def simulate(self, setting: Setting, end: float, limit: float) -> Outcome:
        """Simulate with all bodies awake."""
        import pymunk

        space = pymunk.Space()
        space.gravity = (0.0, -GRAVITY)
        space.iterations = self.iterations
        space.collision_slop = 1e-4  # m; the default, 0.1 m, is meant for pixels
        bodies = []
        for outline in setting.free:
            centre = outline.mean(axis=0)
            corners = [tuple(corner) for corner in (outline - centre).tolist()]
            mass = DENSITY * _area(outline)
            body = pymunk.Body(mass, pymunk.moment_for_poly(mass, corners))
            body.position = tuple(centre.tolist())
            space.add(body, _with_friction(pymunk.Poly(body, corners)))
            bodies.append(body)
        for outline in setting.fixed:
            corners = [tuple(corner) for corner in outline.tolist()]
            space.add(_with_friction(pymunk.Poly(space.static_body, corners)))
        time, used, remark = stepped(lambda: space.step(PEER_STEP), end, limit)
        place = np.array([tuple(body.position) for body in bodies])
        angle = np.array([body.angle for body in bodies])
        return Outcome(
            time=time, seconds=used, free=moved(setting.free, place, angle), remark=remark
        )


@dataclass(frozen=True)
class Box2D:
    """Box2D v3 through pyb2d3: soft constraints with sub-steps, one thread."""

    hertz: float | None = None
    """Stiffness of contacts, Hz; None leaves the default."""

    @property
    def name(self) -> str:
        """Name with the stiffness of contacts."""
        contact = "default" if self.hertz is None else f"contact {self.hertz:g} Hz"
        return f"Box2D v3, {contact}, {SUBSTEPS} sub-steps, h = {1e3 * PEER_STEP:g} ms"

    @property
    def missing(self) -> str:
        """The package, where it is not installed."""
        return "" if find_spec("pyb2d3") else "pyb2d3"

    def simulate(self, setting: Setting, end: float, limit: float) -> Outcome:
        """Simulate with all bodies awake."""
        import pyb2d3

        world = pyb2d3.World(gravity=(0.0, -GRAVITY))
        world.sleeping_enabled = False
        if self.hertz is not None:
            world.set_contact_tuning(self.hertz, 10.0, 3.0)
        surface = pyb2d3.surface_material(friction=FRICTION, restitution=0.0)
        shape = pyb2d3.shape_def(density=DENSITY, material=surface)
        bodies = []
        for outline in setting.free:
            centre = outline.mean(axis=0)
            body = world.create_dynamic_body(position=tuple(centre.tolist()))
            body.create_shape(shape, pyb2d3.polygon(outline - centre))
            bodies.append(body)
        for outline in setting.fixed:
            centre = outline.mean(axis=0)
            body = world.create_static_body(position=tuple(centre.tolist()))
            body.create_shape(shape, pyb2d3.polygon(outline - centre))
        time, used, remark = stepped(lambda: world.step(PEER_STEP, SUBSTEPS), end, limit)
        place = np.array([(body.position.x, body.position.y) for body in bodies])
        angle = np.array([body.angle for body in bodies])
        world.destroy()
        return Outcome(
            time=time, seconds=used, free=moved(setting.free, place, angle), remark=remark
        )


def stepped(step: Callable[[], object], end: float, limit: float) -> tuple[float, float, str]:
    """Call ``step`` until ``end``; return simulated time, time of the processor, s, and the end."""
    wanted = round(end / PEER_STEP)
    begun, used = perf_counter(), process_time()
    for number in range(wanted):
        step()
        if perf_counter() - begun > limit and number + 1 < wanted:
            return (number + 1) * PEER_STEP, process_time() - used, f"stopped after {limit:g} s"
    return end, process_time() - used, ""


def moved(outlines: Floats, place: Floats, angle: Floats) -> Floats:
    """Return rigid outlines (n, 4, 2) whose centres are at ``place`` (n, 2), turned by (n,) rad."""
    arm = outlines - outlines.mean(axis=1, keepdims=True)
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x = cosine * arm[..., 0] - sine * arm[..., 1]
    y = sine * arm[..., 0] + cosine * arm[..., 1]
    return place[:, None, :] + np.stack([x, y], axis=2)


def _area(outline: Floats) -> float:
    x, y = outline.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _with_friction(shape: Any) -> Any:
    """Return a shape of pymunk with sqrt of the friction: it multiplies those of both shapes."""
    shape.friction, shape.elasticity = np.sqrt(FRICTION), 0.0
    return shape
