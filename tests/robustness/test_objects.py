"""A run leaves Python's housekeeping as it found it."""

import gc

import pytest

from clast.objects import MANY, left_alone
from clast.simulate import Schedule, simulate
from systems import by_convex, wall


class Ring:
    """An object that refers to itself: only a search for cycles finds it."""

    alive = 0

    def __init__(self):
        self.itself = self
        Ring.alive += 1

    def __del__(self):
        Ring.alive -= 1


def test_old_objects_are_left_alone_and_new_ones_are_not():
    gc.collect()
    Ring()
    with left_alone():
        gc.collect()
        assert Ring.alive == 1
        Ring()
        gc.collect()
        assert Ring.alive == 1
    gc.collect()
    assert Ring.alive == 0


def test_new_objects_are_looked_through_less_often_and_then_as_before():
    usual = gc.get_threshold()
    with left_alone():
        assert gc.get_threshold() == (MANY, *usual[1:])
    assert gc.get_threshold() == usual
    gc.set_threshold(0)  # switched off: so it stays
    try:
        with left_alone():
            assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*usual)


def test_what_others_have_frozen_stays_so():
    gc.freeze()
    try:
        with left_alone():
            pass
        assert gc.get_freeze_count() > 0
    finally:
        gc.unfreeze()


def test_a_run_leaves_nothing_frozen():
    seen = []
    schedule = Schedule(step=1e-3, end=5e-3, every=5e-3)
    simulate(
        wall(2, 2), by_convex(5e9), schedule, watch=lambda _: seen.append(gc.get_freeze_count())
    )
    assert min(seen) > 0
    assert gc.get_freeze_count() == 0


def test_a_run_that_ends_early_leaves_nothing_frozen():
    def stop(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        simulate(wall(2, 2), by_convex(5e9), Schedule(step=1e-3, end=1.0, every=1.0), watch=stop)
    assert gc.get_freeze_count() == 0
