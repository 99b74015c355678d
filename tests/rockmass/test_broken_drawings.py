"""Broken drawings: each gives one clear message with its place, and never another error.

The last tests cut good files short and change bytes of them at random.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from clast.case.drawn_case import case_text
from clast.errors import CaseError, ClastError
from clast.rockmass.drawings.blocks_out import read_blocks_npz, write_blocks_npz
from clast.rockmass.drawings.csv_lines import read_csv, read_outline, read_traces
from clast.rockmass.drawings.dda_xml import read_dda_xml
from clast.rockmass.drawings.dxf import DxfReading, read_dda_dxf, read_dxf
from clast.rockmass.drawings.shi_files import read_shi_analysis, read_shi_blocks, read_shi_geometry
from clast.rockmass.readers import read_drawing
from scenes.legacy_files import ANALYSIS, BLOCKS, GEOMETRY, XML

READERS: dict[str, Callable[[Path], Any]] = {
    "traces": read_traces,
    "outline": read_outline,
    "csv": read_csv,
    "geometry": read_shi_geometry,
    "analysis": read_shi_analysis,
    "blocks": read_shi_blocks,
    "xml": read_dda_xml,
    "dxf": read_dxf,
}

TEXTS = [
    # reader, text, what the message must say
    ("csv", "", "has no rows"),
    ("csv", "# nothing\n\n", "has no rows"),
    ("csv", "x1,y1,x2,y2\n", "heading but no rows"),
    ("csv", "1,2,3\n", "3 columns without a heading"),
    ("csv", "1,2\n3,4\n", "2 columns without a heading"),
    ("csv", "a,b,c,d\n1,2,3,4\n", "columns a, b, c, d"),
    ("csv", "x1,y1,x2,z2\n1,2,3,4\n", "z2"),
    ("csv", "x1,y1,x2,y2,jiont\n1,2,3,4,a\n", "did you mean 'joint'"),
    ("csv", "x1,y1,x1,y2\n1,2,3,4\n", "two columns x1"),
    ("csv", "0,0,1,1\n0,0,1\n", "line 2.*3 columns instead of 4"),
    ("csv", "0,0,1,1\n0,0,1,1,7\n", "line 2.*5 columns"),
    ("csv", "x1,y1,x2,y2\n0,0,1,one\n", "line 2, column y2.*'one' is not a number"),
    ("csv", "x1,y1,x2,y2\n0,0,1,\n", "line 2, column y2.*is empty"),
    ("csv", "x1,y1,x2,y2\n0,0,1,nan\n", "'nan' is not a number"),
    ("csv", "x1,y1,x2,y2\n0,0,1,1e400\n", "line 2, column y2"),
    ("csv", "x1,y1,x2,y2\n0,0,1,1e15\n", "far too large"),
    ("csv", "x1,y1,x2,y2\n0,0,1,1_000\n", "'1_000' is not a number"),
    ("csv", 'x1,y1,x2,y2\n0,0,1,"2\n', "line 2.*cannot be split"),
    ("csv", "id,x,y\n,1,2\n", "line 2, column id.*is empty"),
    ("csv", "id,x,y,joint\na,1,2,f\na,3,4,g\n", "a name the joints f, g"),
    ("csv", "dip,dip_direction\n95,10\n", "95 is not a valid dip"),
    ("csv", "dip,dip_direction\n45,-10\n", "-10 is not a valid dip direction"),
    ("csv", "dip,dip_direction,length\n45,10,0\n", "0 is not a valid length"),
    ("csv", "x,y\n0,0\n1,1\n", "2 different points"),
    ("csv", "x,y\n0,0\n4,4\n4,0\n0,4\n", r"crosses or touches itself at \(2, 2\) m"),
    ("csv", "x,y\n0,0\n1,1\n2,2\n", "crosses or touches itself"),
    ("traces", "x,y\n0,0\n1,0\n1,1\n", "has no traces"),
    ("outline", "0,0,1,1\n", "is not an outline"),
    ("geometry", "", "line 1.*ends before the node distance"),
    ("geometry", "title of the file", "the text there is not a number"),
    ("geometry", "7 4 1", "7 is not a node distance"),
    ("geometry", GEOMETRY.replace("7 4\n", "7\n", 1), "line"),
    ("geometry", GEOMETRY.replace("7 4\n", "7.5 4\n", 1), "7.5 is not a valid number of lines"),
    ("geometry", GEOMETRY.replace("7 4\n", "-7 4\n", 1), "-7 is not a valid number of lines"),
    (
        "geometry",
        GEOMETRY.replace("7 4\n", "7 8\n", 1),
        ("8 boundary lines are announced, but only 7"),
    ),
    ("geometry", GEOMETRY.replace("7 4\n", "900 4\n", 1), "900 lines are announced"),
    (
        "geometry",
        GEOMETRY.replace("21  5 2", "21 5 2.5"),
        ("line 11.*2.5 is not a valid joint type number"),
    ),
    ("geometry", GEOMETRY.replace("21  5 2", "21 5 0"), "line 11.*numbered from 1"),
    ("geometry", GEOMETRY.replace("21  5 2", "21 x 2"), "line 11.*'x' is not a number"),
    ("geometry", GEOMETRY.replace("21  5 2", "21 inf 2"), "line 11.*'inf' is not a number"),
    ("geometry", GEOMETRY.replace("4  2 1.0D3", "2  2 1.0D3"), "line 15.*length 0"),
    ("geometry", GEOMETRY.rpartition(" 1  1")[0], "ends before hole point 2"),
    ("geometry", "0.1 1 1 0 0 0 0 0 0 0 0 1 1 1", "enclose no area"),
    ("analysis", "", "ends before the analysis type"),
    ("analysis", "3" + ANALYSIS[1:], "3 is not an analysis type"),
    ("analysis", ANALYSIS.replace("1 100", "1 0"), "the steps is 0"),
    ("analysis", ANALYSIS.replace("0.01 0.001", "0.01 0"), "time step is 0"),
    ("analysis", ANALYSIS.replace("0.01 0.001", "-1 1"), "displacement ratio is -1"),
    ("analysis", ANALYSIS.replace("2 3\n", "2 30\n"), "30 joint materials are announced"),
    ("analysis", ANALYSIS.replace("30 5 1", "thirty 5 1"), "line 7.*the text there"),
    ("analysis", ANALYSIS[:80], "materials|ends before|no number"),
    ("blocks", "0 0 0 0 0 0", "has no blocks"),
    ("blocks", BLOCKS.replace("1 1 4", "1 1 2", 1), "block 1 has the vertices 1 to 2"),
    ("blocks", BLOCKS.replace("1 1 4", "1 0 4", 1), "block 1 has the vertices 0 to 4"),
    ("blocks", BLOCKS.replace("2 9 11", "2 9 99", 1), "line 4.*9 to 99 of 15"),
    ("blocks", BLOCKS.replace("1 1 4", "0 1 4", 1), "0 is not a valid material number"),
    ("blocks", BLOCKS.replace("2 1 0\n3 1 1", "2 0 1\n3 0 0.5", 1), "block 1 has no area"),
    ("blocks", BLOCKS[:60], "ends before|numbers follow"),
    ("xml", "", "is not XML"),
    ("xml", "<DDA>", "is not XML.*"),
    ("xml", "<html/>", "its root is html, not DDA"),
    ("xml", "<DDA/>", "no lines and no materials"),
    ("xml", XML.replace(">-1 0 21 0<", ">-1 0 21<"), "line 10, line.*3 numbers instead of 4"),
    ("xml", XML.replace(">-1 0 21 0<", ">a b c d<"), "line 10, line.*'a' is not a number"),
    ("xml", XML.replace('Joint type="2"', "Joint"), "line 6, joint.*0 numbers.*a type"),
    ("xml", XML.replace('Joint type="2"', 'Joint type="x"'), "line 6, joint.*'x'"),
    (
        "xml",
        XML.replace('Joint type="2"', 'Joint type="-1"'),
        "-1 is not a valid joint type number",
    ),
    ("xml", XML.replace("<dda:Unitmass>2.7</dda:Unitmass>", ""), "has no unitmass"),
    ("xml", XML.replace("<dda:Friction>20<", "<dda:Friction>20 30<"), "2 numbers instead of one"),
    ("xml", XML.replace("<dda:Istress>-10 -100 1<", "<dda:Istress>1 2<"), "2 numbers instead of 3"),
    ("xml", XML.replace('flag="1"', 'flag="maybe"'), "'maybe' is neither"),
    ("xml", XML.replace('type="dynamic"', 'type="fast"'), "'fast' is not a type of analysis"),
    ("xml", XML.replace('timesteps="100"', 'timesteps="1.5"'), "Numtimesteps is 1.5"),
    ("xml", XML.replace('numpoints="2">0 0 -5', 'numpoints="3">0 0 -5'), "numpoints is 3"),
    ("xml", XML.replace("1 0 -5<", "1 0<"), "is not t fx fy"),
    ("xml", XML.replace('encoding="utf-8"', 'encoding="klingon"'), "is not XML"),
    ("xml", "<DDA>" + "<a>" * 200 + "</a>" * 200 + "</DDA>", "nested too deeply"),
    ("dxf", "", "is not a DXF file"),
    ("dxf", "hello", "is not a DXF file"),
    ("dxf", "AC1032\0\0\0\0", "is a DWG file"),
]


@pytest.mark.parametrize(("reader", "text", "message"), TEXTS)
def test_broken_texts(tmp_path, reader, text, message):
    path = tmp_path / "broken.txt"
    path.write_text(text, "utf-8")
    with pytest.raises(CaseError) as refused:
        READERS[reader](path)
    assert re.search(message, str(refused.value), re.DOTALL), str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert len(str(refused.value).splitlines()) <= 2


def draws(path: Path, *calls: tuple[Any, ...]) -> Path:
    """Write a DXF file: the name of a method of the model space, its arguments, its layer."""
    document = ezdxf.new("R2010", units=6)
    for name, *arguments, layer in calls:
        getattr(document.modelspace(), name)(*arguments, dxfattribs={"layer": layer})
    document.saveas(path)
    return path


BOX = ("add_polyline2d", [(0, 0), (9, 0), (9, 9), (0, 9), (0, 0)], "BOUNDARY")
DRAWINGS = [
    ([], "layer BOUNDARY(?s:.)*nothing is drawn"),
    ([("add_point", (0, 0), "BOUNDARY")], "BOUNDARY has 0 outlines"),
    ([("add_line", (0, 0), (1, 0), "BOUNDARY")], "not closed: a gap of 1 m"),
    ([("add_line", (0, 0), (0, 0), "BOUNDARY")], "BOUNDARY has 0 outlines"),
    ([BOX, ("add_circle", (4, 4), 1, "BOUNDARY")], "has 2 outlines, not one: POLYLINE"),
    ([BOX, ("add_circle", (4, 4), 0, "JOINTS")], "CIRCLE.*radius 0"),
    ([BOX, ("add_circle", (4, 4), -1, "JOINTS")], "CIRCLE.*radius -1"),
    ([BOX, ("add_line", (0, 0, 0), (1, 1, 1), "JOINTS")], "not planar: z ranges from 0 .* to 1"),
    ([BOX, ("add_line", (0, 0), (1e14, 0), "JOINTS")], "LINE.*far too large"),
    ([BOX, ("add_line", (0, 0), (float("nan"), 0), "JOINTS")], "LINE.*not a finite number"),
    (
        [("add_polyline2d", [(0, 0), (9, 9), (9, 0), (0, 9), (0, 0)], "BOUNDARY")],
        r"crosses or touches itself at \(4.5, 4.5\)",
    ),
    (
        [BOX, ("add_polyline2d", [(1, 1), (2, 1), (2, 2), (1, 2)], "OPENINGS_a")],
        "not closed: a gap of 1 m",
    ),
    (
        [BOX, ("add_polyline2d", [(1, 1), (2, 2), (2, 1), (1, 2), (1, 1)], "REGIONS_a")],
        "crosses or touches itself",
    ),
]


@pytest.mark.parametrize(("calls", "message"), DRAWINGS)
def test_broken_drawings(tmp_path, calls, message):
    path = draws(tmp_path / "x.dxf", *calls)
    with pytest.raises(CaseError, match=message) as refused:
        read_dxf(path)
    assert str(refused.value).startswith(str(path))


def test_a_block_in_itself_is_no_endless_loop(tmp_path):
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    space.add_circle((0, 0), 9, dxfattribs={"layer": "BOUNDARY"})
    for name, other in (("A", "B"), ("B", "A")):
        document.blocks.new(name).add_blockref(other, (0, 0))
    space.add_blockref("A", (0, 0), dxfattribs={"layer": "JOINTS"})
    document.saveas(tmp_path / "x.dxf")
    assert read_dxf(tmp_path / "x.dxf").traces == ()


def test_blocks_of_blocks_of_blocks_are_refused_before_memory_ends(tmp_path, monkeypatch):
    monkeypatch.setattr("clast.rockmass.drawings.dxf_entities.ENTITIES_MAX", 500)
    document = ezdxf.new("R2010", units=6)
    document.blocks.new("B0").add_line((0, 0), (1, 0))
    for k in range(1, 6):
        block = document.blocks.new(f"B{k}")
        for x in range(10):
            block.add_blockref(f"B{k - 1}", (x, k))
    document.modelspace().add_blockref("B5", (0, 0), dxfattribs={"layer": "JOINTS"})
    document.saveas(tmp_path / "x.dxf")
    with pytest.raises(CaseError, match="more than 500 entities"):
        read_dxf(tmp_path / "x.dxf")


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"unit": "furlong"}, "'furlong' is not a valid unit"),
        ({"unit": 0.0}, "0.0 is not a valid length"),
        ({"unit": float("nan")}, "nan is not a valid length"),
        ({"sagitta": 0.0}, "sagitta"),
        ({"sagitta": 1e-14}, "more than 100000 chords"),
        ({"tolerance": -1.0}, "tolerance"),
    ],
)
def test_readings_that_make_no_sense(tmp_path, how, message):
    path = draws(tmp_path / "x.dxf", ("add_circle", (0, 0), 9, "BOUNDARY"))
    with pytest.raises(CaseError, match=message):
        read_dxf(path, DxfReading(**how))


def test_a_unit_that_no_rock_is_drawn_in(tmp_path):
    path = draws(tmp_path / "x.dxf", BOX)
    document = ezdxf.readfile(path)
    document.header["$INSUNITS"] = 19
    document.saveas(path)
    with pytest.raises(CaseError, match=r"\$INSUNITS is 19"):
        read_dxf(path)


def test_without_ezdxf_the_message_says_what_to_install(tmp_path, monkeypatch):
    path = draws(tmp_path / "x.dxf", BOX)
    monkeypatch.setitem(__import__("sys").modules, "ezdxf", None)
    monkeypatch.setitem(__import__("sys").modules, "ezdxf.recover", None)
    with pytest.raises(CaseError, match=r'pip install "clast\[dxf\]"'):
        read_dxf(path)


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing", "there is no such file"),
        (".", "is a directory"),
        ("a\0b", "is not a valid file name"),
    ],
)
def test_files_that_cannot_be_opened(tmp_path, reader, name, message):
    with pytest.raises(CaseError, match=message):
        READERS[reader](tmp_path / name)


@pytest.mark.parametrize("name", ["a.dwg", "a.png", "a.toml", "a.npz"])
def test_files_that_are_no_drawings(tmp_path, name):
    (tmp_path / name).write_bytes(b"x")
    with pytest.raises(CaseError, match="not a drawing that clast can read"):
        read_drawing(tmp_path / name)


# At random ---------------------------------------------------------------------------------------

ROUNDS = 60
"""Damaged files of each kind and of each way to damage them."""


def drawing_text(folder: Path) -> bytes:
    """Return a DXF file with every kind of entity that is read."""
    document = ezdxf.new("R2000", units=4)
    space = document.modelspace()
    boundary = {"layer": "BOUNDARY"}
    space.add_lwpolyline([(0, 0), (9, 0, 0, 0, 0.5), (9, 9)], close=True, dxfattribs=boundary)
    block = document.blocks.new("B")
    block.add_line((0, 0), (1, 1))
    block.add_arc((0, 0), 1, 0, 90)
    space.add_blockref("B", (3, 3), dxfattribs={"layer": "JOINTS_a", "xscale": 2})
    space.add_spline([(0, 0), (1, 2), (3, 1)], dxfattribs={"layer": "JOINTS"})
    space.add_ellipse((4, 4), (2, 0), 0.5, dxfattribs={"layer": "OPENINGS_e"})
    space.add_polyline2d([(1, 1, 0.5), (2, 2, 0)], format="xyb", dxfattribs={"layer": "JOINTS"})
    space.add_mtext("F", dxfattribs={"insert": (1, 1)})
    space.add_point((1, 1), dxfattribs={"layer": "FIXED"})
    document.saveas(folder / "good.dxf")
    return (folder / "good.dxf").read_bytes()


def archive(folder: Path) -> bytes:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    write_blocks_npz(folder / "good.npz", square, [0, 4], ["a"], ["", "b", "", ""])
    return (folder / "good.npz").read_bytes()


def encoded(text: str) -> Callable[[Path], bytes]:
    return lambda folder: text.encode()


TABLE = "id,x,y,joint\na,0,0,f\na,1,1,f\nb,5,5,g\nb,6,5,g\n"
SURVEY = "dip;dip_direction;length\n30,5;120;4\n60;10;\n"
GOOD: dict[str, tuple[Callable[[Path], bytes], Callable[[Path], Any]]] = {
    "table.csv": (encoded(TABLE), read_csv),
    "survey.csv": (encoded(SURVEY), read_csv),
    "geometry.dat": (encoded(GEOMETRY), read_shi_geometry),
    "analysis.dat": (encoded(ANALYSIS), read_shi_analysis),
    "blocks.dat": (encoded(BLOCKS), read_shi_blocks),
    "both.xml": (encoded(XML), read_dda_xml),
    "site.dxf": (drawing_text, read_dxf),
    "dda.dxf": (drawing_text, read_dda_dxf),
    "blocks.npz": (archive, read_blocks_npz),
}


def cut_short(content: bytes, random: np.random.Generator) -> bytes:
    return content[: random.integers(len(content))]


def digits(content: bytes, random: np.random.Generator) -> bytes:
    """Change some characters of numbers, where it hurts most."""
    places = [found.start() for found in re.finditer(rb"[0-9.]", content)]
    changed = bytearray(content)
    for place in random.choice(places, random.integers(1, 6)):
        changed[place] = random.choice(list(b"0123456789.-eE,nx "))
    return bytes(changed)


def line_lost(content: bytes, random: np.random.Generator) -> bytes:
    lines = content.split(b"\n")
    del lines[random.integers(len(lines))]
    return b"\n".join(lines)


@pytest.mark.parametrize("damage", [cut_short, digits, line_lost])
@pytest.mark.parametrize("name", GOOD)
def test_damaged_files_are_read_or_refused(tmp_path, name, damage):
    make, read = GOOD[name]
    content = make(tmp_path)
    path = tmp_path / name
    path.write_bytes(content)
    read(path)  # the good one
    if name.endswith(".dxf"):  # the entities are what is damaged: most of the file are tables
        head, mark, content = content.partition(b"ENTITIES")
    else:
        head, mark = b"", b""
    random = np.random.default_rng([len(content), len(damage.__name__)])
    for _ in range(ROUNDS if not name.endswith(".dxf") else ROUNDS // 4):
        path.write_bytes(head + mark + damage(content, random))
        try:
            found = read(path)
            if hasattr(found, "traces"):
                case_text(found)
        except ClastError as refused:
            assert str(refused).count("\n") <= 1, refused
