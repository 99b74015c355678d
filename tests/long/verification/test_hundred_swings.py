"""A bar on a hinge keeps its energy over a hundred swings."""

from clast.verification.problem import Trial
from clast.verification.problems.supports.hinges import SwingingBars, compare
from clast.verification.variants import CONVEX


def test_a_hundred_swings_take_a_millionth_of_the_energy():
    case, trial = SwingingBars(name="one bar", swings=100), Trial(CONVEX)
    compare(trial, case, case.run(CONVEX))
    period, _, kept = trial.rows
    assert abs(period.computed / period.exact - 1.0) < 1e-4
    # 1e-8 a swing, of the time integration; a third more since links act where their ends are now
    assert abs(kept.computed) < 1.2e-6
