"""The next guess of a fixed point x = g(x), from guesses and their values (Anderson 1965).

With residuals f = g - x of the last guesses, the changes of f are combined so that the rest of the
last f is least, and the same combination is taken off the last g.  Where g swings about its fixed
point, or creeps towards it, that takes a few guesses in place of tens.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats

DEPTH = 3
"""Changes from guess to guess that are combined, at most."""
ALIKE = 1e-12
"""Share of the largest product of changes below which they are not told apart."""


@dataclass(frozen=True)
class Guesses:
    """Guesses x, shape (k, m), and their values g(x), (k, m), the last ones last."""

    given: tuple[Floats, ...] = ()
    """The guesses, shape (m,) each."""
    answers: tuple[Floats, ...] = ()
    """Their values, shape (m,) each."""

    def with_one(self, given: Floats, answer: Floats) -> Guesses:
        """Return the last guesses and one more."""
        return Guesses((*self.given[-DEPTH:], given), (*self.answers[-DEPTH:], answer))

    def next_guess(self) -> Floats:
        """Return the next guess, shape (m,); after one guess its value."""
        answers = np.array(self.answers)
        residuals = answers - np.array(self.given)
        changes = np.diff(residuals, axis=0)
        # einsum adds in one order whatever the number of threads
        products = np.einsum("km,lm->kl", changes, changes)
        right = np.einsum("km,m->k", changes, residuals[-1])
        shares = np.linalg.lstsq(products, right, rcond=ALIKE)[0]
        return np.asarray(answers[-1] - np.einsum("k,km->m", shares, np.diff(answers, axis=0)))
