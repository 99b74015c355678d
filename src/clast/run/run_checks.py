"""Warnings at the end of a run: results that look right and are not.

Each is a number measured during the run against the limit beyond which the method is no longer
reliable, with the key that helps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import attrgetter

import numpy as np

from clast.block.polygon import thicknesses
from clast.errors import StepOutcome, StepRejected
from clast.model.model import Floats, Model
from clast.model.state import Kind, Ledger, Overlap, State, entries_of
from clast.read_only import changed
from clast.run.overlap import unseen_overlaps
from clast.step import energy_balance
from clast.step.method import Method, StepResult
from clast.step.remedies import remedy, stiffnesses_named

ROUNDING = 1e-9
"""Energy gained or lost that is round-off, in units of the stored energy."""
PENETRATION_MAX = 0.05
"""Penetration above which it is warned of, in units of the thinner block."""
NUMERICAL_MAX = 0.05
"""Numerical dissipation or gain, likewise, in units of the energy turned over."""
UNEXPLAINED_MAX = 1e-6
"""Energy that the ledger does not explain, likewise."""
COUNTED = entries_of(Kind.STORED, Kind.BROUGHT, Kind.LOST, Kind.NUMERICAL)
"""Entries of the ledger whose changes are energy turned over."""
_entries = attrgetter(*COUNTED)
NAMED = 3
"""Overlaps that are listed one by one."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """Measurements of a run so far; a part of its data from step to step."""

    least: Floats
    """Least value of each of the energies of ``COUNTED``, J/m, shape (k,)."""
    greatest: Floats
    """Greatest, likewise."""
    deepest: tuple[float, str] = (PENETRATION_MAX, "")
    """Largest penetration above PENETRATION_MAX, in units of the thinner block; its message."""
    overlaps: Mapping[tuple[str, str], Overlap] = field(default_factory=dict)
    """The deepest overlap that contacts do not know of, by the names of the blocks."""

    @property
    def turned_over(self) -> float:
        """Largest change of any entry of the ledger so far, J/m.

        Kinetic energy counts from rest: a flight that nothing slows down is not a small change.
        """
        return float((self.greatest - self.least).max())


@dataclass(frozen=True, kw_only=True)
class Watch:
    """Looks at a run while it goes."""

    model: Model
    method: Method
    carried: float = 1.0
    """Least share of velocity that any stage of the run carries to the next step."""

    @cached_property
    def _thickness(self) -> Floats:
        """Thickness of each block, m, shape (n,)."""
        return thicknesses(self.model.vertices, self.model.block_start)

    def begin(self, state: State) -> Watched:
        """Return the measurements at the start of a run."""
        held = np.array(_entries(state.ledger))
        from_rest = np.where(np.array(COUNTED) == "kinetic", 0.0, held)
        return Watched(least=np.minimum(held, from_rest), greatest=held)

    def with_step(self, seen: Watched, result: StepResult) -> Watched:
        """Return the measurements after an accepted step."""
        held = np.array(_entries(result.state.ledger))
        seen = changed(
            seen, least=np.minimum(seen.least, held), greatest=np.maximum(seen.greatest, held)
        )
        if result.penetration <= seen.deepest[0] * self._thickness.min():
            return seen
        return changed(seen, deepest=self._deeper(seen.deepest, result))

    def with_frame(self, seen: Watched, state: State) -> Watched:
        """Return the measurements after a look at the outlines of a frame."""
        overlaps = dict(seen.overlaps)
        for one in unseen_overlaps(self.model, state, self.method.critdis):
            before = overlaps.get(one.blocks)
            if before is None or one.depth > before.depth:
                overlaps[one.blocks] = one
        return replace(seen, overlaps=overlaps)

    def warnings(self, seen: Watched, state: State, step: float) -> tuple[str, ...]:
        """Return the warnings at the end of a run, each with its number and a remedy.

        ``state`` is the last one, ``step``, s, the length of the step to it, 0 if there was none.
        """
        ledger = state.ledger
        texts = [*self._of_overlaps(seen), seen.deepest[1], self._of_energy(seen, ledger)]
        texts += [self._of_balance(seen, ledger), self._of_rest(state, step)]
        return tuple(text for text in (*texts, self._of_stress(state, step)) if text)

    def _deeper(self, before: tuple[float, str], result: StepResult) -> tuple[float, str]:
        """Return the largest penetration against the thinner of its two blocks."""
        memory, model = result.state.memory, self.model
        block, other = model.vertex_block[memory.vertex], memory.block
        thinner = np.minimum(self._thickness[block], self._thickness[other])
        share = -memory.gap / thinner
        at = int(share.argmax())
        if share[at] <= before[0]:
            return before
        names = model.block_name[block[at]], model.block_name[other[at]]
        return (
            float(share[at]),
            f"block '{names[0]}' was {-memory.gap[at]:.3g} m inside '{names[1]}' at t = "
            f"{result.state.time:.4g} s, {100.0 * share[at]:.3g} % of the thinner of the two: the "
            "contacts are too soft for their load. Raise "
            f"{stiffnesses_named(model, self.method)}",
        )

    def _of_overlaps(self, seen: Watched) -> list[str]:
        """Return a warning for the deepest overlaps and one for the number of all."""
        worst = sorted(seen.overlaps.values(), key=lambda one: -one.depth)
        texts = [
            f"overlap: blocks '{one.blocks[0]}' and '{one.blocks[1]}' share {one.area:.3g} m2, "
            f"{one.depth:.3g} m deep, at t = {one.time:.4g} s, of which their contacts know "
            f"{one.known:.3g} m. Do not trust later results there; use a smaller time.step, or "
            f"raise {stiffnesses_named(self.model, self.method)}"
            for one in worst[:NAMED]
        ]
        if len(worst) > NAMED:
            texts.append(f"overlap: so do {len(worst) - NAMED} more pairs of blocks")
        return texts

    def _of_energy(self, seen: Watched, ledger: Ledger) -> str:
        """Return a warning where the time integration took or gave too much energy."""
        ratio = min(self.carried, self.method.dynamic_ratio)
        if ratio < 1.0 or self.method.integrator.theta > 0.5:
            return ""
        turned_over = seen.turned_over
        share = abs(ledger.numerical) / turned_over if turned_over > 0.0 else 0.0
        if share <= NUMERICAL_MAX or abs(ledger.numerical) <= self._negligible(ledger):
            return ""
        did = "took" if ledger.numerical > 0.0 else "brought in"
        return (
            f"the time integration {did} {100.0 * share:.3g} % of the energy turned over "
            f'("numerical" {ledger.numerical:.3g} J/m): lower time.step'
        )

    def _of_balance(self, seen: Watched, ledger: Ledger) -> str:
        """Return a warning where the entries of the ledger fail to explain too much energy."""
        turned_over = max(seen.turned_over, self._negligible(ledger))
        if abs(ledger.unaccounted) <= UNEXPLAINED_MAX * turned_over:
            return ""
        return (
            f"the energy balance does not close: {ledger.unaccounted:.2g} J/m are unaccounted for, "
            f"{abs(ledger.unaccounted) / turned_over:.1g} of the {turned_over:.3g} J/m turned over "
            f"(at most {UNEXPLAINED_MAX:g} as a rule): {self._cause_of_imbalance()}"
        )

    def _cause_of_imbalance(self) -> str:
        """Return the likely cause of energy unaccounted for, and the remedy."""
        actions = self.model.actions
        others = [one for one in actions if not type(one).__module__.startswith("clast.")]
        if others:
            kinds = ", ".join(sorted({type(one).__name__ for one in others}))
            return (
                f"work and ledger of an action of a script ({kinds}) do not agree with its forces; "
                "see docs/how-to/extend.md"
            )
        tolerance = getattr(self.method.process, "tolerance", None)
        if tolerance is None:
            return "steps were solved inaccurately. Lower time.step"
        key = f"method.process.tolerance ({tolerance:g})"
        return f"steps were solved too loosely. Lower {key} or time.step"

    def _negligible(self, ledger: Ledger) -> float:
        """Return the energy that is negligible whatever is turned over, J/m."""
        size = np.sqrt(self.model.area[~self.model.fixed])
        weight = self.model.mass[~self.model.fixed] * float(np.hypot(*self.model.gravity))
        # what lifts every block by less than 1e-4 of its size
        return 1e-4 * float(weight @ size) + ROUNDING * ledger.stored

    def _of_rest(self, state: State, step: float) -> str:
        """Return a warning where a static run ends while blocks still move, by 2 m d/h2."""
        model = self.model
        free = ~model.fixed
        if self.method.dynamic_ratio > 0.0 or step == 0.0 or not free.any():
            return ""
        speed = np.hypot(state.velocity[:, 0], state.velocity[:, 1])
        theta = self.method.integrator.theta
        force = model.mass * speed / step
        weight = model.mass * float(np.hypot(*model.gravity))
        largest = state.memory.normal_force.max(initial=0.0)
        reference = max(float(weight[free].max()), float(largest))
        worst = int(np.where(free, force, -1.0).argmax())
        share = float(force[worst]) / reference if reference > 0.0 else 0.0
        if share <= 1e-3:
            return ""
        return (
            f"the static run ended while block '{model.block_name[worst]}' still moved by "
            f"{theta * speed[worst] * step:.3g} m a step; its unbalanced force is "
            f"{100.0 * share:.3g} % of the largest there is. Raise time.end, or time.step, "
            "so that blocks come to rest sooner"
        )

    def _of_stress(self, state: State, step: float) -> str:
        """Return a warning where the mean stress of the start has been lost."""
        model = self.model
        if model.absent.any():  # stress goes round the void
            return ""
        stressed = np.any(model.initial_stress != 0.0, axis=1) & ~model.fixed
        if not stressed.any() or step == 0.0:
            return ""
        weight = model.area[stressed] / model.area[stressed].sum()
        mean = [weight @ stress[stressed] for stress in (model.initial_stress, state.stress)]
        lost = float(np.linalg.norm(mean[1] - mean[0]) / np.linalg.norm(mean[0]))
        if lost <= 0.05:
            return ""
        texts = [", ".join(f"{value:.3g}" for value in stress) for stress in mean]
        return (
            f"the mean stress of the blocks with an initial stress went from ({texts[0]}) to "
            f"({texts[1]}) Pa, a change of {100.0 * lost:.3g} %: contacts close until they carry "
            f"it. Raise {stiffnesses_named(self.model, self.method)}, or give an "
            "initial_stress that gravity, loads and supports balance"
        )


def reject_created_energy(
    model: Model, method: Method, state: State, first: Ledger, seen: Watched
) -> None:
    """Raise StepRejected where the blocks hold far more energy than they can have."""
    created = energy_balance.created(state.ledger, first)
    if created <= 0.0:
        return
    allowed = energy_balance.tolerated(model, state.ledger, first)
    allowed += energy_balance.round_off(model, method, state, len(state.memory))
    allowed += 1e-3 * seen.turned_over
    if created > allowed:
        raise StepRejected(
            StepOutcome.ENERGY_CREATED,
            f"{created:.3g} J/m too much at t = {state.time:.6g} s",
            remedy=remedy(StepOutcome.ENERGY_CREATED, model, method, state, 0.0),
        )
