"""Rock masses to begin with, as texts: ``clast new NAME --template tunnel``."""

from __future__ import annotations

SLOPE = """\
# Bedding that dips out of a slope: dry it stands; when water rises in its joints, cables hold it.
# Plane failure of all beds as one block (Hoek & Bray): F = 1.12 dry, 0.88 wet, 1.05 wet with
# pretension. Cut into blocks, which lean on each other, the beds have 1.01 dry (clast study fos).
# Try:
#   bolt = []                  nothing holds the beds: they slide when the water comes
#   water.line                 [[0,15],[26,6]], a lower level: no cables are needed
#   joint.bedding              friction_angle = 30: it slides dry, less than its dip of 35 degrees
#   bolt_kind.cable            pretension, yield_force: force of the cables at first, and at most

schema = 1
title = "Slope in bedding, with water and cables"
plane = "strain"
gravity = [0.0, -9.8]
damping = "adaptive"                   # brings it to rest; it also slows what slides

[time]
step = 2e-3                            # s
end = 1.0                              # longest time of a stage

[rock.sandstone]
young = 5e9                            # Pa
poisson = 0.25
density = 2500.0

[joint.default]                        # what no set names
friction_angle = 40.0

[joint.bedding]
friction_angle = 38.0                  # degrees

[domain]                               # what the joints cut: clast cut slope.toml -o slope.png
boundary = [[0,3],[32,3],[32,6],[26,6],[17,24],[0,24]]
rock = "sandstone"
fixed_sides = ["bottom", "left", "right"]

[[joint_set]]
name = "bedding"
joint = "bedding"
angle = -35.0                          # degrees from +x, counter-clockwise
spacing = 3.5
origin = [25.5, 7.0]                   # a bed daylights 1 m above the floor

[[region]]                             # the beds that can move
name = "beds"
polygon = [[-0.2,24.9],[25.5,6.9],[25.5,25]]

[[joint_set]]
name = "cross joints"
angle = 60.0
spacing = {distribution="normal", mean=4.5, std=0.5}
within = "beds"
seed = 7                               # another one is another realisation

[amplitude.rise]                       # time counts from the stage that names it
time = [0, 0.2]
value = [0, 1]

[[water]]
line = [[0,22],[14,20],[26,6]]         # water level in the joints, from the back to the foot
acts_on = "joints"
amplitude = "rise"

[bolt_kind.cable]                      # numbers per metre along the slope
stiffness = 1e7                        # N/m
yield_force = 2e5                      # N/m
pretension = 5e4                       # N/m

[[bolt]]
name = "cable 1"
kind = "cable"
start = [24.33, 9.24]
end = [18.42, 8.19]
stage = "cables"

[[bolt]]
name = "cable 2"
kind = "cable"
start = [23.21, 11.47]
end = [15.33, 10.08]
stage = "cables"

[[bolt]]
name = "cable 3"
kind = "cable"
start = [21.07, 15.77]
end = [10.23, 13.85]
stage = "cables"

[[bolt]]
name = "cable 4"
kind = "cable"
start = [19.95, 18.00]
end = [7.14, 15.74]
stage = "cables"

[[bolt]]
name = "cable 5"
kind = "cable"
start = [17.85, 22.20]
end = [2.09, 19.42]
stage = "cables"

[[measured_point]]
name = "crest"
at = [16.8, 23.8]

[[stage]]
name = "dry"
dynamic_ratio = 0.0                    # static: what has no equilibrium fails
reset_displacement = true              # displacements count from here

[[stage]]
name = "cables"

[[stage]]
name = "water"
loads = ["rise"]

[output]
every = 0.05
"""

TUNNEL = """\
# A horseshoe in two joint sets at a depth of some 90 m: the rock is in balance, then the heading
# is dug, and bolts go in when the rock has given way by some tenths of a millimetre.
# Try:
#   bolt_pattern = []          a block slides out of the left wall; the report names it
#   bolt_kind.swellex          pretension = 0: the bolts carry what the block needs, and no more
#   stage heading: relax       share of the support that ends at once: 1.0 is a blast
#   opening.center             elsewhere other blocks come loose, or none

schema = 1
title = "Tunnel in two joint sets, dug and bolted"
plane = "strain"
gravity = [0.0, -9.8]
damping = "adaptive"                   # brings it to rest; it also slows what slides

[time]
step = 1e-3                            # s
end = 0.6                              # longest time of a stage

[rock.gneiss]
young = 2e10                           # Pa
poisson = 0.25
density = 2700.0

[joint.default]                        # what no set names
friction_angle = 35.0

[joint.foliation]
friction_angle = 22.0

[joint.joints]
friction_angle = 35.0

[in_situ]                              # stress before anything is dug: from the weight above
vertical = "overburden"
k0 = 0.7                               # horizontal by vertical stress
datum = 100.0                          # height y of the surface, m

[domain]                               # what is cut: clast cut tunnel.toml -o tunnel.png
boundary = [[0,0],[30,0],[30,24],[0,24]]
rock = "gneiss"
smallest_block = 0.1                   # m2: smaller ones join a neighbour
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

[[opening]]                            # rock until a stage takes it out
name = "heading"
shape = "horseshoe"
center = [14.3, 9]                     # middle of the floor
width = 6.0
wall_height = 3.0

[bolt_kind.swellex]                    # numbers per metre along the tunnel
stiffness = 2e7                        # N/m
yield_force = 1.2e5                    # N/m
rupture_elongation = 0.1               # m
pretension = 1e4                       # N/m

[[bolt_pattern]]
kind = "swellex"
opening = "heading"
length = 4.0
spacing = 1.2                          # along the wall
from = -20.0                            # degrees round the middle of the opening
to = 200.0
anchorage = "grouted"                  # one spring for every joint that a bolt crosses
free_length = 0.3
stage = "support"

[[measured_point]]
name = "crown"
at = [14.3, 15.5]

[[stage]]
name = "settled"
dynamic_ratio = 0.0
reset_displacement = true              # displacements count from here

[[stage]]
name = "heading"
excavate = ["heading"]
relax = 0.5                            # half of the load of the heading ends at once,
relax_time = 0.04                      # s: the rest in this time
until = "time"
time = 0.05

[[stage]]
name = "support"

[output]
every = 0.02
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
