"""The window of a case as a person uses it: fields, faults, steps back, the file."""

import json

import pytest

from clast.case.case_file import json_schema
from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")


@pytest.fixture
def template(window):
    """Return a function that opens a template; it gives page and file."""
    return lambda name: window(TEMPLATES[name], f"{name}.toml")[:2]


def table(page, *place):
    page.click(f"nav [data-table='{json.dumps(list(place), separators=(',', ':'))}']")


def field(page, key):
    return page.locator(f'[data-key="{key}"] input[type="text"]').first


def saved(page, file, text):
    """Wait until a file has a text, and the window says so."""
    until(page, "clastEditor.state.unsaved === false && !clastEditor.hand.isBusy")
    assert file.read_bytes().decode() == text


def test_a_value_is_changed_marked_mended_and_undone(template):
    page, file = template("slope")
    old = TEMPLATES["slope"]
    table(page, "joint", "bedding")
    friction = field(page, "Joint.friction_angle")
    friction.click()
    friction.press("End")
    for _ in range(4):
        friction.press("Backspace")
    page.keyboard.type("95", delay=20)
    row = page.locator('[data-key="Joint.friction_angle"]')
    row.locator(".fault", has_text="must be below 90, not 95").wait_for()
    assert page.text_content("#saved") == "not saved: 1 fault"
    assert page.text_content("nav [aria-current] .mark") == "1"
    assert page.evaluate("document.activeElement.selectionStart") == 2
    assert "9" in file.read_text("utf-8")
    table(page, "time")
    page.click("#faults .fault")  # leads to the field
    assert page.evaluate("document.activeElement.value") == "95"
    page.keyboard.press("Home")
    page.keyboard.press("Delete")
    page.keyboard.press("End")
    page.keyboard.type(".5")  # 5.5, typed into the field that kept the cursor
    assert friction.input_value() == "5.5"
    saved(page, file, old.replace("friction_angle = 38.0 ", "friction_angle = 5.5 "))
    page.keyboard.press("Control+z")  # what was typed since the field was left
    until(page, "clastEditor.state.content.joint.bedding.friction_angle === 95")
    page.keyboard.press("Control+z")
    saved(page, file, old)
    assert friction.input_value() == "38.0"
    page.click("#redo")
    page.click("#redo")
    saved(page, file, old.replace("friction_angle = 38.0 ", "friction_angle = 5.5 "))


def test_units_are_understood_and_other_texts_are_marked(template):
    page, file = template("slope")
    table(page, "rock", "sandstone")
    young = field(page, "Rock.young")
    young.fill("20 GPa")
    saved(page, file, TEMPLATES["slope"].replace("young = 5e9", "young = 20e9"))
    young.fill("20 apples")
    assert "is not a number, Pa" in page.text_content('[data-key="Rock.young"]')
    page.wait_for_timeout(500)
    saved(page, file, TEMPLATES["slope"].replace("young = 5e9", "young = 20e9"))
    density = field(page, "Rock.density")
    density.fill("2.7 t/m3")
    until(page, "clastEditor.state.content.rock.sandstone.density === 2700")
    assert "density = 2.7e3" in page.input_value("#text")


def test_names_are_chosen_from_those_there_are_and_follow(template):
    page, file = template("slope")
    table(page, "joint_set", 0)
    page.locator('[data-key="JointSetTable.joint"] select').select_option(label="default")
    until(page, 'clastEditor.state.content.joint_set[0].joint === "default"')
    page.keyboard.press("Control+z")
    until(page, 'clastEditor.state.content.joint_set[0].joint === "bedding"')
    table(page, "joint", "bedding")
    page.fill(".form input[aria-label=name]", "clay seam")
    page.keyboard.press("Enter")
    until(page, 'clastEditor.state.content.joint_set[0].joint === "clay seam"')
    text = TEMPLATES["slope"].replace("[joint.bedding]", '[joint."clay seam"]')
    saved(page, file, text.replace('joint = "bedding"', 'joint = "clay seam"'))
    page.keyboard.press("Control+z")
    saved(page, file, TEMPLATES["slope"])


def test_tables_are_added_and_removed(template):
    page, file = template("slope")
    page.select_option(".add-table", "measured_point")
    until(page, "clastEditor.state.content.measured_point.length === 2")
    until(page, "document.querySelector('nav [aria-current]').textContent.trim().startsWith('2')")
    field(page, "MeasuredPoint.name").fill("toe")
    until(page, 'clastEditor.state.content.measured_point[1].name === "toe"')
    page.click(".form >> text=remove")
    saved(page, file, TEMPLATES["slope"])


def test_a_slider_moves_the_value_as_one_step(template):
    page, file = template("slope")
    table(page, "joint_set", 1)
    slider = page.locator('input[aria-label="angle slider"]')
    slider.focus()
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    until(page, "clastEditor.state.content.joint_set[1].angle > 60 && !clastEditor.hand.isBusy")
    page.click("#undo")
    saved(page, file, TEMPLATES["slope"])
    assert page.is_disabled("#undo")


def test_the_text_is_typed_and_a_change_by_others_appears(template):
    page, file = template("slope")
    page.click("#toml summary")
    page.fill("#text", TEMPLATES["slope"].replace("38.0", "38.0 ]"))
    until(page, "clastEditor.state.faults[0]?.line === 29")
    assert "line 29" in page.text_content("#faults")
    page.fill("#text", TEMPLATES["slope"].replace("38.0", "33.0"))
    saved(page, file, TEMPLATES["slope"].replace("38.0", "33.0"))
    page.click("h1")
    file.write_text(TEMPLATES["slope"].replace("38.0", "31.0"), "utf-8")
    until(page, "clastEditor.state.content.joint.bedding.friction_angle === 31")
    table(page, "joint", "bedding")
    assert field(page, "Joint.friction_angle").input_value() == "31.0"


def test_a_text_with_faults_is_saved_on_the_users_word(template):
    page, file = template("slope")
    table(page, "joint", "bedding")
    assert page.is_hidden("#write")
    field(page, "Joint.friction_angle").fill("95.0")
    page.click("#write")
    saved(page, file, TEMPLATES["slope"].replace("38.0 ", "95.0 "))
    assert page.is_hidden("#write")


def content(page, *place):
    return page.evaluate(
        "(place) => place.reduce((one, part) => one?.[part], clastEditor.state.content)",
        list(place),
    )


def row(page, key):
    return page.locator(f'.form [data-key="{key}"]')


def settled(page):
    page.wait_for_timeout(50)
    until(page, "!clastEditor.hand.isBusy && !clastEditor.hand.waiting.length")


def test_a_key_in_place_of_another_brings_those_that_go_with_it(template):
    page, file = template("slope")
    table(page, "joint_set", 0)
    turn = row(page, "JointSetTable.angle").locator("select.instead")
    turn.select_option("dip")
    until(page, "clastEditor.state.content.joint_set[0].dip !== undefined")
    settled(page)
    one = content(page, "joint_set", 0)
    assert "angle" not in one
    assert {"dip", "dip_direction", "spacing_is"} <= one.keys()
    row(page, "JointSetTable.dip").locator("select.instead").select_option("angle")
    until(page, "clastEditor.state.content.joint_set[0].angle !== undefined")
    assert not {"dip", "dip_direction", "spacing_is"} & content(page, "joint_set", 0).keys()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    saved(page, file, TEMPLATES["slope"])


def test_a_law_or_a_shape_brings_its_keys_and_takes_others_away(template):
    page, file = template("lined-tunnel")
    name = page.evaluate("Object.keys(clastEditor.state.content.joint)[0]")
    table(page, "joint", name)
    row(page, "Joint.law").locator("select").select_option(label="barton-bandis")
    until(page, "Object.values(clastEditor.state.content.joint)[0].jrc > 1")
    assert not {"friction_angle", "cohesion"} & content(page, "joint", name).keys()
    assert row(page, "Joint.friction_angle").count() == 0
    table(page, "opening", 0)
    shape = content(page, "opening", 0, "shape")
    other = {"circle": "box"}.get(shape, "circle")
    row(page, "OpeningTable.shape").locator("select").last.select_option(label=other)
    until(page, f"clastEditor.state.content.opening[0].shape === '{other}'")
    settled(page)
    keys = {"circle": {"center", "radius"}, "box": {"corner", "size"}}[other]
    given = content(page, "opening", 0).keys()
    assert keys <= given
    assert not {"center", "radius", "width", "wall_height", "corner", "size"} - keys & given
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    saved(page, file, TEMPLATES["lined-tunnel"])


def test_an_entry_is_moved_and_duplicated(template):
    page, file = template("slope")
    table(page, "joint_set", 1)
    names = [one["name"] for one in content(page, "joint_set")]
    page.click(".form button >> text=/^up$/")
    until(page, f"clastEditor.state.content.joint_set[0].name === '{names[1]}'")
    current = "document.querySelector('nav [aria-current]').textContent.trim()"
    until(page, f"{current} === '{names[1]}'")
    page.click(".form button >> text=/^down$/")
    until(page, f"clastEditor.state.content.joint_set[0].name === '{names[0]}'")
    saved(page, file, TEMPLATES["slope"])
    page.click(".form button >> text=/^duplicate$/")
    until(page, f"clastEditor.state.content.joint_set.length === {len(names) + 1}")
    copied = content(page, "joint_set", 2)
    assert copied.pop("name") == f"{names[1]} 2"
    assert {"name": names[1], **copied} == content(page, "joint_set", 1)


def test_what_others_name_is_removed_as_somebody_chooses(template):
    page, file = template("slope")
    old = TEMPLATES["slope"]
    table(page, "joint", "bedding")
    page.click(".form >> text=remove")
    asked = page.locator(".form .asked")
    assert "joint_set 1 joint" in asked.inner_text()
    page.click("text=keep it")
    assert asked.count() == 0
    for choice in ("remove these values too", "remove it all the same", None):
        table(page, "joint", "bedding")
        page.click(".form button >> text=/^remove$/")
        if choice:
            page.click(f"text={choice}")
        else:
            page.select_option("select[aria-label='Name another']", "default")
        until(page, "!('bedding' in clastEditor.state.content.joint)")
        named = content(page, "joint_set", 0, "joint")
        assert named == {"remove it all the same": "bedding", None: "default"}.get(choice)
        page.keyboard.press("Control+z")
        saved(page, file, old)
    table(page, "measured_point", 0)
    page.click(".form >> text=remove")
    until(page, "!clastEditor.state.content.measured_point?.length")


def test_a_key_of_other_words_is_renamed_on_request_only(template):
    page, file = template("slope")
    wrong = TEMPLATES["slope"].replace("friction_angle = 38.0", "jfric = 38.0")
    file.write_text(wrong, "utf-8")
    until(page, "clastEditor.state.faults.length > 0")
    table(page, "joint", "bedding")
    page.click("text=rename to friction_angle")
    until(page, "clastEditor.state.content.joint.bedding.friction_angle === 38")
    saved(page, file, TEMPLATES["slope"])


def test_a_second_window_looks_on_until_it_takes_over(template, browser):
    page, file = template("slope")
    until(page, "clastEditor.state.leads !== ''")
    second = browser.new_page()
    second.goto(page.url)
    second.wait_for_selector("body[data-ready]")
    until(second, "clastEditor.state.looks_on")
    assert "another window edits this case" in second.text_content("#saved")
    assert second.locator("#undo").is_hidden()
    table(second, "joint", "bedding")  # it may look at every table
    until(second, "document.querySelector('.form').inert")
    assert not page.evaluate("clastEditor.state.looks_on")
    second.click("#take-over")
    until(page, "clastEditor.state.looks_on")
    until(second, "!document.querySelector('.form').inert")
    field(second, "Joint.friction_angle").fill("36.0")
    saved(second, file, TEMPLATES["slope"].replace("38.0 ", "36.0 "))
    until(page, "clastEditor.state.content.joint.bedding.friction_angle === 36")
    second.close()
    until(page, "clastEditor.state.leads !== '' || !clastEditor.state.looks_on")
    until(page, "!clastEditor.state.looks_on")


def properties(schema):
    """Return every key of every table of the schema, as rows name them."""
    found, met = set(), set()

    def walk(node, owner):
        if "$ref" in node:
            owner = node["$ref"].split("/")[-1]
            return None if owner in met else (met.add(owner), walk(schema["$defs"][owner], owner))
        for key, one in node.get("properties", {}).items():
            found.add(f"{owner or node['title']}.{key}")
            walk(one, None)
        inner = [*node.get("anyOf", []), *node.get("oneOf", []), *node.get("prefixItems", [])]
        inner += [node[key] for key in ("items", "additionalProperties") if node.get(key)]
        for one in inner:
            walk(one, None)

    walk(schema, "Case")
    return found


REACH = """async () => {
  const { hand, state } = clastEditor, seen = new Set(), tried = new Set();
  const entered = new Map(), EXAMPLES = ["1", "0.5", "30", "1e-6", "2", "some text"];
  const all = (what, under = document) => [...under.querySelectorAll(what)];
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const idle = async () => { do await wait(5); while (hand.isBusy || hand.waiting.length); };
  const look = () => all(".form [data-key]").forEach((row) => seen.add(row.dataset.key));
  const set = (control, value) => {
    control.value = value;
    control.dispatchEvent(new Event("change", { bubbles: true }));
  };
  // a value of each field, which the case takes: its own, its default or another
  const enter = async (row) => {
    const { key, place } = row.dataset, own = (one) => one.closest(".row") === row;
    const [field, ...others] = all("input[type=text]", row).filter(own);
    if (!field || others.length || entered.get(key)) return;
    entered.set(key, "");
    for (const example of [field.value, field.placeholder, ...EXAMPLES].filter(Boolean)) {
      field.focus();
      field.value = example;
      field.dispatchEvent(new Event("input", { bubbles: true }));
      await idle();
      const isFaulty = state.faults.some((one) => JSON.stringify(one.place) === place);
      const isRefused = field.ariaInvalid || isFaulty;
      if (!isRefused) { entered.set(key, example); break; }
    }
    field.blur();
    await idle();
  };
  const ways = function* () {
    for (const button of all(".form .row > button[id], .form .list > li:last-child > button"))
      yield [`${button.closest(".row").dataset.key} ${button.id ? "" : "item"}`,
        () => button.click()];
    for (const name of all(".form .row .new-name"))
      yield [`${name.closest(".row").parentElement.closest(".row").dataset.key} name`,
        () => set(name, "new")];
    const selects = [...all(".form .form-of:not(.instead)"), ...all(".form .form-of.instead")];
    for (const select of selects) for (const { value } of select.options)
      yield [`${select.closest(".row").dataset.key} ${value}`, () => set(select, value)];
  };
  const next = () => [...ways()].find(([name]) => !tried.has(name));
  const explore = async () => {
    for (let found = [null, () => {}]; found; found = next()) {
      tried.add(found[0]);
      found[1]();
      await idle();
      look();
      for (const row of all(".form [data-key]")) await enter(row);
    }
  };
  set(document.querySelector(".level select"), "rare");
  for (const name of all("nav [data-table]").map((one) => one.dataset.table)) {
    document.querySelector(`nav [data-table=${CSS.escape(name)}]`)?.click();
    await explore();
  }
  const add = document.querySelector(".add-table");
  const top = [...Object.keys(state.content), ...all("option", add).map((one) => one.value)];
  top.filter(Boolean).forEach((name) => seen.add(`Case.${name}`));
  for (const name of all("option", add).map((one) => one.value).filter(Boolean)) {
    const text = state.text;
    set(add, name);
    await explore();
    hand.text(text);
    await idle();
  }
  return [[...seen], Object.fromEntries(entered)];
}"""
"""Uses every button and choice of the forms, table by table, and enters a value in every field;
returns the keys that it has seen, and the values, "" where none was taken."""


WITH_OTHERS = {
    "Joint.relative_roughness",
    "SpreadTable.mean",
    "SpreadTable.sd",
    "SpreadTable.values",
    "FlowTable.passes",
    "BarrierTable.restitution",
}
"""Keys that a case takes only beside others, which this walk does not give."""


def test_every_key_of_the_schema_is_in_a_form_and_takes_a_value(template):
    page, _ = template("incline")
    seen, entered = page.evaluate(REACH)
    seen = set(seen)
    assert {key for key, value in entered.items() if not value} == WITH_OTHERS
    assert len(entered) > 250
    expected = properties(json_schema())
    assert sorted(expected - seen) == []
    assert len(expected) > 400
