"""The page of rockfall in a browser: all paths, and one that is chosen and played."""

import numpy as np
import pytest

import clast
from clast.case.templates import TEMPLATES
from clast.study.rockfall.page import write_page
from clast.trajectory import path


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    settings = ["source.1.rocks=8", 'title="Rocks </script> & more"']
    case = clast.Case.from_text(TEMPLATES["rockfall"], "rockfall.toml", settings)
    folder = tmp_path_factory.mktemp("rocks") / "out"
    results = clast.rockfall(case, folder, workers=1)
    return results, write_page(results)


def shown_rock(page):
    """Corners of the rock that is drawn, m, (n, 2)."""
    text = page.evaluate("document.querySelector('.rock').getAttribute('points')")
    return np.array([one.split(",") for one in text.split()], float)


def at_time(page, time):
    page.evaluate(
        "(time) => { const input = document.querySelector('[data-part=time]'); input.value = time;"
        " input.dispatchEvent(new Event('input')); }",
        time,
    )


def test_the_page_of_rockfall_plays_the_chosen_path(written, browser) -> None:
    results, file = written
    window = browser[0].new_page()
    faults: list[str] = []
    window.on("pageerror", lambda fault: faults.append(str(fault)))
    window.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
    window.goto(file.as_uri())
    window.wait_for_selector("main[data-ready=yes]")
    assert window.locator("h1").text_content() == "Rocks </script> & more"
    assert window.locator(".path").count() == 8
    window.locator("[data-part=path]").fill("5")
    window.locator("[data-part=path]").press("Enter")
    assert "path 5 of edge" in window.locator("[data-part=told]").text_content()

    # half way between two records of a flight, and at its end, the rock is where it flew
    campaign, one = results.campaign, results.campaign.follow(5)
    records = one.course.records[: one.course.tally[0]]
    row, after = records[0], records[1]
    span = 0.5 * (after[path.CLOCK] - row[path.CLOCK])
    at_time(window, float(row[path.CLOCK] + span))
    place = row[[path.X, path.Y]] + campaign.origin + span * row[path.AFTER : path.AFTER + 2]
    place = place + 0.5 * span**2 * campaign.gravity
    angle = row[path.ANGLE] + span * row[path.AFTER + 2]
    c, s = np.cos(angle), np.sin(angle)
    corners = place + one.rock.corners @ np.array([[c, s], [-s, c]])
    np.testing.assert_allclose(shown_rock(window), corners, rtol=0, atol=1e-3)
    at_time(window, 1e6)
    end = shown_rock(window).mean(axis=0)
    assert np.hypot(*(end - one.state[:2] - campaign.origin)) < one.rock.numbers[2]

    # a click on the end of another path chooses it, and it plays from its start
    other = results.campaign.follow(2)
    x, y = (other.state[:2] + campaign.origin).tolist()
    place = window.evaluate(
        "([x, y]) => { const m = document.querySelector('[data-part=upright]').getScreenCTM();"
        " const at = new DOMPoint(x, y).matrixTransform(m); return [at.x, at.y]; }",
        [x, y],
    )
    window.mouse.click(*place)
    told = window.locator("[data-part=told]").text_content()
    assert "t = 0.00 s" in told
    window.locator("[data-part=play]").click()
    window.wait_for_timeout(400)
    assert window.locator("[data-part=told]").text_content() != told
    assert faults == []
    window.close()


def test_the_records_of_the_page_are_those_of_the_paths(written) -> None:
    results, file = written
    text = file.read_text("utf-8")
    assert text.count("</script>") == 2
    assert "http" not in text.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    assert results.campaign.begin(3).state.tolist() == pytest.approx(
        results.campaign.follow(3).course.records[0, path.X : path.ANGLE + 1].tolist()
        + results.campaign.follow(3).course.records[0, path.AFTER : path.FACE].tolist()
    )
