"""Links, reactions, linings and joints of a page, as still pictures have them."""

import numpy as np
import pytest

import clast
from clast.pictures.draw_blocks import areas_of
from clast.pictures.fields import SCALARS, scale_of
from clast.pictures.joint_values import JOINT_FIELDS
from clast.pictures.page.frame_data import moving
from clast.pictures.supports import forces_in, places_of, states_of
from clast.results.frames import absent_in_frame
from scenes.browsers import colour_at, settled


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """Return the run of a bar on a hinge and a tie that breaks, and a beam on two noses."""
    builder = clast.ModelBuilder(title="Held", gravity=(0.0, -10.0))
    builder.add_rock("steel", young=2e11, poisson=0.3, density=7800.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(vertices=[(-1, 1), (3, 1), (3, 1.2), (-1, 1.2)], name="ground", fixed=True)
    builder.block(vertices=[(0, -0.05), (2, -0.05), (2, 0.05), (0, 0.05)], name="bar")
    builder.link(name="hinge", at=(0, 0), block="bar", x="rigid", y="rigid")
    builder.link(name="tie", at=(2, 0), block="bar", y=1e4, rupture=1e-3)
    for name, x in (("left", 5.0), ("right", 7.0)):
        nose = [(x - 0.1, -3.0), (x + 0.1, -3.0), (x + 0.1, 0.0), (x - 0.1, 0.0)]
        builder.block(name=name, vertices=nose, fixed=True)
        builder.measured_reaction(name, block=name)
    builder.block(name="beam", vertices=[(4.9, 0.0), (7.9, 0.0), (7.9, 0.2), (4.9, 0.2)])
    path = tmp_path_factory.mktemp("held") / "held.vtkhdf"
    return clast.simulate(builder.build(), end=0.2, every=0.02, step=2e-3, output=path)


def numbers(page, kind, *names):
    """Return numbers of the last frame of links, reactions or linings, a column for each name."""
    found = page.evaluate(
        "([kind, names]) => names.map((name) => Array.from(clastPage.run[kind][name]))",
        [kind, list(names)],
    )
    frames = page.evaluate("clastPage.run.frameCount")
    return np.array(found, float).reshape(len(names), frames, -1)[:, -1].T


def test_links_and_reactions_stand_where_still_pictures_have_them(opened, held):
    page = opened(held, address="#field=rock&layers=links,reactions")
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    ends = numbers(page, "links", "x0", "y0", "x1", "y1").reshape(-1, 2, 2)
    assert ends + origin == pytest.approx(places_of(held, -1), abs=1e-6)
    assert numbers(page, "links", "state").ravel().tolist() == states_of(held, -1).tolist()
    drawn = numbers(page, "reactions", "x", "y", "fx", "fy")
    for (name, at, force), row in zip(forces_in(held, -1), drawn, strict=True):
        assert row[:2] + origin == pytest.approx(at, abs=1e-5), name
        assert row[2:] == pytest.approx(force, rel=1e-6), name
    said = page.inner_text("[data-part=legend]")
    assert "link, broken" in said and "link\n" in said and "reaction, up to" in said
    page.focus("[data-part=above]")
    page.keyboard.press("Home")
    settled(page)
    assert "broken" not in page.inner_text("[data-part=legend]")
    names = page.evaluate("[...clastPage.$('curve').options].map((one) => one.text)")
    assert "Link tie, force" in names and "Reaction left, force" in names


@pytest.fixture(scope="module")
def lined(tmp_path_factory):
    """Return the run of a ring of shotcrete that two forces press."""
    from clast.verification.problems.supports.lining_ring import lining_ring

    return clast.simulate(
        lining_ring.set_up(),
        end=0.1,
        every=0.05,
        step=0.05,
        dynamic_ratio=0.0,
        output=tmp_path_factory.mktemp("ring") / "ring.vtkhdf",
    )


def test_diagrams_of_linings_have_the_numbers_of_the_file(opened, lined):
    page = opened(lined, address="#field=rock&layers=moments,normal-forces,shear-forces")
    for name in lined.lining_name:
        lining = lined.lining(name)
        drawn = numbers(page, "linings", "normal_force", "shear_force", "moment").T
        for values, column in zip(drawn, ("normal_force", "shear_force", "moment"), strict=True):
            assert values == pytest.approx(getattr(lining, column)[-1], rel=1e-6, abs=1e-6)
    said = page.inner_text("[data-part=legend]")
    assert all(f"{letter} of the lining" in said for letter in "NQM")


@pytest.mark.parametrize("field", ["mobilised", "sliding"])
def test_what_joints_mobilise_is_that_of_still_pictures(opened, parted, field):
    page = opened(parted, address=f"#field={field}&layers=")
    drawn = page.evaluate(
        "(field) => { const found = []; clastPage.run.eachFace(field, clastPage.state.frame,"
        " (ends, value) => found.push([...ends, value])); return found; }",
        field,
    )
    faces = JOINT_FIELDS[field].values(parted, -1)
    origin = page.evaluate("[0, 1, 0, 1].map((k) => clastPage.run.scene.origin[k])")
    wanted = np.column_stack([faces.ends.reshape(-1, 4) - origin, faces.value])
    assert len(drawn) == len(wanted) > 0
    for row in wanted:
        turned = [*row[2:4], *row[:2], row[4]]
        away = [
            min(np.abs(np.subtract(one, row)).max(), np.abs(np.subtract(one, turned)).max())
            for one in drawn
        ]
        assert min(away) < 1e-3 * max(1.0, row[4])
    assert JOINT_FIELDS[field].label in page.inner_text("[data-part=legend]")


def test_live_frames_join_where_a_field_of_joints_comes_or_goes(opened, parted):
    page = opened(parted)
    counts = page.evaluate(
        """() => {
          const { joined } = modules.moving;
          const { moving, blockCount } = clastPage.run;
          const { slip, ...rest } = moving.faces;
          const without = { ...moving, faces: rest };
          const angle = () => moving.motion.angle.slice();
          const copy = () => ({ ...moving, motion: { ...moving.motion, angle: angle() } });
          const gone = joined(copy(), { ...without, motion: copy().motion }, blockCount).faces.slip;
          const come = joined({ ...without, motion: copy().motion }, copy(), blockCount).faces.slip;
          return [gone.count, come.count, gone.value.length, slip.count];
        }"""
    )
    own = counts[3]
    assert counts[0] == own + [0] * len(own) and counts[1] == [0] * len(own) + own
    assert counts[2] == sum(own)


def test_blocks_that_come_in_a_later_stage_are_on_the_page(opened, sprayed):
    """Each block is there as the file has it, in the colours and in the scale, and is told."""
    results = clast.read(sprayed.output)
    page = opened(results, address="#field=sigma_1&layers=excavated,before")
    origin = page.evaluate("clastPage.run.scene.origin")
    for frame in range(len(results.times)):
        absent = absent_in_frame(results, frame)
        there = page.evaluate(
            "(frame) => clastPage.run.scene.blocks.map((_, k) => clastPage.run.isGone(frame, k))",
            frame,
        )
        assert there == absent.tolist()
    segment = int(np.flatnonzero(results.lined)[0])
    own = slice(*results.block_start[segment : segment + 2])
    at = results.vertices(-1)[own].mean(axis=0) - origin
    drawn = colour_at(page, *at)
    page.evaluate("clastPage.goTo(clastPage.run.stages.indexOf('dig'))")
    settled(page)
    assert colour_at(page, *at) == [255, 255, 255] != drawn
    assert "excavated" in page.inner_text("[data-part=legend]")
    page.evaluate(f"clastPage.choose({{ chosen: {segment} }})")
    settled(page)
    assert "comes later" in page.inner_text("[data-part=chosen]")
    page.focus("[data-part=above]")
    page.keyboard.press("End")
    settled(page)
    assert "comes later" not in page.inner_text("[data-part=chosen]")
    values = page.evaluate("clastPage.charts.curve.lines[0].values")
    assert [one is None for one in values] == [one != "line" for one in results.frame_stages]
    most = SCALARS["sigma_1"].values(results, -1)
    free = ~(results.fixed | absent_in_frame(results, -1))
    area = areas_of(results, results.vertices(-1))
    scale = scale_of(most[free], area[free], None)
    ends = page.evaluate("['low', 'high'].map((end) => Number(clastPage.$(end).value))")
    assert ends == pytest.approx([scale.low, scale.high], rel=1e-3)
    without = free & ~results.lined
    assert scale.high > scale_of(most[without], area[without], None).high


@pytest.mark.parametrize("cut", [1, 3, 4, 5, 7])
def test_live_frames_join_where_blocks_go_and_come(opened, sprayed, cut):
    results = clast.read(sprayed.output)
    page = opened(results)
    parts = [
        moving(results, np.array(range(*ends)), 1e6)
        for ends in ((0, cut), (cut, len(results.times)))
    ]
    whole, found = page.evaluate(
        """async (parts) => {
          const { decodeMoving, joined } = modules.moving;
          const { blockStart, blockCount, gone } = clastPage.run;
          const decoded = parts.map((one) => decodeMoving(one, blockStart));
          const [first, second] = await Promise.all(decoded);
          return [gone, joined(first, second, blockCount).gone];
        }""",
        parts,
    )
    assert found == whole and sum(map(len, whole)) == 2 * int(results.lined.sum()) + 1


def test_names_of_two_kinds_do_not_hide_each_other_on_a_page(opened, sprayed):
    """A block, a point, a reaction and a lining are called "crown"."""
    results = clast.read(sprayed.output)
    page = opened(results)
    wanted = {
        "Point crown, displacement": results.history("crown").displacement[-1, 0],
        "Reaction crown, force": results.reaction("crown").force[-1, 0],
        "Lining crown, M": results.lining("crown").moment[-1].max(),
    }
    for name, value in wanted.items():
        page.select_option("[data-part=curve]", label=name)
        settled(page)
        shown = page.evaluate("clastPage.charts.curve.lines[0].values.at(-1)")
        assert shown == pytest.approx(float(f"{value:.6g}"), rel=1e-9, abs=1e-15), name
    number = results.block_name.index("crown")
    page.evaluate(f"clastPage.choose({{ chosen: {number} }})")
    settled(page)
    assert "Block crown" in page.inner_text("[data-part=chosen]")
    assert page.evaluate("clastPage.charts.curve.name") == "Block crown, Displacement"
