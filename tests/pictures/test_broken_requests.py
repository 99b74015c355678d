"""Pictures, pages and films that cannot be had: exit code 2, one message, and no file is left."""

import numpy as np
import pytest

import clast
from clast.errors import CaseError, ModelError
from clast.pictures.figure_options import Look
from clast.pictures.film import FilmLook, FilmSpeed
from scenes.command_line import clast_command

REQUESTS = {
    # clast plot
    "field": (["plot", "FILE", "--field", "slipp"], "did you mean 'slip'"),
    "initials of a field": (["plot", "FILE", "--field", "syy"], "did you mean 'sigma_yy'"),
    "film": (["plot", "FILE", "-o", "film.gif"], "clast film FILE film.gif writes films"),
    "no field": (["plot", "FILE", "--field", ""], "there is no field ''"),
    "frame": (["plot", "FILE", "--frame", "99"], "99"),
    "frame before the first": (["plot", "FILE", "--frame", "-99"], "-99"),
    "time": (["plot", "FILE", "--time", "9"], "9"),
    "time that is none": (["plot", "FILE", "--time", "nan"], "nan"),
    "stage": (["plot", "FILE", "--stage", "dig"], "stage"),
    "limits": (["plot", "FILE", "--limits", "2,1"], "the lower limit first"),
    "one limit": (["plot", "FILE", "--limits", "2"], "--limits"),
    "limits that are none": (["plot", "FILE", "--limits", "a,b"], "--limits"),
    "infinite limits": (["plot", "FILE", "--limits", "0,inf"], "finite"),
    "zoom": (["plot", "FILE", "--zoom", "1,1,0,0"], "has no area"),
    "zoom without blocks": (
        ["plot", "FILE", "--zoom", "90,90,91,91"],
        ("no block lies in this area"),
    ),
    "size": (["plot", "FILE", "--size", "1"], "too small"),
    "dots": (["plot", "FILE", "--dpi", "5"], "between 20 and 2400"),
    "too many dots": (["plot", "FILE", "--dpi", "2400", "--size", "200"], "more than a picture"),
    "layer": (["plot", "FILE", "--layers", "chain"], "did you mean 'chains'"),
    "frames to compare": (["plot", "FILE", "--compare-frames", "0"], "--compare-frames"),
    "half a frame": (["plot", "FILE", "--compare-frames", "0,1.5"], "not a frame number"),
    "frames that are not": (["plot", "FILE", "--compare-frames", "0,77"], "77"),
    "history": (["plot", "FILE", "--history", "B"], "there is no history 'B'"),
    "abscissa": (["plot", "FILE", "--history", "A", "--against", "A:z"], "'A:z'"),
    "point": (["plot", "FILE", "--point", "B"], "'B'"),
    "bolt": (["plot", "FILE", "--bolt", "B"], "bolt"),
    "two pictures": (["plot", "FILE", "--point", "A", "--history", "A"], "one at a time"),
    "format": (["plot", "FILE", "-o", "OUT/a.xyz"], ".xyz"),
    "folder": (["plot", "FILE", "-o", "OUT/nowhere/a.png"], "nowhere"),
    "no file": (["plot", "OUT/none.vtkhdf"], "none.vtkhdf"),
    "no result file": (["plot", "TEXT"], "case.toml"),
    # clast page
    "page format": (["page", "FILE", "OUT/a.pdf"], ".html"),
    "page folder": (["page", "FILE", "OUT/nowhere/a.html"], "does not exist"),
    "budget": (["page", "FILE", "OUT/a.html", "--budget", "12 parsecs"], "is not a valid size"),
    "budget below 0": (["page", "FILE", "OUT/a.html", "--budget", "0"], "is not a valid size"),
    "page of a text": (["page", "TEXT", "OUT/a.html"], "case.toml"),
    # clast film
    "film format": (["film", "FILE", "OUT/a.avi"], ".avi"),
    "pictures per second": (["film", "FILE", "OUT/a.gif", "--fps", "0"], "0 pictures per second"),
    "speed": (["film", "FILE", "OUT/a.gif", "--speed", "-1"], "not a valid speed"),
    "film size": (["film", "FILE", "OUT/a.gif", "--size", "8"], "too few"),
    "film stage": (["film", "FILE", "OUT/a.gif", "--stage", "dig"], "stage"),
    "film field": (["film", "FILE", "OUT/a.gif", "--field", "colour"], "no field 'colour'"),
    "film zoom": (["film", "FILE", "OUT/a.gif", "--zoom", "1,2,3"], "--zoom"),
    "film folder": (["film", "FILE", "OUT/nowhere/a.gif"], "nowhere"),
    # clast run --live, clast resume --live
    "address": (["run", "CASE", "--live-at", "here"], "is not a valid address"),
    "port": (["run", "CASE", "--live-at", "127.0.0.1:99999"], "is not a valid address"),
    "no port": (["run", "CASE", "--live-at", "127.0.0.1:"], "is not a valid address"),
    "host": (["run", "CASE", "--live-at", "256.0.0.1:0"], "the page cannot be served"),
    "no checkpoint": (["resume", "TEXT", "--live"], "case.toml"),
    "missing checkpoint": (["resume", "OUT/none.checkpoint.h5", "--live"], "none.checkpoint.h5"),
}


@pytest.mark.parametrize(("words", "wanted"), REQUESTS.values(), ids=REQUESTS)
def test_what_cannot_be_had_is_said_and_leaves_nothing(
    words, wanted, parted, tmp_path, monkeypatch
):
    text = tmp_path / "case.toml"
    case = clast.Case.validated(CASE, "case")
    text.write_text(case.to_toml(), encoding="utf-8")
    folder = tmp_path / "out"
    folder.mkdir()
    monkeypatch.chdir(folder)
    places = {"FILE": str(parted.output), "TEXT": str(text), "CASE": str(text)}
    given = [places.get(word, word.replace("OUT", str(folder))) for word in words]
    if words[0] == "plot" and "-o" not in words:
        given += ["-o", str(folder / "a.png")]
    done = clast_command(*given)
    assert done.exit_code == 2, done.output
    assert done.stdout == "" and done.stderr.startswith("error: ")
    assert "Traceback" not in done.output and len(done.stderr) < 2000
    assert wanted in " ".join(done.stderr.split()), done.stderr
    assert list(folder.iterdir()) == []


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
CASE = {
    "time": {"step": 1e-3, "end": 0.1},
    "rock": {"rock": {"young": 5e9, "poisson": 0.2, "density": 2500.0}},
    "block": [{"name": "a", "vertices": SQUARE, "fixed": True}],
}


@pytest.mark.parametrize(
    "ask",
    [
        lambda run: run.plot(frame=99),
        lambda run: run.plot(look=Look(limits=(1.0, np.nan))),
        lambda run: clast.plot_results(run, "a.docx"),
        lambda run: FilmLook(size=(10, 10)),
        lambda run: FilmSpeed(fps=np.nan),
        lambda run: FilmSpeed(speed=np.inf),
        lambda run: run.measured_contact("bed"),
        lambda run: run.history("nobody"),
        lambda run: run.field("slip"),
    ],
)
def test_what_scripts_cannot_have(ask, parted, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((CaseError, ModelError)) as refused:
        ask(parted)
    assert str(refused.value).strip()
    assert list(tmp_path.iterdir()) == []
