"""Small cases that are cut into blocks: two joint sets, a wall with an opening, a tunnel."""

TWO_SETS = """schema = 1
title = "Two sets"
time = {step = 1e-3, end = 5e-3}
[rock.granite]
young = 1e9
poisson = 0.2
density = 2700.0
[joint.bedding]
friction_angle = 20.0
[joint.cross]
friction_angle = 35.0
[domain]
boundary = [[0, 0], [10, 0], [10, 8], [0, 8]]
seed = 7
[[joint_set]]
name = "bedding"
joint = "bedding"
angle = 10.0
spacing = {distribution = "lognormal", mean = 2.0, sd = 0.3}
[[joint_set]]
name = "cross"
joint = "cross"
angle = 95.0
spacing = 2.5
"""

WALL = """schema = 1
title = "A wall with a door"
time = {step = 1e-3, end = 5e-3}
[rock.brick]
young = 5e9
poisson = 0.2
density = 1800.0
[joint.bed]
friction_angle = 35.0
[joint.head]
friction_angle = 30.0
[domain]
boundary = [[0, 0], [4, 0], [4, 2], [0, 2]]
fixed_sides = ["bottom"]
[[block_pattern]]
corner = [0, 0]
size = [4, 2]
brick = [0.4, 0.2]
joint = "bed"
head_joint = "head"
[[opening]]
name = "door"
shape = "box"
corner = [1.6, 0.4]
size = [0.8, 1.0]
excavated = true
"""

TUNNEL = """schema = 1
title = "A tunnel in two rocks"
time = {step = 1e-3, end = 5e-3}
[rock.granite]
young = 2e10
poisson = 0.2
density = 2700.0
[rock.shale]
young = 5e9
poisson = 0.3
density = 2400.0
[joint.bedding]
friction_angle = 25.0
[joint.cross]
friction_angle = 35.0
[domain]
boundary = [[0, 0], [20, 0], [20, 20], [0, 20]]
rock = "granite"
fixed_sides = ["bottom", "left", "right"]
[[joint_set]]
name = "bedding"
joint = "bedding"
angle = 0.0
spacing = 2.5
[[joint_set]]
name = "cross"
joint = "cross"
model = "cross-jointed"
angle = 80.0
spacing = 3.0
stagger = 0.5
terminates_at = ["bedding"]
[[region]]
name = "shale bed"
polygon = [[0, 0], [20, 0], [20, 5], [0, 5]]
rock = "shale"
[[opening]]
name = "heading"
shape = "circle"
center = [10, 10]
radius = 2.0
"""
