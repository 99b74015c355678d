"""Cut rock between two lakes, with an opening in it: a case of flow in stages."""

from __future__ import annotations

TEXT = """
title = "An opening between two lakes"
gravity = [0.0, -9.81]
[time]
end = {end}
step = 1e-2
dynamic_ratio = 0.0
[rock.stone]
young = 50e9
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 40.0
aperture = 2e-4
{joint}
[domain]
boundary = [[0, 0], [10, 0], [10, 10], [0, 10]]
fixed_sides = ["bottom", "left", "right"]
[[joint_set]]
name = "a"
angle = 20
spacing = 1.6
[[joint_set]]
name = "b"
angle = 95
spacing = 1.3
[[opening]]
name = "tunnel"
shape = "box"
corner = [4, 1.2]
size = [2, 2]
{opening}
"""
FLOW = """
[flow]
{flow}
[[flow_boundary]]
name = "lake"
where = {{side = "left"}}
head = {head}
[[flow_boundary]]
name = "sea"
where = {{side = "right"}}
head = 7.3
"""


def rock(*, end: float = 0.03, joint: str = "", opening: str = "") -> str:
    """Return the case without water, with more keys of its joints and its opening."""
    return TEXT.format(end=end, joint=joint, opening=opening)


def lakes(head: float = 7.3, flow: str = "") -> str:
    """Return the tables of the flow, with the level of the lake, m, and more keys of [flow]."""
    return FLOW.format(head=head, flow=flow)
