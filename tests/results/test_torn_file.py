"""Every state that a kill can leave a result file in, one after the other."""

from __future__ import annotations

import dataclasses
import io
import os
import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

from clast.errors import CaseError
from clast.inputs.builder import InputBuilder
from clast.model.model import Model
from clast.model.state import State, initial_state
from clast.results import Results, RunRecorder, read_results
from clast.results.journal import JournalledFile, read_journal
from clast.results.page_checksums import PAGE, packed
from clast.results.result_writer import MOVING
from clast.results.schema import MOVING_FIELDS
from scenes.recorded_run import moved, report, step_result, three_blocks

KEPT = 4096
"""Linux stops a write at the end of a page when the process is killed."""

Change = tuple[int, bytes | None]
"""A place and the bytes written there; None: the file was cut there, or lengthened."""


class Disk:
    """Files opened for writing through it, every change noted."""

    def __init__(self) -> None:
        self.changes: list[Change] = []
        self.room = 10**12

    def open(self, file: int, mode: str, buffering: int) -> io.FileIO:
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

        return Watched(file, mode.replace("b", ""))


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    disk = Disk()
    monkeypatch.setattr("clast.results.output.open", disk.open, raising=False)
    return disk


def states(changes: list[Change], start: int, kept: int = KEPT) -> Iterator[bytearray]:
    """Yield the file as a kill can leave it, from change number ``start`` on."""
    file = bytearray()
    for number, (place, data) in enumerate(changes):
        file.extend(bytes(max(0, place - len(file))))
        if data is None:
            del file[place:]
        else:
            for cut in range(kept - place % kept, len(data), kept):
                file[place : place + cut] = data[:cut]
                if number >= start:
                    yield file
            file[place : place + len(data)] = data
        if number >= start:
            yield file


def many_blocks() -> Model:
    """528 squares: as many as need a chunk of the file for every frame."""
    builder = InputBuilder(title="many blocks")
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
        for name in [*(one.place for one in MOVING_FIELDS), "Steps/PartOffsets", f"Steps/{MOVING}"]:
            assert np.isfinite(grid[name][:]).all()
        # The first contacts and steps get an index where something else was: no viewer looks there.
        for name in ("frames", "energy", "history/tip"):
            assert len(file[name][:]) == len(file[name])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("build", "at", "first", "last"),
    [(three_blocks, moved, 1, 3), (three_blocks, moved, 39, 40), (many_blocks, shifted, 63, 65)],
    ids=["first frames", "new chunks", "new branches of the indexes"],
)
@pytest.mark.one_in(3)
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
    whole = {bytes(state) for state in states(changes, begin, kept=10**9)}
    for state in states(changes, begin):
        torn.write_bytes(state)
        # In the middle of a write HDF5's own checksum of a chunk is wrong, for a microsecond.
        if bytes(state) in whole:
            check_for_others(torn)
        results = read_results(torn)
        seen.append(len(results.times))
        check(results, model, at)
    # chunks of 2 kB: a file of a few blocks grows little, so that it has fewer states
    assert len(seen) > 50
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


def test_reading_a_file_with_half_a_frame_writes_nothing(tmp_path: Path, disk: Disk):
    model, path = three_blocks(), tmp_path / "out.vtkhdf"
    for frames in write_frames(model, moved, path):
        if frames == 2:
            break
    torn = [bytes(state) for state in states(disk.changes, 0)]
    half = next(state for state in reversed(torn) if has_journal(state, tmp_path))
    path.write_bytes(half)
    path.chmod(0o400)
    results = read_results(path)
    assert len(results.times) == 2
    check(results, model, moved)
    assert path.read_bytes() == half


def has_journal(state: bytes, folder: Path) -> bool:
    (folder / "state").write_bytes(state)
    with (folder / "state").open("rb", buffering=0) as file:
        return read_journal(file) is not None


# --- the journalled file by itself ---------------------------------------------------------------


def journalled(path: Path, content: bytes = b"", opened: Callable[..., io.FileIO] = open):
    """A journalled file with some content that counts."""
    path.touch()
    file = JournalledFile(opened(path, "r+b", buffering=0))
    file.write(memoryview(content))
    file.commit()
    return file


def test_changes_are_seen_at_once_and_take_effect_together(tmp_path: Path):
    path = tmp_path / "file"
    file = journalled(path, b"0123456789")
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
        sums = np.array([zlib.crc32(expected)], np.uint32)
        assert path.read_bytes() == expected + packed(sums, len(expected))
    file.seek(0, os.SEEK_END)
    assert file.tell() == len(expected)
    file.close()


def test_sums_of_many_pages_follow_every_change(tmp_path: Path):
    path, random = tmp_path / "file", np.random.default_rng(4)
    expected = bytearray(random.bytes(5 * PAGE // 2))
    file = journalled(path, bytes(expected))
    for _ in range(60):
        if random.random() < 0.3:
            size = int(random.integers(PAGE // 2, 4 * PAGE))
            file.truncate(size)
            del expected[size:]
            file.seek(0, os.SEEK_END)
            file.seek(int(random.integers(0, 2 * PAGE)), os.SEEK_CUR)
        else:
            file.seek(int(random.integers(0, len(expected))))
        place, data = file.tell(), random.bytes(int(random.integers(1, PAGE)))
        file.write(memoryview(data))
        file.commit()
        file.seek(0)
        content = file.read(10**6)
        assert content[: min(place, len(expected))] == expected[:place]
        assert content[place : place + len(data)] == data
        expected = bytearray(content)
        sums = [zlib.crc32(content[at : at + PAGE]) for at in range(0, len(content), PAGE)]
        assert path.read_bytes() == content + packed(np.array(sums, np.uint32), len(content))
    file.close()


def test_a_commit_that_is_interrupted_is_completed_by_the_next(tmp_path: Path, disk: Disk):
    for stop in range(1, 8):
        path = tmp_path / f"file {stop}"
        disk.changes, disk.room = [], 10**12
        file = journalled(path, b"a" * 100, disk.open)
        for place in (0, 40, 60, 100):
            file.seek(place)
            file.write(memoryview(b"b" * 10))
        disk.changes = Interrupting(stop)
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
        expected = expected[:105] + b"c" * 10
        sums = np.array([zlib.crc32(expected)], np.uint32)
        assert path.read_bytes() == expected + packed(sums, len(expected))


class Interrupting(list[Change]):
    """Notes of changes that an interrupt comes into, instead of change number ``stop``."""

    def __init__(self, stop: int) -> None:
        super().__init__()
        self._stop = stop

    def append(self, change: Change) -> None:
        if len(self) + 1 == self._stop:
            raise KeyboardInterrupt
        super().append(change)


def test_a_journal_that_only_looks_like_one_is_none(tmp_path: Path, disk: Disk):
    file = journalled(tmp_path / "file", b"a" * 100, disk.open)
    begin = len(disk.changes)
    file.seek(0)
    file.write(memoryview(b"b" * 10))
    file.commit()
    whole = max((bytes(state) for state in states(disk.changes, begin)), key=len)
    assert has_journal(whole, tmp_path)
    found = [byte for byte in range(len(whole)) if has_journal(spoiled(whole, byte), tmp_path)]
    assert found == list(range(len(path_content(tmp_path))))


def spoiled(content: bytes, byte: int) -> bytes:
    changed = bytearray(content)
    changed[byte] ^= 1
    return bytes(changed)


def path_content(folder: Path) -> bytes:
    """What is before the journal: the content and its checksums."""
    return (folder / "file").read_bytes()


RECORD, TRAILER = struct.Struct("<QQ"), struct.Struct("<QQI8s")


@pytest.mark.parametrize(
    "records",
    [
        RECORD.pack(0, 8)[:9],
        RECORD.pack(0, 8) + b"1234",
        RECORD.pack(0, 10**18) + b"1234",
        RECORD.pack(10**18, 4) + b"1234",
        RECORD.pack(96, 8) + b"12345678",
    ],
    ids=["half a record", "half its bytes", "endless", "far away", "beyond the end"],
)
def test_a_crafted_journal_is_none(tmp_path: Path, records: bytes):
    trailer = TRAILER.pack(100, len(records), zlib.crc32(records), b"clastjnl")
    assert not has_journal(b"a" * 100 + records + trailer, tmp_path)
