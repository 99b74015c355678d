"""Words of UDEC as keys of a case file: the message has clast's word, as the how-to page has."""

from __future__ import annotations

import pytest

import clast
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.errors import CaseError
from clast.inputs.declaring.validation_messages import UDEC, keys_of, table_in
from scenes.places import ROOT


def refused(word: str) -> str:
    """Return the message about a word in [joint.default]."""
    text = INCLINE.replace("[joint.default]", f"[joint.default]\n{word} = 1.0")
    with pytest.raises(CaseError) as caught:
        clast.Case.from_text(text, "incline.toml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("jkn", "UDEC's 'jkn' is 'normal_stiffness' in clast"),
        ("JFRIC", "UDEC's 'JFRIC' is 'friction_angle' in clast"),
        # the nearest keys to look at are 'cohesion' and 'dilation_until'
        ("jtension", "UDEC's 'jtension' is 'tensile_strength' in clast"),
        ("jdilation", "UDEC's 'jdilation' is 'dilation_angle' in clast"),
        ("dens", "UDEC's 'dens' is 'density' in clast, in the table rock"),
        ("zone", "UDEC's 'zone' is 'rock' in clast"),
        ("boundary", "'boundary' belongs in the table domain"),
        ("friction_angel", "did you mean 'friction_angle'?"),
    ],
)
def test_a_word_of_udec_is_answered_with_that_of_clast(word: str, said: str):
    message = refused(word)
    assert f"[joint.default] {word}: there is no such key" in message
    assert message.endswith(said)


def test_all_are_keys_and_on_the_page():
    page = (ROOT / "docs" / "how-to" / "from-other-programs.md").read_text("utf-8")
    tables = [Case, *(table_in(one.annotation) for one in Case.model_fields.values())]
    keys = {key for table in tables if table is not None for key in keys_of(table)}
    assert set(UDEC.values()) <= keys
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    for word, key in UDEC.items():
        said = [row for row in rows if word in row.split("|")[1].replace("`", " ").split()]
        assert any(key in row for row in said), (word, key)
