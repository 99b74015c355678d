"""clast cut and clast import: what they print and write."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from typer.testing import CliRunner

from clast.case.case_file import Case
from clast.cli.commands import app
from clast.results import read_results
from clast.rockmass.drawings.blocks_out import (
    read_blocks_npz,
    write_blocks_csv,
    write_blocks_dxf,
    write_blocks_npz,
)
from scenes import legacy_files
from scenes.cut_cases import TUNNEL, TWO_SETS
from scenes.drawn_blocks import rounded, wall


def done(*words: str) -> str:
    result = CliRunner().invoke(app, list(words))
    assert result.exit_code == 0, result.output
    return result.stdout


def refused(*words: str) -> str:
    result = CliRunner().invoke(app, list(words))
    assert result.exit_code == 2 and result.stdout == "", result.output
    return result.stderr


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "tunnel.toml"
    path.write_text(TUNNEL, encoding="utf-8")
    return path


def test_cut_says_what_was_cut(case: Path):
    text = done("cut", str(case))
    cut = Case.from_toml(case).cut().cut
    assert f"{cut.block_count} (" in text and "400 m2" in text
    assert "bedding" in text and "cross" in text and "shale" in text


def test_cut_as_json(case: Path):
    content = json.loads(done("cut", str(case), "--json", "--set", "domain.seed=3"))
    assert content["area"] == pytest.approx(400.0, rel=1e-9)
    assert [one["name"] for one in content["sets"]] == ["bedding", "cross"]
    assert sum(content["rocks"].values()) == content["blocks"]
    assert 0 < content["fixed_blocks"] < content["blocks"] and content["output"] is None


def test_blocks_go_out_by_the_ending(case: Path, tmp_path: Path):
    found = Case.from_toml(case).cut()
    done("cut", str(case), "-o", str(tmp_path / "b.npz"))
    blocks = read_blocks_npz(tmp_path / "b.npz")
    np.testing.assert_array_equal(blocks.vertices, found.cut.vertices)
    assert "construction-joint:heading" in blocks.edge_joint and "shale" in blocks.rock
    done("cut", str(case), "-o", str(tmp_path / "b.csv"))
    assert (tmp_path / "b.csv").read_text().count("\n") == 1 + len(found.cut.vertices)
    done("cut", str(case), "-o", str(tmp_path / "b.dxf"))
    space = ezdxf.readfile(tmp_path / "b.dxf").modelspace()
    assert len(space.query("LWPOLYLINE")) == found.cut.block_count
    assert "JOINTS_construction-joint-heading" in {line.dxf.layer for line in space.query("LINE")}


@pytest.mark.parametrize(("name", "begins"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml")])
@pytest.mark.parametrize("by", ["set", "rock"])
def test_pictures_go_out_by_the_ending(
    case: Path, tmp_path: Path, name: str, begins: bytes, by: str
):
    done("cut", str(case), "-o", str(tmp_path / name), "--by", by)
    assert (tmp_path / name).read_bytes().startswith(begins)


def test_a_report_has_pictures_and_tables(case: Path, tmp_path: Path):
    done("cut", str(case), "-o", str(tmp_path / "a.html"))
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") >= 2 and "bedding" in page and "tunnel" in page


@pytest.mark.parametrize(
    ("output", "words"),
    [("b.txt", ".dxf, .csv, .npz"), ("b", "nothing"), ("none/b.csv", "its folder does not exist")],
)
def test_blocks_that_go_nowhere(case: Path, tmp_path: Path, output: str, words: str):
    assert words in refused("cut", str(case), "-o", str(tmp_path / output))


def test_check_looks_at_a_case_that_is_cut(case: Path):
    text = done("check", str(case))
    assert f"{Case.from_toml(case).cut().cut.block_count} (" in text
    assert "construction-joint:heading" in text


def test_import_of_a_drawing(tmp_path: Path):
    document = ezdxf.new("R2010", units=0)
    space = document.modelspace()
    corners = [(0, 0), (2000, 0), (2000, 1000), (0, 1000)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "BOUNDARY"})
    space.add_line((0, 300), (2000, 300), dxfattribs={"layer": "JOINTS_bedding"})
    space.add_text("Section", dxfattribs={"layer": "TITLE"})
    document.saveas(tmp_path / "site.dxf")
    target, blocks = tmp_path / "site.toml", tmp_path / "b.npz"
    words = ("import", str(tmp_path / "site.dxf"), "-o", str(target), "--unit", "cm")
    text = done(*words, "--blocks", str(blocks))
    assert "outline of the domain 1, traces 1" in text and "cm" in text
    assert "left out: " in text and "TITLE" in text
    assert 'fill in the values marked "to be given" there' in text
    content = tomllib.loads(target.read_text("utf-8"))
    assert content["domain"]["boundary"][2] == [20.0, 10.0]
    assert read_blocks_npz(blocks).count == 2
    assert "already exists" in refused(*words)


def test_import_of_legacy_files_with_their_analysis(tmp_path: Path):
    (tmp_path / "slope.geo").write_text(legacy_files.GEOMETRY)
    (tmp_path / "slope.ana").write_text(legacy_files.ANALYSIS)
    target = tmp_path / "slope.toml"
    text = done(
        *("import", str(tmp_path / "slope.geo"), "-o", str(target)),
        *("--analysis", str(tmp_path / "slope.ana"), "--mass-unit", "1000"),
    )
    assert "left out: " in text and "fixed line" in text
    assert f"next: clast check {target}" in text
    case = Case.from_toml(target)
    assert case.rock["rock-1"].density == 2700.0
    assert case.cut().cut.block_count >= 2


def wall_of(path: Path) -> None:
    """Write a wall whose bricks are rounded to millimetres one by one, one of them clockwise."""
    vertices, start = wall(5, 4)
    vertices = rounded(vertices, np.random.default_rng(5), 4e-4)
    vertices[4:8] = vertices[4:8][::-1]
    WRITERS[path.suffix](path, vertices, start, ["granite"] * (len(start) - 1))


WRITERS = {".csv": write_blocks_csv, ".npz": write_blocks_npz, ".dxf": write_blocks_dxf}
GIVEN = ("rock.granite={young=5e9, poisson=0.2, density=2000}", "time.step=1e-3", "time.end=1e-2")
GIVEN += ("joint.default={friction_angle=30}",)


@pytest.mark.parametrize("ending", WRITERS)
def test_import_of_finished_blocks(ending: str, tmp_path: Path):
    """They are put together, each repair is said with its places, and the case is accepted."""
    wall_of(tmp_path / f"wall{ending}")
    target = tmp_path / "case.toml"
    words = ("import", str(tmp_path / f"wall{ending}"), "-o", str(target), "--as", "blocks")
    text = done(*words, "--tolerance", "0.003")
    assert "taken over: 22 blocks; rocks granite" in text
    assert text.count("repair: ") == 3 and "became one: (" in text
    assert "tolerance 0.003 m: no vertex moved by more than 0.00" in text
    assert "1 blocks ran clockwise and were reversed: 2" in text
    blocks = read_blocks_npz(tmp_path / "case-blocks.npz")
    assert blocks.count == 22
    case = Case.from_toml(target, GIVEN)
    assert len(case.model().overlaps.pair) == 0
    assert "already exists" in refused(*words)


def test_import_of_finished_blocks_as_json(tmp_path: Path):
    wall_of(tmp_path / "wall.npz")
    target = tmp_path / "case.toml"
    file = str(tmp_path / "b.csv")
    words = ("import", str(tmp_path / "wall.npz"), "-o", str(target), "--blocks", file, "--json")
    content = json.loads(done(*words))
    assert content["blocks"] == 22 and content["tolerance"] == 0.0015
    assert {"what", "count", "places"} == set(content["repairs"][0])
    assert all(0 < len(one["places"]) <= 5 for one in content["repairs"])
    assert 'file = "b.csv"' in target.read_text("utf-8")
    assert Case.from_toml(target, GIVEN).model().block_count == 22


def test_check_says_what_was_repaired(tmp_path: Path):
    wall_of(tmp_path / "wall.npz")
    table = '[[block_file]]\nfile = "wall.npz"\nfixed = [1, 2, 3, 4, 5]\n'
    head = "schema = 1\n[time]\nstep = 1e-3\nend = 1e-2\n"
    rock = "[rock.granite]\nyoung = 5e9\npoisson = 0.2\ndensity = 2000.0\n"
    rock += "[joint.default]\nfriction_angle = 30.0\n"
    path = tmp_path / "wall.toml"
    path.write_text(f"{head}{rock}{table}[repair]\ntolerance = 3e-3\n", encoding="utf-8")
    text = done("check", str(path))
    assert "repairs" in text and "became one: (" in text and "reversed" in text
    content = json.loads(done("check", str(path), "--json"))
    assert content["repairs"][0]["count"] > 10 and len(content["repairs"][0]["places"]) == 5
    assert not any("overlap" in one for one in content["warnings"])


def facade(path: Path) -> None:
    """Draw two piers, a lintel as a SOLID, a gable as a 3DFACE, and one pier once more."""
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    pier = [(0, 0), (1, 0), (1, 3), (0, 3)]
    for shift in (0.0, 4.0):
        points = [(x + shift, y) for x, y in pier]
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": "Pier"})
    space.add_lwpolyline(pier[2:] + pier[:2], close=True, dxfattribs={"layer": "Old"})
    space.add_solid([(0, 3), (5, 3), (0, 4), (5, 4)], dxfattribs={"layer": "Lintel"})
    space.add_3dface([(0, 4), (5, 4), (2.5, 5), (2.5, 5)], dxfattribs={"layer": "Gable"})
    document.saveas(path)


def test_drawn_blocks_have_names(tmp_path: Path):
    facade(tmp_path / "facade.dxf")
    target, picture = tmp_path / "a.toml", tmp_path / "names.svg"
    words = ("import", str(tmp_path / "facade.dxf"), "-o", str(target), "--as", "blocks")
    text = done(*words, "--names", str(picture), "--fixed-layers", "pier")
    assert "taken over: 4 blocks" in text and "fixed: 2 blocks on pier" in text
    again = "outlines drawn again were taken once: LWPOLYLINE"
    assert again in text and "on layer Old (as LWPOLYLINE" in text
    assert "4 Gable" in picture.read_text("utf-8") and "2 Pier-2" in picture.read_text("utf-8")
    given = [one.replace("granite", name) for one in GIVEN[:1] for name in ("Pier", "Lintel")]
    given += [GIVEN[0].replace("granite", "Gable"), *GIVEN[1:]]
    case = Case.from_toml(target, [*given, "measured_point=[{name='a', at=[0.5, 3], block='1'}]"])
    model = case.model()
    assert model.block_name == ("Pier-1", "Pier-2", "Lintel", "Gable")
    assert model.fixed.tolist() == [True, True, False, False]
    assert model.measured_points.block.tolist() == [0]
    assert model.area.tolist() == [3.0, 3.0, 5.0, 2.5]
    cut = ("cut", str(tmp_path / "cut.toml"), "--names", str(tmp_path / "cut.png"))
    (tmp_path / "cut.toml").write_text(CUT, encoding="utf-8")
    assert "cut.png" in done(*cut) and (tmp_path / "cut.png").stat().st_size > 1000
    assert ".png, .svg, .pdf" in refused(*cut[:3], "names.txt")


CUT = """schema = 1
time = {step = 1e-3, end = 1e-2}
domain = {boundary = [[0, 0], [4, 0], [4, 2], [0, 2]]}
rock.a = {young = 1e9, poisson = 0.2, density = 2e3}
joint.default = {friction_angle = 30}
joint_set = [{name = "a", spacing = 1.0, angle = 90.0}]
"""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("facade.dxf", "-o", "a.toml", "--as", "blocks", "--fixed-layers", "peer"), "'Pier'"),
        (("wall.csv", "-o", "a.toml", "--fixed-layers", "a"), "the file has no layers"),
        (("traces.csv", "-o", "a.toml", "--fixed-layers", "a"), "blocks are made by cutting"),
        (("wall.csv", "-o", "a.toml", "--tolerance", "0.3"), "median edge"),
        (("wall.csv", "-o", "a.toml", "--tolerance", "0"), "not a valid distance"),
        (("site.dxf", "-o", "a.toml", "--as", "drawing"), "--as blocks"),
        (("none.npz", "-o", "a.toml"), "no such file"),
        (("traces.csv", "-o", "a.toml", "--tolerance", "1e-3"), "[domain] has a tolerance"),
    ],
)
def test_blocks_that_cannot_be_imported(words, said, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("wall.csv", "site.dxf"):
        wall_of(Path(name))
    facade(Path("facade.dxf"))
    Path("traces.csv").write_text("x1,y1,x2,y2\n0,0,1,1\n")
    assert said in refused("import", *words)
    assert not Path("a.toml").exists() and not Path("a-blocks.npz").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("none.dxf", "-o", "a.toml"), "no such file"),
        (("site.csv", "-o", "a.txt"), "use a name ending in .toml"),
        (("site.csv", "-o", "none/a.toml"), "its folder does not exist"),
        (("site.csv", "-o", "a.toml", "--blocks", "b.svg"), ".dxf, .csv, .npz"),
        (("site.csv", "-o", "a.toml", "--blocks", "b.npz"), "no outline of the domain"),
        (("site.geo", "-o", "a.toml", "--mass-unit", "-1"), "mass"),
        (("site.dxf", "-o", "a.toml", "--unit", "furlong"), "not a valid unit"),
    ],
)
def test_what_cannot_be_imported(words, said, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("site.csv").write_text("x1,y1,x2,y2\n0,0,1,1\n")
    Path("site.geo").write_text(legacy_files.GEOMETRY)
    document = ezdxf.new("R2010", units=6)
    document.modelspace().add_circle((0, 0), 1, dxfattribs={"layer": "BOUNDARY"})
    document.saveas("site.dxf")
    assert said in refused("import", *words)
    assert not Path("a.toml").exists()


def test_run_of_a_case_that_is_cut(tmp_path: Path):
    """Contacts have the friction of the set that their entrance edge belongs to."""
    path = tmp_path / "sets.toml"
    path.write_text(TWO_SETS, encoding="utf-8")
    output = tmp_path / "sets.vtkhdf"
    sides = 'domain.fixed_sides=["bottom"]'
    content = json.loads(done("run", str(path), "-o", str(output), "--set", sides, "--json"))
    assert content["steps"] == 5
    results = read_results(output)
    contacts = results.contacts()
    case = Case.from_toml(path)
    model = case.model()
    start, end = model.vertices, model.vertices[following(model.block_start)]
    angle = np.degrees(np.arctan2(*(end - start).T[::-1])) % 180.0
    edge = contacts["edge"]
    flat = np.abs(angle[edge] - 10.0) < 1.0
    normal, shear = contacts["normal_force"], np.abs(contacts["shear_force"])
    # one that has just begun to bear, or is about to open, lags most
    bears = normal > 1e-3 * normal.max()
    bound = np.tan(np.radians(np.where(flat, 20.0, 35.0)))
    ratio = shear[bears] / (normal[bears] * bound[bears])
    # friction follows the normal force of the step before, which still changes after five steps;
    # the friction of the other set would reach 1.92 on the flat edges
    slides = ratio[flat[bears]]
    assert 0.9 < slides.max() < 1.4 and ratio.max() < 1.4


def following(start: np.ndarray) -> np.ndarray:
    """Return the vertex after each vertex in its block, shape (nv,)."""
    after = np.arange(1, start[-1] + 1)
    after[start[1:] - 1] = start[:-1]
    return after
