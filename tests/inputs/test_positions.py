"""Lines of a text that tables and keys take, as the text pane marks them."""

import pytest

from clast.case.templates import TEMPLATES
from clast.inputs.declaring.positions import places_of

TEXT = """title = "a"

# of the set
[[joint_set]]
angle = [
  1, # one
  2]
[joint_set.spacing]
mean = 3
[joint]

[joint."a b"]
x.y = 1
z = 2"""


def test_tables_and_keys_have_their_lines():
    spans = {place: (first, last) for place, first, last in places_of(TEXT).spans()}
    assert spans == {
        ("title",): (1, 1),
        ("joint_set", 0): (4, 7),
        ("joint_set", 0, "angle"): (5, 7),
        ("joint_set", 0, "spacing"): (8, 9),
        ("joint_set", 0, "spacing", "mean"): (9, 9),
        ("joint",): (10, 10),
        ("joint", "a b"): (12, 14),
        ("joint", "a b", "x", "y"): (13, 13),
        ("joint", "a b", "z"): (14, 14),
    }


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("name", ["slope", "lined-tunnel"])
def test_the_first_line_is_that_of_a_fault_there(name, newline):
    places = places_of(TEMPLATES[name].replace("\n", newline))
    lines = TEMPLATES[name].split("\n")
    for place, first, last in places.spans():
        assert first == places.line(place)
        assert lines[first - 1].lstrip().startswith(("[", *map(str, place)))
        assert lines[last - 1].strip() != ""
