"""A heading in jointed rock with all that stages may have.

    python -m scenes.staged_heading PROCESS

prints what a run of the same heading in finer joints leaves, in hashes: enough blocks for threads.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from hashlib import sha256

import numpy as np

import clast
from clast import Stage
from clast.actions.damping import Adaptive, Kinetic
from clast.rockmass import Box, Domain, JointSet, Opening, cut
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method

G = 9.81
WIDTH, HEIGHT = 12.0, 9.0
FINER, SHORT, STEP = 5.4, 0.7, 2e-3
"""For threads: how much finer the joints are and how much shorter the stages, and the step, s."""
STAGES = (
    Stage(name="settle", time=0.1, dynamic_ratio=0.0, hold=5, reset_displacement=True),
    Stage(
        name="dig",
        until="time",
        time=0.03,
        excavate=("heading",),
        relax=0.4,
        relax_time=0.05,  # goes on while the bolts are in
        damping=Adaptive(),
    ),
    Stage(name="bolt", until="time", time=0.03, install=("bar",), damping=Kinetic()),
    Stage(name="rain", until="time", time=0.03, loads=("rise",)),
    Stage(
        name="quake",
        until="time",
        time=0.04,
        ground_motion=True,
        joints={"default": {"friction_angle": 28.0}},
    ),
)


def heading(finer: float = 1.0) -> clast.ModelBuilder:
    """Return a heading under an overburden, with bolts, water and an earthquake to come.

    The spacings of the joints are divided by ``finer``.
    """
    boundary = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]])
    box = Opening(name="heading", shape=Box(corner=(4.5, 3.0), size=(3.0, 2.5)), excavated=False)
    sets = [
        JointSet(name="a", angle=62.0, spacing=2.1 / finer),
        JointSet(name="b", angle=-21.0, spacing=1.9 / finer),
    ]
    found = cut(Domain(boundary=boundary), sets=sets, openings=[box], seed=2)
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=10e9, poisson=0.25, density=2600.0)
    builder.add_joint("default", friction_angle=32.0)
    builder.add_weld("weld")
    along = found.joint_names.index("construction-joint:heading")
    names = builder.blocks(
        vertices=found.vertices,
        start=found.block_start,
        edge_joint=["weld" if k == along else "" for k in found.edge_joint],
    )
    inside = [names[k] for k in np.flatnonzero(found.opening >= 0)]
    builder.opening("heading", inside, weld="weld")
    builder.in_situ = clast.Overburden(k0=0.6, datum=60.0)
    builder.add_bolt_kind("bar", stiffness=2e7, yield_force=3e4, pretension=1e4)
    outline = np.array([[4.5, 3.0], [7.5, 3.0], [7.5, 5.5], [4.5, 5.5]])
    builder.bolt_pattern(
        outline, kind="bar", length=2.5, spacing=0.9, angles=(30.0, 150.0), pretension_is="jacked"
    )
    builder.add_amplitude("rise", [0.0, 0.02], [0.0, 1.0])
    builder.water(8.0, acts_on="joints", name="groundwater", amplitude="rise")
    builder.measured_point("crown", (6.0, 5.6))
    time = np.linspace(0.0, 0.04, 21)
    record = np.stack([3.0 * np.sin(2.0 * np.pi * time / 0.04), 0.0 * time], axis=1)
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(time, record))
    return builder


def prepared(process: str, law: str, finer: float = 1.0) -> tuple[clast.Model, Method, Schedule]:
    """Return model, method and schedule of the heading."""
    stiffness = {"modified": 5e8, "open-close": 2e9, "convex": 10e9}[process]
    case = heading(finer).case(
        step=1e-3,
        end=1.0,
        every=0.01,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
        stages=STAGES,
    )
    model = case.model()
    return model, case.method(model), case.schedule()


def digits(process: str) -> dict[str, str]:
    """Return hashes of what a run leaves, by what they are of, and its number of blocks."""
    model, method, schedule = prepared(process, "penalty", finer=FINER)
    short = tuple(replace(one, time=SHORT * one.time) for one in schedule.stages)
    run = simulate(model, method, replace(schedule, step=STEP, stages=short))
    kept = {**vars(run.state), **vars(run.state.memory), **run.energy, "bolts": run.bolts(-1).force}
    hashes = {
        name: sha256(np.ascontiguousarray(values).tobytes()).hexdigest()
        for name, values in kept.items()
        if isinstance(values, np.ndarray)
    }
    return {**hashes, "blocks": str(model.block_count), "end": run.report.outcome}


if __name__ == "__main__":
    json.dump(digits(sys.argv[1]), sys.stdout)
