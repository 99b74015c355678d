"""Tracks as sections: lengths by coordinates in space, and files that hold none."""

import numpy as np
import pytest

import clast
from clast.rockmass.drawings.gpx import section_of

HEAD = '<?xml version="1.0"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">\n'


def gpx(places, kind: str = "trkpt") -> str:
    rows = [
        f'<{kind} lat="{a:.12f}" lon="{b:.12f}"><ele>{h}</ele></{kind}>\n' for a, b, h in places
    ]
    group = "rte" if kind == "rtept" else "trk><trkseg"
    close = "rte" if kind == "rtept" else "trkseg></trk"
    return f"{HEAD}<{group}>\n{''.join(rows)}</{close}>\n</gpx>\n"


def in_space(lat, lon) -> np.ndarray:
    """Places on the ellipsoid WGS 84, m, about the centre of the earth."""
    a, f = 6378137.0, 1.0 / 298.257223563
    b = a * (1.0 - f)
    lat, lon = np.radians(lat), np.radians(lon)
    n = a * a / np.sqrt((a * np.cos(lat)) ** 2 + (b * np.sin(lat)) ** 2)
    return np.stack(
        [
            n * np.cos(lat) * np.cos(lon),
            n * np.cos(lat) * np.sin(lon),
            (b / a) ** 2 * n * np.sin(lat),
        ],
        axis=-1,
    )


@pytest.mark.parametrize("lat", [-67.0, 0.0, 46.5])
@pytest.mark.parametrize("way", [(1.0, 0.0), (0.6, -0.8), (0.0, 1.0)])
@pytest.mark.parametrize("lon", [8.0, 179.999])
@pytest.mark.parametrize("size", [1e-3, 0.05])
def test_lengths_are_those_of_chords_in_space(lat, way, lon, size, tmp_path) -> None:
    shares = np.array([0.0, 0.3, 0.7, 1.0])
    lats, lons = lat + size * way[0] * shares, lon + size * way[1] * shares
    heights = [900.0, 800.0, 750.0, 700.0]
    folded = (lons + 180.0) % 360.0 - 180.0
    (tmp_path / "track.gpx").write_text(gpx(zip(lats, folded, heights, strict=True)))
    points = section_of(tmp_path / "track.gpx")
    steps = np.linalg.norm(np.diff(in_space(lats, lons), axis=0), axis=1)
    # parallels and meridians of 5 km are curved, and not seen from right above
    assert np.diff(points[:, 0]) == pytest.approx(steps, rel=2e-6 if size > 0.01 else 3e-9)
    assert points[:, 1].tolist() == heights
    assert points[0, 0] == 0.0


PLACES = [(46.0, 8.0, 900.0), (46.0, 8.0004, 880.0), (46.0, 8.001, 800.0)]


def test_a_route_is_read_where_there_is_no_track_and_points_that_stay_are_left_out(tmp_path):
    still = [PLACES[0], PLACES[1], (46.0, 8.00039, 881.0), PLACES[1], PLACES[2]]
    (tmp_path / "a.gpx").write_text(gpx(still, "rtept"))
    (tmp_path / "b.gpx").write_text(gpx(PLACES))
    assert section_of(tmp_path / "a.gpx").tolist() == section_of(tmp_path / "b.gpx").tolist()


CASE = """
schema = 1
[rockfall]
file = "track.gpx"
surface = ["rock"]
[surface.rock]
normal_restitution = 0.4
friction_angle = 30.0
[[source]]
name = "edge"
at = [5, 900]
rocks = 2
volume = 0.5
"""


def test_rocks_fall_on_a_track(tmp_path) -> None:
    (tmp_path / "track.gpx").write_text(gpx(PLACES))
    (tmp_path / "case.toml").write_text(CASE)
    results = clast.rockfall(tmp_path / "case.toml", tmp_path / "out", workers=1)
    profile = results.campaign.profile + results.campaign.origin
    assert profile[:, 1].tolist() == [900.0, 880.0, 800.0]
    assert profile[-1, 0] == pytest.approx(77.4, abs=0.1)
    assert (tmp_path / "out" / "paths.csv").exists()


BROKEN = {
    "no elevation": (
        gpx(PLACES).replace("<ele>880.0</ele>", ""),
        "line 5, trkpt: has no elevation",
    ),
    "no number": (
        gpx(PLACES).replace("880.0", "high"),
        "line 5, ele: the text there is not a number",
    ),
    "no latitude": (gpx(PLACES).replace("lat=", "at="), "has no lat"),
    "metres": (gpx([(5e5, 8.0, 1.0), *PLACES]), "lat is 500000"),
    "feet below the sea": (gpx([(46.0, 8.0, 2e4), *PLACES]), "is 20000"),
    "a point": (gpx(PLACES[:1]), "has 1 point(s)"),
    "there and back": (gpx([*PLACES, PLACES[0]]), "beside the straight line"),
    "a hairpin": (gpx([PLACES[0], (46.0002, 8.0005, 850.0), *PLACES[1:]]), "no section"),
    "another root": ("<kml></kml>", "its root is kml, not gpx"),
    "an entity": (f'<!DOCTYPE a [<!ENTITY b "c">]>{gpx(PLACES)}', "declares a document type"),
    "half a file": (gpx(PLACES)[:-20], "is not XML"),
    "nothing": ("", "is not XML"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_tracks_are_refused_in_words(name: str, tmp_path) -> None:
    text, said = BROKEN[name]
    (tmp_path / "track.gpx").write_text(text)
    (tmp_path / "case.toml").write_text(CASE)
    with pytest.raises(clast.CaseError) as refused:
        clast.load(tmp_path / "case.toml").campaign()
    assert said in str(refused.value)
    assert "track.gpx" in str(refused.value)


@pytest.mark.parametrize("given", ["[]", '["rock", "rock"]'])
def test_a_track_needs_one_surface(given: str) -> None:
    with pytest.raises(clast.CaseError, match=r"surface\(s\) for a track"):
        clast.Case.from_text(CASE.replace('["rock"]', given), "case.toml")
