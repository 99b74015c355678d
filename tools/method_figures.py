"""Draw the figures of docs/theory/method.md: ``python tools/method_figures.py [NAME ...]``.

Each function below draws one; runs are short and made anew, so that no figure is
older than the method.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt  # noqa: TID253 - a tool that draws
from matplotlib.axes import Axes  # noqa: TID253
from matplotlib.figure import Figure  # noqa: TID253
from scipy.special import ellipj, ellipk

import clast
from clast.results import PointHistory

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
INK, RUN, PALE = "#333333", "#0b6e99", "#c8d3da"
GRAVITY = 9.8


def block() -> Figure:
    """Draw a polygon in its six motions."""
    figure, charts = plt.subplots(1, 6, figsize=(9, 1.9))
    corners = np.array([(-1.0, -0.7), (0.5, -0.9), (1.1, 0.1), (0.3, 0.9), (-0.9, 0.6)])
    x, y = corners.T
    motions = {
        "$u_0$": (0.45 + 0 * x, 0 * y),
        "$v_0$": (0 * x, 0.45 + 0 * y),
        "$r_0$": (-0.35 * y - 0.06 * x, 0.35 * x - 0.06 * y),
        r"$\varepsilon_x$": (0.35 * x, 0 * y),
        r"$\varepsilon_y$": (0 * x, 0.35 * y),
        r"$\gamma_{xy}$": (0.25 * y, 0.25 * x),
    }
    for chart, (name, motion) in zip(charts, motions.items(), strict=True):
        chart.fill(x, y, fc=PALE, ec="none")
        chart.fill(*(corners + np.stack(motion, 1)).T, fc="none", ec=RUN, lw=1.6)
        chart.plot(0, 0, "o", ms=3, color=INK)
        chart.set(xlim=(-1.7, 1.7), ylim=(-1.5, 1.5), aspect="equal", title=name)
        chart.axis("off")
    return figure


def contact() -> Figure:
    """Draw gap and slip of a vertex above an edge, and the two laws."""
    figure, (scene, normal, shear) = plt.subplots(1, 3, figsize=(9, 2.6))
    scene.fill([-1.5, 1.5, 1.5, -1.5], [0, 0, -0.8, -0.8], fc=PALE, ec=INK)
    scene.fill([0, 1.2, 0.3, -0.8], [0.35, 1.0, 1.6, 1.1], fc=PALE, ec=INK)
    scene.annotate("", (0, 0), (0, 0.35), arrowprops={"arrowstyle": "<->", "color": RUN})
    scene.text(0.08, 0.1, "$g_n$", color=RUN)
    scene.annotate("", (0.9, 0.12), (0.3, 0.12), arrowprops={"arrowstyle": "->", "color": RUN})
    scene.text(0.95, 0.08, "$s$", color=RUN)
    scene.set(xlim=(-1.6, 1.6), ylim=(-0.9, 1.7), aspect="equal")
    scene.axis("off")
    gap = np.linspace(-1, 1, 100)
    normal.plot(gap, np.maximum(0, -gap), color=RUN)
    normal.set(xlabel="gap $g_n$", ylabel="$N$", title="normal force")
    slip = np.linspace(-2, 2, 200)
    shear.plot(slip, np.clip(-slip, -0.8, 0.8), color=RUN)
    shear.text(-1.9, 0.52, r"$N\tan\varphi + cL$", color=INK, fontsize=8)
    shear.set(xlabel="slip $s$", ylabel="$T$", title="shear force")
    for chart in (normal, shear):
        _bare(chart)
    return figure


def step() -> Figure:
    """Draw the potential of a falling block above a floor, and iterations of three processes."""
    figure, (one, two) = plt.subplots(1, 2, figsize=(9, 3.2))
    mass, speed, h, gap, stiffness = 1.0, -3.0, 0.1, 0.1, 1.5e3
    d = np.linspace(-0.45, 0.15, 400)
    free = mass / h**2 * (d - h * speed) ** 2 + mass * GRAVITY * d
    both = free + 0.5 * stiffness * np.minimum(0, gap + d) ** 2
    one.plot(d, free, "--", color=INK, lw=1, label="without contact")
    one.plot(d, both, color=RUN, label="with contact")
    one.axvline(-gap, color=PALE, lw=1)
    one.plot(d[both.argmin()], both.min(), "o", color=RUN)
    one.set(xlabel="displacement of the step, m", ylabel=r"$\Pi$, J/m", ylim=(-5, 12))
    one.legend(frameon=False, fontsize=8)
    matrix, start = np.array([[2.0, 0.6], [0.6, 1.0]]), np.array([1.6, 1.4])
    kinks = (np.array([1.0, 0.4]), 12.0), (np.array([0.2, 1.0]), 8.0)

    def slope(at: np.ndarray, closed: tuple[bool, ...]) -> tuple[np.ndarray, np.ndarray]:
        force, stiff = matrix @ (at + 1.0), matrix.copy()
        for (row, k), shut in zip(kinks, closed, strict=True):
            force = force + k * shut * (row @ at) * row
            stiff += k * shut * np.outer(row, row)
        return force, stiff

    x, y = np.meshgrid(np.linspace(-1.6, 1.8, 120), np.linspace(-1.6, 1.8, 120))
    at = np.stack([x, y], -1)
    height = 0.5 * np.einsum("...i,ij,...j", at + 1.0, matrix, at + 1.0)
    for row, k in kinks:
        height += 0.5 * k * np.minimum(0, at @ row) ** 2
    two.contour(x, y, height, levels=14, colors=PALE, linewidths=0.8)
    at, path = start, [start]
    for _ in range(8):  # Newton's method, here without the need of a line search
        force, stiff = slope(at, tuple(bool(row @ at < 0) for row, _ in kinks))
        at = at - np.linalg.solve(stiff, force)
        path.append(at)
    two.plot(*np.array(path).T, "o-", ms=4, color=RUN, label="convex: to the minimum")
    force, stiff = slope(start, (False, False))
    once = start - np.linalg.solve(stiff, force)
    two.plot(*np.stack([start, once], 1), "s:", ms=4, color="#c44536", label="modified: one solve")
    two.set(xlabel="$d_1$", ylabel="$d_2$")
    two.legend(frameon=False, fontsize=8, loc="lower right")
    return figure


def impact() -> Figure:
    """Draw the height of a block that falls, for steps and stiffnesses."""
    figure, chart = plt.subplots(figsize=(9, 2.6))
    for h, stiffness, dash in ((1e-3, 5e9, "-"), (5e-3, 5e7, "--"), (1e-2, 5e10, ":")):
        history = _bounce(h, stiffness)
        chart.plot(history.time, 1 + history.displacement[:, 1], dash, lw=1.6,
                   label=f"h = {1e3 * h:g} ms, p = {stiffness:.0e} N/m per m")  # fmt: skip
    chart.set(xlabel="time, s", ylabel="height, m")
    chart.legend(frameon=False, fontsize=8)
    return figure


def statics() -> Figure:
    """Draw the unbalanced force by step of static stages."""
    figure, chart = plt.subplots(figsize=(9, 2.8))
    cases = {
        "a wall at half its buckling load": _wall(0.5, 1e-3),
        "the same at 0.9 of it": _wall(0.9, 1e-3),
        "a block on a slope steeper than its friction angle": _slope(),
    }
    for (name, case), colour in zip(cases.items(), (RUN, INK, "#c44536"), strict=True):
        run = case.run()
        unbalanced = run.table("steps")["unbalanced"]
        verdict = run.report.stages[-1].outcome
        chart.semilogy(1 + np.arange(len(unbalanced)), unbalanced, "o-", ms=3, color=colour,
                       label=f"{name}: {verdict}")  # fmt: skip
    chart.set(xlabel="step", ylabel="largest unbalanced force,\nshare of the forces", xlim=(0, 40))
    chart.legend(frameon=False, fontsize=8)
    return figure


def checks() -> Figure:
    """Draw four runs beside their closed forms."""
    figure, charts = plt.subplots(2, 2, figsize=(9, 5.6))
    _sliding(charts[0, 0])
    history = _bounce(1e-3, 5e9)
    _compared(charts[0, 1], history.time, 1 + history.displacement[:, 1], _parabolas(history.time))
    charts[0, 1].set(title="2  bouncing, e = 0.7", xlabel="time, s", ylabel="height, m")
    _pendulum(charts[1, 0])
    _buckling(charts[1, 1])
    return figure


def _compared(chart: Axes, x: np.ndarray, run: np.ndarray, exact: np.ndarray) -> None:
    chart.plot(x, exact, color=PALE, lw=4, label="closed form")
    chart.plot(x, run, color=RUN, lw=1.2, label="clast")
    chart.legend(frameon=False, fontsize=8)


def _builder(friction_angle: float) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=5e10, poisson=0.0, density=2500.0)
    builder.add_joint(friction_angle=friction_angle, restitution=0.7)
    return builder


def _bounce(h: float, stiffness: float) -> PointHistory:
    builder = _builder(30.0)
    builder.block(name="floor", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], fixed=True)
    builder.block(name="block", vertices=[(-0.2, 1), (0.2, 1), (0.2, 1.4), (-0.2, 1.4)])
    law = {"name": "penalty", "normal_stiffness": stiffness}
    builder.measured_point("foot", at=(0.0, 1.0), block="block")
    return clast.simulate(builder.build(), step=h, end=2.0, contact_law=law).history("foot")


def _parabolas(time: np.ndarray) -> np.ndarray:
    fall, speed = np.sqrt(2 / GRAVITY), np.sqrt(2 * GRAVITY)
    height = 1 - 0.5 * GRAVITY * time**2
    begin = fall
    for bounce in range(1, 12):
        up = speed * 0.7**bounce
        since = time - begin
        height = np.where(since > 0, up * since - 0.5 * GRAVITY * since**2, height)
        begin += 2 * up / GRAVITY
    return np.maximum(height, 0)


def _sliding(chart: Axes) -> None:
    angle, speed = np.radians(20.0), 1.0
    along, up = np.array([np.cos(angle), -np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    builder = _builder(30.0)
    ends = [-1 * along, 4 * along]
    builder.block(name="slope", fixed=True, vertices=[ends[0] - up, ends[1] - up, ends[1], ends[0]])
    corners = [0 * along, along, along + 0.5 * up, 0.5 * up]
    builder.block(name="block", vertices=corners, velocity=(*(speed * along), 0.0))
    history = clast.simulate(builder.build(), step=1e-3, end=1.0).block("block")
    slowing = GRAVITY * (np.cos(angle) * np.tan(np.radians(30.0)) - np.sin(angle))
    time = np.minimum(history.time, speed / slowing)
    _compared(
        chart, history.time, history.displacement @ along, speed * time - slowing * time**2 / 2
    )
    chart.set(title="1  sliding to rest", xlabel="time, s", ylabel="displacement, m")


def _pendulum(chart: Axes) -> None:
    builder = _builder(30.0)
    builder.block(name="bar", vertices=[(0, -0.05), (1, -0.05), (1, 0.05), (0, 0.05)])
    builder.fixed_point(at=(0.0, 0.0), block="bar")
    builder.measured_point("end", at=(1.0, 0.0), block="bar")
    history = clast.simulate(builder.build(), step=2e-4, end=4.0).history("end")
    inertia = 1 / 3 + 0.1**2 / 12
    rate, k = np.sqrt(GRAVITY * 0.5 / inertia), np.sin(np.pi / 4)
    sn = ellipj(ellipk(k**2) - rate * history.time, k**2)[0]
    _compared(
        chart, history.time, np.degrees(history.rotation), 2 * np.degrees(np.arcsin(k * sn)) - 90
    )
    chart.set(title="3  pendulum from 90 degrees", xlabel="time, s", ylabel="rotation, degrees")


WIDTH, HEIGHT, COURSES, STIFFNESS = 0.3, 0.25, 12, 2e9


def _wall(share: float, off: float) -> clast.Case:
    """Return a dry wall on elastic joints under a share of its buckling load ``off`` its axis."""
    half = WIDTH / 2
    blocks = [{"name": "base", "fixed": True, "vertices": [[-2, -1], [2, -1], [2, 0], [-2, 0]]}]
    for course in range(COURSES):
        low, high = course * HEIGHT, (course + 1) * HEIGHT
        corners = [[-half, low], [half, low], [half, high], [-half, high]]
        blocks.append({"name": f"course {course + 1}", "vertices": corners})
    top = COURSES * HEIGHT
    force = [0.0, -share * _stiffness()[1]]
    return clast.Case.model_validate({
        "gravity": [0.0, 0.0],
        "time": {"step": 0.02, "end": 20.0},
        "rock": {"stone": {"young": 1e12, "poisson": 0.0, "density": 2000.0}},
        "joint": {"default": {"friction_angle": 40.0, "normal_stiffness": STIFFNESS,
                              "shear_stiffness": STIFFNESS}},
        "block": blocks,
        "point_load": [{"at": [off, top], "force": force, "block": f"course {COURSES}"}],
        "measured_point": [{"name": "top", "at": [0.0, top], "block": f"course {COURSES}"}],
        "stage": [{"name": "load", "dynamic_ratio": 0.0}],
    })  # fmt: skip


def _slope() -> clast.Case:
    """Return a block on a slope of 25 degrees whose friction angle is 20 degrees."""
    rise = float(np.tan(np.radians(25.0)))
    along, up = (np.array([np.cos(a), np.sin(a)]) for a in np.radians([-25.0, 65.0]))
    foot = np.array([0.5, 3.5 * rise])
    corners = [foot, foot + along, foot + along + 0.5 * up, foot + 0.5 * up]
    slope = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0 * rise]]
    return clast.Case.model_validate({
        "gravity": [0.0, -GRAVITY],
        "time": {"step": 0.02, "end": 20.0},
        "rock": {"rock": {"young": 5e10, "poisson": 0.0, "density": 2500.0}},
        "joint": {"default": {"friction_angle": 20.0}},
        "block": [
            {"name": "slope", "fixed": True, "vertices": slope},
            {"name": "block", "vertices": [one.tolist() for one in corners]},
        ],
        "stage": [{"name": "weight", "dynamic_ratio": 0.0}],
    })  # fmt: skip


def _stiffness() -> tuple[np.ndarray, float]:
    """Return K of the rotations of rigid courses, N, and the load at which K - G is singular, N/m.

    A joint turns by the difference of its courses' rotations, of stiffness k b3/12.  An upright
    load P sinks by h t2/2 where a course turns by t: G = P h.
    """
    joint = np.eye(COURSES) - np.eye(COURSES, k=-1)
    stiff = joint.T @ joint * STIFFNESS * WIDTH**3 / 12
    return stiff, float(np.linalg.eigvalsh(stiff).min()) / HEIGHT


def _buckling(chart: Axes) -> None:
    stiff, critical = _stiffness()
    off, shares = 1e-4, np.linspace(0.0, 0.95, 100)
    top = np.eye(COURSES)[-1]
    sway = [
        HEIGHT
        * np.linalg.solve(
            stiff - p * critical * HEIGHT * np.eye(COURSES), p * critical * off * top
        ).sum()
        for p in shares
    ]
    chart.plot(shares, 1e3 * np.array(sway), color=PALE, lw=4, label="closed form")
    some = (0.2, 0.4, 0.6, 0.8, 0.9, 0.95)
    runs = [_wall(p, off).run().history("top").displacement[-1, 0] for p in some]
    chart.plot(some, 1e3 * np.abs(runs), "o", color=RUN, label="clast")
    chart.legend(frameon=False, fontsize=8)
    chart.set(
        title="4  a wall under an eccentric load", xlabel="load / buckling load", ylabel="sway, mm"
    )


def _bare(chart: Axes) -> None:
    chart.axhline(0, color=PALE, lw=0.8)
    chart.axvline(0, color=PALE, lw=0.8)
    chart.set(xticks=[], yticks=[])


FIGURES: dict[str, Callable[[], Figure]] = {
    "block": block,
    "contact": contact,
    "step": step,
    "impact": impact,
    "statics": statics,
    "checks": checks,
}

if __name__ == "__main__":
    for name in sys.argv[1:] or FIGURES:
        drawn = FIGURES[name]()
        drawn.tight_layout()
        drawn.savefig(IMAGES / f"method-{name}.png", dpi=110)
        plt.close(drawn)
