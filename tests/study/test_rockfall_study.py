"""Rockfall as a study: counts and statistics, and what they are counted from."""

import csv
import json

import numpy as np
import pytest

import clast
from clast.study.rockfall import portions
from clast.trajectory.campaign import portion
from scenes.command_line import clast_command, good

TEXT = """
schema = 1
[rockfall]
profile = [[0, 20], [10, 18], [20, 4], [40, 0], [60, 0]]
surface = ["rock", "rock", "talus", "talus"]
stations = 20
[surface.rock]
normal_restitution = "normal(0.4, 0.04)"
tangential_restitution = 0.9
roughness = 2.0
[surface.talus]
normal_restitution = 0.3
tangential_restitution = 0.8
rolling_resistance = 0.05
[[source]]
name = "left"
line = [[3, 22], [9, 20]]
rocks = 7
volume = "uniform(0.2, 1)"
velocity = ["uniform(1, 3)", 0]
[[source]]
name = "right"
at = [9, 21]
rocks = 5
volume = 0.5
shape = [[0, 0], [2, 0], [1, 2]]
velocity = [3, 0]
[[barrier]]
name = "fence"
x = 35
height = 2
capacity = 20e3
[[collector]]
name = "road"
x = 45
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    case = clast.Case.from_text(TEXT, "rocks.toml")
    return clast.rockfall(case, tmp_path_factory.mktemp("rocks") / "out", workers=1)


def test_every_rock_has_a_path_with_a_closed_ledger(results) -> None:
    assert results.paths["path"] == [*range(1, 13)]
    assert results.paths["source"] == ["left"] * 7 + ["right"] * 5
    assert max(map(abs, results.paths["unaccounted"])) < 1e-12
    assert set(results.paths["end"]) <= {"rest", "out", "held"}
    volumes = np.array(results.paths["volume"])
    assert ((volumes >= 0.2) & (volumes <= 1.0)).all()
    assert results.paths["mass"] == pytest.approx(2700.0 * volumes)


def test_a_path_depends_on_its_number_alone(results) -> None:
    rows, arrays = portion(results.campaign, [9, 4])
    kept = list(zip(*results.paths.values(), strict=True))
    assert tuple(rows[0]) == kept[8]
    assert tuple(rows[1]) == kept[3]
    assert (arrays["records"][:, 0] == 9).sum() == (results.records[:, 0] == 9).sum()


def test_barriers_count_what_came_and_what_they_held(results) -> None:
    fence = results.barriers()[0]
    held = results.paths["held_by"].count("fence")
    assert fence["held"] == held > 0
    passed = sum(x > 35.0 for x in results.paths["end_x"])
    assert fence["came"] == held + passed
    assert fence["share_held"] == held / fence["came"]
    energy = results.hits[:, 4]
    assert fence["energy_max"] == energy.max()
    assert fence["energy_p95"] == np.percentile(energy, 95.0)
    assert (energy[results.hits[:, -1] == 1.0] <= 20e3).all()
    assert (energy[results.hits[:, -1] == 0.0] > 20e3).all()


def test_stations_count_the_rocks_that_pass(results) -> None:
    starts, ends = np.array(results.paths["start_x"]), results.ends
    for row in results.stations():
        assert row["count"] >= ((starts < row["x"]) & (ends > row["x"])).sum()
        if row["count"]:
            assert row["speed_mean"] <= row["speed_max"]
            assert row["energy_max"] >= row["translational_max"]
    assert [row["name"] for row in results.stations() if row["name"]] == ["fence", "road"]


def test_tables_are_written_with_every_digit(results) -> None:
    with (results.folder / "paths.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["end_x"]) for row in rows] == results.paths["end_x"]
    with (results.folder / "blows.csv").open() as file:
        blows = list(csv.DictReader(file))
    counted = [sum(int(row["path"]) == k for row in blows) for k in range(1, 13)]
    through = [int((results.hits[:, 0] == k).sum()) for k in range(1, 13)]
    assert counted == [a + b for a, b in zip(results.paths["blows"], through, strict=True)]


def test_a_study_in_pieces_has_the_tables_of_one_as_a_whole(results, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(portions, "PATHS", 5)
    case, folder = clast.Case.from_text(TEXT, "rocks.toml"), tmp_path / "out"
    clast.rockfall(case, folder, array=(2, 3))
    assert not (folder / "paths.csv").exists()
    for name in ("paths.npz", "blows.csv"):
        clast.rockfall(case, folder, array=(1, 3))
        next(folder.glob(f"runs/*/*/{name}")).write_bytes(b"damaged")
    other = clast.rockfall(case, folder, workers=1)
    for name in ("paths", "blows", "stations", "barriers"):
        ours = (results.folder / f"{name}.csv").read_bytes()
        assert (other.folder / f"{name}.csv").read_bytes() == ours


WALL = """
schema = 1
time = { step = 1e-4, end = 0.02 }
[rock.stone]
young = 1e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 0.0
[[block]]
name = "floor"
rock = "stone"
fixed = true
vertices = [[0, -1], [20, -1], [20, 0], [0, 0]]
[[block]]
name = "wall"
rock = "stone"
vertices = [[10, 0], [11, 0], [11, 3], [10, 3]]
[rockfall]
[surface.stone]
normal_restitution = 0.0
friction_angle = 30.0
[[source]]
name = "slope"
at = [4, 1.6]
rocks = 2
volume = 0.5
length = 1.0
velocity = [15, 2]
spin = -2.0
"""


def test_a_rock_that_strikes_a_block_is_handed_over_to_a_run_of_blocks(tmp_path) -> None:
    case = clast.Case.from_text(WALL, "wall.toml")
    results = clast.rockfall(case, tmp_path / "out", workers=1)
    rows = {row["block"]: row for row in results.blocks()}
    assert rows["wall"]["rocks"] == 2
    assert not rows["wall"]["fixed"]
    first = next(one for one in results.blows() if one[0] == 1 and one[6] == "wall")
    mass, speed = results.paths["mass"][0], np.hypot(first[7], first[8])
    assert rows["wall"]["translational_max"] >= 0.5 * mass * speed**2 * (1 - 1e-12)
    assert "'wall' the hardest" in results.remark_on_blocks
    with (tmp_path / "out" / "blocks.csv").open() as file:
        assert {row["block"] for row in csv.DictReader(file)} == set(rows)

    handed = clast.load(results.hand_over(1))
    assert handed.rockfall is None
    assert handed.block[-1].velocity == pytest.approx(first[7:10])
    run = handed.run(warn=lambda text: None)
    start, end = run.model.velocity[:, :3], run.state.velocity[:, :3]
    rock, wall = run.block_name.index("falling rock"), run.block_name.index("wall")
    assert run.model.mass[rock] == pytest.approx(mass)
    # the floor has no friction: the momentum along it that the rock loses is the wall's
    assert end[wall, 0] > 0.5
    given = run.model.mass[wall] * end[wall, 0]
    taken = run.model.mass[rock] * (start[rock, 0] - end[rock, 0])
    assert given == pytest.approx(taken, rel=1e-6)


def test_blocks_that_rocks_fall_on_need_no_time_unless_they_are_run(tmp_path) -> None:
    text = WALL.replace("time = { step = 1e-4, end = 0.02 }", "")
    timed, untimed = (clast.Case.from_text(one, "wall.toml") for one in (WALL, text))
    assert "time" not in clast.Case.from_text(untimed.to_toml(), "x").model_fields_set
    for case, name in ((timed, "timed"), (untimed, "untimed")):
        clast.rockfall(case, tmp_path / name, workers=1)
    tables = [(tmp_path / name / "blows.csv").read_bytes() for name in ("timed", "untimed")]
    assert tables[0] == tables[1]
    with pytest.raises(clast.CaseError, match=r"\[time\]: is missing"):
        untimed.run()


@pytest.mark.parametrize(
    ("number", "change", "said"),
    [
        (3, "", "numbered from 1 to 2"),
        (1, "velocity = [-9, 2]", "strikes no block that can move"),
    ],
)
def test_only_a_path_that_strikes_a_free_block_is_handed_over(
    number: int, change: str, said: str, tmp_path
) -> None:
    text = WALL.replace("velocity = [15, 2]", change or "velocity = [15, 2]")
    results = clast.rockfall(clast.Case.from_text(text, "x.toml"), tmp_path / "out", workers=1)
    with pytest.raises(clast.CaseError, match=said):
        results.hand_over(number)


def test_the_page_of_a_folder_shows_its_paths(results, tmp_path) -> None:
    good("page", results.folder, tmp_path / "rocks.html")
    scene = (tmp_path / "rocks.html").read_text("utf-8").partition('id="scene">')[2]
    paths = json.loads(scene.partition("</script>")[0])["paths"]
    assert [one["number"] for one in paths] == results.paths["path"]
    assert [one["end"] for one in paths] == results.paths["end"]
    empty = clast_command("page", tmp_path)
    assert empty.exit_code == 2
    assert "clast study collect reports on a folder of a study" in empty.stderr
