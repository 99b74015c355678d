"""What cannot be cut ends with exit code 2 and one message with table, key and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from clast.case.case_file import Case
from clast.cli.commands import app
from scenes.cut_cases import TUNNEL, TWO_SETS, WALL
from scenes.refusals import refusal, some_of

BEDDING = 'name = "bedding"\njoint = "bedding"\nangle = 10.0\n'
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
    "boundary of nan": (
        sets(BOX, "[[0, 0], [nan, 0], [10, 8]]"),
        ["[domain] boundary 2, number 1", "finite"],
    ),
    "boundary of three numbers": (sets(BOX, "[[0,0,0],[1,0,0],[1,1,0]]"), ["boundary 1", "items"]),
    "unknown key of the domain": (sets("seed = 7", "sead = 7"), ["[domain] sead", "'seed'"]),
    "unknown key of a file": (
        sets(BOX, '{file = "a.dxf", layr = "A"}'),
        ["[domain] boundary.layr", "'layer'"],
    ),
    "rock that is not there": (
        sets("seed = 7", 'rock = "granit"'),
        ["[domain] rock", "no rock 'granit'", "'granite'"],
    ),
    "which rock": (tunnel('rock = "granite"\n', ""), ["[domain] rock", "names no rock", "shale"]),
    "seed below 0": (sets("seed = 7", "seed = -1"), ["[domain] seed", "0 or more"]),
    "no blocks at all": (sets("seed = 7", "most_blocks = 0"), ["[domain] most_blocks", "1 or"]),
    "too many blocks": (
        sets("seed = 7", "most_blocks = 10"),
        ["joint_set", "spacing", "than the 10 allowed", "would do", "most_blocks"],
    ),
    "unknown side": (
        sets("seed = 7", 'fixed_sides = ["botom"]'),
        ["[domain] fixed_sides 1", "did you mean 'bottom'?"],
    ),
    "two domains": (sets("[domain]", "[[domain]]"), ["domain", "one bracket"]),
    # joint sets
    "no name": (sets('name = "bedding"\n', ""), ["[[joint_set]] 1 name", "is missing"]),
    "name twice": (sets('name = "cross"', 'name = "bedding"'), ["joint_set 'bedding'", "rename"]),
    "unknown key of a set": (
        sets("angle = 10", "angel = 10"),
        ["[[joint_set]] 1 'bedding' angel", "'angle'"],
    ),
    "joint that is not there": (
        sets('joint = "bedding"', 'joint = "beding"'),
        ["[[joint_set]] 1 'bedding' joint", "no joint 'beding'", "'bedding'"],
    ),
    "unknown model": (
        sets(CROSS, CROSS + 'model = "beacher"\n'),
        ["[[joint_set]] 2 'cross' model", "no model 'beacher'", "'baecher'"],
    ),
    "no angle": (sets("angle = 10.0\n", ""), ["joint_set 'bedding', angle", "angle or dip"]),
    "angle of a text": (sets("10.0", '"steep"'), ["'bedding' angle", "must be a number"]),
    "dip without direction": (
        cross("dip = 30\nspacing = 1\n"),
        ["joint_set 'cross', dip", "belong together"],
    ),
    "dip without section": (
        cross('dip = 30\ndip_direction = 90\nspacing = 1\nspacing_is = "true"\n'),
        ["joint_set 'cross', dip", "section_azimuth"],
    ),
    "dip above 90": (
        cross('dip = 95\ndip_direction = 90\nspacing = 1\nspacing_is = "true"\n'),
        ["joint_set 'cross', dip", "95 is not a valid dip"],
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
    "spacing 0": (spacing("0.0"), ["joint_set 'bedding', spacing", "above 0"]),
    "spacing below 0": (spacing("-1.0"), ["joint_set 'bedding', spacing", "above 0"]),
    "spacing of nan": (spacing("nan"), ["'bedding' spacing", "finite"]),
    "spacing of a text": (spacing('"2 m"'), ["'bedding' spacing", "must be a number"]),
    "spacing of a list": (spacing("[1.0, 2.0]"), ["'bedding' spacing", "must be a number"]),
    "unknown distribution": (
        spacing('{distribution = "log-normal", mean = 2.0, sd = 0.3}'),
        ["'bedding' spacing.distribution", "'lognormal'"],
    ),
    "no mean": (
        spacing('{distribution = "lognormal", sd = 0.3}'),
        ["'bedding' spacing.mean", "is missing", "mean, sd"],
    ),
    "sd below 0": (
        spacing('{distribution = "lognormal", mean = 2.0, sd = -0.3}'),
        ["joint_set 'bedding', spacing, sd", "not a standard deviation"],
    ),
    "sd of an exponential": (
        spacing('{distribution = "exponential", mean = 2.0, sd = 0.3}'),
        ["'bedding' spacing.sd", "no such key"],
    ),
    "unknown number": (
        spacing('{distribution = "normal", mean = 2.0, sdd = 0.3}'),
        ["'bedding' spacing.sdd", "'sd'"],
    ),
    "low above high": (
        spacing('{distribution = "uniform", low = 2.0, high = 1.0}'),
        ["joint_set 'bedding', spacing", "below low"],
    ),
    "no values": (spacing('{distribution = "values", values = []}'), ["spacing", "empty list"]),
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
    "intensity 0": (cross(BAECHER + "intensity = 0\ntrace_length = 1\n"), ["intensity", "above 0"]),
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
    "unknown set to end at": (
        cross(CROSS + 'model = "cross-jointed"\nterminates_at = ["beding"]\n'),
        ["joint_set 'cross', terminates_at", "no set 'beding'", "'bedding'"],
    ),
    "unknown region": (cross(CROSS + 'within = "here"\n'), ["'cross', within", "no region 'here'"]),
    "within nothing": (
        cross(CROSS + "within = [[90, 0], [91, 0], [91, 1]]\n"),
        ["joint_set 'cross', within", "outside the domain"],
    ),
    "within a number": (cross(CROSS + "within = 3\n"), ["'cross' within", "list in brackets"]),
    "scatter twice": (
        cross(CROSS + 'fisher_kappa = 9\nangle_spread = {distribution="von-mises", kappa=9}\n'),
        ["'cross' fisher_kappa", "both given"],
    ),
    "rounds below 0": (
        cross('spacing = 1\nmodel = {name = "voronoi", rounds = -1}\n'),
        ["'cross' model.rounds", "0 or more"],
    ),
    # traces
    "trace of nothing": (TRACE, ["[[trace]] 1", "neither points nor file"]),
    "trace of both": (
        TRACE + 'points = [[0,0],[1,1]]\nfile = "a.csv"\n',
        ["[[trace]] 1", "points and file"],
    ),
    "trace outside": (TRACE + "points = [[0, 90], [9, 90]]\n", ["trace 1", "82 m", "units"]),
    "joint of a trace": (
        TRACE + 'points = [[0, 4], [10, 4]]\njoint = "crosss"\n',
        ["[[trace]] 1 joint", "'cross'"],
    ),
    "layer without file": (TRACE + 'points = [[0,0],[1,1]]\nlayer = "A"\n', ["layer", "no file"]),
    "welded by name": (
        sets("[joint.bedding]", "[joint.welded]").replace('"bedding"\nangle', '"welded"\nangle'),
        ["joint_set 'bedding', joint", "is reserved for welded edges"],
    ),
    # openings, regions, masonry
    "opening without shape": (tunnel(CIRCLE, ""), ["[[opening]] 1 'heading'", "neither shape"]),
    "unknown shape": (tunnel('"circle"', '"circel"'), ["'heading' shape", "'circle'"]),
    "no radius": (tunnel("radius = 2.0\n", ""), ["'heading' radius", "is missing", "chords"]),
    "radius 0": (tunnel("radius = 2.0", "radius = 0.0"), ["'heading' radius", "above 0"]),
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
    "rock of a region": (
        tunnel('rock = "shale"', 'rock = "shall"'),
        ["[[region]] 1 'shale bed' rock", "'shale'"],
    ),
    "region outside": (
        tunnel("[[0, 0], [20, 0], [20, 5], [0, 5]]", "[[0, -9], [20, -9], [20, -5]]"),
        ["region 'shale bed'", "outside the domain"],
    ),
    "brick of no height": (
        wall("[0.4, 0.2]", "[0.4, 0.0]"),
        ["[[block_pattern]] 1 brick 2", "above 0"],
    ),
    "unknown bond": (
        wall("brick = ", 'pattern = "runing-bond"\nbrick = '),
        ["[[block_pattern]] 1 pattern", "'running-bond'"],
    ),
    "head joint that is not there": (
        wall('head_joint = "head"', 'head_joint = "heed"'),
        ["[[block_pattern]] 1 head_joint", "'head'"],
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_cannot_be_cut_is_refused_in_words(name: str, tmp_path: Path):
    text, words = BROKEN[name]
    case = tmp_path / "case.toml"
    case.write_text(text, encoding="utf-8")
    is_one_message(refusal(case, Case.cut), case, words)


@pytest.mark.parametrize("name", some_of(BROKEN, 12))
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
