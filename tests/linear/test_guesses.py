"""The fixed point of a map that swings, creeps and turns at once is found in a few guesses."""

import numpy as np
import pytest

from clast.linear.guesses import CHANGES_MAX, Guesses

SHARES = np.array([-0.95, 0.9, 0.5])
"""By what the map takes one distance from the fixed point to the next: it swings, and creeps."""


def maps(guess: np.ndarray, at: np.ndarray) -> np.ndarray:
    basis = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.0, 1.0, 3.0], [2.0, 0.0, 1.0]]))[0]
    return at + basis @ (SHARES * (basis.T @ (guess - at)))


def test_as_many_guesses_as_it_combines_are_enough_for_a_straight_map():
    at, guesses, guess = np.array([3.0, -1.0, 2.0]), Guesses(), np.zeros(3)
    for _ in range(CHANGES_MAX + 1):
        guesses = guesses.with_one(guess, maps(guess, at))
        guess = guesses.next_guess()
    assert guess == pytest.approx(at, rel=1e-6)
    plain = np.zeros(3)
    for _ in range(CHANGES_MAX + 1):
        plain = maps(plain, at)
    assert np.abs(plain - at).max() > 0.5


def test_it_keeps_no_more_guesses_than_it_combines_and_bears_ones_alike():
    guesses, guess = Guesses(), np.ones(2)
    for _ in range(9):
        guesses = guesses.with_one(guess, guess)
    assert len(guesses.given) == len(guesses.answers) == CHANGES_MAX + 1
    assert np.array_equal(guesses.next_guess(), guess)
    assert np.array_equal(Guesses().with_one(np.zeros(2), guess).next_guess(), guess)
