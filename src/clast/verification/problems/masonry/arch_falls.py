"""An arch whose supports spread until it falls: three hinges, and the way of the crown.

Rigid voussoirs that carry no tension and do not slide turn about corners of their joints.  With the
turns p_k >= 0 about the inner and q_k >= 0 about the outer end of each joint, their shape is that of
least potential energy

    V = sum of W_j y_j(p, q)    so that the last joint has moved by (spread, 0), and not turned,

which is followed from the shape at the start.  Where it ends, the arch falls: there is no shape
nearby in which it stands (Heyman 1995; Ochsendorf 2002).  The turns that are not zero are the
hinges, where the line of thrust touches an edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import minimize

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Comparison, Outcome, Problem, absolute, relative
from clast.verification.problems.masonry.arch_push import DENSITY, GRAVITY, Arch, add_arch
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, Variant

ARCHES = (
    Arch(name="semicircle of 16", radius=4.0, voussoirs=16),
    Arch(name="semicircle of 20, t/R = 0.12", radius=4.0, share=0.12, voussoirs=20),
    Arch(name="segment of 140 degrees, 10 voussoirs", radius=4.0, embrace=140.0, voussoirs=10),
)
STEP, STEPS, SETTLED = 1e-2, 400, 40
"""Time step, s, steps in which a support moves, and before that."""
SHARES = (0.25, 0.5, 0.75, 0.95)
"""Spreads at which the crown is looked at, in units of that at which the arch falls."""
BEYOND = 1.05
"""Spread at the end, in the same units."""
LEAST_TURN = 1e-3
"""Turn of a hinge, rad."""
TOLERANCE = 0.01
WHY = "joints and blocks give a little; a step moves the support by 0.26 % of the way to the fall"


@dataclass(frozen=True)
class Rigid:
    """Voussoirs of an arch as rigid blocks, from the right support, which moves, to the left."""

    ends: Floats
    """Inner and outer ends of its k + 1 joints, m, shape (2, k + 1, 2)."""
    weight: Floats
    """Shares of the voussoirs in the weight, shape (k,)."""
    centroid: Floats
    """Their centroids, m, shape (k, 2)."""

    @classmethod
    def of(cls, arch: Arch) -> Rigid:
        """Return the voussoirs of an arch."""
        inner, outer = arch.joints()
        quads = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
        after = np.roll(quads, -1, axis=1)
        cross = quads[..., 0] * after[..., 1] - quads[..., 1] * after[..., 0]
        centroid = ((quads + after) * cross[..., None]).sum(axis=1) / 3.0
        area = cross.sum(axis=1)
        return cls(np.stack([inner, outer]), area / area.sum(), centroid / area[:, None])

    def placed(self, turns: Floats) -> tuple[Floats, Floats, float, Floats]:
        """Return ends of joints and centroids after ``turns``, and turn and way of the far end.

        ``turns`` (2, k + 1) are about the inner and the outer ends, the latter clockwise.  The
        chain begins at the right support, which stays: the left one moves.
        """
        angle, offset = 0.0, np.zeros(2)
        ends, centroid = np.empty_like(self.ends), np.empty_like(self.centroid)
        for k in range(self.ends.shape[1]):
            for side, sense in ((0, 1.0), (1, -1.0)):
                pivot = _turned(self.ends[side, k], angle) + offset
                ends[side, k] = pivot
                angle += sense * turns[side, k]
                offset = pivot - _turned(self.ends[side, k], angle)
            if k < len(centroid):
                centroid[k] = _turned(self.centroid[k], angle) + offset
        return ends, centroid, angle, offset

    def equilibrium(self, spread: float, near: Floats) -> Floats | None:
        """Return the turns (2, k + 1) of least energy beside ``near`` ones; None: there are none."""
        shape = near.shape
        sense = np.stack([np.ones(shape[1]), -np.ones(shape[1])])

        def energy(turns: Floats) -> tuple[float, Floats]:
            ends, centroid, _, _ = self.placed(turns.reshape(shape))
            mass = np.append(np.cumsum(self.weight[::-1])[::-1], 0.0)
            moment = np.append(np.cumsum((self.weight * centroid[:, 0])[::-1])[::-1], 0.0)
            gradient = sense * (moment - mass * ends[..., 0])
            return float(self.weight @ centroid[:, 1]), gradient.ravel()

        def apart(turns: Floats) -> Floats:
            _, _, angle, offset = self.placed(turns.reshape(shape))
            return np.array([offset[0] + spread, offset[1], angle])

        def slope(turns: Floats) -> Floats:
            ends, _, _, offset = self.placed(turns.reshape(shape))
            x, y = (sense * (offset[axis] - ends[..., axis]) for axis in (0, 1))
            return np.stack([-y.ravel(), x.ravel(), sense.ravel()])

        found = minimize(
            energy,
            near.ravel(),
            jac=True,
            method="SLSQP",
            bounds=[(0.0, None)] * near.size,
            constraints={"type": "eq", "fun": apart, "jac": slope},
            options={"ftol": 1e-14, "maxiter": 500},
        )
        turns = np.maximum(0.0, found.x).reshape(shape)
        # beyond the last shape the search ends anywhere
        beside = np.abs(turns - near).max() < 0.3 and np.abs(apart(found.x)).max() < 1e-9
        return turns if found.success and beside else None

    def path(self, step: float, finest: float = 1e-5) -> tuple[Floats, Floats]:
        """Return spreads, m (s,), and turns (s, 2, k + 1), in steps, until the arch falls."""
        spreads, turns = [0.0], [np.zeros(self.ends.shape[:2])]
        while step > finest:
            found = self.equilibrium(spreads[-1] + step, turns[-1])
            if found is None:
                step *= 0.5
            else:
                spreads.append(spreads[-1] + step)
                turns.append(found)
        return np.array(spreads), np.array(turns)

    def sunk(self, turns: Floats) -> float:
        """Return by how much the outer end of the middle joint has come down, m."""
        crown = self.ends.shape[1] // 2
        return float(self.ends[1, crown, 1] - self.placed(turns)[0][1, crown, 1])


def _turned(point: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def hinges_of(turns: Floats) -> set[tuple[str, int]]:
    """Return the hinges among turns (2, k + 1): end of a joint, and its number from the right."""
    side, joint = np.nonzero(turns > LEAST_TURN)
    return {(("inner", "outer")[s], int(k)) for s, k in zip(side, joint, strict=True)}


def spreading(arch: Arch = ARCHES[0], spread: float = 0.5, side: str = "right") -> Model:
    """Return an arch one of whose abutments moves out by ``spread``, m, after it has settled."""
    builder = InputBuilder(title="Arch on supports that spread", gravity=(0.0, -GRAVITY))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=arch.friction_angle)
    add_arch(builder, arch)
    middle = arch.voussoirs // 2
    builder.measured_point("crown", arch.joints()[1][middle], block=str(middle))
    first, last = SETTLED * STEP, (SETTLED + STEPS) * STEP
    way = spread if side == "right" else -spread
    table = builder.add_table("spread", [0.0, first, last], [0.0, 0.0, way])
    builder.motion(name="spread", block=f"{side} abutment", x={"displacement": table})
    return builder.build()


def run_of(arch: Arch, spread: float, variant: Variant, side: str = "right") -> Run:
    """Return the static run."""
    model = spreading(arch, spread, side)
    method = variant.method(model, normal_stiffness=1e10, max_displacement=0.05, dynamic_ratio=0.0)
    end = (SETTLED + STEPS) * STEP
    return simulate(model, method, Schedule(step=STEP, end=end, every=end / 44))


def followed(run: Run, spread: float) -> tuple[Floats, Floats]:
    """Return the spread and the way of the crown down since the support moves, m, (t,) each."""
    history = run.history("crown")
    share = (history.time - SETTLED * STEP) / (STEPS * STEP)
    moved = share > 0.0
    down = -history.displacement[:, 1]
    begun = float(down[np.flatnonzero(~moved)[-1]])
    return spread * share[moved], down[moved] - begun


def fall(spreads: Floats, down: Floats) -> float:
    """Return the spread (t,) after which the crown comes down ten times as fast as at first."""
    rate = np.diff(down) / np.diff(spreads)
    early = float(np.median(rate[: len(rate) // 2]))
    fast = np.flatnonzero(rate > 10.0 * early)
    return float(spreads[fast[0]]) if len(fast) else np.inf


def hinges_in(run: Run, arch: Arch, spread: float, at: float) -> set[tuple[str, int]]:
    """Return the hinges of a run, as ``hinges_of`` does, when the support has moved by ``at``, m."""
    time = (SETTLED + STEPS * at / spread) * STEP
    frame = int(np.abs(run.times - time).argmin())
    first = [run.block_start[run.block_name.index(str(k + 1))] for k in range(arch.voussoirs)]
    turned = np.zeros(arch.voussoirs + 2)
    for which, sign in ((frame, 1.0), (0, -1.0)):
        vertices = run.vertices(which)
        radial = np.array([vertices[k + 1] - vertices[k] for k in first])
        turned[1:-1] += sign * np.arctan2(radial[:, 1], radial[:, 0])
    turns = np.diff(turned)
    return hinges_of(np.stack([np.maximum(0.0, turns), np.maximum(0.0, -turns)]))


def examine(arches: tuple[Arch, ...], variant: Variant) -> Outcome:
    """Compare hinges, the way of the crown and the spread at which arches fall."""
    rows: list[Comparison] = []
    charted = []
    for number, arch in enumerate(arches):
        rigid = Rigid.of(arch)
        spreads, turns = rigid.path(0.01 * arch.radius)
        limit, most = float(spreads[-1]), BEYOND * float(spreads[-1])
        down = np.array([rigid.sunk(one) for one in turns])
        side = ("right", "left")[number % 2]
        run = run_of(arch, most, variant, side)
        way, sunk = followed(run, most)
        rows.append(
            relative(
                f"spread at the fall, {arch.name}", "m", fall(way, sunk), limit, TOLERANCE, WHY
            )
        )
        for share in SHARES:
            near = turns[int(np.abs(spreads - share * limit).argmin())]
            exact = rigid.equilibrium(share * limit, near)
            if exact is None:  # the path has come by here
                continue
            quantity = f"way of the crown at {share:g} of it, {arch.name}"
            got = float(np.interp(share * limit, way, sunk))
            rows.append(relative(quantity, "m", got, rigid.sunk(exact), TOLERANCE, WHY))
            other = hinges_of(exact) ^ hinges_in(run, arch, most, share * limit)
            quantity = f"hinges at other places at {share:g} of it, {arch.name}"
            rows.append(absolute(quantity, "", len(other), 0.0, 0.0, "hinges are where they are"))
        charted.append((arch.name, spreads, down, way, sunk))
    name, spreads, down, way, sunk = charted[0]
    shown = sunk < 2.0 * down[-1]
    chart = Chart(
        title=f"way of the crown, {name}",
        x_label="spread of the supports, m",
        y_label="way down, m",
        curves=(
            exact_curve("rigid voussoirs, to the fall", spreads, down),
            curve(variant.name, way[shown], sunk[shown]),
        ),
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="arch-falls",
    title="Arch on supports that spread until it falls",
    text="A support of an arch moves out until the arch falls, and 5 % farther; static "
    "(dynamic_ratio = 0). Mean radius 4 m, t/R = 0.15, phi = 60 degrees, E = 50 GPa, p = 10 GPa, "
    "h = 10 ms in 400 steps. Hinges are joints that have turned by more than 1 mrad.",
    formula="the shape of least potential energy of rigid voussoirs that turn about corners",
    source="followed with scipy's SLSQP; Heyman (1995), Ochsendorf (2002)",
    set_up=spreading,
    examine=partial(examine, ARCHES),
    variants=(CONVEX, CONVEX_MULTIPLIERS),
    left_out="modified: in steps this long one pass and four throw the voussoirs, p h2/m being "
    "far above 6; open-close: it cuts steps whose modes do not settle until the inertia of so "
    "short a step holds the arch, which is not in equilibrium then",
    quick=(CONVEX,),
    examine_briefly=partial(examine, ARCHES[:1]),
)
