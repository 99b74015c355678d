"""Three blocks that move by formula, recorded as a run would: what is read back is known."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clast.block import polygon
from clast.contact.contacts import ContactResponse, Contacts
from clast.inputs.builder import InputBuilder
from clast.model.model import Model
from clast.model.state import Ledger, State, initial_state
from clast.results import Report, Run, RunRecorder
from clast.step.method import StepResult

STEP = 0.01
TRANSLATION = np.array([[0.0, 0.0], [0.3, -0.1], [-0.2, 0.4]])
SPIN = np.array([0.0, 0.5, -0.25])


def three_blocks(shift: float = 0.0) -> Model:
    """A fixed base, a triangle on it and an L-shaped block, moved by (shift, shift), m."""
    builder = InputBuilder(title="three blocks")
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_rock("marl", young=5e9, poisson=0.3, density=2300.0)
    outlines = {
        "base": [(0, 0), (10, 0), (10, 1), (0, 1)],
        "wedge": [(1, 1), (4, 1), (1, 3)],
        "corner": [(6, 1), (9, 1), (9, 2), (7, 2), (7, 4), (6, 4)],
    }
    builder.add_joint("bed", friction_angle=30.0)
    builder.add_joint("foot", friction_angle=20.0)
    along = {"base": ["", "", "bed", ""], "wedge": None, "corner": ["foot", *5 * [""]]}
    for name, loop in outlines.items():
        builder.block(
            name=name,
            vertices=np.array(loop, float) + shift,
            rock="marl" if name == "corner" else "granite",
            fixed=name == "base",
            edge_joint=along[name],
        )
    builder.fixed_point((shift, shift), block="base")
    builder.measured_point("tip", (1 + shift, 3 + shift), block="wedge")
    builder.measured_point("left/right", (6.5 + shift, 3.5 + shift), block="corner")
    return builder.build()


def moved(model: Model, time: float) -> State:
    """The state at ``time``: every block has translated and turned about its centroid."""
    _, centroid, _ = polygon.moments(model.vertices, model.block_start)
    now = centroid + TRANSLATION * time

    def place(at: np.ndarray, block: np.ndarray) -> np.ndarray:
        angle = SPIN[block] * time
        x, y = (at - centroid[block]).T
        turned = [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)]
        return now[block] + np.column_stack(turned)

    start = initial_state(model)
    points = model.material_points
    return dataclasses.replace(
        start,
        time=time,
        vertices=place(model.vertices, model.vertex_block),
        points=place(points.at, points.block),
        velocity=np.column_stack([TRANSLATION, SPIN, np.zeros((3, 3))]),
        rotation=SPIN * time,
        stress=np.array([[0.0, -2e3, 0.0], [3e3, -1e3, 1e3], [0.0, 0.0, 5e2]]) * time,
        ledger=Ledger(kinetic=2.0 * time, gravity=-3.0 * time, friction=time),
    )


def contacts_at(model: Model, vertices: list[int]) -> tuple[Contacts, ContactResponse]:
    """Contacts of some vertices with the top of the base; the first carries no force."""
    count = len(vertices)

    def filled(kind: type, **given: object) -> dict[str, object]:
        names = (field.name for field in dataclasses.fields(kind))
        return {name: given.get(name, np.zeros(count)) for name in names}

    vertex = np.array(vertices)
    normal_force = 1e3 * np.arange(count, dtype=float)
    contacts = filled(
        Contacts,
        vertex=vertex,
        edge=np.full(count, 2),
        normal=np.tile([0.0, 1.0], (count, 1)),
        foot=model.vertices[vertex],
        joint=1 + np.arange(count) % 2,
    )
    response = filled(
        ContactResponse,
        normal_force=normal_force,
        shear_force=0.1 * normal_force,
        mode=np.ones(count, np.int64),
        bonded=np.ones(count, np.bool_),
    )
    return Contacts(**contacts), ContactResponse(**response)  # type: ignore[arg-type]


def step_result(model: Model, time: float) -> StepResult:
    contacts, response = contacts_at(model, [4, 5, 7])
    return StepResult(
        state=moved(model, time),
        contacts=contacts,
        response=response,
        counts={"passes": 2},
        travel=1e-3,
        penetration=1e-6,
        seconds={"solve": 1e-4},
    )


def report(state: State, **given: object) -> Report:
    entries: dict[str, object] = {
        "finished": True,
        "outcome": "the run reached its end",
        "steps": 20,
        "passes": 40,
        "cut_steps": 1,
        "largest_contacts": 3,
        "largest_penetration": 1e-6,
        "ledger": state.ledger,
        "wall_seconds": 0.5,
        "seconds": {"solve": 0.2},
        "warnings": ("a warning",),
    }
    return Report(**{**entries, **given})  # type: ignore[arg-type]


@dataclass(frozen=True)
class Recorded:
    """A run of 20 steps with a frame every 5, and the states it went through."""

    run: Run
    states: list[State]
    frames: list[State]


def record(model: Model, output: Path | None = None, steps: int = 20, **options: float) -> Recorded:
    text = "schema = 1\n# Tück\n"
    recorder = RunRecorder(model, case_text=text, output=output, **options)
    states = [moved(model, 0.0)]
    frames = states[:]
    recorder.start(states[0])
    for number in range(1, steps + 1):
        result = step_result(model, number * STEP)
        recorder.step(result, STEP)
        states.append(result.state)
        if number % 5 == 0:
            recorder.frame(result.state, result.contacts, result.response)
            frames.append(result.state)
    return Recorded(recorder.finish(report(states[-1])), states, frames)
