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


def run_of(name):
    return clast.simulate(bricks(name).build(), step=1e-3, end=2e-3, every=1e-3)


def comparison(name, folder):
    """Return the page that compares a method with itself."""
    # a case file takes no names of measured things with a slash
    case = bricks(name, name.replace("/", "|")).case(step=1e-3, end=2e-3)
    paths = studies.write_comparison(studies.compare(case, ["convex"], ["penalty"]), folder)
    return next(path for path in paths if path.suffix == ".html").read_text("utf-8")


def study(name, _):
    page = StudyPage(name)
    page.say(name)
    page.head(name)
    page.table([name], [[name]])
    page.run(run_of(name), name)
    return page.text()


def cut_report(name, folder):
    domain = Domain(boundary=[(0, 0), (4, 0), (4, 2), (0, 2)])
    made = cut(domain, [JointSet(name=name, angle=90.0, spacing=1.0, joint=name)])
    return write_cut_report(made, folder / "cut.html", title=name).read_text("utf-8")


PAGES = {
    "run": lambda name, _: page_text(scene_of(run_of(name), 1e6)),
    "table of a run": lambda name, _: run_of(name)._repr_html_(),
    "table of a model": lambda name, _: run_of(name).model._repr_html_(),
    "comparison": comparison,
    "study": study,
    "cut": cut_report,
}


@pytest.fixture(scope="module", params=PAGES)
def made(request, tmp_path_factory):
    """Return what makes a page, and the elements of the page of a plain name."""
    make = PAGES[request.param]
    return request.param, make, Elements(make("plain", tmp_path_factory.mktemp("plain")))


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_names_make_no_element(made, name, tmp_path):
    kind, make, plain = made
    page = Elements(make(name, tmp_path))
    assert page.found == plain.found
    if kind != "run":  # its names stand in JSON
        assert name.strip() in page.text
    for inner, other in zip(page.frames, plain.frames, strict=True):
        assert Elements(inner).found == Elements(other).found


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_the_page_of_a_run_has_its_names_as_they_are(name):
    text = page_text(scene_of(run_of(name), 1e6))
    start = text.index('id="scene">') + len('id="scene">')
    scene = json.loads(text[start : text.index("</script>", start)])
    assert scene["title"] == name and scene["rocks"] == [name] and name in scene["joints"]
    assert scene["blocks"] == [f"{name} 1", f"{name} 2"]
    assert scene["points"][0]["name"] == name and scene["bolts"]["names"] == [f"{name} b"]
    assert any(one["name"] == f"Contact {name} c, slip" for one in scene["curves"])
