"""What compilation costs: counted without compiling."""

from __future__ import annotations

import compile_cost

from clast.compute.roots import listed


def test_kernels_are_counted_and_the_largest_comes_first(capsys):
    assert compile_cost.main(["--count"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    known = [root for roots in listed().values() for root in roots if root.is_there]
    assert len(rows) == len(known)
    numbers = [int(number) for number, _ in rows]
    assert numbers == sorted(numbers, reverse=True) and numbers[-1] > 0
