"""Rock masses to begin with, as texts: ``clast new NAME --template tunnel``."""

from __future__ import annotations

SLOPE = """\
schema = 1
title = "Slope in bedding that dips out of it"
gravity = [0.0, -9.8]

[time]
step = 2e-3
end = 1.0

[rock.sandstone]
young = 5e9                            # Pa
poisson = 0.25
density = 2500.0

[joint.default]                        # what no set names
friction_angle = 30.0

[joint.bedding]
friction_angle = 25.0                  # the bedding dips by 35 degrees: it slides

[joint.cross]
friction_angle = 40.0
cohesion = 1e4                         # Pa

[domain]                               # what the joints cut: clast cut slope.toml -o slope.png
boundary = [[0,0],[60,0],[60,20],[40,20],[20,50],[0,50]]
rock = "sandstone"
fixed_sides = ["bottom", "left", "right"]
seed = 7                               # another one is another realisation of the same rock mass

[[joint_set]]
name = "bedding"
joint = "bedding"
angle = -35.0                          # degrees from +x, counter-clockwise
spacing = {distribution="lognormal", mean=3.0, std=0.5}

[[joint_set]]
name = "cross joints"
joint = "cross"
angle = 60.0
spacing = 4.0
trace_length = 12.0                    # not persistent: bridges of rock between traces
bridge_length = 1.0

[output]
every = 0.05
"""

TUNNEL = """\
schema = 1
title = "Tunnel in two joint sets"
plane = "strain"
gravity = [0.0, -9.8]

[time]
step = 2e-3
end = 1.0

[rock.gneiss]
young = 2e10                           # Pa
poisson = 0.25
density = 2700.0

[joint.default]                        # what no set names
friction_angle = 30.0

[joint.foliation]
friction_angle = 30.0

[joint.joints]
friction_angle = 35.0

[domain]                               # what is cut: clast cut tunnel.toml -o tunnel.png
boundary = [[0,0],[30,0],[30,24],[0,24]]
rock = "gneiss"
fixed_sides = ["bottom", "left", "right"]
seed = 3

[[joint_set]]
name = "foliation"
joint = "foliation"
angle = 40.0                           # degrees from +x, counter-clockwise
spacing = {distribution="normal", mean=2.0, std=0.3}

[[joint_set]]
name = "joints"
joint = "joints"
angle = -60.0
spacing = 2.5

[[opening]]
name = "heading"
shape = "horseshoe"
center = [15, 8]                       # middle of the floor
width = 6.0
wall_height = 3.0
excavated = true                       # void from the start

[output]
every = 0.05
"""

KEY_BLOCK = """\
schema = 1
title = "Key block in the roof of a drift"
plane = "strain"
gravity = [0.0, -9.8]

[time]
step = 1e-3
end = 0.5

[rock.granite]
young = 3e10                           # Pa
poisson = 0.2
density = 2650.0

[joint.default]
friction_angle = 35.0

[joint.seam]
friction_angle = 25.0                  # nothing presses on the wedge: no angle would hold it

[domain]                               # what is cut: clast cut key-block.toml -o key-block.png
boundary = [[0,0],[12,0],[12,10],[0,10]]
rock = "granite"
fixed_sides = ["bottom", "left", "right", "top"]

[[trace]]                              # joints as they were drawn
points = [[4.6,5.0],[6.0,8.0],[7.6,5.0]]
joint = "seam"

[[opening]]
name = "drift"
shape = "box"
corner = [4, 2]                        # lower left
size = [4.2, 3.0]
excavated = true

[[measured_point]]
name = "wedge"
at = [6.0, 6.0]

[[reference]]                          # it falls freely
point = "wedge"
time = 0.5
displacement = [0.0, -1.225]
source = "closed form: g t2/2"

[output]
every = 0.02
"""
