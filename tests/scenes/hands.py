"""A person at the window of a case: mouse, keys, typed points, forms."""

import json
import tomllib

from scenes.browsers import until

CANVAS = "#section canvas[tabindex]"
FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


class Hand:
    """A person at a window: keys, and a mouse at places of the section, m."""

    def __init__(self, page):
        self.page = page
        self.keys = page.keyboard
        box = page.locator("#section canvas[tabindex]").bounding_box()
        self.corner = box["x"], box["y"]

    def at(self, x, y):
        """Return where a place is on the screen, when all that has changed is drawn."""
        self.page.evaluate(FRAMES)
        box = self.page.locator("#section canvas[tabindex]").bounding_box()
        px, py = self.page.evaluate("(at) => clastEditor.section.screen(at)", [x, y])
        return box["x"] + px, box["y"] + py

    def click(self, x, y):
        self.page.mouse.click(*self.at(x, y))

    def drag(self, start, end, steps=4):
        self.page.mouse.move(*self.at(*start))
        self.page.mouse.down()
        self.page.mouse.move(*self.at(*end), steps=steps)
        self.page.mouse.up()

    def tool(self, name, label=None):
        self.page.click(f'[data-tool="{name}"]')
        if label:
            self.page.select_option("[aria-label='Drawn table']", label=label)

    def type(self, *texts):
        for text in texts:
            self.page.fill(".tools .point input", text)
            self.page.press(".tools .point input", "Enter")

    def rest(self):
        """Wait until all that was done is in the window."""
        until(self.page, "!clastEditor.hand.isBusy && !clastEditor.hand.waiting.length")

    @property
    def content(self):
        """What the text has now."""
        self.rest()
        return tomllib.loads(self.page.evaluate("clastEditor.state.text"))

    @property
    def steps(self):
        """How many steps can be undone."""
        self.rest()
        return self.page.evaluate("clastEditor.state.undo[0]")

    def say(self):
        return self.page.inner_text(".tools .hint")

    def choose(self, *place):
        """Show the form of a table."""
        self.rest()
        self.page.click(f"nav [data-table='{_shown(place)}']")

    def add(self, table, name=None):
        """Add a table by the list above the tables, and give it a name of its own."""
        self.rest()
        before = self.page.evaluate("clastEditor.state.chosen")
        self.page.select_option(".add-table", value=table)
        until(self.page, f"JSON.stringify(clastEditor.state.chosen) !== '{_shown(before)}'")
        made = self.page.evaluate("clastEditor.state.chosen.at(-1)")
        if isinstance(made, str):
            self.page.wait_for_selector(f".form h2:has-text('{made}')")
        if name is not None:
            self.page.fill(".form input[aria-label='name']", name)
            self.page.press(".form input[aria-label='name']", "Enter")
            self.page.wait_for_selector(f".form h2:has-text('{name}')")

    def fill(self, **values):
        """Fill rows of the form that is shown, each a key with its value."""
        for key, value in values.items():
            self._fill(key, value)
        self.rest()

    def drop(self, key):
        """Leave a key out."""
        self.page.locator(f".form [data-key$='.{key}'] > .drop").first.click()
        self.rest()

    def instead(self, key):
        """Give a key in place of another that stands there."""
        self.page.select_option(f".form select.instead:has(option[value='{key}'])", value=key)
        self.rest()

    def form_of(self, key, label):
        """Give a key another form."""
        row = self.page.locator(f".form [data-key$='.{key}']").first
        row.locator("select.form-of:not(.instead)").first.select_option(label=label)
        self.rest()

    def name_value(self, key, name, value):
        """Give a value to one more name of a key that holds several."""
        row = self.page.locator(f".form [data-key$='.{key}']").first
        row.locator(".new-name").first.fill(name)
        row.locator(".new-name").first.blur()
        self.rest()
        self._enter(row.locator("input[type=text]:not(.new-name)").last, value)
        self.rest()

    def vary(self, **values):
        """Give keys distributions, which are texts in place of numbers."""
        for key, value in values.items():
            row = self.page.locator(f".form [data-key$='.{key}']").first
            row.wait_for()
            if not row.locator("select.form-of:not(.instead)").count():
                row.locator("> button[id]").click()
                self.rest()
            self.form_of(key, "text")
            self._enter(row.locator("input[type=text]").first, value)
        self.rest()

    def _fill(self, key, value):
        row = self.page.locator(f".form [data-key$='.{key}']").first
        row.wait_for()
        whole = row.locator("> button[id]")
        if whole.count():
            whole.click()
            self.rest()
        if whole.count() == 0 and row.locator("> output").count():
            return  # there is one value alone
        if isinstance(value, list):
            self._fill_each(row, value)
        else:
            self._enter(
                row.locator("input[type=text], input[type=checkbox], select:not(.form-of)").first,
                value,
            )

    def _fill_each(self, row, values):
        fields = row.locator("input[type=text], select:not(.form-of)")
        more = row.locator(".list > li:last-child > button")
        while fields.count() < len(values):
            more.click()
            self.rest()
        for number, value in enumerate(values):
            self._enter(fields.nth(number), value)

    def _enter(self, field, value):
        self.rest()
        kind = field.evaluate("(one) => one.tagName === 'SELECT' ? 'select' : one.type")
        if kind == "select":
            field.select_option(label=str(value))
        elif kind == "checkbox":
            field.set_checked(value)
        else:
            field.fill(str(value))
            field.blur()


def _shown(place):
    return json.dumps(list(place), separators=(",", ":"))
