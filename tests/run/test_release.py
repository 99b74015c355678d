"""Support forces that one stage releases in part, and a later stage to the end."""

from pathlib import Path

import pytest

import clast
from scenes.restarts import pressed_at

WEIGHT = 4.0 * 2500.0 * 9.81
"""Weight of the beam, N/m."""
CASE = """
schema = 1
plane = "strain"
time = {step = 2e-3, end = 1.0, dynamic_ratio = 0.0}
rock.stone = {young = 10e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
bolt_kind.bar = {stiffness = 1e9}
opening = [{name = "room", blocks = ["pillar"]}]
bolt = [
    {name = "left", kind = "bar", start = [1.5, 0.5], end = [1.5, 2.5]},
    {name = "right", kind = "bar", start = [2.5, 0.5], end = [2.5, 2.5]},
]
gravity = [0, -9.81]

[[block]]
name = "ground"
fixed = true
vertices = [[-1, -1], [5, -1], [5, -0.5], [-1, -0.5]]

[[block]]
name = "above"
fixed = true
vertices = [[-1, 2], [5, 2], [5, 3], [-1, 3]]

[[block]]
name = "beam"
vertices = [[0, 0], [4, 0], [4, 1], [0, 1]]

[[block]]
name = "pillar"
vertices = [[1, -0.5], [3, -0.5], [3, 0], [1, 0]]

[[stage]]
name = "gravity"
"""
DIG = '[[stage]]\nname = "dig"\nexcavate = ["room"]\ninstall = ["bar"]\n'


def run_of(folder: Path, *stages: str, settings: str = "") -> clast.Run:
    """Return the run of a beam on a pillar that is excavated below two bolts."""
    path = folder / "case.toml"
    path.write_text("\n".join([settings, CASE, DIG, *stages]), encoding="utf-8")
    return clast.load(path).run()


def carried(run: clast.Run) -> list[float]:
    """Return the force of both bolts at the end of every stage, in weights of the beam."""
    left, right = run.bolt_history("left"), run.bolt_history("right")
    both = (left.force + right.force) / WEIGHT
    return [float(both[left.time <= stage.end + 1e-9][-1]) for stage in run.stages[1:]]


def later(name: str, share: float, *, by: str = "room", more: str = "") -> str:
    return f'[[stage]]\nname = "{name}"\nrelease = {{{by} = {share}}}\n{more}\n'


@pytest.mark.parametrize("process", ["convex", "modified", "open-close"])
def test_bolts_carry_what_is_released(tmp_path: Path, process: str) -> None:
    settings = f'method.process = "{process}"'
    over = "relax = 0.0\nrelax_time = 0.1"
    run = run_of(
        tmp_path, f"release = 0.4\n{over}", later("rest", 1.0, more=over), settings=settings
    )
    assert [stage.outcome for stage in run.stages] == 3 * ["equilibrium"]
    assert carried(run) == pytest.approx([0.4, 1.0], rel=5e-4)


def test_steps_of_the_release_do_not_matter(tmp_path: Path) -> None:
    at_once = carried(run_of(tmp_path))[-1]
    by_parts = carried(
        run_of(
            tmp_path,
            "release = {room = 0.25}",
            later("half", 0.5, by="pillar"),
            later("more", 0.5 + 0.25, more="relax = 0.2\nrelax_time = 0.05"),
            later("rest", 1.0),
        )
    )
    assert by_parts == pytest.approx([0.25, 0.5, 0.75, 1.0], rel=1e-4)
    assert by_parts[-1] == pytest.approx(at_once, rel=1e-6)


def test_a_run_goes_on_in_the_middle_of_a_release(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text("\n".join([CASE, DIG, "release = 0.5", later("rest", 1.0)]), encoding="utf-8")
    case = clast.load(path)
    whole = case.run()
    dug = whole.stages[1]
    at = whole.stages[0].steps + dug.steps + 1  # the first step of what releases the rest
    part = case.run(output=tmp_path / "part.vtkhdf", progress=pressed_at(at))
    assert part.checkpoint is not None
    assert carried(clast.resume(part.checkpoint)) == carried(whole)


@pytest.mark.parametrize(
    ("stages", "what"),
    [
        (("release = 0.5", later("rest", 0.4)), "0.4 is not more than the 0.5"),
        ((later("rest", 1.0),), "1 is not more than the 1"),
        (("release = {rom = 0.5}",), "there is no opening or block 'rom'"),
        (("release = {beam = 0.5}",), "block 'beam' has not been excavated by then"),
        (("release = 1.5",), "must be 1 or less, not 1.5"),
        (("relax_time = 1.0",), "nothing left to release"),
    ],
)
def test_impossible_releases_are_refused(
    tmp_path: Path, stages: tuple[str, ...], what: str
) -> None:
    with pytest.raises(clast.ClastError, match=what):
        run_of(tmp_path, *stages)
