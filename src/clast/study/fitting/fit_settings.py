"""How a back-analysis is made."""

from __future__ import annotations

from dataclasses import dataclass

from clast import spelling
from clast.errors import CaseError, shortened

LEAST_SQUARES, ENSEMBLE = "least-squares", "es-mda"
"""Methods."""
MOST_PLACES = 60
"""Most places that least squares look at, each with the derivatives there."""


@dataclass(frozen=True, kw_only=True)
class FitSettings:
    """How a back-analysis is made."""

    method: str = LEAST_SQUARES
    """"least-squares", or "es-mda": an ensemble, for many parameters."""
    members: int = 100
    """Members of the ensemble."""
    rounds: int = 4
    """How often the ensemble takes in the observations, each time a part of them."""
    seed: int = 1
    """Seed of the ensemble."""

    def checked(self) -> FitSettings:
        """Return itself; raises CaseError for wrong numbers."""
        methods = (LEAST_SQUARES, ENSEMBLE)
        if self.method not in methods:
            remedy = spelling.advice(str(self.method), methods, kind="method")
            what = f"there is no method '{shortened(str(self.method))}'"
            raise CaseError(what, where="method", remedy=remedy)
        for name, least, most in (
            ("members", 10, 100_000),
            ("rounds", 1, 50),
            ("seed", 0, 2**63 - 1),
        ):
            value = getattr(self, name)
            if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
                raise CaseError(
                    f"{value!r} is not a valid number of {name}"
                    if name != "seed"
                    else "is not a valid seed",
                    where=name,
                    remedy=f"give a whole number from {least} to {most:,}",
                )
        return self

    def most_runs(self, parameters: int) -> int:
        """Return how many runs it takes at most."""
        if self.method == ENSEMBLE:
            return self.members * (self.rounds + 1)
        return MOST_PLACES * (parameters + 2)
