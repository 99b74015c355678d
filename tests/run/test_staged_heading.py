"""A heading in jointed rock with all that stages may have, in every process: it stays closed."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast import Stage
from clast.actions.damping import Adaptive, Kinetic
from clast.model.state import LEDGER_ENTRIES, Ledger
from clast.rockmass import Box, Domain, JointSet, Opening, cut
from clast.run.schedule import Schedule
from clast.run.simulate import RunState, simulate
from clast.step.method import Method

G = 9.81
WIDTH, HEIGHT = 12.0, 9.0
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


def heading() -> clast.ModelBuilder:
    """Return a heading under an overburden, with bolts, water and an earthquake to come."""
    boundary = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]])
    box = Opening(name="heading", shape=Box(corner=(4.5, 3.0), size=(3.0, 2.5)), excavated=False)
    sets = [
        JointSet(name="a", angle=62.0, spacing=2.1),
        JointSet(name="b", angle=-21.0, spacing=1.9),
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
    builder.add_table("rise", [0.0, 0.02], [0.0, 1.0])
    builder.water(8.0, acts_on="joints", name="groundwater", factor="rise")
    builder.measured_point("crown", (6.0, 5.6))
    time = np.linspace(0.0, 0.04, 21)
    record = np.stack([3.0 * np.sin(2.0 * np.pi * time / 0.04), 0.0 * time], axis=1)
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(time, record))
    return builder


def prepared(process: str, law: str) -> tuple[clast.Model, Method, Schedule]:
    """Return model, method and schedule of the heading."""
    stiffness = {"modified": 5e8, "open-close": 2e9, "convex": 10e9}[process]
    case = heading().case(
        step=1e-3,
        end=1.0,
        every=0.01,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
        stages=STAGES,
    )
    model = case.model()
    return model, case.method(model), case.schedule()


def turned_over(run: clast.Run) -> float:
    """Return the largest change of an entry of the ledger, J/m."""
    entries = [name for name in LEDGER_ENTRIES if name != "unaccounted"]
    return max(float(np.ptp(run.energy[name])) for name in entries)


@pytest.mark.parametrize(
    ("process", "law"),
    [
        ("convex", "penalty"),
        ("convex", "augmented-lagrangian"),
        ("open-close", "penalty"),
        ("modified", "penalty"),
        pytest.param("open-close", "augmented-lagrangian", marks=pytest.mark.slow),
        pytest.param("modified", "augmented-lagrangian", marks=pytest.mark.slow),
    ],
)
def test_all_that_stages_have_at_once(process: str, law: str):
    model, method, schedule = prepared(process, law)
    carried: list[RunState] = []
    run = simulate(model, method, schedule, keep=carried.append)
    assert [stage.name for stage in run.stages] == [stage.name for stage in STAGES]
    assert abs(run.energy["unaccounted"]).max() < 1e-6 * turned_over(run)
    assert carried[-1].state.ledger != Ledger()
    for entry in ("removed", "water", "bolts", "damping", "loads"):
        assert getattr(carried[-1].state.ledger, entry) != 0.0, entry
    assert run.bolts(-1).force.max() > 5e3
    ends = [k for k in range(len(carried) - 1) if carried[k].position.over]
    for at in (ends[1] - 5, ends[3] + 7):
        last: list[RunState] = []
        simulate(model, method, schedule, begin=carried[at], keep=last.append)
        assert np.array_equal(last[-1].state.vertices, carried[-1].state.vertices)
        assert np.array_equal(last[-1].state.velocity, carried[-1].state.velocity)
        assert last[-1].state.ledger == carried[-1].state.ledger
