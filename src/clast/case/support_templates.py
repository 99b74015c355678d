"""Cases with supports that move, as texts: ``clast new NAME --template spreading-arch``."""

from __future__ import annotations

import math

from clast.case.masonry_templates import block_text, point_text

SPREADING_ARCH = """\
# An arch whose right abutment gives way: joints open where the line of thrust touches the edges,
# at the back of the crown and at the soffit of both haunches, and the crown sinks.
#   radius    = {radius:<6g} m  of the middle line
#   thickness = {thickness:<6g} m
#   voussoirs = {voussoirs:<6}    an even number has a joint at the crown
#   spread    = {spread:<6g} m  the displacement of the abutment
# The voussoirs are listed one by one; a script writes the file for other numbers:
#   from clast.case.templates import spreading_arch
#   open("wide.toml", "w").write(spreading_arch(spread=0.5))
# What else to change:
#   amplitude.spread: value   [0.0, 0.0, 0.5]: the arch falls when it has moved by 0.471 m;
#                             [0.0, 0.0, -0.05]: it is squeezed, and the crown rises
#   joint.default             friction_angle = 20: voussoirs slide before

schema = 1
title = "Arch on an abutment that gives way"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 1e-2
end = 2.4
dynamic_ratio = 0.0                    # static: no velocity is carried from step to step

[rock.stone]
young = 5e10                           # Pa
poisson = 0.2
density = 2400.0                       # kg/m3

[joint.default]
friction_angle = 40.0                  # degrees

[amplitude.spread]                     # m: first the arch carries its weight
time = [0.0, 0.4, 2.4]
value = [0.0, 0.0, {spread:g}]

[[motion]]
name = "spread"
block = "right abutment"
x = {{ displacement = "spread" }}

[[measured_reaction]]                  # that of the motion is recorded by itself
name = "left"
block = "left abutment"

[output]
every = 0.04
"""

SHEAR_BOX = """\
# A direct shear test of a rough joint: the upper half is pressed with 1 MPa and drawn by 10 mm.
# Its reaction gives the strength: at the peak tan(phi_r + JRC log10(JCS/sigma)) = tan(48 degrees)
# times the normal force.  The joint opens as it slides.
# Try:
#   motion.stress             [0.0, -5e6]: less steep, and it opens less
#   joint.rough: jrc          4.0, a smooth joint; 16.0, a rough one
#   clast export shear-box.vtkhdf --to csv --tables reactions    the forces over time

schema = 1
title = "Direct shear test of a rough joint"
gravity = [0.0, 0.0]

[time]
step = 1e-3                            # s
end = 1.2

[rock.granite]
young = 3e10                           # Pa
poisson = 0.2
density = 2650.0                       # kg/m3

[joint.rough]
between = [["lower half", "upper half"]]
law = "barton-bandis"
jrc = 10.0                             # joint roughness coefficient, 0 to 20
jcs = 100e6                            # Pa: compressive strength of the walls
residual_friction_angle = 28.0         # degrees
sample_length = 0.3                    # m

[joint.default]
friction_angle = 30.0

[[block]]
name = "lower half"
vertices = [[-0.05, -0.1], [0.35, -0.1], [0.35, 0], [-0.05, 0]]
fixed = true

[[block]]
name = "upper half"
vertices = [[0, 0], [0.3, 0], [0.3, 0.1], [0, 0.1]]

[amplitude.way]                        # m: first it is pressed
time = [0.0, 0.2, 1.2]
value = [0.0, 0.0, 0.01]

[[motion]]
name = "box"
block = "upper half"
x = { displacement = "way" }
rotation = 0.0
stress = [0.0, -1e6]                   # Pa: a servo presses downwards
limit_speed = 1.0                      # m/s, where nothing resists
ease = 0.05                            # s: begins without a shock

[[measured_point]]
name = "joint"
at = [0.15, 0]
block = "upper half"

[output]
every = 0.02
"""

SETTLING_WALL = """\
# A wall of dry bricks on a foundation of which the right part settles by 30 mm: the bricks above
# it turn, cracks open in steps from the joint of the foundation upwards.
# Try:
#   the two foundations       3.9 in place of 2.4, twice each: the wall bridges what settles, and
#                             a twelfth of its weight is left on it
#   joint.mortar              cohesion = 2e5, tensile_strength = 1e5: cracks run through mortar

schema = 1
title = "Brick wall on a foundation that settles"
gravity = [0.0, -9.8]                  # m/s2

[time]
step = 1e-2
end = 2.2
dynamic_ratio = 0.0                    # static: no velocity is carried from step to step

[rock.brick]
young = 5e9                            # Pa
poisson = 0.2
density = 1800.0                       # kg/m3

[rock.concrete]
young = 3e10
poisson = 0.2
density = 2400.0

[joint.mortar]
friction_angle = 35.0                  # degrees
cohesion = 0.0                         # Pa

[joint.default]                        # where no joint is named
friction_angle = 35.0

[domain]
boundary = [[0, 0], [6, 0], [6, 3], [0, 3]]
rock = "brick"

[[block_pattern]]
pattern = "running-bond"
corner = [0, 0]                        # lower left
size = [6.0, 3.0]
brick = [0.6, 0.3]                     # width and height, m
joint = "mortar"

[[block]]
name = "firm"
vertices = [[-0.3, -0.5], [2.4, -0.5], [2.4, 0], [-0.3, 0]]
rock = "concrete"
fixed = true

[[block]]
name = "soft"
vertices = [[2.4, -0.5], [6.3, -0.5], [6.3, 0], [2.4, 0]]
rock = "concrete"
fixed = true

[amplitude.settlement]                 # m: first the wall carries its weight
time = [0.0, 0.2, 2.2]
value = [0.0, 0.0, -0.03]

[[motion]]
name = "settlement"
block = "soft"
y = { displacement = "settlement" }

[[measured_reaction]]                  # that of the motion is recorded by itself
name = "firm part"
block = "firm"

[[measured_point]]
name = "corner"
at = [6.0, 3.0]

[output]
every = 0.1
"""

LINED_TUNNEL = """\
# A tunnel in two joint sets at a depth of some 100 m, in stages: the rock is in balance, the top
# heading is dug and bolted, the bench is dug, shotcrete is sprayed while a third of the forces of
# the bench is still to be released, and an earthquake shakes what stands.
# Try:
#   lining.shotcrete           thickness = 0.1: an eighth of the stiffness in bending
#   stage bench: time          0.3: all is released before the shotcrete comes, which carries less
#   joint.foliation            shear_stiffness = 1e9: it shears more before it slips
#   ground_motion              scale = 2.0: a stronger earthquake
#   clast plot lined-tunnel.vtkhdf --layers moments --zoom=-6,-5,6,6

schema = 1
title = "Tunnel dug in two parts, bolted, sprayed and shaken"
plane = "strain"
gravity = [0.0, -9.8]

[time]
step = 1e-2                            # s
end = 1.0                              # longest time of a stage

[rock.gneiss]
young = 5e9                            # Pa
poisson = 0.25
density = 2700.0

[joint.default]                        # what no set names
friction_angle = 35.0
normal_stiffness = 2e10                # Pa/m: without, contacts close as E of the rock lets them
shear_stiffness = 4e9

[joint.foliation]
friction_angle = 30.0
normal_stiffness = 2e10
shear_stiffness = 4e9

[joint.joints]
friction_angle = 35.0
normal_stiffness = 2e10
shear_stiffness = 4e9

[joint.bond]                           # between shotcrete and rock
friction_angle = 35.0
cohesion = 5e5                         # Pa
tensile_strength = 5e5
normal_stiffness = 5e10                # Pa/m
shear_stiffness = 5e9

[in_situ]                              # stress before anything is dug: from the weight above
vertical = "overburden"
k0 = 0.7                               # horizontal by vertical stress
datum = 100.0                           # height y of the surface, m

[domain]                               # what is cut: clast cut lined-tunnel.toml -o tunnel.png
boundary = [[-12,-12],[12,-12],[12,12],[-12,12]]
rock = "gneiss"
smallest_block = 0.2                   # m2: smaller ones join a neighbour
fixed_sides = ["bottom", "left", "right"]

[[joint_set]]
name = "foliation"
joint = "foliation"
angle = 35.0                           # degrees from +x, counter-clockwise
spacing = 2.0
origin = [0.9, -0.3]

[[joint_set]]
name = "joints"
joint = "joints"
angle = -62.0
spacing = 2.2
origin = [0.9, -0.3]

[[opening]]                            # rock until a stage takes it out
name = "heading"
shape = "polygon"
points = [
    [-3,-0.5], [3,-0.5], [3,0], [2.853,0.927], [2.427,1.763], [1.763,2.427], [0.927,2.853],
    [0,3], [-0.927,2.853], [-1.763,2.427], [-2.427,1.763], [-2.853,0.927], [-3,0],
]

[[opening]]
name = "bench"
shape = "box"
corner = [-3, -3]
size = [6, 2.5]

[bolt_kind.swellex]                    # numbers per metre along the tunnel
stiffness = 2e7                        # N/m
yield_force = 1.2e5                    # N/m
rupture_elongation = 0.1               # m
pretension = 1e4                       # N/m

[[bolt_pattern]]
kind = "swellex"
opening = "heading"
length = 4.0
spacing = 1.3                          # along the roof
from = 0.0                             # degrees round the middle of the heading
to = 180.0
anchorage = "grouted"                  # one spring for every joint that a bolt crosses
free_length = 0.3
stage = "bolts"

[[lining]]                             # counter-clockwise: right wall, roof, left wall
name = "shotcrete"
polyline = [
    [3,-3], [3,0], [2.853,0.927], [2.427,1.763], [1.763,2.427], [0.927,2.853], [0,3],
    [-0.927,2.853], [-1.763,2.427], [-2.427,1.763], [-2.853,0.927], [-3,0], [-3,-3],
]
thickness = 0.2                        # m
segment = 0.8                          # m, at most
young = 1.5e10                         # Pa
poisson = 0.2
tension = 2e6                          # Pa
compression = 2.5e7
joint = "bond"
stage = "shotcrete"

[ground_motion]
acts = "body-force"                    # motion is relative to the ground
time = [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]   # s
acceleration = [0, 1.5, 0, -3.0, 0, 1.5, 0] # m/s2; the ground ends at rest where it was

[[measured_point]]
name = "crown"
at = [0, 3.05]

[[stage]]
name = "settled"
dynamic_ratio = 0.0                    # static
reset_displacement = true              # displacements count from here

[[stage]]
name = "heading"
dynamic_ratio = 0.0
excavate = ["heading"]
relax = 0.6
relax_time = 0.3
until = "time"
time = 0.1

[[stage]]
name = "bolts"
dynamic_ratio = 0.0

[[stage]]
name = "bench"
dynamic_ratio = 0.0
excavate = ["bench"]
relax = 0.5                            # share of the support that ends at once,
relax_time = 0.3                       # s: the rest in this time
until = "time"
time = 0.1

[[stage]]
name = "shotcrete"
dynamic_ratio = 0.0

[[stage]]
name = "earthquake"
step = 2e-3
dynamic_ratio = 1.0
ground_motion = true
until = "time"
time = 0.6
damping = { mass = 0.5, stiffness = 1e-4 }

[method]
integrator = "midpoint"                # waves are not damped by the steps

[output]
every = 0.05
"""


def spreading_arch(
    radius: float = 4.0, thickness: float = 0.6, voussoirs: int = 16, spread: float = 0.4
) -> str:
    """Return a semicircular arch of a mean radius, m, whose right abutment moves out, m."""
    head = SPREADING_ARCH.format(
        radius=radius, thickness=thickness, voussoirs=voussoirs, spread=spread
    )
    low, high = radius - 0.7 * thickness, radius + 1.2 * thickness
    blocks = [
        block_text(f"{name} abutment", corners, "fixed = true\n")
        for name, corners in (
            ("left", [(-high, -0.5), (-low, -0.5), (-low, 0.0), (-high, 0.0)]),
            ("right", [(low, -0.5), (high, -0.5), (high, 0.0), (low, 0.0)]),
        )
    ]
    joints = [
        [
            (round(reach * math.cos(angle), 6) + 0.0, round(reach * math.sin(angle), 6))
            for reach in (radius - 0.5 * thickness, radius + 0.5 * thickness)
        ]
        for angle in (math.pi * k / voussoirs for k in range(voussoirs + 1))
    ]
    for k in range(voussoirs):
        (first, second), (third, fourth) = joints[k], joints[k + 1]
        blocks.append(block_text(f"voussoir {k + 1}", [first, second, fourth, third]))
    crown = point_text("crown", (0.0, radius + 0.5 * thickness), f"voussoir {voussoirs // 2}")
    return "\n".join([head, *blocks, crown])
