"""Every state that a kill can leave a result file in, one after the other."""

from __future__ import annotations

import dataclasses
import io
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from recorded_run import moved, report, step_result, three_blocks

from clast.errors import CaseError
from clast.model import Model
from clast.model_builder import ModelBuilder
from clast.results import Results, RunRecorder, read_results
from clast.results.journal import JournalledFile, complete_journal
from clast.results.layout import CELL_ARRAYS, POINT_ARRAYS
from clast.results.writing import MOVING
from clast.state import State, initial_state

PAGE = 4096
"""Linux stops a write at the end of a page when the process is killed."""

Change = tuple[int, bytes | None]
"""A place and the bytes written there; None: the file was cut there, or lengthened."""


class Disk:
    """Files opened for writing through it, every change noted."""

    def __init__(self) -> None:
        self.changes: list[Change] = []
        self.before: bytes = b""
        self.room = 10**12

    def open(self, path: Path, mode: str, buffering: int) -> io.FileIO:
        disk = self

        class Watched(io.FileIO):
            def write(self, data: memoryview) -> int:
                if self.tell() + len(data) > disk.room:
                    raise OSError(28, "No space left on device")
                disk.changes.append((self.tell(), bytes(data)))
                return super().write(data)

            def truncate(self, size: int | None = None) -> int:
                assert size is not None
                disk.changes.append((size, None))
                return super().truncate(size)

        if mode == "r+b" and not self.changes:
            self.before = path.read_bytes()
        return Watched(path, mode.replace("b", ""))


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    disk = Disk()
    monkeypatch.setattr("clast.results.journal.open", disk.open, raising=False)
    monkeypatch.setattr("clast.results.journal.PATIENCE", 0.0)
    return disk


def states(before: bytes, changes: list[Change], start: int) -> Iterator[bytearray]:
    """Yield the file as a kill can leave it, from change number ``start`` on."""
    file = bytearray(before)
    for number, (place, data) in enumerate(changes):
        file.extend(bytes(max(0, place - len(file))))
        if data is None:
            del file[place:]
        else:
            for cut in range(PAGE - place % PAGE, len(data), PAGE):
                file[place : place + cut] = data[:cut]
                if number >= start:
                    yield file
            file[place : place + len(data)] = data
        if number >= start:
            yield file


def many_blocks() -> Model:
    """528 squares: as many as need a chunk of the file for every frame."""
    builder = ModelBuilder(title="many blocks")
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    for number in range(528):
        x, y = 2.0 * (number % 24), 2.0 * (number // 24)
        square = np.array([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)])
        builder.block(name=f"square {number}", vertices=square, rock="granite")
    builder.measured_point("tip", (0.5, 0.5), block="square 0")
    return builder.build()


def shifted(model: Model, time: float) -> State:
    """The state at ``time`` of a model that moves as one, 1 m/s to the right."""
    start = initial_state(model)
    way = np.array([time, 0.0])
    return dataclasses.replace(
        start, time=time, vertices=start.vertices + way, points=start.points + way
    )


def write_frames(model: Model, at: Callable[[Model, float], State], path: Path) -> Iterator[int]:
    """Record frames 0.01 s apart; yield the number of frames after each."""
    recorder = RunRecorder(model, output=path)
    recorder.start(at(model, 0.0))
    for number in range(1, 200):
        yield number
        result = dataclasses.replace(
            step_result(three_blocks(), 0.0), state=at(model, 0.01 * number)
        )
        recorder.step(result, 0.01)
        recorder.frame(result.state)


def check(results: Results, model: Model, at: Callable[[Model, float], State]) -> None:
    """Assert that all frames are there and that the tables belong to them."""
    frames = len(results.times)
    np.testing.assert_allclose(results.times, 0.01 * np.arange(frames))
    for frame in {0, frames // 2, frames - 1}:
        np.testing.assert_array_equal(results.vertices(frame), at(model, 0.01 * frame).vertices)
    assert len(results.history("tip").time) == frames
    assert len(results.energy["kinetic"]) == frames
    assert len(results.steps["step"]) == frames - 1
    assert results.report is None


def check_for_others(path: Path) -> None:
    """Assert that HDF5 alone reads the file, as viewers do, without completing anything."""
    with h5py.File(path, "r") as file:
        grid = file["VTKHDF"]
        frames = int(grid["Steps"].attrs["NSteps"])
        assert frames - 1 <= len(grid["Steps/Values"]) <= frames
        assert len(grid["Points"]) >= frames * int(grid["NumberOfPoints"][0])
        np.testing.assert_allclose(file["frames"][:frames]["time"], 0.01 * np.arange(frames))
        for name in [*POINT_ARRAYS, *CELL_ARRAYS, "Steps/PartOffsets", f"Steps/{MOVING}"]:
            assert np.isfinite(grid[name][:]).all()
        for name in ("frames", "contacts", "energy", "steps", "history/tip"):
            assert len(file[name][:]) == len(file[name])


@pytest.mark.parametrize(
    ("build", "at", "first", "last"),
    [(three_blocks, moved, 1, 3), (three_blocks, moved, 39, 41), (many_blocks, shifted, 63, 66)],
    ids=["first frames", "new chunks", "new branches of the indexes"],
)
def test_every_state_of_the_file_is_read(
    tmp_path: Path,
    disk: Disk,
    build: Callable[[], Model],
    at: Callable[[Model, float], State],
    first: int,
    last: int,
):
    model, path = build(), tmp_path / "out.vtkhdf"
    begin = 0
    for frames in write_frames(model, at, path):
        if frames == first:
            begin = len(disk.changes)
        if frames == last:
            break
    changes, torn = list(disk.changes), tmp_path / "torn.vtkhdf"
    seen = []
    for state in states(disk.before, changes, begin):
        torn.write_bytes(state)
        check_for_others(torn)
        results = read_results(torn)
        seen.append(len(results.times))
        check(results, model, at)
    assert len(seen) > 100
    assert seen == sorted(seen)
    assert set(seen) == set(range(first, last + 1))


def test_a_frame_that_finds_no_room_is_written_when_there_is_some(tmp_path: Path, disk: Disk):
    model, path = three_blocks(), tmp_path / "out.vtkhdf"
    recorder = RunRecorder(model, output=path)
    recorder.start(moved(model, 0.0))
    result = step_result(model, 0.1)
    recorder.step(result, 0.1)
    for room in (path.stat().st_size, path.stat().st_size + 3000):
        disk.room = room
        with pytest.raises(CaseError, match="No space left"):
            recorder.frame(result.state, result.contacts, result.response)
        assert len(read_results(path).times) == 1
    disk.room = 10**12
    results = read_results(recorder.finish(report(result.state)).output)
    np.testing.assert_array_equal(results.times, [0.0, 0.1])
    np.testing.assert_array_equal(results.vertices(-1), result.state.vertices)
    assert len(results.contacts(-1)) == 2


def test_a_run_that_is_given_up_leaves_its_frames(tmp_path: Path):
    model, path = three_blocks(), tmp_path / "out.vtkhdf"
    frames = write_frames(model, moved, path)
    for number in frames:
        if number == 3:
            break
    size = path.stat().st_size
    frames.close()
    assert path.stat().st_size == size
    check(read_results(path), model, moved)


def test_a_file_with_half_a_frame_that_may_not_be_written(tmp_path: Path, disk: Disk):
    model, path = three_blocks(), tmp_path / "out.vtkhdf"
    for frames in write_frames(model, moved, path):
        if frames == 2:
            break
    with_journal = max(place for place, data in disk.changes if data is None)
    torn = next(s for s in states(disk.before, disk.changes, 0) if len(s) == with_journal)
    path.write_bytes(torn)
    disk.room = 0
    with pytest.raises(CaseError, match="killed while it wrote a frame") as caught:
        read_results(path)
    assert "writable" in caught.value.remedy


# --- the journalled file by itself ---------------------------------------------------------------


def test_changes_are_seen_at_once_and_take_effect_together(tmp_path: Path):
    path = tmp_path / "file"
    path.write_bytes(b"0123456789")
    file = JournalledFile(path)
    random, expected = np.random.default_rng(3), bytearray(b"0123456789")
    for _ in range(40):
        committed = bytes(expected)
        for _ in range(random.integers(1, 12)):
            place, count = int(random.integers(0, len(expected) + 1)), int(random.integers(1, 30))
            data = random.bytes(count)
            file.seek(place)
            file.write(memoryview(data))
            expected[place : place + count] = data
            file.seek(0)
            assert file.read(len(expected) + 9) == expected
        assert path.read_bytes()[: len(committed)] == committed
        file.commit()
        assert path.read_bytes() == expected
    file.seek(0, os.SEEK_END)
    assert file.tell() == len(expected)
    file.close()


def test_a_commit_that_is_interrupted_is_completed_by_the_next(tmp_path: Path, disk: Disk):
    for stop in range(1, 7):
        path = tmp_path / f"file {stop}"
        path.write_bytes(b"a" * 100)
        file = JournalledFile(path)
        for place in (0, 40, 60, 100):
            file.seek(place)
            file.write(memoryview(b"b" * 10))
        disk.changes, disk.room = Interrupting(stop), 10**12
        with pytest.raises(KeyboardInterrupt):
            file.commit()
        disk.changes = []
        for place in (50, 100, 105):
            file.seek(place)
            file.write(memoryview(b"c" * 10))
        file.commit()
        file.close()
        expected = bytearray(b"a" * 100)
        for place, letter in [(0, b"b"), (40, b"b"), (60, b"b"), (50, b"c"), (100, b"c")]:
            expected[place : place + 10] = letter * 10
        assert path.read_bytes() == expected[:105] + b"c" * 10


class Interrupting(list[Change]):
    """Notes of changes that an interrupt comes into, instead of change number ``stop``."""

    def __init__(self, stop: int) -> None:
        super().__init__()
        self._stop = stop

    def append(self, change: Change) -> None:
        if len(self) + 1 == self._stop:
            raise KeyboardInterrupt
        super().append(change)


def test_a_file_is_left_alone_that_only_looks_as_if_it_had_a_journal(tmp_path: Path, disk: Disk):
    path = tmp_path / "file"
    path.write_bytes(b"a" * 100)
    file = JournalledFile(path)
    file.seek(0)
    file.write(memoryview(b"b" * 10))
    file.commit()
    with_journal = max(map(bytes, states(disk.before, disk.changes, 0)), key=len)
    for byte in range(100, len(with_journal)):
        spoiled = bytearray(with_journal)
        spoiled[byte] ^= 1
        path.write_bytes(spoiled)
        complete_journal(path)
        assert path.read_bytes() == spoiled
