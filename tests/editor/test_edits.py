"""Edits change one value of a case file, and not a byte of anything else."""

import tomllib

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.edits import Edit, edited
from clast.errors import CaseError
from clast.inputs.declaring.positions import places_of
from scenes.odd_toml import ODD, at, changed_and_back, places, written
from scenes.places import ROOT

WORKED = {path.name: path.read_bytes().decode() for path in (ROOT / "cases").rglob("*.toml")}
TEXTS = {**TEMPLATES, **{name: WORKED[name] for name in ("wall.toml", "wall-2x6.toml")}}
TEXTS["odd"] = ODD
TEXTS["odd, from Windows"] = ODD.replace("\n", "\r\n")


@pytest.mark.parametrize("text", [*TEMPLATES.values(), *WORKED.values(), TEXTS["odd"]])
def test_every_value_is_where_it_is_said_to_be(text):
    content, found = tomllib.loads(text), written(text)
    for place, raw in found.items():
        assert tomllib.loads(f"v = {raw}\n")["v"] == at(content, place)
    single = {one for one in places(content) if not isinstance(at(content, one), dict | list)}
    assert single <= found.keys()
    names = {place for place in places(content) if isinstance(place[-1], str)}
    named = {named for named, _, _ in places_of(text).names}
    assert named == names


@pytest.mark.parametrize("name", TEXTS)
def test_a_value_changed_and_changed_back_gives_the_old_bytes(name):
    text = TEXTS[name]
    content, found = tomllib.loads(text), written(text)
    step = max(1, len(found) // 12)  # each value: tests/long/editor
    for place, raw in list(found.items())[::step]:
        changed_and_back(text, content, place, raw)


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_key_more_and_less_leaves_the_bytes(name):
    text = TEMPLATES[name]
    heads = [one.place for one in places_of(text).sections]
    for head in heads[:: 1 + len(heads) // 40]:  # the heap has seventy alike
        more = edited(text, Edit("set", (*head, "more"), "5e9"))
        assert at(tomllib.loads(more), head)["more"] == 5e9
        assert edited(more, Edit("remove", (*head, "more"))) == text


def test_comments_stay_with_what_they_speak_of():
    text = "[a]\nx = 1\n\n# of b\n[[b]]\ny = 1  # y\n\n# of c\n[c]\nz = 1\n"
    assert edited(text, Edit("set", ("a", "w"), "2")) == text.replace("x = 1\n", "x = 1\nw = 2\n")
    assert edited(text, Edit("remove", ("b", 0))) == "[a]\nx = 1\n\n# of c\n[c]\nz = 1\n"
    more = edited(text, Edit("insert", ("b", 1), "{y = 2, v = [1, 2]}"))
    assert more == text.replace("# of c", "[[b]]\ny = 2\nv = [1, 2]\n\n# of c")
    assert edited(text, Edit("insert", ("b", 0), "{y = 2}")) == text.replace(
        "# of b", "[[b]]\ny = 2\n\n# of b"
    )


def test_points_keep_their_lines():
    text = "p = [\n  [0, 0],  # foot\n  [1, 0],  # toe\n  [1, 1]  # top\n]\n"
    more = edited(text, Edit("insert", ("p", 3), "[0, 1]"))
    assert more == text.replace("[1, 1]  # top", "[1, 1],  # top\n  [0, 1]")
    assert edited(more, Edit("remove", ("p", 3))) == text.replace("1]  #", "1],  #")
    assert edited(text, Edit("insert", ("p", 1), "[2, 0]")) == text.replace(
        "  [1, 0]", "  [2, 0],\n  [1, 0]"
    )
    assert edited(text, Edit("remove", ("p", 1))) == text.replace("  [1, 0],  # toe\n", "")


def test_a_name_is_changed_in_all_heads():
    text = '[rock.a]\nx = 1\n[rock.a.law]\nx = 2\n[rock."b c"]\nx = 3\n'
    renamed = edited(text, Edit("rename", ("rock", "a"), "hard rock"))
    assert renamed == text.replace("rock.a", 'rock."hard rock"')
    with pytest.raises(CaseError, match="there is 'b c' already"):
        edited(text, Edit("rename", ("rock", "a"), "b c"))


@pytest.mark.parametrize(
    "edit",
    [
        Edit("set", ("time", "step"), "1\nend = 2"),
        Edit("set", ("time", "step"), "1 # a comment"),
        Edit("set", ("time", "step"), "3 mm"),
        Edit("set", ("time", "step"), ""),
        Edit("set", ("time", "step", "inner"), "1"),
        Edit("remove", ("time", "ste")),
        Edit("remove", ()),
        Edit("insert", ("block", 7), "{}"),
        Edit("insert", ("block", 0, "vertices", 9), "[0, 0]"),
        Edit("insert", ("time", "x"), "1"),
        Edit("insert", ("block", 0), "1"),
        Edit("rename", ("time", "none"), "x"),
    ],
    ids=str,
)
def test_what_cannot_be_changed_is_refused(edit):
    with pytest.raises(CaseError):
        edited(ODD, edit)
    with pytest.raises(CaseError, match="is not TOML"):
        edited("a = ", edit)


def test_lines_of_faults():
    where = places_of(ODD)
    lines = ODD.split("\n")
    assert lines[where.line(("time", "step")) - 1] == "  step = 1e-3"
    assert lines[where.line(("block", 1)) - 1] == "[[block]]  # interleaved"
    assert lines[where.line(("block", 0, "vertices", 2, 1)) - 1] == "    [1, 1],   # another"
    assert lines[where.line(("rock", "hard # rock", "density")) - 1] == '[rock."hard # rock"]'
    assert where.line(("nothing",)) is None


@pytest.mark.parametrize(
    "text", [ODD, TEMPLATES["slope"], "[a]\nx = 1\n", "# of a\n[a]\nx = 1\n", ""]
)
@pytest.mark.parametrize(
    "edit", [Edit("set", ("schema",), "2"), Edit("set", ("a", "y"), "2")], ids=str
)
def test_a_byte_order_mark_stays(text, edit):
    after = edited(text, edit)
    assert at(tomllib.loads(after), edit.place) == 2
    assert edited(f"\ufeff{text}", edit) == f"\ufeff{after}"


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_an_entry_is_put_behind_the_next_with_its_comments(end):
    one, other = (
        '# of A\n[[s]]\nname = "A"\nj.x = {y = 1}  # x\n',
        '[[s]]\nname = "B"\n[s.k]\nz = 2\n',
    )
    text, swapped = (
        f"a = 1\n\n{first}\n# alone\n\n{second}\n[c]\n".replace("\n", end)
        for first, second in ((one, other), (other, one))
    )
    assert edited(text, Edit("swap", ("s", 0))) == swapped
    assert edited(swapped, Edit("swap", ("s", 0))) == text
    assert edited("[[s]]\nx = 1\n[[s]]\nx = 2", Edit("swap", ("s", 0))) == (
        "[[s]]\nx = 2\n[[s]]\nx = 1\n"
    )
    assert edited("v = [1, {x = 2}, 3]", Edit("swap", ("v", 1))) == "v = [1, 3, {x = 2}]"
    with pytest.raises(CaseError, match=r"s\.3: there is no such entry"):
        edited(text, Edit("swap", ("s", 1)))
    with pytest.raises(CaseError, match="is no item of a list"):
        edited(text, Edit("swap", ("s",)))
