"""Guesses of a fixed point x = g(x), each better than the last (Anderson 1965).

With residuals f = g - x, the changes of f are combined so that the rest of the last f is least, and
the same is taken off the last g.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats

CHANGES_MAX = 3
"""Changes from guess to guess that are combined, at most."""


@dataclass(frozen=True)
class Guesses:
    """Guesses x, shape (k, m), and their values g(x), (k, m), the last ones last."""

    given: tuple[Floats, ...] = ()
    """The guesses, shape (m,) each."""
    answers: tuple[Floats, ...] = ()
    """Their values, shape (m,) each."""

    def with_one(self, given: Floats, answer: Floats) -> Guesses:
        """Return the last guesses and one more."""
        return Guesses((*self.given[-CHANGES_MAX:], given), (*self.answers[-CHANGES_MAX:], answer))

    def next_guess(self) -> Floats:
        """Return the next guess, shape (m,); after one guess its value."""
        answers = np.array(self.answers)
        residuals = answers - np.array(self.given)
        changes = np.diff(residuals, axis=0)
        # einsum adds in one order whatever the number of threads
        products = np.einsum("km,lm->kl", changes, changes)
        right = np.einsum("km,m->k", changes, residuals[-1])
        # Share of the largest product of changes below which they are not told apart
        shares = np.linalg.lstsq(products, right, rcond=1e-12)[0]
        return np.asarray(answers[-1] - np.einsum("k,km->m", shares, np.diff(answers, axis=0)))
