"""The page in a browser, drawn on the 2D canvas and by WebGL2: what a person would see and do."""

import dataclasses
import threading
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import clast
from clast.pictures.fields import scale_of
from clast.pictures.joint_values import JOINT_FIELDS, resultants_of, scale_of_faces
from clast.pictures.live.feed import Feed
from clast.pictures.live.server import LiveServer
from clast.pictures.page.document import BUDGET, page_text
from clast.pictures.page.scene import scene_of
from scenes.browsers import colour_at, settled, until


def on_screen(page, place):
    """Return where a place of the world, m about its origin, is in the window, pixels."""
    return page.evaluate(
        "([x, y]) => { const box = clastPage.above.getBoundingClientRect();"
        " return [box.left + clastPage.view.screenX(x), box.top + clastPage.view.screenY(y)]; }",
        [float(one) for one in place],
    )


def test_a_page_plays_and_answers(opened, wall, browser):
    results = wall(4, 5)
    page = opened(results)
    assert page.evaluate("document.querySelector('main').dataset.renderer") == browser[1]
    assert "20 blocks, 6 frames" in page.inner_text("[data-part=counts]")
    assert page.evaluate("clastPage.state.frame") == 5
    page.focus("[data-part=above]")
    page.keyboard.press("Home")
    assert page.evaluate("clastPage.state.frame") == 0
    page.keyboard.press(".")
    assert page.evaluate("clastPage.state.frame") == 1
    page.select_option("[data-part=speed]", "5")
    page.click("[data-part=play]")
    until(page, "clastPage.state.frame === 5 && !clastPage.playing")
    page.select_option("[data-part=field]", "velocity")
    settled(page)
    assert "field=velocity" in page.evaluate("location.hash")
    assert "Velocity" in page.inner_text("[data-part=legend]")


def test_blocks_have_the_colour_of_their_field_and_their_name_is_told(opened, wall):
    results = wall(4, 5)
    page = opened(results)
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    middles = np.add.reduceat(results.vertices(5), results.block_start[:-1]) / 4.0 - origin
    top, foot = middles[17], middles[1]
    assert colour_at(page, *foot) == [0xDC, 0xDC, 0xDC]  # fixed
    before = colour_at(page, *top)
    page.select_option("[data-part=field]", "rock")
    settled(page)
    after = colour_at(page, *top)
    assert before != after and after in ([0xE0, 0xC9, 0xA0], [0xA9, 0xB8, 0x8F])
    page.mouse.click(*on_screen(page, top))
    settled(page)
    assert f"Block {results.block_name[17]}" in page.inner_text("[data-part=chosen]")
    assert page.evaluate("clastPage.state.chosen") == 17


def test_a_page_whose_graphics_card_is_taken_away_goes_on(opened, wall, browser):
    results = wall(4, 5)
    page = opened(results)
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    foot = np.add.reduceat(results.vertices(5), results.block_start[:-1])[1] / 4.0 - origin
    if browser[1] == "webgl2":
        page.evaluate("clastPage.drawing.gl.getExtension('WEBGL_lose_context').loseContext()")
    until(page, "clastPage.root.dataset.renderer === 'canvas'")
    settled(page)
    assert colour_at(page, *foot) == [0xDC, 0xDC, 0xDC]


@pytest.mark.parametrize("field", ["slip", "opening"])
def test_joints_have_the_scale_and_the_colours_of_still_pictures(opened, parted, field):
    page = opened(parted, address=f"#field={field}&layers=")
    faces = JOINT_FIELDS[field].values(parted, -1)
    scale = scale_of_faces(faces, np.ones(len(faces.value), bool), None)
    low, high = page.evaluate("['low', 'high'].map((end) => clastPage.$(end).value).map(Number)")
    assert [low, high] == pytest.approx([scale.low, scale.high], rel=1e-3)
    most = int(np.abs(faces.value).argmax())
    place = faces.ends[most].mean(axis=0) - page.evaluate("clastPage.run.scene.origin")
    wanted = np.multiply(to_rgb(scale.colours(0.0 if faces.value[most] < 0 else 1.0)), 255)
    drawn = colour_at(page, *place, above=True)
    assert np.abs(np.subtract(drawn, wanted)).max() < 12
    label = JOINT_FIELDS[field].label
    assert label in page.inner_text("[data-part=legend]")
    # a layer above other fields is as wide, in one colour
    page.evaluate(f"clastPage.set({{ field: 'rock', layers: new Set(['{field}']) }})")
    settled(page)
    assert colour_at(page, *place, above=True) in ([0x8E, 0x24, 0xAA], [0x00, 0x69, 0x5C])


def test_scales_end_where_those_of_still_pictures_do(opened, parted):
    page = opened(parted)
    rng = np.random.default_rng(4)
    usual, weight = rng.standard_normal(300), rng.uniform(0.5, 2.0, 300)
    for values in (usual, np.r_[usual[:-1], 50.0], np.abs(usual), -np.abs(usual), 0.0 * usual):
        single = np.float32(values).astype(float)
        scale = scale_of(single, weight)
        found = page.evaluate(
            "([values, weights]) => modules.colours.endsOf("
            "Float32Array.from(values), Float32Array.from(weights), null)",
            [single.tolist(), weight.tolist()],
        )
        assert found == pytest.approx([scale.low, scale.high])


def said_of_chosen(page):
    """Return heading and rows of what is chosen, by name."""
    text = page.inner_text("[data-part=chosen]").replace("\t", "\n").split("\n")
    words = [one.strip() for one in text if one.strip()]
    return words[0], dict(zip(words[1::2], words[2::2], strict=True))


def number(text):
    """Return a number with a unit and its prefix in SI units."""
    value, unit = text.replace("°", " °").split()
    factors = {"µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6}
    prefix = factors.get(unit[0], 1.0) if unit not in ("m", "°") else 1.0
    return float(value.replace("−", "-")) * prefix


def test_a_click_on_a_joint_tells_its_forces_its_slip_and_their_history(opened, parted):
    page = opened(parted, address="#layers=")
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    contacts = parted.contacts(-1)
    row = int(contacts.slip.argmin())
    inward = np.sign(origin[0] - contacts.position[row, 0]) * np.array([0.1, 0.0])
    page.mouse.click(*on_screen(page, contacts.position[row] + inward - origin))
    settled(page)
    heading, said = said_of_chosen(page)
    assert heading == "Joint of moved and table" and said["State"] == "slides"
    assert number(said["Slip"]) == pytest.approx(contacts.slip[row], rel=2e-3)
    assert number(said["Normal force"]) == pytest.approx(contacts.normal_force[row], rel=2e-3)
    assert abs(number(said["Shear force"])) == pytest.approx(
        abs(contacts.shear_force[row]), rel=2e-3
    )
    assert number(said["Mobilised friction"]) == pytest.approx(20.0, abs=0.1)
    assert number(said["Opening"]) == pytest.approx(contacts.opening[row], rel=2e-2)
    # its history: the slip of each frame, a gap where it bears nothing
    slips = page.evaluate("clastPage.charts.curve.lines[0].values")
    for frame in range(len(parted.times)):
        at = parted.contacts(frame)
        own = at.slip[(at.vertex == contacts.vertex[row]) & (at.edge_block == 0)]
        wanted = float(own[0]) if len(own) else None
        assert slips[frame] == (wanted and pytest.approx(wanted, abs=1e-6))
    names = page.evaluate("[...clastPage.$('curve').options].map((one) => one.text)")
    assert names[-3:] == ["Joint, slip", "Joint, forces", "Joint, opening"]
    # the address holds it, and it can be followed
    assert "joint=" in page.evaluate("location.hash")
    page.check("[data-part=follow]")
    page.keyboard.press("Home")
    settled(page)
    page.keyboard.press("End")
    settled(page)
    seen = page.evaluate("[clastPage.view.x, clastPage.view.y]")
    assert np.abs(seen + origin - contacts.position[row]).max() < 0.02
    page.keyboard.press("Escape")
    settled(page)
    assert "Click a block or a joint" in page.inner_text("[data-part=chosen]")


def test_a_click_on_a_joint_that_has_opened_tells_how_far(opened, parted):
    page = opened(parted, address="#layers=&field=opening")
    faces = JOINT_FIELDS["opening"].values(parted, -1)
    most = int(faces.value.argmax())
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    middle = faces.ends[most].mean(axis=0)
    page.mouse.click(*on_screen(page, middle - origin))
    settled(page)
    heading, said = said_of_chosen(page)
    assert sorted(heading.removeprefix("Joint of ").split(" and ")) == ["moved", "still"]
    assert number(said["Opening"]) == pytest.approx(faces.value[most], rel=2e-3)
    assert page.evaluate("clastPage.charts.curve.lines[0].values.at(-1)") == pytest.approx(
        faces.value[most], rel=1e-4
    )


def test_the_legend_names_what_is_drawn_and_goes_with_pictures(opened, wall, tmp_path):
    results = wall(4, 5)
    page = opened(results, address="#field=sigma_yy&layers=contacts,chains,crosses,joints,slip")
    text = page.inner_text("[data-part=legend]")
    contacts = results.contacts(-1)
    most = np.hypot(*contacts.force.T).max()
    assert f"contact force, up to {most / 1e3:.3g} kN/m" in text
    chains = resultants_of(contacts).size.max()
    assert f"force between blocks as width, up to {chains / 1e3:.3g} kN/m" in text
    for part in ("Stress σyy", "bed", "head", "compression, up to", "tension, up to", "fixed"):
        assert part in text, part
    with page.expect_download() as taken:
        page.click("[data-part=svg]")
    taken.value.save_as(tmp_path / "taken.svg")
    svg = (tmp_path / "taken.svg").read_text("utf-8")
    ElementTree.fromstring(svg)
    assert "A wall, t = 1 s" in svg and ">bed<" in svg and "kN/m" in svg


@pytest.mark.parametrize(
    ("name", "part", "anchor"),
    [
        ("A", 0.9, "start"),
        ("A", 0.995, "end"),
        ("name " * 60, 0.3, "start"),
        ("name " * 60, 0.7, "end"),
    ],
)
def test_a_name_stands_where_it_has_room_and_is_cut_where_it_has_none(
    opened, parted, tmp_path, name, part, anchor
):
    page = opened(parted, address="#layers=points")
    page.evaluate(
        """([name, part]) => {
          const { view, run, state } = clastPage;
          run.points[0].name = name;
          view.x = run.points[0].x[state.frame] + ((0.5 - part) * view.width) / view.scale;
        }""",
        [name, part],
    )
    with page.expect_download() as taken:
        page.click("[data-part=svg]")
    taken.value.save_as(tmp_path / "taken.svg")
    texts = ElementTree.parse(tmp_path / "taken.svg").iter("{http://www.w3.org/2000/svg}text")
    (shown,) = [one for one in texts if one.text.startswith(name[:9])]
    assert shown.get("text-anchor") == anchor
    if name != "A":
        width = page.evaluate("clastPage.view.width")
        assert shown.text.endswith("…") and 0.5 * width < 7 * len(shown.text) <= 0.7 * width


def test_the_legend_of_a_chart_has_the_values_of_the_frame(opened, parted):
    page = opened(parted)
    moved = parted.history("A").displacement
    for frame, at in ((0, 0), (-1, -1)):
        page.evaluate("(time) => clastPage.goTo(clastPage.run.frameAt(time))", parted.times[frame])
        settled(page)
        said = [number(one) for one in page.locator(".u-legend .u-value").all_inner_texts()]
        exact = [parted.times[frame], *moved[at]]
        assert said == pytest.approx(exact, rel=1e-3, abs=1e-12)


def test_chains_are_those_of_still_pictures(opened, parted):
    page = opened(parted, address="#layers=chains")
    for frame in range(len(parted.times)):
        wanted = resultants_of(parted.contacts(frame))
        found = page.evaluate(
            "(frame) => modules.contact_faces.resultantsOf(clastPage.run, frame)"
            ".map(({ x, y, size }) => [x, y, size])",
            frame,
        )
        exact = np.column_stack([wanted.at, wanted.size])
        exact = exact[np.argsort(exact[:, 2])]
        rows = np.reshape(sorted(found, key=lambda row: row[2]), (-1, 3))
        rows[:, :2] += page.evaluate("clastPage.run.scene.origin")
        assert rows == pytest.approx(exact, rel=2e-3, abs=2e-3)


def test_a_chart_says_its_values_at_once_and_nothing_lies_on_its_legend(opened, parted):
    page = opened(parted, 390, 844)
    page.select_option("[data-part=curve]", label="Energy")
    until(
        page, "[...document.querySelectorAll('.u-legend .u-value')].every((one) => one.innerText)"
    )
    legend = page.locator(".u-legend").bounding_box()
    button = page.locator("[data-part=csv]").bounding_box()
    assert legend["y"] + legend["height"] <= button["y"]


def test_the_legend_tells_what_lies_beyond_the_scale(opened, wall):
    results = wall(4, 5)
    page = opened(results, address="#field=velocity")
    assert "above" not in page.inner_text("[data-part=legend]")
    speed = np.hypot(*results.field("velocity", -1)[~results.fixed].T)
    low, high = 0.4 * speed.max(), 0.6 * speed.max()
    page.fill("[data-part=low]", str(low))
    page.fill("[data-part=high]", str(high))
    page.press("[data-part=high]", "Enter")
    settled(page)
    text = page.inner_text("[data-part=legend]")
    assert "above, to " in text and ("below, to " in text) == bool((speed < low).any())
    found = number(text.split("above, to ")[1].split("/s")[0])
    assert found == pytest.approx(speed.max(), rel=5e-3)


def test_fields_without_a_scale_offer_none(opened, parted):
    page = opened(parted, address="#field=none")
    assert not page.is_visible("[data-part=share]") and not page.is_visible("[data-part=low]")
    page.select_option("[data-part=field]", "velocity")
    settled(page)
    assert page.is_visible("[data-part=share]") and page.is_visible("[data-part=low]")


def test_water_is_drawn_where_it_presses(opened, wet_run):
    page = opened(wet_run, address="#layers=water&field=none")
    assert page.evaluate("clastPage.run.faces.water.shown") > 0
    assert "water level" in page.inner_text("[data-part=legend]")
    assert "water pressure, up to" in page.inner_text("[data-part=legend]")
    page.select_option("[data-part=field]", "water")
    settled(page)
    assert "Water pressure" in page.inner_text("[data-part=legend]")


def test_no_water_is_drawn_in_a_void(opened, undercut):
    """On the edge laid bare, along the level across the void, and on the wet edge beside it."""
    page = opened(undercut, address="#layers=water&field=none")
    origin = np.array(page.evaluate("clastPage.run.scene.origin"))
    page.evaluate("(clastPage.fitAll(), clastPage.changed())")

    pixel = 1.0 / page.evaluate("clastPage.view.scale")

    def is_blue(x, y):
        around = [(x + a * pixel, y + b * pixel) for a in (-1, 0, 1) for b in (-1, 0, 1)]
        seen = [colour_at(page, *(np.array(at) - origin), above=True) for at in around]
        return any(blue - red > 60 for red, _, blue in seen)

    level = np.interp([2.5, 3.5, 4.5, 0.5], [-5.0, 1.0, 5.0], [0.6, 2.0, 1.8])
    for frame, there in ((0, True), (len(undercut.times) - 1, False)):
        page.evaluate(f"clastPage.goTo({frame})")
        settled(page)
        assert is_blue(2.0, 0.5) == there  # the side of what is dug
        assert is_blue(-1.5, 0.0) == there  # the floor of the closed void
        assert is_blue(2.5, level[0]) == is_blue(3.5, level[1]) == there
        assert is_blue(0.5, level[3]) and is_blue(1.0, 0.0)


def test_an_address_holds_limits_share_and_theme(opened, wall):
    page = opened(wall(4, 5), address="#field=velocity&limits=0.1,0.2&theme=dark&follow")
    assert page.evaluate("clastPage.state.limits") == [0.1, 0.2]
    assert page.get_attribute("main", "data-theme") == "dark"
    page.fill("[data-part=low]", "0.05")
    page.press("[data-part=low]", "Enter")
    settled(page)
    assert "limits=0.05,0.2" in page.evaluate("location.hash")
    page.select_option("[data-part=share]", "0.95")
    settled(page)
    assert "share=0.95" in page.evaluate("location.hash")
    assert "limits" not in page.evaluate("location.hash")


@pytest.mark.parametrize(
    "address",
    [
        "#t=x&field=nothing&view=1,2&layers=foo,bar&block=99",
        "#joint=99999",
        "#joint=1,99",
        "#joint=1,2,3&block=-1",
        "#joint=%00&limits=2,1&share=7&theme=pink",
        "#view=1,1,-1&t=1e99&limits=a,b",
    ],
)
def test_addresses_of_other_runs_do_no_harm(opened, wall, address):
    page = opened(wall(2, 2), address=address)
    assert "4 blocks" in page.inner_text("[data-part=counts]")
    page.mouse.click(*on_screen(page, (0.0, 0.0)))
    settled(page)


def test_an_address_shows_the_same_again(opened, wall):
    page = opened(wall(4, 5), address="#t=0.4&field=sigma_yy&layers=contacts,points&block=7")
    state = "[clastPage.state.frame, clastPage.state.field, clastPage.state.chosen]"
    assert page.evaluate(state) == [2, "sigma_yy", 7]
    assert page.evaluate("[...clastPage.state.layers].sort()") == ["contacts", "points"]


@pytest.mark.parametrize("size", [(390, 844), (1600, 900)])
def test_narrow_and_wide_windows_show_all(opened, wall, size):
    page = opened(wall(4, 5, title="<b>Wand</b> \u202e\U0001f600"), *size)
    assert page.inner_text("[data-part=title]").startswith("<b>Wand</b>")
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    left, right = page.evaluate(
        "(() => { const xs = Array.from(clastPage.run.vertices(0)).filter((_, k) => k % 2 === 0)"
        ".map((x) => clastPage.view.screenX(x));"
        " return [Math.min(...xs), clastPage.view.width - Math.max(...xs)]; })()"
    )
    assert left >= 0.0 and right >= 0.0


def test_pictures_and_tables_can_be_taken_along(opened, wall, tmp_path):
    results = wall(3, 3)
    page = opened(results)
    for part, begins in (("png", b"\x89PNG"), ("svg", b"<svg"), ("csv", b'"time (s)"')):
        with page.expect_download() as taken:
            page.click(f"[data-part={part}]")
        file = tmp_path / f"taken.{part}"
        taken.value.save_as(file)
        assert file.read_bytes().startswith(begins)
    # the table is the chart that is shown: the displacement of the measured point
    table = np.genfromtxt(tmp_path / "taken.csv", delimiter=",", skip_header=1)
    point = results.history("top")
    assert table[:, 0] == pytest.approx(point.time)
    assert table[:, 1:] == pytest.approx(point.displacement, rel=1e-6)


def test_a_live_page_takes_up_frames_and_leads_its_run(opened, parted, tmp_path, browser):
    results = clast.read(parted.output)
    orders = []
    feed = Feed(results.path)
    feed.say({"time": 0.0, "end": 0.04, "step": 2e-3, "steps": 0, "contacts": 4, "paused": True})
    # of three frames the file seems to have one
    feed._results = dataclasses.replace(results, times=results.times[:1], report=None)
    server = LiveServer(("127.0.0.1", 0), feed, orders.append)
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    address = server.address.replace("/#", f"/?renderer={browser[1]}#")
    page = opened(None, address=address)
    assert page.evaluate("clastPage.run.frameCount") == 1
    assert "paused" in page.inner_text("[data-part=status]")
    feed.end()
    page.wait_for_selector("main[data-live=over]")
    page.wait_for_selector(f"main[data-frames='{len(results.times)}']")
    settled(page)
    assert page.evaluate("clastPage.state.frame") == len(results.times) - 1
    drawn = np.reshape(
        page.evaluate("Array.from(clastPage.run.vertices(clastPage.state.frame))"), (-1, 2)
    )
    away = drawn + page.evaluate("clastPage.run.scene.origin") - results.vertices(-1)
    assert np.abs(away).max() < 1e-5
    assert results.report.outcome in page.inner_text("[data-part=report]")
    with page.expect_download() as saved:
        page.click("[data-part=keep]")
    saved.value.save_as(tmp_path / "saved.html")
    assert (tmp_path / "saved.html").read_text("utf-8") == page_text(scene_of(results, BUDGET))
    assert page.evaluate("location.hash").startswith(f"#token={server.token}&t=")
    server.shutdown()
    server.server_close()
