"""A bar on a hinge keeps its energy over a hundred swings."""

from clast.verification.problems.supports.hinges import Case, method_of, rows_of, swung
from clast.verification.variants import CONVEX


def test_a_hundred_swings_take_a_millionth_of_the_energy():
    case = Case(name="one bar", swings=100)
    run = swung(case, CONVEX)
    period, _, kept = rows_of(case, run, method_of(case, CONVEX).fixed_point_stiffness)
    assert abs(period.computed / period.exact - 1.0) < 1e-4
    # 1e-8 a swing, of the time integration; a third more since links act where their ends are now
    assert abs(kept.computed) < 1.2e-6
