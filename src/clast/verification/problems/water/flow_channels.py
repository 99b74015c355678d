"""Channels one behind the other, one above the other, and between faces that are not parallel."""

from clast.verification.fixtures import CUT, into_rock
from clast.verification.problems import InputBuilder, Model, Trial, box, problem

VISCOSITY, PRESSURE = 1e-3, 2e5
FINE, WIDE = 1e-4, 3e-4
"""Apertures, m."""
LENGTHS = (1.5, 2.5)
"""Lengths of the fine and the wide joint, m."""
ROUNDING = "one linear system of a few equations"


def between(builder: InputBuilder, *, longest: float | None = None) -> Model:
    """Return blocks with water that flows through them from left to right."""
    builder.flow = {"viscosity": VISCOSITY, "longest": longest}
    builder.flow_boundary("left", side="left", pressure=PRESSURE)
    builder.flow_boundary("right", side="right", pressure=0.0)
    return builder.build()


def begun(**apertures: float) -> InputBuilder:
    """Return a builder with a rock and joints of some apertures, m, without gravity."""
    builder = InputBuilder(title="Channels", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.2, density=2600.0)
    for name, aperture in {"default": 0.0, **apertures}.items():
        builder.add_joint(name, aperture=aperture, maximum_aperture=1e-2 if aperture else None)
    return builder


def in_series() -> Model:
    """Return a fine joint with a wide one behind it; that between their blocks is tight."""
    first, whole = LENGTHS[0], sum(LENGTHS)
    builder = begun(fine=FINE, wide=WIDE)
    builder.block(name="floor", vertices=box(0, -1, whole, 0))
    under = ["fine", "", "", ""]
    builder.block(name="one", vertices=box(0, 0, first, 1), edge_joint=under)
    under = ["wide", "", "", ""]
    builder.block(name="two", vertices=box(first, 0, whole, 1), edge_joint=under)
    return between(builder)


def parallel() -> Model:
    """Return a fine joint above a wide one."""
    whole = sum(LENGTHS)
    builder = begun(fine=FINE, wide=WIDE)
    builder.block(name="floor", vertices=box(0, -1, whole, 0))
    upper, lower = ["wide", "", "", ""], ["fine", "", "", ""]
    builder.block(name="slab", vertices=box(0, 0, whole, 1), edge_joint=upper)
    builder.block(name="roof", vertices=box(0, 1, whole, 2), edge_joint=lower)
    return between(builder)


def wedge(longest: float | None = None) -> Model:
    """Return a joint that opens by the gap between its faces, from the fine to the wide one."""
    whole = sum(LENGTHS)
    builder = begun(fine=FINE)
    builder.block(name="floor", vertices=box(0, -1, whole, 0))
    roof = [(0.0, 0.0), (whole, WIDE - FINE), (whole, 1.0), (0.0, 1.0)]
    builder.block(name="roof", vertices=roof, edge_joint=["fine", "", "", ""])
    return between(builder, longest=longest)


def exact_flows() -> dict[str, float]:
    """Return the flows in series, parallel, and in the wedge, m2/s."""
    rate, whole = PRESSURE / (12.0 * VISCOSITY), sum(LENGTHS)
    return {
        "in series": rate / (LENGTHS[0] / FINE**3 + LENGTHS[1] / WIDE**3),
        "in parallel": rate * (FINE**3 + WIDE**3) / whole,
        "in a wedge": rate * 2.0 * FINE**2 * WIDE**2 / (FINE + WIDE) / whole,
    }


@problem(set_up=in_series, variants=(CUT,), quick=(CUT,))
def flow_channels(trial: Trial) -> None:
    """Flow in channels.

    Joints of 0.1 mm and 0.3 mm, 1.5 m and 2.5 m long, one behind the other; both one above the
    other over 4 m; and one joint between faces that are 0.1 mm apart at one end and 0.3 mm at the
    other, whole and in pieces of 0.5 m. The pressure falls by 0.2 MPa, without gravity.

    Exact: q = dp/(12 mu sum L/a3), dp sum a3/(12 mu L), and 2 a1^2 a2^2/(a1 + a2) dp/(12 mu L).
    Source: cubic law, and its integral along a wedge.
    Not run with: modified and open-close and convex: nothing moves.
    """
    exact = exact_flows()
    models = {"in series": in_series(), "in parallel": parallel(), "in a wedge": wedge()}
    for name, model in models.items():
        flow = into_rock(model)["left"]
        trial.relative(f"flow {name}", "m2/s", flow, exact[name], 1e-9, ROUNDING)
    flow = into_rock(wedge(longest=0.5))["left"]
    quantity = "flow in a wedge, in pieces"
    trial.relative(quantity, "m2/s", flow, exact["in a wedge"], 1e-9, ROUNDING)
