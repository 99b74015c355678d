"""In-situ stress: nothing moves that is in balance, whatever the cut, the process and the law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clast
from clast.actions.in_situ import loaded_parts
from clast.block import polygon
from clast.contact.candidates import SearchDistance
from clast.contact.detection import detect
from clast.errors import ModelError
from clast.model.edges import outline_edges
from clast.rockmass import Circle, Domain, Exponential, JointSet, Opening, cut
from scenes.systems import box, turned
from scenes.tiers import pairwise

UNIFORM = clast.InSituStress(stress=(-5e6, -10e6, 2e6))
WEIGHT = clast.Overburden(k0=0.5)
WIDTH, HEIGHT = 30.0, 20.0
SIZE = float(np.hypot(WIDTH, HEIGHT))


def rock_mass(
    seed: int,
    stress,
    gravity: float = 0.0,
    young: float = 50e9,
    tension: float = 1e8,
    cohesion: float = 1e8,
    friction: float = 60.0,
    **more,
) -> clast.ModelBuilder:
    """Return a box of rock cut by two sets of joints, one of them at random."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, 180.0)
    sets = [
        JointSet(name="a", angle=angle, spacing=rng.uniform(2.0, 4.0)),
        JointSet(name="b", angle=angle + rng.uniform(30.0, 150.0), spacing=Exponential(mean=3.0)),
    ]
    boundary = np.array([[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]])
    found = cut(Domain(boundary=boundary), sets=sets, seed=seed, **more)
    builder = clast.ModelBuilder(gravity=(0.0, -gravity))
    builder.add_rock("rock", young=young, poisson=0.25, density=2700.0)
    builder.add_joint(
        "default", friction_angle=friction, cohesion=cohesion, tensile_strength=tension
    )
    builder.blocks(vertices=found.vertices, start=found.block_start)
    builder.in_situ = stress
    return builder


def moved(run: clast.Run) -> float:
    """Return the largest displacement of a vertex, as a share of the size of the system."""
    return float(np.abs(run.state.vertices - run.model.vertices).max()) / SIZE


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
def test_water_and_bolts_that_are_there_are_in_balance(process):
    """All that acts at the start counts: contacts bear the effective stress and the bolts' pull."""
    runs = {}
    for share in (0.0, 1.0):
        builder = rock_mass(1, clast.Overburden(k0=0.6, datum=150.0), gravity=9.8)
        if share:
            builder.add_bolt_kind("bar", stiffness=2e8, yield_force=1e6, pretension=2e5)
            for x in (5.0, 12.0, 19.0):
                builder.bolt((x, 4.0), (x + 4.0, 15.0), kind="bar")
            builder.bolt((4.0, 9.0), (24.0, 10.0), kind="bar", pretension_is="jacked")
            builder.water(30.0, acts_on="joints", name="groundwater")
        case = builder.case(step=1e-3, end=0.1, process=process)
        runs[share] = case.run(progress=False)
        assert moved(runs[share]) < 1e-6
    bolted = runs[1.0]
    assert bolted.bolts(-1).force == pytest.approx(2e5, rel=1e-6)
    assert bolted.report.ledger.unaccounted == pytest.approx(0.0, abs=1e-6)
    memory = [run.state.memory.normal_force.sum() for run in runs.values()]
    assert memory[1] < 0.99 * memory[0]


def test_contacts_bear_the_traction_of_the_stress():
    """Two blocks, one joint at 30 degrees: N and T are those of the stress on its length."""
    angle = np.radians(30.0)
    square = box(-1.0, -1.0, 2.0, 2.0)
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.add_joint("default", friction_angle=60.0)
    low, high = square.copy(), square.copy()
    low[2:, 1], high[:2, 1] = 0.0, 0.0
    builder.blocks(vertices=[turned(low, angle), turned(high, angle)])
    xx, yy, xy = UNIFORM.stress
    builder.in_situ = replace(UNIFORM, held=(0.0, 0.0))
    run = builder.case(step=1e-3, end=1e-3).run(progress=False)
    nx, ny = -np.sin(angle), np.cos(angle)
    normal = -(xx * nx**2 + 2.0 * xy * nx * ny + yy * ny**2)
    shear = (yy - xx) * nx * ny + xy * (nx**2 - ny**2)
    memory = run.state.memory
    assert memory.normal_force.sum() == pytest.approx(2.0 * normal, rel=1e-12)
    assert np.abs(memory.shear_force).sum() == pytest.approx(2.0 * abs(shear), rel=1e-12)


def test_forces_of_the_start_are_gone_once_a_contact_has_opened():
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.blocks(vertices=[box(0, 0)], fixed=True)
    builder.block(name="above", vertices=box(0, 1), velocity=(0.0, 3.0, 0.0))
    builder.in_situ = clast.InSituStress(stress=(0.0, -1e4, 0.0), held=(0.0, 0.0))
    run = builder.case(step=1e-3, end=0.05).run(progress=False)
    assert run.state.vertices[-1, 1] > run.model.vertices[-1, 1] + 0.1
    assert (run.state.memory.rest_force == 0.0).all()


def test_stress_goes_round_an_opening_that_is_there_from_the_start():
    """In equilibrium nothing moves; without forces in the contacts the rock first closes them."""
    circle = Opening(name="heading", shape=Circle(center=(15.0, 10.0), radius=3.0), excavated=True)
    found = {}
    for share in (1.0, 0.0):
        builder = rock_mass(3, replace(UNIFORM, in_contacts=share), openings=[circle])
        run = builder.case(step=1e-3, end=0.05, dynamic_ratio=0.0).run(progress=False)
        middle = np.array([run.model.polygon(b).mean(axis=0) for b in range(run.model.block_count)])
        beside = np.abs(middle - (15.0, 10.0)) @ [1.0, 3.0] < 5.0
        found[share] = moved(run), run.state.stress[beside, 1].min(), run.model
    assert found[1.0][0] < 1e-6
    assert found[0.0][0] > 10.0 * found[1.0][0]
    # Kirsch has 25 MPa at the wall, mean over blocks less
    assert -30e6 < found[1.0][1] < -12e6


@pytest.mark.parametrize("contacts", ["in-equilibrium", "none"])
@pytest.mark.parametrize("boundary", ["roller", "fixed", "traction"])
def test_a_case_file_says_the_same(tmp_path, boundary, contacts):
    builder = rock_mass(1, UNIFORM)
    path = tmp_path / "case.toml"
    held = {"roller": (1.0, 0.0), "fixed": (1.0, 1.0), "traction": (0.0, 0.0)}[boundary]
    share = {"in-equilibrium": 1.0, "none": 0.0}[contacts]
    builder.in_situ = replace(UNIFORM, held=held, in_contacts=share, sides=("left", "right"))
    path.write_text(builder.case(step=1e-3, end=1e-3).to_toml())
    assert f'boundary = "{boundary}"' in path.read_text()
    assert clast.load(path).model().in_situ == builder.in_situ


def test_the_overburden_goes_by_the_mean_density_and_the_top(tmp_path):
    builder = rock_mass(1, WEIGHT, gravity=9.8)
    path = tmp_path / "case.toml"
    path.write_text(builder.case(step=1e-3, end=1e-3).to_toml())
    stress = clast.load(path).model().in_situ
    assert stress.datum == pytest.approx(HEIGHT)
    assert stress.gradient == pytest.approx((-0.5 * 2700.0 * 9.8, -2700.0 * 9.8, 0.0))
    assert stress.at(np.array([HEIGHT - 2.0]))[0] == pytest.approx(2.0 * np.array(stress.gradient))


def test_overburden_needs_gravity_downwards():
    with pytest.raises(ModelError, match="not downwards"):
        rock_mass(1, WEIGHT).build()


def test_the_outline_is_the_hull_or_the_sides_named():
    slope = np.array([[0, 0], [60, 0], [60, 20], [40, 20], [20, 50], [0, 50]], float)
    start = np.array([0, 6])
    assert outline_edges(slope, start).tolist() == [[0, 1], [1, 2], [4, 5], [5, 0]]
    assert outline_edges(slope, start, ("left", "bottom")).tolist() == [[0, 1], [5, 0]]
    round_ = 5.0 * np.stack(
        [np.cos(np.arange(12) / 6 * np.pi), np.sin(np.arange(12) / 6 * np.pi)], 1
    )
    assert len(outline_edges(round_, np.array([0, 12]))) == 12


# what is there from the start ---------------------------------------------------------------------


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
@pytest.mark.parametrize(("young", "depth"), [(50e9, 1e5), (20e9, 40e6), (2e9, 40e6), (1e8, 1e6)])
def test_an_opening_begins_in_its_static_solution_at_any_depth(young, depth, process):
    circle = Opening(name="heading", shape=Circle(center=(15.0, 10.0), radius=3.0), excavated=True)
    stress = clast.InSituStress(stress=(-depth, -0.75 * depth, 0.0))
    builder = rock_mass(3, stress, young=young, openings=[circle])
    run = builder.case(step=1e-3, end=0.05, process=process).run(progress=False)
    assert moved(run) < 1e-9
    assert not [note for note in run.report.notes if "begins to move" in note]


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
@pytest.mark.parametrize(("seed", "cohesion"), [(3, 1e8), (3, 1e6), (2, 1e6)])
def test_joints_with_cohesion_alone_begin_in_their_static_solution(seed, cohesion, process):
    """A point that is not pressed has no cohesion, at the start as in a step."""
    circle = Opening(name="heading", shape=Circle(center=(15.0, 10.0), radius=3.0), excavated=True)
    stress = clast.InSituStress(stress=(-40e6, -30e6, 0.0))
    more = {"young": 20e9, "tension": 0.0, "cohesion": cohesion, "friction": 40.0}
    builder = rock_mass(seed, stress, openings=[circle], **more)
    run = builder.case(step=1e-3, end=0.05, process=process).run(progress=False)
    assert moved(run) < 1e-9


SLOPE = """
schema = 1
plane = "stress"
gravity = [0.0, -9.81]
time = {step = %(step)s, end = %(end)s, dynamic_ratio = 0.0}
[rock.r]
young = %(young)s
poisson = 0.28
density = 2800.0
[joint.default]
friction_angle = %(friction)s
cohesion = %(cohesion)s
tensile_strength = %(tension)s
[domain]
boundary = [[0, 0], [27.77030959449861, 0], [27.77030959449861, 7.89311701336847],
    [16.662185756699166, 7.89311701336847], [9.719608358074513, 22.551762895338488],
    [0, 22.551762895338488]]
seed = %(seed)s
fixed_sides = ["bottom"]
[[joint_set]]
name = "s0"
model = "voronoi"
spacing = %(spacing)s
[in_situ]
vertical = "overburden"
k0 = %(k0)s
boundary = "%(boundary)s"
"""
ENDS = {
    "step": 5e-3,
    "end": 0.5,
    "young": 3.57e8,
    "friction": 48.1,
    "cohesion": 0.0,
    "tension": 0.0,
    "seed": 839,
    "spacing": 4.944482055921632,
    "k0": 1.25569510173728,
    "boundary": "fixed",
}
"""A vertex passed to the next edge of a blunt corner here, and took 1.71 MN/m along."""


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
def test_a_slope_rests_whatever_edge_a_vertex_is_on(process: str):
    case = clast.Case.from_toml(f'{SLOPE % ENDS}\n[method]\nprocess = "{process}"\n')
    assert moved(case.run(progress=False)) * SIZE < 1e-7


@pytest.mark.parametrize("seed", range(4))
def test_soft_slopes_of_small_blocks_with_openings_are_not_refused(seed: int):
    """That a block would move by 1 % of the smallest one says nothing about balance."""
    soft = {"young": 1.6e9, "friction": 33.4, "cohesion": 6.8e5, "tension": 2e5, "seed": seed}
    more = {"spacing": 2.5, "k0": 0.433, "boundary": "roller", "end": 0.05}
    boxes = "".join(
        f'[[opening]]\nname = "o{k}"\nshape = "box"\nexcavated = true\n'
        f"corner = [{x}, 2.0]\nsize = [2.6, 2.6]\n"
        for k, x in enumerate((4.3, 9.4))
    )
    run = clast.Case.from_toml(SLOPE % {**ENDS, **soft, **more} + boxes).run(progress=False)
    assert moved(run) * SIZE < 1e-7


def test_what_nothing_holds_is_named_and_falls():
    """A wedge in the roof of an opening, without friction: its own weight is left."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.add_joint("default", friction_angle=5.0)
    builder.blocks(vertices=[[(0, 2), (3, 2), (2, 4), (0, 4)]], fixed=True)
    builder.blocks(vertices=[[(5, 2), (8, 2), (8, 4), (6, 4)]], fixed=True)
    builder.block(name="cap", vertices=[(2, 4), (6, 4), (6, 5), (2, 5)])
    builder.block(name="wedge", vertices=[(3, 2), (5, 2), (6, 4), (2, 4)])
    builder.in_situ = clast.InSituStress(stress=(0.0, 0.0, 0.0), held=(0.0, 0.0))
    run = builder.case(step=1e-3, end=0.02).run(progress=False)
    assert moved(run) * SIZE < 1e-7  # the wedge is wider above: it sits
    builder.blocks(vertices=[[(9, 0), (12, 0), (12, 4), (9, 4)]], fixed=True)
    builder.block(name="roof", vertices=[(8.5, 2.5), (9, 2.5), (9, 3.5), (8.5, 3.5)])
    run = builder.case(step=1e-3, end=0.02).run(progress=False)
    (note,) = [note for note in run.report.notes if "begins to move" in note]
    assert "'roof'" in note
    assert "'wedge'" not in note
    fall = (run.state.vertices - run.model.vertices)[-4:, 1]
    # beside the wall, which holds it for the first step where it touches
    assert fall.mean() == pytest.approx(-0.5 * 9.8 * 0.02**2, rel=1e-3)


def test_a_remedy_names_nothing_that_the_case_has():
    stress = clast.InSituStress(stress=(-1e6, 0.0, 0.0), held=(0.0, 0.0))
    remedies = []
    for held, gradient in (((0.0, 0.0), 0.0), ((0.0, 0.0), -2700.0 * 9.8)):
        builder = rock_mass(1, replace(stress, held=held, gradient=(0.0, 0.5 * gradient, 0.0)), 9.8)
        with pytest.raises(ModelError, match="not in balance") as refused:
            builder.case(step=1e-3, end=1e-2).run(progress=False)
        remedies.append(refused.value.remedy)
    assert "overburden" in remedies[0]
    assert "overburden" not in remedies[1]
    assert all("roller" in text for text in remedies)


def test_bonds_bear_tension_from_the_start():
    """A block hangs from a roof by its bond: two contacts, half of the weight each."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.add_joint("default", friction_angle=30.0, cohesion=1e6, tensile_strength=1e6)
    builder.blocks(vertices=[box(0, 1)], fixed=True)
    builder.block(name="hangs", vertices=box(0, 0))
    builder.in_situ = clast.InSituStress(stress=(0.0, 0.0, 0.0), held=(0.0, 0.0))
    for process in ("convex", "open-close", "modified"):
        run = builder.case(step=1e-3, end=0.1, process=process).run(progress=False)
        assert moved(run) * SIZE < 1e-12
        assert run.state.memory.normal_force.sum() == pytest.approx(-2700.0 * 9.8, rel=1e-9)


# rest forces and corners --------------------------------------------------------------------------


@pytest.mark.parametrize("bend", [1.0, 2.5])
def test_a_rest_force_keeps_its_direction_on_the_next_edge(bend: float):
    """The same force stands otherwise on an edge that is bent: the face has not turned."""
    fall = np.tan(np.radians(bend))
    base = [(0, 0), (4, 0), (4, 2 - 2 * fall), (2, 2), (0, 2)]
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.add_joint("default", friction_angle=40.0)
    builder.blocks(vertices=[base], fixed=True)
    builder.block(name="above", vertices=[(0, 2), (2, 2), (2, 3), (0, 3)])
    builder.in_situ = clast.InSituStress(stress=(0.0, -1e6, 0.0), held=(1.0, 0.0))
    case = builder.case(step=1e-3, end=1e-3)
    run = case.run(progress=False)
    found = []
    for shift in (-1e-6, 1e-6):
        vertices = run.state.vertices.copy()
        vertices[5:, 0] += shift
        state = replace(run.state, vertices=vertices)
        centroid = polygon.moments(vertices, run.model.block_start)[1]
        reach = SearchDistance(front=1e-3, depth=1e-3, critdis=1e-3)
        contacts = detect(run.model, case.method(run.model).corner_rule, state, centroid, reach)
        at = contacts.vertex == 6
        normal = contacts.normal[at]
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        rest = contacts.rest_force[at, None] * normal + contacts.shear_force[at, None] * along
        found.append((contacts.edge[at].tolist(), rest.sum(axis=0)))
    assert found[0][0] != found[1][0]
    np.testing.assert_allclose(found[1][1], found[0][1], atol=1e-9 * 1e6)


# outlines that are not convex ---------------------------------------------------------------------

NOTCHED = {
    "one block": [[(0, 0), (4, 0), (4, 2), (2, 2), (2, 5), (0, 5)]],
    "a deep notch": [[(0, 0), (6, 0), (6, 5), (4, 5), (4, 2), (2, 2), (2, 5), (0, 5)]],
    "half of an edge": [
        [(0, 0), (4, 0), (4, 2), (0, 2)],
        [(1, 2), (2, 2), (2, 5), (1, 5)],
        [(0, 2), (1, 2), (1, 5), (0, 5)],
    ],
}


@pytest.mark.parametrize(
    ("process", "angle", "shape"),
    pairwise(["convex", "open-close", "modified"], [0.0, 0.4], NOTCHED),
)
def test_notches_of_an_outline_at_depth_are_loaded(shape: str, angle: float, process: str):
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.add_joint("default", friction_angle=60.0)
    builder.blocks(vertices=[turned(np.array(one, float), angle) for one in NOTCHED[shape]])
    builder.in_situ = replace(UNIFORM, held=(0.0, 0.0))
    run = builder.case(step=1e-3, end=0.1, process=process).run(progress=False)
    assert moved(run) < 1e-12
    assert np.abs(run.state.stress - run.model.initial_stress).max() < 1e-9 * 10e6


def test_faces_of_slopes_and_of_openings_at_the_outline_are_free():
    slope = np.array([[0, 0], [60, 0], [60, 20], [40, 20], [20, 50], [0, 50]], float)
    builder = clast.ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=2700.0)
    builder.blocks(vertices=[slope])
    builder.in_situ = WEIGHT
    model = builder.build()
    assert sorted(loaded_parts(model, model.in_situ)[0]) == [0, 1, 5]  # nor is the ground surface
    # half of a tunnel, in a model that ends at its plane of symmetry
    half = Opening(name="half", shape=Circle(center=(0.0, 10.0), radius=3.0), excavated=True)
    builder = rock_mass(3, UNIFORM, openings=[half])
    builder.opening_outlines["half"] = half.outline().corners
    model = builder.build()
    edge = loaded_parts(model, model.in_situ)[0]
    middle = 0.5 * (model.vertices[edge] + model.vertices[model.vertex_after[edge]]) + model.origin
    assert np.hypot(*(middle - [0.0, 10.0]).T).min() > 3.0
