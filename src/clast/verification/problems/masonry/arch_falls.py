"""An arch whose supports spread until it falls: three hinges, and the displacement of the crown.

The arch needs the least thrust for which its line stays within the joints (Heyman 1995): it touches
the outer edge of the crown, at B, and on either side the inner edge of that joint, at A, for which

    H = sum of W_k (x_k - x_A) / (y_B - y_A)     of the voussoirs between A and B

is largest.  There it hinges: rigid voussoirs do not slide, the parts between A and B keep their
length, so that with the supports s farther apart A is at x_A + s/2, B on the axis, and

    y_B = y_A + sqrt(|AB|^2 - (x_A + s/2)^2).

With s the thrust grows, and its line moves.  Where it comes to one more edge there is a fifth hinge
by symmetry, and no equilibrium beyond (Ochsendorf 2002): the arch falls.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from clast.verification.problems import Floats, Model, Run, Trial, new_model, problem
from clast.verification.problems.masonry.arch_push import DENSITY, GRAVITY, Arch, add_arch
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, Variant

ARCHES = (
    Arch(name="semicircle of 16", radius=4.0, voussoirs=16),
    Arch(name="semicircle of 20, t/R = 0.12", radius=4.0, share=0.12, voussoirs=20),
    Arch(
        name="10 voussoirs over 140 degrees, t/R = 0.2",
        radius=4.0,
        share=0.2,
        embrace=140.0,
        voussoirs=10,
    ),
)
STEP, STEPS, SETTLED = 1e-2, 250, 25
"""Time step, s, steps in which a support moves, and before that."""
SHARES = (0.25, 0.5, 0.75, 0.95)
"""Spreads at which the crown is looked at, in units of that at which the arch falls."""
BEYOND = 1.04
"""Spread at the end, in the same units."""
WHY = "joints and blocks give a little; a step moves the support by 0.4 % of the way to the fall"


@dataclass(frozen=True)
class Half:
    """The right half of a symmetric arch of rigid voussoirs, k of them, from its springing up."""

    ends: Floats
    """Inner and outer ends of its k + 1 joints, m, shape (2, k + 1, 2)."""
    weight: Floats
    """Areas of the voussoirs, m2, as their weights, shape (k,)."""
    centroid: Floats
    """Their centroids, m, shape (k, 2)."""
    hinge: int = 0
    """Joint at whose inner end it turns."""

    @classmethod
    def of(cls, arch: Arch) -> "Half":
        """Return half of an arch, with its hinge."""
        inner, outer = (ends[: arch.voussoirs // 2 + 1] for ends in arch.joints())
        quads = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
        after = np.roll(quads, -1, axis=1)
        cross = quads[..., 0] * after[..., 1] - quads[..., 1] * after[..., 0]
        twice = cross.sum(axis=1)
        centroid = ((quads + after) * cross[..., None]).sum(axis=1) / (3.0 * twice[:, None])
        ends, weight = np.stack([inner, outer]), 0.5 * twice
        tried = [cls(ends, weight, centroid, joint) for joint in range(len(weight))]
        return max(tried, key=lambda one: one.thrust(ends, centroid))

    def placed(self, spread: float) -> tuple[Floats, Floats]:
        """Return the ends of joints and the centroids when the supports are so much farther apart.

        Below the hinge the voussoirs go with the support, half of the spread.
        """
        low, crown = self.ends[0, self.hinge], self.ends[1, -1]
        displacement, arm = np.array([0.5 * spread, 0.0]), crown - low
        across = -(low + displacement)[0]
        after = np.array([across, np.sqrt(arm @ arm - across**2)])
        # the turn of AB as a complex number
        turn = complex(*after) / complex(*arm)
        spin = np.array([[turn.real, turn.imag], [-turn.imag, turn.real]])

        def moved(points: Floats) -> Floats:
            turned = (points - low) @ spin + low + displacement
            above = np.arange(points.shape[-2]) >= self.hinge
            return np.where(above[:, None], turned, points + displacement)

        return moved(self.ends), moved(self.centroid)

    def thrust(self, ends: Floats, centroid: Floats) -> float:
        """Return the thrust over specific weight, m2, through the hinge and the crown."""
        low, crown = ends[0, self.hinge], ends[1, -1]
        arms = low[0] - centroid[self.hinge :, 0]
        return float(self.weight[self.hinge :] @ arms / (crown - low)[1])

    def room(self, spread: float) -> float:
        """Return by how much the line of thrust stays away from further edges, m3.

        That is the least moment of all forces above a joint about its ends, over specific weight;
        it is negative where the line leaves the joint.
        """
        ends, centroid = self.placed(spread)
        thrust, crown = self.thrust(ends, centroid), ends[1, -1]
        least = np.inf
        for joint in range(len(self.weight)):
            above = slice(joint, None)
            for side, sense in ((0, 1.0), (1, -1.0)):
                if side == 0 and joint == self.hinge:
                    continue
                x, y = ends[side, joint]
                moment = thrust * (crown[1] - y) - self.weight[above] @ (x - centroid[above, 0])
                least = min(least, sense * float(moment))
        return least

    def limit(self) -> float:
        """Return the spread at which the line of thrust comes to one more edge, m."""
        step = 1e-3 * float(self.ends[1, 0, 0])
        spread = step
        while self.room(spread + step) > 0.0:
            spread += step
        return float(brentq(self.room, spread, spread + step))

    def sunk(self, spread: float) -> float:
        """Return by how much the crown has come down, m."""
        return float(self.ends[1, -1, 1] - self.placed(spread)[0][1, -1, 1])

    @property
    def hinges(self) -> set[tuple[str, int]]:
        """The three hinges: end of a joint, and its number from the right."""
        crown = len(self.weight)
        return {("inner", self.hinge), ("outer", crown), ("inner", 2 * crown - self.hinge)}


def hinges_of(turns: Floats) -> set[tuple[str, int]]:
    """Return the hinges among turns of joints (k + 1,), rad, which open outside if positive."""
    # Turn of a hinge, rad
    return {
        ("inner" if turns[joint] > 0.0 else "outer", int(joint))
        for joint in np.flatnonzero(np.abs(turns) > 1e-3)
    }


def spreading(arch: Arch = ARCHES[0], spread: float = 0.5, side: str = "right") -> Model:
    """Return an arch one of whose abutments moves out by ``spread``, m, after it has settled."""
    builder = new_model(
        "Arch on supports that spread", gravity=GRAVITY, young=50e9, density=DENSITY
    )
    builder.add_joint(friction_angle=arch.friction_angle)
    add_arch(builder, arch)
    middle = arch.voussoirs // 2
    builder.measured_point("crown", arch.joints()[1][middle], block=str(middle))
    first, last = SETTLED * STEP, (SETTLED + STEPS) * STEP
    displacement = spread if side == "right" else -spread
    table = builder.add_amplitude("spread", [0.0, first, last], [0.0, 0.0, displacement])
    builder.motion(name="spread", block=f"{side} abutment", x={"displacement": table})
    return builder.build()


def run_of(arch: Arch, spread: float, variant: Variant, side: str = "right") -> Run:
    """Return the static run."""
    model = spreading(arch, spread, side)
    end = (SETTLED + STEPS) * STEP
    return variant.static(model, step=STEP, end=end, every=end / 44, p=1e10, max_displacement=0.05)


def followed(run: Run, spread: float) -> tuple[Floats, Floats]:
    """Return the spread and the sinking of the crown since the support moves, m, (t,) each."""
    history = run.history("crown")
    share = (history.time - SETTLED * STEP) / (STEPS * STEP)
    # a static step may take several: the last of them is the equilibrium
    last = np.append(np.diff(history.time) > 0.0, True)
    share, down = share[last], -history.displacement[last, 1]
    moved = share > 0.0
    begun = float(down[np.flatnonzero(~moved)[-1]])
    return spread * share[moved], down[moved] - begun


def fall(spreads: Floats, down: Floats) -> float:
    """Return the spread (t,) after which the crown comes down farthest, ten times the usual way.

    With multipliers joints that slip by tenths of a millimetre bring it down a little before.
    """
    displacements = np.diff(down)
    farthest = int(np.argmax(displacements))
    early = float(np.median(displacements[: len(displacements) // 2]))
    return float(spreads[farthest]) if displacements[farthest] > 10.0 * early else np.inf


def hinges_in(run: Run, arch: Arch, spread: float, at: float) -> set[tuple[str, int]]:
    """Return the hinges of a run when the support has moved by ``at``, m."""
    time = (SETTLED + STEPS * at / spread) * STEP
    frame = int(np.abs(run.times - time).argmin())
    first = [run.block_start[run.block_name.index(str(k + 1))] for k in range(arch.voussoirs)]
    turned = np.zeros(arch.voussoirs + 2)
    for which, sign in ((frame, 1.0), (0, -1.0)):
        vertices = run.vertices(which)
        radial = np.array([vertices[k + 1] - vertices[k] for k in first])
        turned[1:-1] += sign * np.arctan2(radial[:, 1], radial[:, 0])
    return hinges_of(np.diff(turned))


@problem(set_up=spreading, variants=(CONVEX, CONVEX_MULTIPLIERS), few=(ARCHES[:1],))
def arch_falls(trial: Trial, arches: tuple[Arch, ...] = ARCHES) -> None:
    """Arch on supports that spread until it falls.

    A support of an arch moves out until the arch falls, and 4 % farther; static (dynamic_ratio =
    0). Mean radius 4 m, t/R = 0.15 if not said otherwise, phi = 60 degrees, E = 50 GPa, p = 10 GPa,
    h = 10 ms in 250 steps. Hinges are joints that have turned by more than 1 mrad.

    Exact: y_B = y_A + sqrt(|AB|^2 - (x_A + s/2)^2), until the line of thrust touches one more edge;
    the shapes of least potential energy of rigid voussoirs, followed with scipy's SLSQP, end at the
    same spreads (0.4708, 0.1347 and 1.467 m).
    Source: statics of three hinges; Heyman (1995), Ochsendorf (2002).
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6; open-close: it cuts steps whose modes do not settle until the inertia of so short a
    step holds the arch, which is not in equilibrium then.
    """
    charted = []
    for number, arch in enumerate(arches):
        half = Half.of(arch)
        limit = half.limit()
        run = run_of(arch, BEYOND * limit, trial.variant, ("right", "left")[number % 2])
        displacement, sunk = followed(run, BEYOND * limit)
        quantity = f"spread at the fall, {arch.name}"
        trial.relative(quantity, "m", fall(displacement, sunk), limit, 0.01, WHY)
        for share in SHARES:
            at = share * limit
            quantity = f"displacement of the crown at {share:g} of it, {arch.name}"
            down = float(np.interp(at, displacement, sunk))
            trial.relative(quantity, "m", down, half.sunk(at), 0.01, WHY)
            others = half.hinges ^ hinges_in(run, arch, BEYOND * limit, at)
            quantity = f"hinges elsewhere at {share:g} of it, {arch.name}"
            trial.absolute(quantity, "", len(others), 0.0, 0.0, "where the line touches")
        spreads = np.linspace(0.0, limit, 50)
        charted.append(
            (arch.name, spreads, [half.sunk(one) for one in spreads], displacement, sunk)
        )
    name, spreads, exact, displacement, sunk = charted[0]
    shown = np.flatnonzero(sunk < 2.0 * exact[-1])[::10]
    labels = "spread of the supports, m", "displacement down, m"
    chart = trial.chart(f"displacement of the crown, {name}", *labels)
    chart.exact("three hinges, to the fall", spreads, exact)
    chart.computed(displacement[shown], sunk[shown])
