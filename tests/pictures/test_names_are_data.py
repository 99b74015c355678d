"""Names in a case are data in every page: no element, no attribute, no script comes of them."""

import json
from html.parser import HTMLParser

import pytest

import clast
from clast import studies
from clast.pictures.page.document import page_text
from clast.pictures.page.scene import scene_of
from clast.pictures.rock_mass import write_cut_report
from clast.rockmass import Domain, JointSet, cut
from clast.study.report_page import Page as StudyPage

NAMES = {
    "script": "</script><script>alert(1)</script>",
    "image": "<img src=x onerror=alert(1)>",
    "quotes": "\"' onload='alert(1)' x=\"",
    "comment": "--><!--<script>",
    "entity": "&lt;b&gt; &amp;amp; &#60;",
    "right to left": "\u202e\u05d0\u05d1 \u2066x",
    "emoji": "\U0001f9f1\U0001f469\u200d\U0001f52c",
    "separators": "a\u2028b\u2029c",
    "formula": "$\\alpha$ %s {0} ${x}",
}


class Elements(HTMLParser):
    """Collects the elements of a page with their attributes, and its text."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.found, self.words, self.frames = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, sorted(name for name, _ in attributes)))
        self.frames += [value for name, value in attributes if name == "srcdoc"]

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return "".join(self.words)


def bricks(name, measured=None):
    """Return the builder of a brick on a table in which all is called ``name``."""
    measured = name if measured is None else measured
    builder = clast.ModelBuilder(title=name)
    builder.add_rock(name, young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(name, friction_angle=30.0, between=[[f"{name} 1", f"{name} 2"]])
    builder.block(
        name=f"{name} 1", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], rock=name, fixed=True
    )
    builder.block(name=f"{name} 2", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], rock=name)
    builder.measured_point(measured, (0.5, 0.5), block=f"{name} 2")
    builder.measured_contact(f"{measured} c", joint=name)
    builder.add_bolt_kind(name, stiffness=1e6)
    builder.bolt((0.5, 0.5), (0.5, -0.5), kind=name, name=f"{measured} b")
    return builder


@pytest.fixture(scope="module")
def plain_page():
    return Elements(page_text(scene_of(run_of("plain"), 1e6)))


def run_of(name):
    return clast.simulate(bricks(name).build(), step=1e-3, end=2e-3, every=1e-3)


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_in_the_page_of_a_run(name, plain_page):
    text = page_text(scene_of(run_of(name), 1e6))
    page = Elements(text)
    assert page.found == plain_page.found
    start = text.index('id="scene">') + len('id="scene">')
    scene = json.loads(text[start : text.index("</script>", start)])
    assert scene["title"] == name and scene["rocks"] == [name] and name in scene["joints"]
    assert scene["blocks"] == [f"{name} 1", f"{name} 2"]
    assert scene["points"][0]["name"] == name and scene["bolts"]["names"] == [f"{name} b"]
    assert any(one["name"] == f"Contact {name} c, slip" for one in scene["curves"])


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_in_tables_of_notebooks(name):
    run, plain = run_of(name), run_of("plain")
    for one, other in ((run, plain), (run.model, plain.model)):
        page = Elements(one._repr_html_())
        assert page.found == Elements(other._repr_html_()).found
        assert name in page.text or name.strip() in page.text


def page_of_a_comparison(title, folder):
    """Return the page that compares a method with itself, of a case in which all is called so."""
    # a case file takes no names of measured things with a slash
    case = bricks(title, title.replace("/", "|")).case(step=1e-3, end=2e-3)
    comparison = studies.compare(case, ["convex"], ["penalty"])
    paths = studies.write_comparison(comparison, folder)
    return next(path for path in paths if path.suffix == ".html")


@pytest.fixture(scope="module")
def plain_comparison(tmp_path_factory):
    page = page_of_a_comparison("plain", tmp_path_factory.mktemp("plain"))
    return Elements(page.read_text("utf-8"))


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_in_the_page_of_a_comparison(name, tmp_path, plain_comparison):
    page = Elements(page_of_a_comparison(name, tmp_path).read_text("utf-8"))
    assert page.found == plain_comparison.found and name in page.text


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_in_the_report_of_a_study(name):
    pages = []
    for title in (name, "plain"):
        page = StudyPage(title)
        page.say(title)
        page.head(title)
        page.table([title], [[title]])
        page.run(run_of(title), title)
        pages.append(Elements(page.text()))
    assert pages[0].found == pages[1].found and name in pages[0].text
    inner, plain = (Elements(page.frames[0]) for page in pages)
    assert inner.found == plain.found


@pytest.mark.parametrize("name", [NAMES["image"], NAMES["quotes"], NAMES["emoji"]])
def test_in_the_report_of_a_cut(name, tmp_path):
    domain = Domain(boundary=[(0, 0), (4, 0), (4, 2), (0, 2)])
    pages = []
    for called in (name, "plain"):
        made = cut(domain, [JointSet(name=called, angle=90.0, spacing=1.0, joint=called)])
        path = write_cut_report(made, tmp_path / "cut.html", title=called)
        pages.append(Elements(path.read_text("utf-8")))
    assert pages[0].found == pages[1].found and name in pages[0].text
