"""The window of a case as a person uses it: fields, faults, steps back, the file."""

import json

import pytest

from clast.case.case_file import json_schema
from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")


@pytest.fixture
def window(opened, tmp_path):
    """Return a function that opens a template."""
    windows = []

    def open_template(name):
        file = tmp_path / f"{name}.toml"
        file.write_text(TEMPLATES[name], "utf-8", newline="")
        serving = edited_file(file)
        server = serving.__enter__()
        page = opened(server)
        windows.append((page, serving))
        page.wait_for_selector("body[data-ready]")
        return page, file

    yield open_template
    for page, serving in windows:
        page.close()
        serving.__exit__(None, None, None)


def table(page, *place):
    page.click(f"nav [data-table='{json.dumps(list(place), separators=(',', ':'))}']")


def field(page, key):
    return page.locator(f'[data-key="{key}"] input[type="text"]').first


def saved(page, file, text):
    """Wait until a file has a text, and the window says so."""
    until(page, "clastEditor.state.unsaved === false && !clastEditor.hand.isBusy")
    assert file.read_bytes().decode() == text


def test_a_value_is_changed_marked_mended_and_undone(window):
    page, file = window("slope")
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


def test_units_are_understood_and_other_texts_are_marked(window):
    page, file = window("slope")
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


def test_names_are_chosen_from_those_there_are_and_follow(window):
    page, file = window("slope")
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


def test_tables_are_added_and_removed(window):
    page, file = window("slope")
    page.select_option(".add-table", "measured_point")
    until(page, "clastEditor.state.content.measured_point.length === 2")
    assert page.text_content("nav [aria-current]").strip().startswith("2")
    field(page, "MeasuredPoint.name").fill("toe")
    until(page, 'clastEditor.state.content.measured_point[1].name === "toe"')
    page.click(".form >> text=remove")
    saved(page, file, TEMPLATES["slope"])


def test_a_slider_moves_the_value_as_one_step(window):
    page, file = window("slope")
    table(page, "joint_set", 1)
    slider = page.locator('input[aria-label="angle slider"]')
    slider.focus()
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    until(page, "clastEditor.state.content.joint_set[1].angle > 60 && !clastEditor.hand.isBusy")
    page.click("#undo")
    saved(page, file, TEMPLATES["slope"])
    assert page.is_disabled("#undo")


def test_the_text_is_typed_and_a_change_by_others_appears(window):
    page, file = window("slope")
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


def test_a_text_with_faults_is_saved_on_the_users_word(window):
    page, file = window("slope")
    table(page, "joint", "bedding")
    assert page.is_hidden("#write")
    field(page, "Joint.friction_angle").fill("95.0")
    page.click("#write")
    saved(page, file, TEMPLATES["slope"].replace("38.0 ", "95.0 "))
    assert page.is_hidden("#write")


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
  const all = (what, under = document) => [...under.querySelectorAll(what)];
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const idle = async () => { do await wait(5); while (hand.isBusy || hand.waiting.length); };
  const look = () => all(".form [data-key]").forEach((row) => seen.add(row.dataset.key));
  const set = (control, value) => {
    control.value = value;
    control.dispatchEvent(new Event("change", { bubbles: true }));
  };
  const ways = function* () {
    for (const button of all(".form .row > button[id], .form .list > li:last-child > button"))
      yield [`${button.closest(".row").dataset.key} ${button.id ? "" : "item"}`,
        () => button.click()];
    for (const name of all(".form .row .new-name"))
      yield [`${name.closest(".row").parentElement.closest(".row").dataset.key} name`,
        () => set(name, "new")];
    for (const select of all(".form select.form-of")) for (const { value } of select.options)
      yield [`${select.closest(".row").dataset.key} ${value}`, () => set(select, value)];
  };
  const next = () => [...ways()].find(([name]) => !tried.has(name));
  const explore = async () => {
    await idle();
    look();
    for (let found = next(); found; found = next()) {
      tried.add(found[0]);
      found[1]();
      await idle();
      look();
    }
  };
  set(document.querySelector(".level select"), "more");
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
  return [...seen];
}"""
"""Uses every button and choice of the forms, table by table; returns the keys that it has seen."""


def test_every_key_of_the_schema_is_in_a_form(window):
    page, _ = window("incline")
    seen = set(page.evaluate(REACH))
    expected = properties(json_schema())
    assert sorted(expected - seen) == []
    assert len(expected) > 400
