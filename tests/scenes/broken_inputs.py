"""A broad table of broken inputs: cases with all tables, values and settings that they refuse."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import clast
from clast.errors import CaseError
from clast.inputs.declaring.validation_messages import is_tables

BASE = """
title = "all tables"
plane = "strain"
gravity = [0.0, -9.8]
gravity_amplitude = "ramp"
seismic_coefficient = [0.0, 0.0]
damping = "none"
time = {step = 1e-3, end = 0.01, max_displacement = 0.01, dynamic_ratio = 1.0, smallest_step = 1e-6}
output = {every = 1e-3, contacts = true, checkpoint_every = 10.0}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0, initial_stress = [0.0, 0.0, 0.0]}
in_situ = {stress = [-1e3, -1e3, 0.0], gradient = [0.0, 0.0, 0.0], datum = 0.0, contacts = "none", \
boundary = "roller", sides = ["left"]}
amplitude.ramp = {time = [0.0, 1.0], value = [0.5, 1.0]}
bolt_kind.bar = {stiffness = 1e7, yield_force = 1e5, rupture_elongation = 0.05, pretension = 1e3, \
compression = false}
[joint.default]
friction_angle = 30.0
cohesion = 2.0
tensile_strength = 1.0
residual_cohesion = 0.0
restitution = 0.1
normal_stiffness = 1e9
shear_stiffness = 1e9
between = [["base", "wall"]]
between_rocks = [["stone", "stone"]]
allow_small_friction_angle = false
[ground_motion]
acts = "incoming"
time = [0.0, 1.0]
acceleration = [0.0, 0.1]
vertical = [0.0, 0.1]
scale = 1.0
baseline = "none"
after = "hold"
[[block]]
name = "base"
rock = "stone"
vertices = [[0, -1], [4, -1], [4, 0], [0, 0]]
[[block]]
name = "wall"
vertices = [[0, 0], [1, 0], [1, 2], [0, 2]]
fixed = false
velocity = [0.0, 0.0, 0.0]
initial_stress = [0.0, 0.0, 0.0]
edge_joint = ["default", "", "", ""]
[[opening]]
name = "void"
blocks = ["wall"]
[[fixed_point]]
at = [2.0, -0.5]
block = "base"
[[point_load]]
at = [0.5, 1.0]
force = [1.0, 0.0]
block = "wall"
amplitude = "ramp"
name = "push"
[[line_load]]
start = [0.0, 2.0]
end = [1.0, 2.0]
traction = [0.0, -1.0]
block = "wall"
amplitude = "ramp"
name = "push"
[[pressure]]
start = [0.0, 0.0]
end = [0.0, 2.0]
value = [2e4, 0.0]
block = "wall"
amplitude = "ramp"
name = "push"
[[bolt]]
name = "first"
start = [0.5, 1.0]
end = [0.5, -0.5]
blocks = ["wall", "base"]
kind = "bar"
anchorage = "ends"
pretension_is = "initial"
stage = "later"
[[bolt]]
start = [0.7, 1.0]
end = [0.7, -0.5]
kind = "bar"
anchorage = "grouted"
free_length = 0.1
pretension_is = "jacked"
[[motion]]
name = "raised"
blocks = ["wall"]
x = 0.0
y = {velocity = "ramp", scale = 0.1}
rotation = 0.0
about = [0.0, 0.0]
ease = 0.1
stage = "first"
until = "later"
[[motion]]
block = "wall"
stress = [0.0, -1e5]
x = 0.0
rotation = 0.0
limit_speed = 0.1
amplitude = "ramp"
stage = "later"
until = 0.001
[[link]]
name = "pin"
at = [0.5, 0.0]
blocks = ["wall", "base"]
direction = [0.0, 1.0]
x = "rigid"
y = 1e8
rotation = 1e6
yield_force = 1e5
yield_moment = 1e4
rupture = 0.1
rupture_rotation = 10.0
gap = 1e-3
damping = 1e3
rotation_damping = 1e3
contacts = true
stage = "later"
[[moment]]
block = "wall"
moment = 1.0
amplitude = "ramp"
[[measured_reaction]]
name = "hinge"
fixed_point = [2.0, -0.5]
about = [0.0, 0.0]
[[measured_reaction]]
name = "wall"
block = "wall"
[[water]]
name = "lake"
level = 1.0
acts_on = "both"
density = 1000.0
joints = ["default"]
amplitude = 1.0
drained_at = [[1.0, 0.0]]
wetted = "closed"
[[water]]
line = [[-1.0, 1.0], [5.0, 1.5]]
acts_on = "faces"
amplitude = "ramp"
[[viscous_boundary]]
where = {side = "bottom"}
normal = 1.0
tangential = 1.0
static = "hold"
begins = 0.0
[[viscous_boundary]]
where = {edges = [[[1.0, 2.0], [0.0, 2.0]]]}
stage = "later"
[[measured_point]]
name = "A"
at = [1.0, 2.0]
block = "wall"
[[measured_point]]
name = "foot"
at = [1.0, 0.0]
block = "wall"
[[measured_convergence]]
name = "closing"
of = ["A", "foot"]
[[measured_contact]]
name = "C"
at = [0.0, 0.0]
[[measured_contact]]
name = "J"
joint = "default"
[[reference]]
point = "A"
displacement = [0.0, 0.0]
time = 0.01
source = "known"
[[stage]]
name = "first"
until = "equilibrium"
time = 0.01
damping = "adaptive"
dynamic_ratio = 0.0
force_ratio = 1e-4
speed = 1e-6
hold = 20
reset_displacement = true
step = 1e-3
every = 1e-3
bonds = "hold"
[[stage]]
name = "later"
until = "time"
excavate = ["void"]
relax = 0.5
relax_time = 0.001
install = ["bar"]
loads = ["push"]
ground_motion = true
joint = {default = {friction_angle = 20.0, cohesion = 1.0, tensile_strength = 0.5, \
residual_cohesion = 0.0}}
"""

ROCK_MASS = """
plane = "strain"
time = {step = 1e-3, end = 0.01}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0}
rock.shale = {young = 1e9, poisson = 0.2, density = 2500.0}
joint.bedding = {friction_angle = 30.0}
damping = {mass = 1.0, stiffness = 1e-5}
repair = {tolerance = 1e-3}
[method]
process = {name = "modified", passes = 2}
contact_law = {name = "augmented-lagrangian", normal_stiffness = 1e9, solves = 4, \
multipliers = "carried"}
corner_rule = "shi"
rotation = "exact"
integrator = "midpoint"
solver = "pcg"
critdis = 0.005
fixed_point_stiffness = 1e11
[geometry]
vertices = [[20, 0], [21, 0], [21, 1], [20, 1]]
blocks = [{loop = [1, 2, 3, 4], name = "far", rock = "stone", fixed = true}]
[domain]
boundary = [[0, 0], [8, 0], [8, 6], [0, 6]]
rock = "stone"
section_azimuth = 90.0
tolerance = 1e-6
smallest_edge = 0.01
smallest_block = 0.001
most_blocks = 500
seed = 3
fixed_sides = ["bottom"]
[[joint_set]]
name = "beds"
model = "parallel"
joint = "bedding"
dip = 10.0
dip_direction = 90.0
spacing = {distribution = "normal", mean = 2.0, sd = 0.1}
spacing_is = "true"
origin = [0.0, 1.0]
stagger = 0.0
within = "layer"
seed = 1
fisher_kappa = 500.0
[[joint_set]]
name = "cross"
model = "cross-jointed"
angle = 90.0
spacing = 2.0
terminates_at = ["beds"]
angle_spread = {distribution = "von-mises", kappa = 500.0}
[[trace]]
points = [[0, 3], [8, 3.5]]
joint = "bedding"
set = "faults"
[[opening]]
name = "heading"
shape = "horseshoe"
center = [4, 2]
width = 1.0
wall_height = 0.5
chords = 6
excavated = false
construction_joint = true
[[region]]
name = "layer"
polygon = [[0, 4], [8, 4], [8, 6], [0, 6]]
rock = "shale"
joint = "bedding"
one_block = false
[[block_pattern]]
name = "wall"
pattern = "running-bond"
corner = [0.5, 0.5]
size = [1.0, 1.0]
brick = [0.5, 0.5]
joint = "bedding"
head_joint = "bedding"
"""

WRONG: dict[str, Any] = {
    "text": "nonsense",
    "nan": float("nan"),
    "below": -1e30,
    "above": 1e40,
    "small": 1e-40,
    "none of it": [],
    "table": {"nonsense": 1},
    "true": True,
}

ROUGH = "law='barton-bandis', "


def lined(keys: str, thickness: float = 0.1) -> list[str]:
    """Return the setting that adds a lining with some keys."""
    usual = f"name='plate', thickness={thickness}, segment=0.25, young=2e10"
    return ["lining=[{" + usual + (f", {keys}" if keys else "") + "}]"]


STILL = ["viscous_boundary=[]", "ground_motion.acts='body-force'"]
"""Leaves the dashpots out, that blocks may be fixed."""

RING = "opening=[[0.3, -0.5], [0.7, -0.5], [0.5, -0.3]], spacing=0.5"
"""A pattern of bolts round a hole in the base."""

SETTINGS: dict[str, list[str]] = {
    "two surfaces": ["water.1.line=[[0, 1], [4, 1]]"],
    "water below": ["water.1.level=-5"],
    "water goes back": ["water.2.line=[[0, 1], [3, 1], [2, 1]]"],
    "motion of no block": ["motion.1.blocks=['wal']"],
    "motion of nothing": ["motion.1={name='raised', x=1}"],
    "motion of no blocks": ["motion.1.blocks=[]"],
    "motion twice of a block": ["motion.1.blocks=['wall', 'wall']"],
    "motion of block and blocks": ["motion.1.block=wall"],
    "motion of a fixed point that is none": ["motion.1={fixed_point=[9, 9], y=1}"],
    "motion of a fixed point that turns": ["motion.1={fixed_point=[2, -0.5], rotation=1}"],
    "motion nowhere": ["motion.1={block='wall'}"],
    "motion about without rotation": ["motion.1={block='wall', x=1, about=[0, 0]}"],
    "motion of several that turn": ["motion.1={blocks=['wall', 'base'], rotation=1}"],
    "motion by no table": ["motion.1.y={velocity='rmap'}"],
    "motion by two tables": ["motion.1.y={velocity='ramp', displacement='ramp'}"],
    "motion by nothing": ["motion.1.y={scale=2}"],
    "motion that begins with a jump": ["motion.1.y={displacement='ramp'}"],
    "motion of no stage": ["motion.1.stage=late"],
    "motion that ends with no stage": ["motion.1.until=late"],
    "motion at once with another": ["motion.2.stage=first"],
    "motion against a fixed point": ["motion.1.blocks=['base']"],
    "motions of a name": ["motion.2.name=raised"],
    "motion of a fixed point about": ["motion.1={fixed_point=[2, -0.5], x=1, about=[0, 0]}"],
    "motion of a fixed point by force": [
        "motion.1={fixed_point=[2, -0.5], force=[0, -1], limit_speed=1}"
    ],
    "servo on a fixed block": [*STILL, "block.2.fixed=true", "motion.1.until=first"],
    "servo on different blocks": [
        "motion=[{blocks=['wall', 'base'], stress=[0, 1], limit_speed=1}]"
    ],
    "servo of force and stress": ["motion.2.force=[0, 1]"],
    "servo without a speed": ["motion.2={block='wall', force=[0, 1]}"],
    "servo of nothing": ["motion.2.stress=[0, 0]"],
    "servo on what is moved": ["motion.2.stress=[1e5, 0]"],
    "servo by no table": ["motion.2.amplitude=rmap"],
    "speed of no servo": ["motion.1.limit_speed=1"],
    "link with itself": ["link.1.blocks=['wall', 'wall']"],
    "link of no block": ["link.1.blocks=['wall', 'bas']"],
    "link of nothing": ["link.1={at=[0, 0], x=1e8}"],
    "link twice": ["link.1.block=wall"],
    "link that restrains nothing": ["link.1={at=[0, 0], blocks=['wall', 'base']}"],
    "link of no direction": ["link.1.direction=[0, 0]"],
    "link that yields nowhere": [
        "link.1={at=[0, 0], blocks=['wall', 'base'], x=1e8, yield_moment=1}"
    ],
    "link of no stage": ["link.1.stage=late"],
    "link of two fixed blocks": [*STILL, "block.1.fixed=true", "block.2.fixed=true", "motion=[]"],
    "link of a fixed block": [
        *STILL,
        "link.1={at=[0.5, 0], block='wall', x=1e8}",
        "block.2.fixed=true",
    ],
    **{
        f"link without {key} to act along": [
            f"link.1={{at=[0, 0], blocks=['wall', 'base'], rotation=1e3, {key}=0.1}}"
        ]
        for key in ("yield_force", "gap", "rupture")
    },
    "link of no rotation": ["link.1={at=[0, 0], blocks=['wall', 'base'], x=1, rupture_rotation=5}"],
    "reaction of block and point": ["measured_reaction.2.fixed_point=[2, -0.5]"],
    "reaction of a total": ["measured_reaction.2.name='fixed points'"],
    "joint weakens nothing": ["joint.default={friction_angle=30, slip_weakening=0.01}"],
    "link rigidly misspelt": ["link.1.x=rigd"],
    "lining of nothing": lined(""),
    "lining of two lines": lined("polyline=[[2, 0], [3.5, 0]], opening='void'"),
    "lining of no opening": lined("opening='viod', stage='later'"),
    "lining far away": lined("polyline=[[2, 0], [3e6, 0]]"),
    "lining of a point": lined("polyline=[[2, 0]]"),
    "lining of a point twice": lined("polyline=[[2, 0], [2, 0], [3, 0]]"),
    "lining closed along an open line": lined("polyline=[[2, 0], [3.5, 0]], closed=true"),
    "lining part of no opening": lined("polyline=[[2, 0], [3.5, 0]], part=[[2, 0], [3, 0]]"),
    "lining part that is none": lined("opening='void', stage='later', part=[[1, 1], [1, 1]]"),
    "lining beside an opening": lined("opening='void', stage='later', side='left'"),
    "lining of a ring with ends": lined("opening='void', stage='later', start='clamped'"),
    "lining joins none": lined("polyline=[[2, 0], [3.5, 0]], joins='crown'"),
    "lining joins itself": lined("polyline=[[2, 0], [3.5, 0]], joins='plate'"),
    "lining joins by nothing": lined("polyline=[[2, 0], [3.5, 0]], connection='hinged'"),
    "lining that is closed joins": lined("opening='void', stage='later', joins='crown'"),
    "lining without compression": lined("polyline=[[2, 0], [3.5, 0]], tension=1e6"),
    "lining stronger in tension": lined(
        "polyline=[[2, 0], [3.5, 0]], tension=3e7, compression=2e7"
    ),
    "lining in MPa": lined("polyline=[[2, 0], [3.5, 0]], tension=0, compression=30"),
    "lining of negative strength": lined(
        "polyline=[[2, 0], [3.5, 0]], tension=-1e6, compression=2e7"
    ),
    "lining of no stage": lined("polyline=[[2, 0], [3.5, 0]], stage='late'"),
    "lining of no joint": lined("polyline=[[2, 0], [3.5, 0]], joint='bnd'"),
    "lining in rock": lined("polyline=[[2, -0.5], [3.5, -0.5]]"),
    "lining before its excavation": lined("opening='void', stage='first'"),
    "lining round a sharp corner": lined("polyline=[[2, 0], [3, 0], [3, 0.02], [2, 0.02]]"),
    "lining thicker than its segments": lined("polyline=[[2, 0], [3.5, 0]]", 0.5),
    "lining thinner than nothing": lined("polyline=[[2, 0], [3.5, 0]]", -0.1),
    "moment on no block": ["moment.1.block=wal"],
    "moment by no table": ["moment.1.amplitude=rmap"],
    "reaction of nothing": ["measured_reaction.1={name='hinge'}"],
    "reaction of a free block": ["measured_reaction.2.block=base"],
    "reaction of no block": ["measured_reaction.2.block=bas"],
    "reaction at no fixed point": ["measured_reaction.1.fixed_point=[9, 9]"],
    "reactions of a name": ["measured_reaction.2.name=hinge"],
    "water in t/m3": ["water.1.density=1.0"],
    "water by table": ["water.2.amplitude=rampe"],
    "drain far away": ["water.1.drained_at=[[3.0, -0.5]]"],
    "two waters of a name": ["water.2.name=lake"],
    "water without gravity": ["gravity=[0, 0]"],
    "water on joints of faces": ['water.1.acts_on="faces"'],
    "water that falls upright": ["water.2.line=[[0, 1], [1, 1], [1, 0]]"],
    "water of one point": ["water.2.line=[[0, 1]]"],
    "water line below": ["water.2.line=[[0, -2], [4, -9]]"],
    "water in kN/m3": ["water.1.density=9.81"],
    "water that is a gas": ["water.1.density=50"],
    "water of negative density": ["water.1.density=-1000"],
    "water in no joint": ["water.1.joints=['defalt']"],
    "water in joints that are none": ["water.1.joints=[]"],
    "water beyond its full head": [
        "amplitude.wild={time=[0, 1], value=[0, 2]}",
        "water.2.amplitude=wild",
    ],
    "water of a share above one": ["water.1.amplitude=1.5"],
    "water aslant": ["gravity=[1, -9]"],
    "water that wets nothing": ["water.1={level=-0.5, acts_on='joints'}"],
    "water of no file": ["water.2.line={file='none.csv'}"],
    "bolt outside": ["bolt.1.end=[9, 9]"],
    "bolt in a block": ["bolt.1.end=[0.5, 1.5]"],
    "bolt of no length": ["bolt.1.end=[0.5, 1.0]"],
    "bolt of no kind": ["bolt.1.kind=bare"],
    "bolt of no block": ['bolt.1.blocks=["wall", "bas"]'],
    "bolt at ends with a free length": ["bolt.1.free_length=0.1"],
    "bolt grouted with blocks": ['bolt.2.blocks=["wall", "base"]'],
    "bolt of no stage": ["bolt.1.stage=late"],
    "bolts of a name": ["bolt.2.name=first"],
    "bolt beyond all": ["bolt.2.end=[0.7, -3]"],
    "bolt that begins outside": ["bolt.2.start=[-2, 0.5]", "bolt.2.end=[0.5, 0.5]"],
    "bolt within a block": ["bolt.2.end=[0.7, 0.5]"],
    "bolt along a joint": ["bolt.2.start=[0.1, 0]", "bolt.2.end=[0.9, 0]"],
    "bolt where blocks touch": ["bolt.1={start=[0.5, 0], end=[0.5, 1], kind='bar'}"],
    "bolt without a free length": [
        "bolt.2={start=[0.7, 1], end=[0.7, -0.5], kind='bar', anchorage='grouted'}"
    ],
    "kind torn by its jack": ["bolt_kind.bar={stiffness=1e7, pretension=1e5, rupture_strain=1e-3}"],
    "kind twice stiff": ["bolt_kind.bar.young=2e11"],
    "kind not stiff": ["bolt_kind.bar={yield_force=1e5}"],
    "kind half stiff": ["bolt_kind.bar={young=2e11, area=1e-4}"],
    "kind over yield": ["bolt_kind.bar.pretension=2e5"],
    "kind ruptures twice": ["bolt_kind.bar.rupture_strain=0.1"],
    "kind breaks early": ["bolt_kind.bar.rupture_elongation=1e-3"],
    "jack of nothing": ["bolt_kind.bar.pretension=0"],
    "pattern longer than the rock": [f"bolt_pattern=[{{{RING}, kind='bar', length=9}}]"],
    "pattern that turns back": [
        f"bolt_pattern=[{{{RING}, kind='bar', length=0.6, from=170, to=160}}]"
    ],
    "pattern of no stage": [f"bolt_pattern=[{{{RING}, kind='bar', length=0.6, stage='late'}}]"],
    "pattern of no kind": [f"bolt_pattern=[{{{RING}, kind='bare', length=0.6, from=60, to=120}}]"],
    "pattern of no opening": ["bolt_pattern=[{opening='x', kind='bar', length=1, spacing=1}]"],
    "pattern of blocks": ["bolt_pattern=[{opening='void', kind='bar', length=1, spacing=1}]"],
    "pattern round a bay": [
        "bolt_pattern=[{opening=[[0,0],[6,0],[6,6],[5,6],[5,1],[1,1],[1,6],[0,6]], kind='bar', "
        "length=1, spacing=1, from=80, to=100}]"
    ],
    "dashpots at no edge": ["viscous_boundary.2.where={edges=[[[9, 9], [8, 9]]]}"],
    "dashpots within": ["viscous_boundary.2.where={edges=[[[0, 0], [1, 0]]]}"],
    "dashpots nowhere": ["viscous_boundary.2.where={}"],
    "dashpots by two": ["viscous_boundary.2.where={side='left', polygon=[[0,0],[1,0],[1,1]]}"],
    "dashpots on no side": ["viscous_boundary.2.where={side='up'}"],
    "dashpots in no polygon": ["viscous_boundary.2.where={polygon=[[7,7],[8,7],[8,8]]}"],
    "dashpots in a bow": ["viscous_boundary.2.where={polygon=[[0,0],[1,1],[1,0],[0,1]]}"],
    "dashpots twice": ["viscous_boundary.2.where={side='bottom'}"],
    "dashpots of nothing": ["viscous_boundary.1.normal=0", "viscous_boundary.1.tangential=0"],
    "dashpots begin twice": ["viscous_boundary.2.begins=0.001"],
    "dashpots on a fixed block": ["block.1.fixed=true"],
    "overburden and stress": ["in_situ.vertical=overburden"],
    "overburden without k0": ["in_situ={vertical='overburden'}"],
    "overburden with gradient": ["in_situ={vertical='overburden', k0=1, gradient=[1,1,0]}"],
    "overburden too low": ["in_situ={vertical='overburden', k0=1, datum=-9}"],
    "pressure at no edge": ["pressure.1.start=[-0.1, 0]", "pressure.1.end=[-0.1, 2]"],
    "pressure of no length": ["pressure.1.end=[0, 0]"],
    "pressure of three": ["pressure.1.value=[1, 2, 3]"],
    "pressure of infinity": ["pressure.1.value=[1, inf]"],
    "pressure between two blocks": ["pressure.1={start=[0, 0], end=[1, 0], value=1}"],
    "pressure on another block": ["pressure.1.block=base"],
    "pressure on no block": ["pressure.1.block=wal"],
    "pressure by no table": ["pressure.1.amplitude=rmap"],
    "load in the air": ["point_load.1.at=[9, 9]"],
    "load on no block": ["point_load.1.block=wal"],
    "load by no table": ["point_load.1.amplitude=rmap"],
    "load in another block": ["point_load.1.block=base"],
    "line of no length": ["line_load.1.end=[0, 2]"],
    "line out of the block": ["line_load.1.end=[5, 5]"],
    "held in the air": ["fixed_point.1.at=[9, 9]"],
    "measured in the air": ["measured_point.1.at=[9, 9]"],
    "measured of no block": ["measured_point.1.block=wal"],
    "measured by a path": ["measured_point.1.name='a/b'"],
    "convergence of one point": ["measured_convergence.1.of=['A']"],
    "convergence of no points": ["measured_convergence.1.of=['a', 'b']"],
    "convergence of a point with itself": ["measured_convergence.1.of=['A', 'A']"],
    "contact nowhere": ["measured_contact.1={name='C'}"],
    "contact at both": ["measured_contact.1.joint=default"],
    "contact of no joint": ["measured_contact.2.joint=defualt"],
    "contact named twice": ["measured_contact.2.name=C"],
    "contact without a name": ["measured_contact.1.name=' '"],
    "contact at infinity": ["measured_contact.1.at=[0, inf]"],
    "contact on a line": ["measured_contact.1.at=[0]"],
    "contact with a block": ["measured_contact.1.block=wall"],
    "measured by a dot": ["measured_point.1.name='.'", "reference.1.point='.'"],
    "table falls": ["amplitude.ramp.time=[1, 0]"],
    "table of one": ["amplitude.ramp={time=[0], value=[1]}"],
    "table uneven": ["amplitude.ramp.value=[1]"],
    "joint in radians": ["joint.default.friction_angle=0.5"],
    "joint of more left": ["joint.default.residual_cohesion=9"],
    "joint kinetic above static": ["joint.default.kinetic_friction_angle=40"],
    "joint kinetic in radians": ["joint.default.kinetic_friction_angle=0.5"],
    "joint critical of nothing": ["joint.default.critical_speed=0.001"],
    "joint dilates too much": ["joint.default.dilation_angle=31"],
    "joint dilates at right angles": ["joint.default.dilation_angle=90"],
    "joint dilates in radians": ["joint.default.dilation_angle=0.2"],
    "joint dilates more than it slides": [
        "joint.default.dilation_angle=15",
        "joint.default.kinetic_friction_angle=10",
    ],
    "joint dilates until nothing": ["joint.default.dilation_until=0.01"],
    "joint rough by Coulomb": ["joint.default.jrc=10"],
    "joint rough with friction": ["joint.default.law='barton-bandis'"],
    "joint of no law": ["joint.default.law='barton'"],
    **{
        f"joint rough: {name}": [f"joint.default={{{ROUGH}{keys}}}"]
        for name, keys in {
            "beyond 20": "jrc=21, jcs=1e8, residual_friction_angle=28",
            "no jcs": "jrc=10, residual_friction_angle=28",
            "no residual": "jrc=10, jcs=1e8",
            "MPa": "jrc=10, jcs=100, residual_friction_angle=28",
            "mm": "jrc=10, jcs=1e8, residual_friction_angle=28, initial_aperture=0.2",
            "sample in mm": "jrc=10, jcs=1e8, residual_friction_angle=28, sample_length=100",
            "field below sample": "jrc=10, jcs=1e8, residual_friction_angle=28, field_length=0.01",
            "steep": "jrc=10, jcs=1e8, residual_friction_angle=75",
            "radians": "jrc=10, jcs=1e8, residual_friction_angle=0.5",
            "cohesion": "jrc=10, jcs=1e8, residual_friction_angle=28, cohesion=1e5",
            "dilation": "jrc=10, jcs=1e8, residual_friction_angle=28, dilation_angle=5",
            "soft": "jrc=2, jcs=1e6, residual_friction_angle=28, initial_aperture=1e-3",
            "tight": "jrc=10, jcs=1e8, residual_friction_angle=28, initial_aperture=1e-6",
        }.items()
    },
    "stage of a rough joint": [
        f"joint.default={{{ROUGH}jrc=10, jcs=1e8, residual_friction_angle=28}}",
        "stage.2.time=0.005",
    ],
    "stage reduces Coulomb": [
        "stage.2.joint={default={strength_reduction=1.5}}",
        "stage.2.time=0.005",
    ],
    "stage dilates too much": ["stage.2.joint={default={dilation_angle=35}}", "stage.2.time=0.005"],
    "joint of no block": ["joint.default.between=[['base', 'wal']]"],
    "joint of one block": ["joint.default.between=[['wall', 'wall']]"],
    "joint of no rock": ["joint.default.between_rocks=[['stone', 'ston']]"],
    "joint of nothing": ["joint.other={friction_angle=20}"],
    "rock too soft for strain": ["rock.stone.poisson=0.5"],
    "rock by no name": ["block.1.rock=ston"],
    "edge of no joint": ["block.2.edge_joint=['defalt', '', '', '']"],
    "edges too few": ["block.2.edge_joint=['default']"],
    "fixed and moving": ["block.2.velocity=[1,0,0]", "block.2.fixed=true"],
    "blocks of a name": ["block.2.name=base"],
    "opening of no block": ["opening.1.blocks=['wal']"],
    "opening by a block's name": ["opening.1.name=wall"],
    "opening of blocks with a shape": ["opening.1.shape=box"],
    "opening of blocks that is void": ["opening.1.excavated=true"],
    "opening of no weld": ["opening.1.weld=seem"],
    "opening of a shape with a weld": [
        "opening.1={name='void', shape='box', corner=[0, 0], size=[1, 1], weld='default'}"
    ],
    "opening without a domain": [
        "opening.1={name='void', shape='box', corner=[0, 0], size=[1, 1]}"
    ],
    **{
        f"block that {name}": [f"block.1.vertices={vertices}"]
        for name, vertices in {
            "has two corners": [[0, 0], [1, 0]],
            "crosses itself": [[0, 0], [1, 1], [1, 0], [0, 1]],
            "touches itself": [[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]],
            "has no area": [[0, 0], [1, 0], [2, 0]],
            "has a corner twice": [[0, 0], [1, 0], [1, 0], [0, 1]],
            "comes back": [[0, 0], [1, 0], [0, 1], [0, 0]],
            "has three coordinates": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        }.items()
    },
    "held where blocks touch": ["fixed_point.1={at=[0.5, 0]}"],
    "held in another block": ["fixed_point.1={at=[0.5, 1], block='base'}"],
    "gravity by no table": ["gravity_amplitude=rmap"],
    "motion falls": ["ground_motion.time=[1, 0]"],
    "motion uneven": ["ground_motion.time=[0, 1, 2]"],
    "motion of no file": ["ground_motion={acts='base', file='none.csv'}"],
    "base of nothing": ["ground_motion.acts=base", "fixed_point=[]"],
    "reference of no point": ["reference.1.point=B"],
    "stage of no opening": ["stage.2.excavate=['vod']"],
    "stage of no bolt": ["stage.2.install=['bars']"],
    "stage of no load": ["stage.2.loads=['pull']"],
    "stages of a name": ["stage.2.name=first"],
    "stage relaxes too long": [
        "bolt=[]",
        "stage.2.install=[]",
        "stage.2.relax_time=9",
        "stage.2.until=equilibrium",
        "stage.2.time=5",
    ],
    "stage damped the wrong way": ["stage.1.damping={name='adaptive', ratio=-1}"],
    "stage damped by another's number": ["stage.1.damping={name='kinetic', ratio=1}"],
    "stage loads twice": ["stage.2.time=0.005", "stage.2.loads=['push', 'push']"],
    "stages load twice": ["stage.2.time=0.005", "stage.1.loads=['push']"],
    "stages excavate twice": ["stage.2.time=0.005", "stage.1.excavate=['void']"],
    "stages without the motion": [
        "bolt=[]",
        "stage.2.install=[]",
        "stage.2.time=0.005",
        "stage.2.ground_motion=false",
    ],
    "load called as a table": [
        "bolt=[]",
        "stage.2.install=[]",
        "stage.2.time=0.005",
        "point_load.1.name=ramp",
        "stage.2.loads=['ramp']",
    ],
    "stage of no joint": ["stage.2.joint={defalt={cohesion=1}}"],
    "stage of joint of nothing": ["stage.2.joint={default={}}"],
    "step over end": ["time.step=1"],
    "smallest over step": ["time.smallest_step=1"],
}


def changed(content: dict[str, Any], path: list[Any], value: Any) -> dict[str, Any]:
    """Return the content with another value at a path."""
    if not path:
        return value
    inner = content[path[0]]
    copy: Any = list(content) if isinstance(content, list) else dict(content)
    copy[path[0]] = changed(inner, path[1:], value)
    return copy


def keys_in(content: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Give the paths to all keys below the top of a case, each key of a kind of table once."""
    if isinstance(content, dict):
        for key, value in content.items():
            inner = (*path, key)
            if isinstance(value, dict) or is_tables(value):
                yield from keys_in(value, inner)
            else:
                yield inner
    elif isinstance(content, list):
        for number, value in enumerate(content):
            yield from keys_in(value, (*path, number))


def made_of(content: dict[str, Any]) -> None:
    clast.Case.validated(content, "x").model()


def broken(settings: list[str]) -> None:
    case = clast.Case.from_text(BASE, "x", settings)
    case.schedule()
    case.examine()


def places_of(attempt: Callable[[], object]) -> Iterator[tuple[Any, ...]]:
    try:
        attempt()
    except CaseError as error:
        yield from (fault.place for fault in error.faults)
