"""The list of kernels, with what they cost."""

from __future__ import annotations

import compile_cost

from clast.compute.roots import listed


def test_kernels_are_shown_the_slowest_first(capsys):
    assert compile_cost.main([]) == 0
    *rows, whole = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert len(rows) == sum(map(len, listed().values()))
    seconds = [float(row[0]) for row in rows]
    assert seconds == sorted(seconds, reverse=True) and seconds[0] > 0.0
    assert float(whole[0]) > 10.0
