"""Result files of walls of any size, without simulating them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.contact.contacts import ContactResponse, Contacts
from clast.inputs.builder import InputBuilder
from clast.model.model import Model
from clast.model.state import Ledger, State, initial_state
from clast.pictures.page.document import write_page
from clast.results import Report, Results, RunRecorder, read_results
from scenes.browsers import CHROMIUM, RENDERERS, settled


def grid_model(rows: int, columns: int, title: str = "A wall") -> Model:
    """Rows of squares of 1 m on fixed feet, of two rocks, with a measured point at the top.

    Edges inside have joints, bed and head; those outside have none.
    """
    builder = InputBuilder(title=title)
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_rock("marl", young=5e9, poisson=0.3, density=2300.0)
    builder.line_joints += ["bed", "head"]
    for name in ("bed", "head"):
        builder.add_joint(name, friction_angle=30.0)
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    for row in range(rows):
        for column in range(columns):
            inside = (row > 0, column < columns - 1, row < rows - 1, column > 0)
            names = zip(("bed", "head", "bed", "head"), inside, strict=True)
            builder.block(
                edge_joint=[name if within else "" for name, within in names],
                vertices=square + np.array([column, row]),
                rock="marl" if (row // 2 + column // 3) % 2 else "granite",
                fixed=row == 0,
            )
    last = rows * columns
    builder.measured_point("top", (columns - 0.5, rows - 0.5), block=str(last))
    return builder.build()


def leaning(model: Model, time: float) -> State:
    """A state in which every block has moved with its height, and bears what is above it."""
    start = initial_state(model)
    height = np.add.reduceat(model.vertices[:, 1], model.block_start[:-1]) / 4.0
    shift = np.where(model.fixed, 0.0, 0.08 * time * height)
    across, top = np.array([1.0, -0.1]), model.vertices[:, 1].max()
    points = model.material_points
    return dataclasses.replace(
        start,
        time=time,
        vertices=model.vertices + across * shift[model.vertex_block][:, None],
        points=points.at + across * shift[points.block][:, None],
        velocity=np.outer(0.08 * height * ~model.fixed, [1.0, -0.1, 0.0, 0.0, 0.0, 0.0]),
        stress=np.column_stack([height, -2.6e4 * (top - height), 1e3 * np.sin(height)]) * time,
        rotation=0.01 * time * np.sin(height),
        ledger=Ledger(kinetic=time),
    )


def bearing(model: Model, state: State) -> tuple[Contacts, ContactResponse]:
    """Contacts of the lower left corner of every free block with what is below it."""
    vertex = model.block_start[:-1][~model.fixed]
    count = len(vertex)
    above = model.vertices[:, 1].max() - model.vertices[vertex, 1]

    def filled(kind: type, **given: object) -> dict[str, object]:
        kinds = {"joint": np.int64, "bonded": np.bool_}
        names = (field.name for field in dataclasses.fields(kind))
        return {name: given.get(name, np.zeros(count, kinds.get(name))) for name in names}

    contacts = filled(Contacts, vertex=vertex, edge=vertex, normal=np.tile([0.0, 1.0], (count, 1)))
    response = filled(
        ContactResponse,
        normal_force=2.6e4 * above,
        shear_force=4e3 * above,
        mode=np.ones(count, np.int64),
    )
    return Contacts(**contacts), ContactResponse(**response)  # type: ignore[arg-type]


def recorded(model: Model, path: Path) -> Results:
    recorder = RunRecorder(model, output=path)
    recorder.start(leaning(model, 0.0))
    for number in range(1, 6):
        state = leaning(model, 0.2 * number)
        recorder.instant(state)
        recorder.frame(state, *bearing(model, state))
    recorder.finish(
        Report(
            finished=True,
            outcome="the run reached its end",
            steps=5,
            passes=5,
            cut_steps=0,
            largest_contacts=1,
            largest_penetration=0.0,
            ledger=state.ledger,
            wall_seconds=0.1,
        )
    )
    return read_results(path)


@pytest.fixture
def wall(tmp_path: Path) -> Callable[..., Results]:
    """Return a function that makes results of a wall of ``rows`` by ``columns`` squares."""

    def make(rows: int, columns: int, title: str = "A wall") -> Results:
        return recorded(grid_model(rows, columns, title), tmp_path / "wall.vtkhdf")

    return make


@pytest.fixture(scope="session")
def parted(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    """Return the run of two bricks on a table: one stands, the other slides away from it."""
    builder = clast.ModelBuilder(title="Parted", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=20.0)
    table = [(-4, -1), (4, -1), (4, 0), (2, 0), (1, 0), (0, 0), (-4, 0)]
    builder.block(name="table", vertices=table, fixed=True)
    builder.block(name="still", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="moved", vertices=[(1, 0), (2, 0), (2, 1), (1, 1)], velocity=(1.0, 0.0, 0.0))
    builder.measured_point("A", (1.0, 0.0), block="moved")
    path = tmp_path_factory.mktemp("parted") / "parted.vtkhdf"
    return clast.simulate(builder.build(), step=2e-3, end=0.04, every=0.02, output=path)


@pytest.fixture(scope="session")
def sprayed(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    """Return the run of a hole in four blocks that is dug, and lined two stages later.

    The lining, a measured point, a reaction and the block above are all called "crown".
    """
    builder = clast.ModelBuilder(title="Sprayed", gravity=(0.0, 0.0))
    builder.in_situ = {"stress": [-4e5, -2e6, 0.0]}
    builder.add_rock("stone", young=2e9, poisson=0.2, density=2500.0)
    for name, strength in (("default", 0.0), ("bond", 1e6)):
        given = {"cohesion": strength, "tensile_strength": strength}
        stiffness = {"normal_stiffness": 1e10, "shear_stiffness": 1e10}
        builder.add_joint(name, friction_angle=35.0, **given, **stiffness)
    ring = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
    builder.block(name="core", vertices=ring)
    for k, name in enumerate(("right", "crown", "left", "invert")):
        here, there = ring[k], ring[(k + 1) % 4]
        far = [(3.0 * x, 3.0 * y) for x, y in (here, there)]
        out = [(1.5 * x, 1.5 * y) for x, y in far]
        builder.block(name=name, vertices=[here, *far, there])
        builder.block(name=f"far {name}", vertices=[far[0], *out, far[1]], fixed=True)
    builder.opening("hole", ["core"])
    keys = {"thickness": 0.1, "segment": 0.5, "young": 20e9, "density": 2400.0}
    builder.lining("crown", opening="hole", joint="bond", stage="line", **keys)
    builder.measured_point("crown", (0.0, 1.0), block="crown")
    builder.measured_reaction("crown", block="far crown")
    stages = (
        clast.Stage(name="settled", until="time", time=0.2),
        clast.Stage(
            name="dig", until="time", time=0.2, excavate=("hole",), relax=0.5, relax_time=1.0
        ),
        clast.Stage(name="line", until="time", time=0.8),
    )
    path = tmp_path_factory.mktemp("sprayed") / "sprayed.vtkhdf"
    given = {"step": 0.1, "dynamic_ratio": 0.0, "max_displacement": 0.05, "every": 0.1}
    return clast.simulate(builder.build(), end=1.2, stages=stages, output=path, **given)


@pytest.fixture(scope="module")
def wet_run(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    builder = clast.ModelBuilder(title="Pier", gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(name="base", vertices=[(1e4, -1), (10004, -1), (10004, 0), (1e4, 0)], fixed=True)
    builder.block(name="pier", vertices=[(10001, 0), (10002, 0), (10002, 2), (10001, 2)])
    builder.add_amplitude("rise", [0.0, 0.02], [0.0, 1.0])
    builder.water(2.4, name="pool", amplitude="rise", drained_at=[(10001.5, 0)])
    path = tmp_path_factory.mktemp("water") / "pier.vtkhdf"
    return clast.simulate(builder, end=0.02, step=1e-3, output=path)


@pytest.fixture(scope="session")
def undercut(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    """Return the run of eight blocks in water; two are dug, of which one leaves a closed void."""
    builder = clast.ModelBuilder(title="Undercut", gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e10, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=60.0)
    boxes = {
        "floor": (-1, -1, 5, 0),
        "wall": (0, 0, 2, 2),
        "dug": (2, 0, 4, 2),
        "left": (-3, 0, -2, 1),
        "void": (-2, 0, -1, 1),
        "right": (-1, 0, 0, 1),
        "lintel": (-3, 1, 0, 1.5),
        "bed": (-3, -1, -1, 0),
    }
    for name, (x0, y0, x1, y1) in boxes.items():
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        builder.block(name=name, vertices=corners, fixed=name in ("floor", "bed"))
    builder.water(line=[(-5.0, 0.6), (1.0, 2.0), (5.0, 1.8)], name="gw")
    stages = [
        clast.Stage(name="rest", until="time", time=0.05),
        clast.Stage(name="dig", until="time", time=0.05, excavate=("dug", "void")),
    ]
    path = tmp_path_factory.mktemp("undercut") / "undercut.vtkhdf"
    given = {"dynamic_ratio": 0.0, "step": 1e-2, "every": 0.05, "stages": stages}
    return clast.simulate(builder, end=0.1, output=path, **given)


@pytest.fixture(scope="module", params=RENDERERS)
def browser(request: pytest.FixtureRequest) -> Iterator[tuple[Any, str]]:
    """A browser for the tests of a file, and how it draws."""
    driving = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with driving.sync_playwright() as driver:
        started = driver.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", *RENDERERS[request.param]]
        )
        yield started, request.param
        started.close()


@pytest.fixture
def opened(browser: tuple[Any, str], tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Return a function that opens a page in a window of its own, and keeps what goes wrong."""
    started, renderer = browser
    windows, faults = [], []

    def opening(
        results: Any, width: int = 1280, height: int = 800, address: str = "", **media: str
    ) -> Any:
        windows.append(started.new_context(viewport={"width": width, "height": height}, **media))
        page = windows[-1].new_page()
        page.on("pageerror", lambda fault: faults.append(str(fault)))
        page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        page.on(
            "request",
            lambda asked: (
                faults.append(asked.url)
                if not asked.url.startswith(("file:", "blob:", "data:", "http://127.0.0.1:"))
                else None
            ),
        )
        if results is not None:
            file = write_page(results, tmp_path / "page.html")
            address = f"{file.as_uri()}?renderer={renderer}{address}"
        page.goto(address)
        page.wait_for_selector("main[data-ready=yes]", timeout=60_000)
        settled(page)
        return page

    yield opening
    for window in windows:
        window.close()
    assert faults == []
