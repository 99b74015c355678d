"""Measuring on a page: magnified displacements, axes, lines by hand, stresses of joints, signs."""

import numpy as np
import pytest

import clast
from clast.pictures.joint_values import JOINT_FIELDS
from scenes.browsers import settled


@pytest.fixture
def results(wall):
    return wall(4, 5)


@pytest.fixture
def page(opened, results):
    page = opened(results)
    yield page


def placed(page, expression: str) -> np.ndarray:
    """Return coordinates of a page, x and y by turns, as they are in the case, shape (k, 2)."""
    origin = page.evaluate("clastPage.run.scene.origin")
    return np.reshape(page.evaluate(f"Array.from({expression})"), (-1, 2)) + origin


@pytest.mark.parametrize("factor", [1.0, 50.0, 0.5])
def test_displacements_are_drawn_magnified_and_said_to_be(page, results, factor):
    page.fill("[data-part=factor]", str(factor))
    page.keyboard.press("Enter")
    settled(page)
    start, here = results.vertices(0), results.vertices(5)
    wanted = start + factor * (here - start)
    # a page knows displacements to a 65,535th of their range, which is magnified as well
    error = 1e-5 + factor * 2.0 * np.ptp(here - start) / 65_535.0
    assert placed(page, "clastPage.run.vertices(5)") == pytest.approx(wanted, abs=error)
    said = page.evaluate("clastPage.svg()").count("displacements × ")
    assert said == (0 if factor == 1.0 else 2)  # in the drawing, and in the title below it
    # what is measured stays what it was
    far = page.evaluate("clastPage.run.value('displacement', 5, 17)")
    assert far == pytest.approx(np.hypot(*results.field("displacement", 5)[17]), rel=1e-3)


def test_contacts_go_with_their_blocks(page, results):
    page.fill("[data-part=factor]", "30")
    page.keyboard.press("Enter")
    settled(page)
    contacts = results.contacts(5)
    first = page.evaluate("clastPage.run.contacts.first[5]")
    x, y, vertex, by = (
        np.array(page.evaluate(f"Array.from(clastPage.run.contacts.{name}.slice({first}))"))
        for name in ("x", "y", "vertex", "by")
    )
    start, here = results.vertices(0), results.vertices(5)
    origin = page.evaluate("clastPage.run.scene.origin")
    corner = (np.abs(contacts.position - here[contacts.vertex]).max(axis=1) < 1e-9).nonzero()[0]
    assert len(corner) > 10
    place = {(vertex[k], by[k]): (x[k], y[k]) for k in range(len(vertex))}
    for k in corner:
        at = contacts.vertex[k]
        drawn = np.array(place[at, contacts.edge_block[k]]) + origin
        wanted = start[at] + 30.0 * (here[at] - start[at])
        assert drawn == pytest.approx(wanted, abs=3e-3)


def test_a_factor_to_be_seen_is_round_and_shows_a_twentieth(page, results):
    page.click("[data-part=factor-auto]")
    settled(page)
    factor = page.evaluate("clastPage.run.factor")
    assert factor / 10 ** np.floor(np.log10(factor)) in (1.0, 2.0, 5.0)
    start, here = results.vertices(0), results.vertices(5)
    largest = np.hypot(*results.field("displacement", 5).T).max()
    model = np.ptp(start, axis=0).max()
    assert factor == 1 or 0.02 * model < factor * largest <= 0.05 * model
    assert "magnify=" in page.evaluate("location.hash") or factor == 1
    assert here.shape == start.shape


def test_a_line_by_hand_has_length_dip_and_the_values_along_it(page, results):
    page.click("[data-part=rule]")
    box = page.locator("[data-part=above]").bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.7 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"], steps=4)
    page.mouse.up()
    settled(page)
    x0, y0, x1, y1 = page.evaluate("clastPage.state.line")
    text = page.evaluate("clastPage.svg()")
    dip = np.degrees(np.arctan2(abs(y1 - y0), abs(x1 - x0)))
    assert f"{dip:.1f}°, rising to the right" in text
    along = np.array(page.evaluate("clastPage.charts.curve.along"))
    values = page.evaluate("clastPage.charts.curve.lines[0].values")
    assert along[-1] == pytest.approx(np.hypot(x1 - x0, y1 - y0))
    far = np.hypot(*results.field("displacement", 5).T)
    for share in (0.1, 0.5, 0.83):
        at = round(share * (len(along) - 1))
        part = along[at] / along[-1]
        block = page.evaluate(
            "([x, y]) => clastPage.run.blockAt(5, x, y)",
            [x0 + part * (x1 - x0), y0 + part * (y1 - y0)],
        )
        assert values[at] == (None if block < 0 else pytest.approx(far[block], rel=1e-3, abs=1e-9))
    assert page.evaluate("clastPage.charts.csv()").startswith('"distance (m)"')
    # it does not move the view, and Escape takes it away
    page.keyboard.press("Escape")
    settled(page)
    assert page.evaluate("clastPage.state.line") is None


def test_the_place_under_the_pointer_is_that_of_the_case(page):
    box = page.locator("[data-part=above]").bounding_box()
    page.mouse.move(box["x"] + 120, box["y"] + 90)
    x, y = page.evaluate(
        "[clastPage.view.worldX(120) + clastPage.run.scene.origin[0],"
        " clastPage.view.worldY(90) + clastPage.run.scene.origin[1]]"
    )
    words = page.inner_text("[data-part=place]").replace("−", "-").split()
    assert float(words[1]) == pytest.approx(x, abs=0.02)
    assert float(words[4]) == pytest.approx(y, abs=0.02)


def test_axes_have_the_coordinates_of_the_case(page):
    page.evaluate("clastPage.view.show(0, 0, 20, 20)")
    page.evaluate("clastPage.changed()")
    settled(page)
    origin = page.evaluate("clastPage.run.scene.origin")
    marks = page.evaluate(
        "(() => { const texts = []; const pen = { lines() {}, text(x, y, text, a, b, anchor) {"
        " if (anchor === 'middle') texts.push([clastPage.view.worldX(x), text]); } };"
        " modulesOfPage(pen); return texts; })()".replace(
            "modulesOfPage(pen)",
            "clastPage.state.layers.add('axes'), clastPage.drawLayers({...pen, areas() {},"
            " circle() {}}, null)",
        )
    )
    assert len(marks) >= 3
    for x, text in marks:
        assert float(text.replace("−", "-")) == pytest.approx(x + origin[0], abs=1e-6)


def test_compression_may_count_positive(page, results):
    page.select_option("[data-part=field]", "sigma_1")
    settled(page)
    assert "tension positive" in page.inner_text("[data-part=legend]")
    plain = [
        page.evaluate(f"clastPage.run.value('{name}', 5, 9)") for name in ("sigma_1", "sigma_3")
    ]
    page.check("[data-part=pressed-positive]")
    settled(page)
    assert "compression positive" in page.inner_text("[data-part=legend]")
    turned = [
        page.evaluate(f"clastPage.run.value('{name}', 5, 9)") for name in ("sigma_1", "sigma_3")
    ]
    assert turned == [-plain[1], -plain[0]] and turned[0] >= turned[1]
    assert "compression" in page.evaluate("location.hash")


@pytest.fixture(scope="module")
def stack(tmp_path_factory):
    """Two blocks of 1 m on a floor, the upper one pushed by 3 kN/m, at rest."""
    builder = clast.ModelBuilder(title="Two blocks, pushed", gravity=(0.0, -9.81))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="lower", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="upper", vertices=[(0, 1), (1, 1), (1, 2), (0, 2)])
    builder.point_load((0.0, 1.5), (3e3, 0.0), "upper")
    path = tmp_path_factory.mktemp("stack") / "stack.vtkhdf"
    clast.simulate(builder.build(), end=0.2, step=0.01, dynamic_ratio=0.0, output=path)
    return clast.read_results(path)


def test_stresses_of_joints_are_force_over_length(stack):
    weight = 2000.0 * 9.81
    normal = np.sort(JOINT_FIELDS["normal_stress"].values(stack, -1).value)
    assert normal == pytest.approx([weight, 2.0 * weight], rel=1e-4)
    assert JOINT_FIELDS["shear_stress"].values(stack, -1).value == pytest.approx(3e3, rel=1e-4)
    used = np.sort(JOINT_FIELDS["utilisation"].values(stack, -1).value)
    friction = np.tan(np.radians(30.0))
    assert used == pytest.approx(100.0 * 3e3 / (friction * weight * np.array([2.0, 1.0])), rel=1e-4)


def test_a_page_has_the_stresses_of_joints_and_of_the_one_that_is_clicked(opened, stack):
    page = opened(stack)
    last = page.evaluate("clastPage.state.frame")
    for field in ("normal_stress", "shear_stress", "utilisation"):
        page.select_option("[data-part=field]", field)
        settled(page)
        drawn = page.evaluate(
            f"(() => {{ const all = []; clastPage.run.eachFace('{field}', {last},"
            " (_, value) => all.push(value)); return all; })()"
        )
        wanted = JOINT_FIELDS[field].values(stack, -1).value
        assert np.sort(drawn) == pytest.approx(np.sort(wanted), rel=2e-3)
    x, y = page.evaluate(
        "(() => { const { above, view, run } = clastPage, box = above.getBoundingClientRect();"
        " const [x0, y0] = run.scene.origin; return [box.left + view.screenX(0.8 - x0),"
        " box.top + view.screenY(1 - y0)]; })()"
    )
    page.mouse.click(x, y)
    settled(page)
    said = page.inner_text("[data-part=chosen]")
    assert "Normal stress" in said and "19.6" in said and "kPa" in said
    assert "Share of the strength used" in said and "26.5" in said


def test_what_moves_fills_the_view(page):
    page.click("[data-part=fit]")
    settled(page)
    whole = page.evaluate("clastPage.view.wide")
    page.click("[data-part=fit-moving]")
    settled(page)
    assert page.evaluate("clastPage.view.wide") != whole
