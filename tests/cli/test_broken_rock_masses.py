"""What cannot be cut ends with exit code 2 and one message with table, key and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from clast.case.case_file import Case
from clast.cli.commands import app
from scenes.cut_cases import TUNNEL, TWO_SETS, WALL
from scenes.refusals import refusal, some_of

LOGNORMAL = '{distribution = "lognormal", mean = 2.0, sd = 0.3}'
BOX = "[[0, 0], [10, 0], [10, 8], [0, 8]]"
CROSS = "angle = 95.0\nspacing = 2.5\n"
BAECHER = 'angle = 95.0\nmodel = "baecher"\n'
CIRCLE = 'shape = "circle"\ncenter = [10, 10]\nradius = 2.0\n'


def sets(old: str, new: str) -> str:
    assert old in TWO_SETS, old
    return TWO_SETS.replace(old, new, 1)


def tunnel(old: str, new: str) -> str:
    assert old in TUNNEL, old
    return TUNNEL.replace(old, new, 1)


def wall(old: str, new: str) -> str:
    assert old in WALL, old
    return WALL.replace(old, new, 1)


def spacing(written: str) -> str:
    return sets(LOGNORMAL, written)


def cross(written: str) -> str:
    return sets(CROSS, written)


BEFORE_DOMAIN = TWO_SETS.partition("[domain]")[0]
AFTER_DOMAIN = "[[joint_set]]" + TWO_SETS.partition("[[joint_set]]")[2]
TRACE = TWO_SETS + "[[trace]]\n"

BROKEN: dict[str, tuple[str, list[str]]] = {
    # the domain
    "no domain": (BEFORE_DOMAIN + AFTER_DOMAIN, ["[[joint_set]] 1", "no [domain]", "boundary"]),
    "boundary crosses itself": (
        sets(BOX, "[[0, 0], [10, 8], [10, 0], [0, 8]]"),
        ["domain, boundary", "crosses or touches itself at (5, 4)", "order the points"],
    ),
    "boundary of three numbers": (sets(BOX, "[[0,0,0],[1,0,0],[1,1,0]]"), ["boundary 1", "items"]),
    "which rock": (tunnel('rock = "granite"\n', ""), ["[domain] rock", "names no rock", "shale"]),
    "too many blocks": (
        sets("seed = 7", "most_blocks = 10"),
        ["joint_set", "spacing", "than the 10 allowed", "would do", "most_blocks"],
    ),
    # joint sets
    "name twice": (sets('name = "cross"', 'name = "bedding"'), ["joint_set 'bedding'", "rename"]),
    "no angle": (sets("angle = 10.0\n", ""), ["joint_set 'bedding', angle", "angle or dip"]),
    "dip without direction": (
        cross("dip = 30\nspacing = 1\n"),
        ["joint_set 'cross', dip", "belong together"],
    ),
    "dip without section": (
        cross('dip = 30\ndip_direction = 90\nspacing = 1\nspacing_is = "true"\n'),
        ["joint_set 'cross', dip", "section_azimuth"],
    ),
    "which spacing": (
        cross("dip = 30\ndip_direction = 90\nspacing = 1\n"),
        ["joint_set 'cross', spacing_is", "true (in space) or apparent"],
    ),
    "section along the set": (
        sets("seed = 7", "section_azimuth = 0.0").replace(
            CROSS, 'dip = 90\ndip_direction = 90.1\nspacing = 1\nspacing_is = "true"\n'
        ),
        ["joint_set 'cross', dip", "nearly parallel"],
    ),
    "no spacing": (spacing("1.0").replace("spacing = 1.0\n", ""), ["'bedding', spacing", "needs"]),
    "spacing of a list": (spacing("[1.0, 2.0]"), ["'bedding' spacing", "must be a number"]),
    "sd of an exponential": (
        spacing('{distribution = "exponential", mean = 2.0, sd = 0.3}'),
        ["'bedding' spacing.sd", "no such key"],
    ),
    "low above high": (
        spacing('{distribution = "uniform", low = 2.0, high = 1.0}'),
        ["joint_set 'bedding', spacing", "below low"],
    ),
    "bridge without trace": (cross(CROSS + "bridge_length = 1\n"), ["bridge_length", "give both"]),
    "key of another model": (cross(CROSS + "intensity = 1\n"), ["'cross', intensity", "not used"]),
    "baecher without length": (
        cross(BAECHER + "intensity = 1\n"),
        ["joint_set 'cross', trace_length", "needs trace_length"],
    ),
    "baecher twice as dense": (
        cross(BAECHER + "intensity = 1\nspacing = 1\ntrace_length = 1\n"),
        ["joint_set 'cross', intensity", "both given"],
    ),
    "sd beyond all means": (
        spacing('{distribution = "lognormal", mean = 1.0, sd = 1000.0}'),
        ["joint_set 'bedding', spacing, sd", "100 times the mean"],
    ),
    "traces without end": (
        cross(BAECHER + "intensity = 1\ntrace_length = 1e12\n"),
        ["joint_set 'cross', trace_length", "200 times", "poisson-lines"],
    ),
    "many chords": (
        tunnel(CIRCLE, CIRCLE + "chords = 100000000000000000000\n"),
        ["opening 'heading', chords", "3 to 10000"],
    ),
    "within nothing": (
        cross(CROSS + "within = [[90, 0], [91, 0], [91, 1]]\n"),
        ["joint_set 'cross', within", "outside the domain"],
    ),
    "scatter twice": (
        cross(CROSS + 'fisher_kappa = 9\nangle_spread = {distribution="von-mises", kappa=9}\n'),
        ["'cross' fisher_kappa", "both given"],
    ),
    # traces
    "trace of nothing": (TRACE, ["[[trace]] 1", "neither points nor file"]),
    "trace of both": (
        TRACE + 'points = [[0,0],[1,1]]\nfile = "a.csv"\n',
        ["[[trace]] 1", "points and file"],
    ),
    "trace outside": (TRACE + "points = [[0, 90], [9, 90]]\n", ["trace 1", "82 m", "units"]),
    "layer without file": (TRACE + 'points = [[0,0],[1,1]]\nlayer = "A"\n', ["layer", "no file"]),
    "welded by name": (
        sets("[joint.bedding]", "[joint.welded]").replace('"bedding"\nangle', '"welded"\nangle'),
        ["joint_set 'bedding', joint", "is reserved for welded edges"],
    ),
    # openings, regions, masonry
    "opening without shape": (tunnel(CIRCLE, ""), ["[[opening]] 1 'heading'", "neither shape"]),
    "size of a circle": (tunnel(CIRCLE, CIRCLE + "size = [1, 1]\n"), ["'heading' size", "circle"]),
    "two chords": (tunnel(CIRCLE, CIRCLE + "chords = 2\n"), ["opening 'heading', chords", "3"]),
    "opening that crosses itself": (
        tunnel(CIRCLE, 'shape = "polygon"\npoints = [[8,8],[12,12],[12,8],[8,12]]\n'),
        ["opening 'heading'", "crosses or touches itself"],
    ),
    "nothing at a side": (
        wall('["bottom"]', '["left"]').replace(
            "corner = [1.6, 0.4]\nsize = [0.8, 1.0]", "corner = [0, 0]\nsize = [0.4, 2.0]"
        ),
        ["domain, fixed_sides", "no block is at the left"],
    ),
    "region outside": (
        tunnel("[[0, 0], [20, 0], [20, 5], [0, 5]]", "[[0, -9], [20, -9], [20, -5]]"),
        ["region 'shale bed'", "outside the domain"],
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_cannot_be_cut_is_refused_in_words(name: str, tmp_path: Path):
    text, words = BROKEN[name]
    case = tmp_path / "case.toml"
    case.write_text(text, encoding="utf-8")
    is_one_message(refusal(case, Case.cut), case, words)


@pytest.mark.parametrize("name", some_of(BROKEN, 5))
def test_the_command_says_so_and_writes_nothing(name: str, tmp_path: Path):
    text, words = BROKEN[name]
    case, output = tmp_path / "case.toml", tmp_path / "blocks.npz"
    case.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(app, ["cut", str(case), "-o", str(output)])
    assert result.exit_code == 2, result.output
    assert not output.exists() and result.stdout == ""
    is_one_message(result.stderr, case, words)


def is_one_message(message: str, case: Path, words: list[str]) -> None:
    assert message.startswith(f"error: {case}: ") and message.count("error: ") == 1, message
    assert "\n  " in message, "every message offers a remedy"
    assert "Traceback" not in message and "pydantic" not in message and "<" not in message
    assert len(message) < 2000
    for word in words:
        assert word in message, message
