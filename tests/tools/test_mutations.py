"""The wrong formulas of tools/mutations.py can be made: each stands once in its file."""

from __future__ import annotations

import ast
import hashlib
from pathlib import Path

import pytest
from mutations import MUTATIONS, Mutation, mutated, order_of_tests, take_kernels

TESTS = Path(__file__).parents[1]
PACKAGE = TESTS.parent / "src" / "clast"
CHAPTERS = {"model", "block", "contact", "linear", "minimise", "actions", "step"}


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda one: f"{one.file}: {one.wrong}")
def test_a_formula_stands_once_and_can_be_made_wrong(mutation: Mutation):
    right = (PACKAGE / mutation.file).read_text("utf-8")
    wrong = mutated(right, mutation)
    assert ast.dump(ast.parse(wrong)) != ast.dump(ast.parse(right))


def test_there_are_formulas_of_every_chapter():
    assert len(MUTATIONS) == 48
    assert {Path(one.file).parts[0] for one in MUTATIONS} == CHAPTERS


def test_a_formula_that_is_gone_is_said():
    with pytest.raises(ValueError, match="not once"):
        mutated("a + b", Mutation("block/none.py", "a - b", "a + b"))


def test_tests_of_the_module_come_first():
    order = order_of_tests(Mutation("contact/laws.py", "", ""), TESTS)
    assert str(TESTS / "contact" / "test_laws.py") in order[0]
    assert order[1] == [str(TESTS / "contact")]
    assert order[2] == [str(TESTS / "linear")]


def test_kernels_come_along_under_the_name_of_their_new_place(tmp_path):
    own, other = tmp_path / "own", tmp_path / "other"

    def place(root: Path) -> Path:
        number = hashlib.sha1(str(root / "contact").encode(), usedforsecurity=False).hexdigest()
        return root / "contact" / "__pycache__" / "laws-0123" / f"contact_{number}"

    place(own).mkdir(parents=True)
    (place(own) / "laws.one.nbi").write_bytes(b"code")
    take_kernels(own, other)
    assert (place(other) / "laws.one.nbi").read_bytes() == b"code"
