"""A run that is resumed leaves the same digits."""

import signal
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from clast.case.case_file import Case
from clast.case.resume import resume as resume_case
from clast.run.interrupts import Interrupted
from clast.run.schedule import Progress
from clast.verification.problems import Floats, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, LAGGED, MIDPOINT, OPEN_CLOSE, Variant

CASE = "resume.toml"
END, STEP = 0.25, 2.0**-9
"""End, s; a step of so many s that no time is rounded."""
MIDDLE = 53
"""Steps before the interruption."""
BITS = "a checkpoint holds all that a run carries"
KINDS = {"dynamic": 1.0, "static": 0.0}
"""Share of velocity that is carried, by name."""


def text(ratio: float, variant: Variant, end: float) -> str:
    """Return a case: four blocks on a base that moves, one of them in flight."""
    process = ", ".join(
        f"{key} = {repr(value).replace(chr(39), chr(34))}" for key, value in variant.process.items()
    )
    blocks = [
        ("base", (-2.0, -1.0, 4.0, 0.0)),
        ("a", (0.0, 0.0, 1.0, 1.0)),
        ("b", (1.0, 0.0, 2.0, 1.0)),
        ("c", (0.5, 1.0, 1.5, 2.0)),
        ("d", (0.6, 2.0 if ratio == 0.0 else 2.05, 1.4, 2.8)),
    ]
    lines = [
        "schema = 1",
        "gravity = [0.0, -9.81]",
        f"time = {{step = {STEP!r}, end = {end!r}, dynamic_ratio = {ratio!r}}}",
        "rock = {stone = {young = 5e9, poisson = 0.2, density = 2500.0}}",
        "joint = {default = {friction_angle = 35.0}}",
        "output = {every = 0.0625, checkpoint_every = 1e6}",
        "[method]",
        f'process = {{{process}}}\nintegrator = "{variant.integrator}"',
        'contact_law = {name = "penalty", normal_stiffness = 2e8}',
    ]
    for name, (left, low, right, high) in blocks:
        corners = f"[[{left}, {low}], [{right}, {low}], [{right}, {high}], [{left}, {high}]]"
        lines.append(f'[[block]]\nname = "{name}"\nvertices = {corners}')
    lines += [f"[[fixed_point]]\nat = [{x}, -1.0]" for x in (-2.0, 4.0)]
    lines.append('[[measured_point]]\nname = "top"\nat = [1.0, 2.5]\nblock = "d"')
    lines.append(
        '[ground_motion]\nacts = "base"\ntime = [0.0, 0.0625, 0.1875, 0.25]\n'
        "acceleration = [0.0, 3.0, -3.0, 0.0]"
    )
    return "\n".join(lines)


def both(ratio: float, variant: Variant) -> tuple[Run, Run]:
    """Return the run in one go, and that which was resumed in the middle."""
    with TemporaryDirectory() as folder:
        whole = Case.from_text(text(ratio, variant, END), CASE).run(
            output=Path(folder, "whole.vtkhdf")
        )
        half = Case.from_text(text(ratio, variant, END), CASE).run(
            output=Path(folder, "part.vtkhdf"), warn=_unsaid, progress=_interrupt
        )
        if half.checkpoint is None or half.report.steps != MIDDLE:
            raise AssertionError("a run that is interrupted leaves a checkpoint")
        rest = resume_case(half.checkpoint, warn=_unsaid)
        # histories lie in the files
        for run in (whole, rest):
            run.history("top")
        return whole, rest


def _interrupt(at: Progress) -> None:
    """Interrupt a run in the middle."""
    if at.steps == MIDDLE:
        raise Interrupted(signal.SIGINT)  # a signal is not heard where nohup has it ignored


def _unsaid(text: str) -> None:
    """Say nothing: the step is coarse for the motion, and both runs have it."""


def apart(one: Run, other: Run) -> dict[str, float]:
    """Return the largest differences between the results of both runs."""
    pairs: dict[str, tuple[Floats, Floats]] = {
        "vertices, m": (one.state.vertices, other.state.vertices),
        "velocities, m/s": (one.state.velocity, other.state.velocity),
        "contact forces, N/m": (one.state.memory.normal_force, other.state.memory.normal_force),
    }
    differences = {
        name: float(np.abs(first - second).max()) if len(first) == len(second) else np.inf
        for name, (first, second) in pairs.items()
    }
    ledgers = one.report.ledger, other.report.ledger
    differences["friction work, J/m"] = abs(ledgers[0].friction - ledgers[1].friction)
    differences["steps"] = float(abs(one.report.steps - other.report.steps))
    return differences


def set_up() -> Model:
    """Return the model."""
    return Case.from_text(text(1.0, CONVEX, END), CASE).model()


@problem(set_up=set_up, variants=(CONVEX, OPEN_CLOSE, LAGGED, MIDPOINT))
def resume(trial: Trial) -> None:
    """A run that is resumed.

    Four blocks on a base that moves by 2.3 cm in 0.25 s, one of them falling by 5 cm; and the same
    static, all in touch. Run in one go, and interrupted after 53 steps and resumed. p = 0.2 GPa, h
    = 1/512 s.

    Exact: no digit differs.
    Source: a run goes on from all that it carries.
    """
    for name, ratio in KINDS.items():
        whole, rest = both(ratio, trial.variant)
        for quantity, difference in apart(whole, rest).items():
            what, _, unit = quantity.partition(", ")
            text = f"{name}: difference of {what}"
            trial.absolute(text, unit, difference, 0.0, 0.0, BITS)
        first, second = whole.history("top"), rest.history("top")
        labels = "time, s", "displacement, mm"
        chart = trial.chart(f"{name}: displacement of the upper block", *labels)
        chart.exact("in one go", first.time, 1e3 * first.displacement[:, 0])
        chart.computed(second.time[::8], 1e3 * second.displacement[::8, 0], label="resumed")
