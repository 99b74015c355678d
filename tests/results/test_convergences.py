"""[[measured_convergence]] and reactions of a side: what they are, where they appear, refusals."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import clast
from clast.cli.commands import app
from clast.errors import CaseError
from clast.exports.csv_tables import write_csv
from clast.pictures.histories import plot_histories
from clast.pictures.page.document import write_page
from clast.pictures.plot import plot_results
from clast.results import read_results
from clast.study.expressions import read
from clast.study.measures import MEASURES, RunResults, check, known_names

LEFT, RIGHT = np.array([0.6, 0.2]), np.array([-0.2, 0.5])
"""Velocities of the two blocks, m/s."""
END = 0.05


def pair(*, angle=0.0, mirrored=False, turned=(), reverse=False, at=(0.0, 0.0)):
    """Return a builder of two blocks that fly towards each other, seen in another frame."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, -s], [s, c]]) @ np.diag([-1.0 if mirrored else 1.0, 1.0])

    def seen(points):
        return (np.asarray(points, float) @ turn.T + at).tolist()

    builder = clast.ModelBuilder(title="Pair", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    order = -1 if mirrored else 1
    blocks = {"left": (0.0, LEFT), "right": (3.0, RIGHT)}
    for name in reversed(blocks) if reverse else blocks:
        x, velocity = blocks[name]
        corners = [(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)][::order]
        builder.block(name=name, vertices=seen(corners), velocity=[*(turn @ velocity), 0.0])
    builder.measured_point("A", seen([(1.0, 0.25)])[0], block="left")
    builder.measured_point("B", seen([(3.0, 1.0)])[0], block="right")
    builder.measured_convergence("wall", ("B", "A") if reverse else ("A", "B"))
    return builder


@pytest.mark.parametrize(
    "view",
    [
        {},
        {"angle": 37.0},
        {"mirrored": True},
        {"reverse": True},
        {"angle": -120.0, "at": (3.2e5, 5.1e6)},
    ],
    ids=["as it is", "turned", "mirrored", "renumbered", "far away"],
)
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_points_that_approach(view, step):
    """Two blocks in free flight: (v_A - v_B).e t, with e from A to B at the start."""
    run = pair(**view).case(step=step, end=END, max_displacement=0.1).run()
    way = np.array([2.0, 0.75])
    rate = (LEFT - RIGHT) @ way / np.hypot(*way)
    history = run.convergence("wall")
    size = max(1.0, *np.abs(view.get("at", (0.0, 0.0))))
    assert history.convergence == pytest.approx(rate * history.time, abs=1e-14 * size)
    assert history.convergence[-1] > 0.0
    assert run.table("convergences", "wall").units["convergence"] == "m"


def test_it_counts_from_a_reset_and_is_a_measure():
    fly = clast.Stage(name="fly", until="time", time=END, reset_displacement=True)
    stages = [fly, clast.Stage(name="on", until="time", time=END)]
    run = clast.simulate(pair().build(), stages=stages, step=1e-3, max_displacement=0.1)
    rows = run.convergence("wall")
    rate = rows.convergence[10] / rows.time[10]
    assert rows.convergence[-1] == pytest.approx(rate * END, rel=1e-9)
    known = known_names(run.model)
    check(read("convergence(wall)", "measure", (), MEASURES), known)
    with pytest.raises(CaseError, match="wall"):
        check(read("convergence(wal)", "measure", (), MEASURES), known)
    at_half = MEASURES["convergence"].value(RunResults(run), "wall", f"{1.5 * END}")
    assert at_half == pytest.approx(rate * 0.5 * END, rel=1e-9)


@pytest.mark.slow
def test_it_is_in_file_tables_summary_and_pictures(tmp_path):
    case = pair().case(step=1e-3, end=END)
    path = tmp_path / "pair.vtkhdf"
    run = case.run(output=path)
    results = read_results(path)
    expected = run.convergence("wall").convergence
    assert results.convergence("wall").convergence == pytest.approx(expected, abs=0.0)
    assert results.convergence_points.tolist() == [[0, 1]]
    (table,) = write_csv(results, tmp_path / "tables", tables=["convergences"])
    heading, *rows = table.read_text().splitlines()
    assert heading == "convergence,time,convergence"
    assert float(rows[-1].split(",")[2]) == expected[-1]
    shown = CliRunner().invoke(app, ["info", str(path), "--json"])
    told = json.loads(shown.stdout)["convergences"]["wall"]
    assert told["convergence"] == expected[-1]
    assert told["distance"] == pytest.approx(np.hypot(2.0, 0.75))
    assert "convergences at the end" in CliRunner().invoke(app, ["info", str(path)]).stdout
    assert plot_results(results, tmp_path / "end.png").stat().st_size
    assert plot_histories(results, tmp_path / "h.svg", ["wall"]).stat().st_size
    assert write_page(results, tmp_path / "page.html").stat().st_size


BLOCK = """
[time]
step = 1e-3
end = 0.01
[rock.r]
young = 5e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 30.0
[[block]]
name = "b"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[measured_point]]
name = "crown"
at = [0, 0]
[[measured_point]]
name = "floor"
at = [0, 0]
"""


def test_faults_are_told_together_and_with_the_nearest_name():
    text = BLOCK + '[[measured_convergence]]\nname = "c"\nof = ["crwn", "flor"]\n'
    with pytest.raises(CaseError) as told:
        clast.Case.from_text(text, "x.toml")
    assert "'crwn'" in str(told.value) and "crown" in str(told.value)
    assert "'flor'" in str(told.value)


@pytest.mark.parametrize("ends", [("crown", "floor"), ("crown", "crown")])
def test_points_at_one_place_have_no_line(ends):
    of = ", ".join(f'"{one}"' for one in ends)
    text = BLOCK + f'[[measured_convergence]]\nname = "c"\nof = [{of}]\n'
    with pytest.raises(clast.ModelError, match="at one place"):
        clast.Case.from_text(text, "x.toml").model()


# Reactions of a side ------------------------------------------------------------------------------


def trough(turned):
    """Return a builder with a block that leans on a floor and a wall, both fixed."""
    builder = clast.ModelBuilder(gravity=(-3.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=0.0)
    parts = [
        ("wall", [(-1, 0), (0, 0), (0, 3), (-1, 3)]),
        ("floor", [(0.0, -1), (3, -1), (3, 0), (0.0, 0)]),
    ]
    for name, vertices in reversed(parts) if turned else parts:
        builder.block(name=name, vertices=vertices, fixed=True)
    builder.block(name="stone", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    return builder


@pytest.mark.parametrize("turned", [False, True])
def test_sides_carry_their_part_of_the_weight(turned):
    builder = trough(turned)
    builder.measured_reaction("left side", side="left")
    builder.measured_reaction("bottom side", side="bottom")
    run = clast.simulate(builder.build(), step=2e-3, end=0.2, dynamic_ratio=0.0)
    mass = 2500.0 * 2.0
    left, bottom = (run.reaction(f"{one} side").force[-1] for one in ("left", "bottom"))
    assert left == pytest.approx([3.0 * mass, 0.0], rel=1e-3, abs=1.0)
    assert bottom == pytest.approx([0.0, 9.8 * mass], rel=1e-3, abs=1.0)
    assert left + bottom == pytest.approx(run.reaction("fixed blocks").force[-1], rel=1e-9)


def test_a_side_has_its_viscous_edges_and_fixed_points():
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="a", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.viscous_boundary(side="bottom", begins=10.0)
    builder.fixed_point((0.0, 0.5))
    builder.measured_reaction("bottom", side="bottom")
    builder.measured_reaction("left", side="left")
    run = clast.simulate(builder.build(), step=2e-3, end=0.1, dynamic_ratio=0.0)
    bottom, left = (run.reaction(one).force for one in ("bottom", "left"))
    assert bottom == pytest.approx(run.reaction("viscous edges").force, rel=1e-12)
    assert left == pytest.approx(run.reaction("fixed points").force, rel=1e-12)
    assert (bottom + left)[-1, 1] == pytest.approx(2500.0 * 2.0 * 9.8, rel=1e-3)


def test_a_side_without_supports_is_refused():
    builder = pair()
    builder.measured_reaction("r", side="top")
    with pytest.raises(clast.ModelError, match="no fixed block, fixed point, viscous edge or"):
        builder.build()
