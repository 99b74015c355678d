"""Films: which frame is shown when, what is drawn of it, files that are whole or not there."""

import errno
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from clast.errors import CaseError
from clast.pictures import film
from clast.pictures.film import (
    FilmLook,
    FilmSpeed,
    FrameDrawer,
    ffmpeg,
    frames_of,
    timing,
    write_film,
)

SMALL = FilmLook(size=(320.0,))


def pictures_in(path):
    """Return the pictures of an MP4, (pictures, height, width, 3), and its pictures a second."""
    told = subprocess.run(
        [ffmpeg(), "-i", path], capture_output=True, text=True, check=False
    ).stderr
    stream = next(line for line in told.splitlines() if "Video:" in line)
    words = [word.strip() for word in stream.split(",")]
    width, height = map(
        int, next(w for w in words if "x" in w and w[0].isdigit()).split()[0].split("x")
    )
    fps = float(next(word for word in words if word.endswith("fps")).split()[0])
    raw = subprocess.run(
        [ffmpeg(), "-loglevel", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
        capture_output=True,
        check=True,
    ).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width, 3), fps


def test_without_a_speed_every_frame_is_one_picture():
    assert timing(np.array([0.0, 0.1, 5.0]), range(3), FilmSpeed()) == ((0, 1), (1, 1), (2, 1))


@pytest.mark.parametrize(
    ("times", "fps", "speed", "expected"),
    [
        # four pictures a frame
        ([0.0, 1.0, 2.0], 4.0, 1.0, [(0, 4), (1, 4), (2, 1)]),
        # every other frame
        ([0.0, 0.5, 1.0, 1.5, 2.0], 1.0, 1.0, [(0, 1), (2, 1), (4, 1)]),
        # slow motion, 0.3 = 3 * 0.1 not to the last digit
        ([0.0, 0.1, 0.2, 0.3], 10.0, 0.5, [(0, 2), (1, 2), (2, 2), (3, 1)]),
        # uneven frames, and two at one time: a stage begins
        ([0.0, 1.0, 1.0, 1.2, 4.0], 1.0, 1.0, [(0, 1), (2, 1), (3, 2), (4, 1)]),
    ],
)
def test_a_speed_says_which_frame_stands_for_how_long(times, fps, speed, expected):
    shown = timing(np.array(times), range(len(times)), FilmSpeed(fps=fps, speed=speed))
    assert shown == tuple(expected)
    assert sum(ticks for _, ticks in shown) == round((times[-1] - times[0]) / speed * fps) + 1


def test_a_stage_begins_with_the_state_that_it_takes_over(wall):
    results = wall(2, 3)
    assert list(frames_of(results, None)) == [0, 1, 2, 3, 4, 5]
    with pytest.raises(CaseError, match="stage"):
        frames_of(results, "nowhere")


def test_pictures_of_a_film_are_alike_but_for_what_moves(wall):
    results = wall(3, 4)
    drawing = FrameDrawer(results, range(6), FilmLook(size=(640.0,), field="sigma_yy"), 1280)
    first, last = drawing.picture(0), drawing.picture(5)
    assert drawing.size == (640, first.shape[0])
    assert first.shape[0] % 2 == 0
    # colour bar to the right and legend below are the same, blocks and clock are not
    changed = (first != last).any(axis=2)
    assert not changed[:, 540:].any()
    assert not changed[-70:].any()
    assert changed.any()
    # nothing of one picture is left in the next
    assert np.array_equal(drawing.picture(0), first)


def test_a_block_is_drawn_where_the_results_have_it(wall):
    results = wall(2, 2)
    look = FilmLook(size=(800.0, 600.0), limits=(0.0, 1.0), zoom=(0.0, 0.0, 3.0, 3.0))
    drawing = FrameDrawer(results, range(6), look, 1280)
    picture = drawing.picture(5)
    box = drawing._axes.get_window_extent()
    (left, right), (low, high) = drawing._axes.get_xlim(), drawing._axes.get_ylim()
    outline = results.vertices(5)[results.block_start[3] : results.block_start[4]]
    for corner in outline:
        x = box.x0 + (corner[0] - left) / (right - left) * box.width
        y = picture.shape[0] - (box.y0 + (corner[1] - low) / (high - low) * box.height)
        here = picture[int(y) - 1 : int(y) + 3, int(x) - 1 : int(x) + 3, :3]
        assert here.min() < 90, "the corner of an outline is dark"


@pytest.mark.parametrize("field", ["rock", "block", "joint", "none", "velocity"])
def test_every_kind_of_field_is_filmed(wall, field):
    results = wall(3, 3)
    drawing = FrameDrawer(results, range(6), FilmLook(field=field, size=(480.0,)), 1280)
    assert (drawing.picture(0) != drawing.picture(5)).any()


def test_a_tall_scene_is_no_higher_than_three_quarters_of_its_width(wall):
    width, height = FrameDrawer(wall(12, 1), range(6), FilmLook(), 1280).size
    assert (width, height) == (1280, 960)


def test_mp4_holds_every_picture(wall, tmp_path):
    results = wall(2, 3)
    path = write_film(results, tmp_path / "wall.mp4", look=SMALL, speed=FilmSpeed(fps=5.0))
    pictures, fps = pictures_in(path)
    assert (len(pictures), fps) == (6, 5.0)
    drawn = FrameDrawer(results, range(6), SMALL, 1280).picture(5)[..., :3].astype(int)
    # H.264 keeps colours at half resolution
    assert np.abs(pictures[5].astype(int) - drawn).mean() < 3.0


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_gif_and_webp_last_as_long_as_the_run(wall, tmp_path, ending):
    heard = []
    path = write_film(
        wall(2, 3),
        tmp_path / f"wall.{ending}",
        look=SMALL,
        speed=FilmSpeed(fps=30.0, speed=0.5),
        watch=lambda done, of: heard.append((done, of)),
    )
    with Image.open(path) as film:
        lasts = []
        for number in range(film.n_frames):
            film.seek(number)
            film.load()
            lasts.append(film.info["duration"])
        assert film.size[0] == 320
    # 1 s of the run at half its speed, and the last picture for one tick
    assert sum(lasts) == pytest.approx(2000.0 + 1000.0 / 30.0, abs=10.0)
    assert heard == [(k, 6) for k in range(1, 7)]


def test_paper_stays_white_in_a_gif(wall, tmp_path):
    path = write_film(wall(2, 3), tmp_path / "wall.gif", look=SMALL)
    with Image.open(path) as film:
        assert film.convert("RGB").getpixel((2, 2)) == (255, 255, 255)


@pytest.mark.parametrize(
    ("times", "speed"), [([0.0, 1e6], FilmSpeed(speed=1e-3)), (np.zeros(200_000), FilmSpeed())]
)
def test_a_film_of_days_is_refused(times, speed):
    with pytest.raises(CaseError, match="100,000 pictures at most"):
        timing(np.array(times), range(len(times)), speed)


def test_a_gif_is_not_faster_than_browsers_show_it(wall, tmp_path):
    with pytest.raises(CaseError, match="50 pictures per second"):
        write_film(wall(1, 2), tmp_path / "film.gif", speed=FilmSpeed(fps=60.0))


@pytest.mark.parametrize("ending", ["mp4", "gif", "webp"])
@pytest.mark.parametrize("fault", [KeyboardInterrupt(), OSError(errno.ENOSPC, "No space left")])
def test_nothing_of_a_film_is_left_that_was_not_finished(wall, tmp_path, ending, fault):
    old = tmp_path / f"film.{ending}"
    old.write_bytes(b"an older film")

    def watch(done, of):
        if done == 3:
            raise fault

    with pytest.raises((CaseError, KeyboardInterrupt)):
        write_film(wall(1, 2), old, look=SMALL, watch=watch)
    assert old.read_bytes() == b"an older film"
    assert sorted(found.name for found in tmp_path.iterdir()) == sorted([old.name, "wall.vtkhdf"])


def test_what_ffmpeg_says_is_told(wall, tmp_path, monkeypatch):
    failing = tmp_path / "ffmpeg"
    failing.write_text(
        "#!/bin/sh\nhead -c 1000 >/dev/null\necho 'No space left on device' >&2\nexit 1\n"
    )
    failing.chmod(0o755)
    monkeypatch.setattr(film.shutil, "which", lambda name: str(failing))
    with pytest.raises(CaseError, match="No space left on device"):
        write_film(wall(1, 2), tmp_path / "film.mp4", look=SMALL)
    assert not (tmp_path / "film.mp4").exists()


def test_without_ffmpeg_it_is_said_what_to_install(wall, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(CaseError, match=r"clast\[film\]"):
        write_film(wall(1, 2), tmp_path / "film.mp4", look=SMALL)
