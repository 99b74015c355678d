"""The names of scripts whose arguments follow from the declarations of inputs.

Editors and type checkers read script.pyi beside it, which ``make reference`` writes; ``help`` shows
the same sentences.
"""

from clast.case.api import TABLES, WHOLE, ModelBuilder, simulate
from clast.inputs.declaring.arguments import meanings_of, with_arguments
from clast.inputs.stages import StageTable
from clast.model.stages import Stage

__all__ = ["ModelBuilder", "Stage", "simulate"]

_meanings = meanings_of(*TABLES.values())
_meanings |= {key: meanings_of(StageTable)[key].partition(":")[0] + "." for key in WHOLE}
for _taker in (simulate, ModelBuilder.case, ModelBuilder.to_toml):
    _taker.__doc__ = with_arguments(_taker.__doc__, _meanings)
Stage.__doc__ = with_arguments(Stage.__doc__, meanings_of(Stage))
