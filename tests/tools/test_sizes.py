"""The sizes of folders are held against a budget."""

import sizes


def test_a_folder_above_its_budget_or_without_one_fails():
    lines = {"__init__.py": 2, "step/a.py": 30, "step/deep/b.py": 12, "run/c.py": 5}
    _, above = sizes.report("p", lines, {"all": 49, "step": 42, "run": 5, "root": 2})
    assert not above
    rows, above = sizes.report("p", lines, {"all": 49, "step": 41, "run": 5, "root": 2})
    assert above
    assert [row.split()[0] for row in rows if row.endswith("above its budget")] == ["step"]
    _, above = sizes.report("p", lines, {"all": 49, "step": 42, "root": 2})
    assert above
    assert sizes.lines_of_folders(lines)[1]["step"] == 2


def test_tests_have_one_budget():
    assert not sizes.report("t", {"run/c.py": 5}, {"all": 5})[1]
    assert sizes.report("t", {"run/c.py": 6}, {"all": 5})[1]
