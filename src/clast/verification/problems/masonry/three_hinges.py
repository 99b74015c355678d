"""A cracked beam between abutments arches: the thrust of a three-hinged beam."""

import numpy as np

from clast.verification.problems import Model, State, Trial, box, new_model, problem
from clast.verification.variants import BOTH_LAWS

GRAVITY, DENSITY, DEPTH = 9.8, 2600.0, 0.5
NOSE = 0.1
"""Distance c of the noses from the ends of the beam, m."""
SLENDERNESSES = (4.0, 6.0, 8.0)
"""L/d of the beams."""
SINKS = "hinges and blocks give, by which the middle sinks and the lever arm shrinks"


def exact_thrust(slenderness: float) -> float:
    """Return the thrust over the weight of the beam."""
    return 0.5 * (0.25 * slenderness - NOSE / DEPTH)


def beam(slenderness: float = 6.0) -> Model:
    """Return two fixed abutments with noses and two blocks bridging ``slenderness`` x d."""
    half, low, high = 0.5 * slenderness * DEPTH, -0.3, DEPTH + 0.3
    builder = new_model(
        "Three-hinged beam", gravity=GRAVITY, young=50e9, density=DENSITY, poisson=0.0
    )
    abutment = [(half - NOSE, low), (half + 0.5, low), (half + 0.5, high), (half, high)]
    abutment += [(half, -0.1), (half - NOSE, 0.0)]
    builder.block(name="right abutment", vertices=abutment, fixed=True)
    mirrored = [(-x, y) for x, y in reversed(abutment)]
    builder.block(name="left abutment", vertices=mirrored, fixed=True)
    for name, left, right in (("right half", 0.0, half), ("left half", -half, 0.0)):
        builder.block(name=name, vertices=box(left, 0.0, right, DEPTH))
    return builder.build()


def force_of_vertices(model: Model, state: State, of: str, into: str) -> float:
    """Return the normal force of the vertices of one block on the edges of another, N/m."""
    owner, edge = (model.block_name.index(name) for name in (of, into))
    memory = state.memory
    here = (model.vertex_block[memory.vertex] == owner) & (memory.block == edge)
    return float(memory.normal_force[here].sum())


@problem(set_up=beam, variants=BOTH_LAWS, few=(SLENDERNESSES[:1],))
def three_hinges(trial: Trial, slendernesses: tuple[float, ...] = SLENDERNESSES) -> None:
    """Three-hinged beam.

    Two blocks of 0.5 m depth, cracked in the middle, bridge 2, 3 and 4 m between fixed abutments
    under their weight, without friction; E = 50 GPa, nu = 0, p = 2 GPa, h = 1 ms, static
    (dynamic_ratio = 0).

    Exact: thrust W (L/4 - c)/(2 d), reaction W/2.
    Source: equilibrium of one half about its lower hinge.
    """
    thrusts = []
    for slenderness in slendernesses:
        model = beam(slenderness)
        state = trial.variant.static(model, step=1e-3, end=0.4, p=2e9, max_displacement=0.01).state
        weight = DENSITY * GRAVITY * slenderness * DEPTH**2
        thrust = force_of_vertices(model, state, "left half", "left abutment")
        reaction = force_of_vertices(model, state, "left abutment", "left half")
        thrusts.append(thrust / weight)
        exact, at = weight * exact_thrust(slenderness), f"at L/d = {slenderness:g}"
        trial.relative(f"thrust {at}", "N/m", thrust, exact, 5e-4, SINKS)
        trial.relative(f"reaction {at}", "N/m", reaction, 0.5 * weight, 1e-6, "at rest")
    fine = np.linspace(3.0, 9.0, 30)
    chart = trial.chart("thrust of the beam", "L/d", "H/W")
    chart.exact("(L/4 - c)/(2 d)", fine, [exact_thrust(one) for one in fine])
    chart.computed(slendernesses, thrusts)
