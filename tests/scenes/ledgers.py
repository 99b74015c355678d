"""The energy ledger of a run: nothing is left over."""

import numpy as np

import clast
from clast.model.state import LEDGER_ENTRIES, Kind, entries_of


def assert_closed(run: clast.Run, share: float = 1e-6) -> None:
    """Assert that the ledger explains all but a share of the energy that went through it."""
    energy = run.energy
    balance = entries_of(Kind.STORED, Kind.LOST, Kind.NUMERICAL)
    total = sum(energy[name] for name in balance)
    total = total - sum(energy[name] for name in entries_of(Kind.BROUGHT))
    turned_over = max(np.abs(energy[name]).max() for name in LEDGER_ENTRIES)
    assert np.abs(total - total[0]).max() <= share * turned_over
    assert np.abs(energy["unaccounted"]).max() <= share * turned_over
