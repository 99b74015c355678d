"""No digit on a page that is not known: numbers are held against those of the result file."""

import re

import numpy as np
import pytest

import clast
from clast.pictures.page.frame_data import NOISE
from scenes.browsers import settled, until

pytestmark = pytest.mark.parametrize("browser", ["canvas"], indirect=True)  # no pixels
FACTORS = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9, "": 1.0}
FIELDS = {
    "Displacement": "displacement",
    "Velocity": "velocity",
    "Rotation": "rotation",
    "Stress σxx": "sigma_xx",
    "Stress σyy": "sigma_yy",
    "Shear stress σxy": "sigma_xy",
    "Largest principal stress σ1": "sigma_1",
    "Smallest principal stress σ3": "sigma_3",
}


@pytest.fixture(scope="module")
def dropped(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    """Return a run in which one block strikes fast while others creep or rest.

    Blocks are no squares and deform, so that centroids are not the means of their vertices.
    """
    builder = clast.ModelBuilder(title="Dropped", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=2e8, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    table = [(-6, -1), (6, -1), (6, 0), (-6, 0)]
    builder.block(name="table", vertices=table, fixed=True)
    builder.block(name="heap", vertices=[(-3, 0), (-1, 0), (-1.5, 1), (-2.8, 1.6)])
    builder.block(name="under", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="drop", vertices=[(0.1, 3.5), (0.9, 3.5), (0.9, 4.1), (0.3, 4.4)])
    builder.block(name="still", vertices=[(3, 0), (4, 0), (4, 1), (3, 1)])
    path = tmp_path_factory.mktemp("dropped") / "dropped.vtkhdf"
    return clast.simulate(builder.build(), step=2e-3, end=1.0, every=0.05, output=path)


def read(text):
    """Return a number and how far it may be off by what is written, in SI units; degrees."""
    text = text.replace("−", "-")
    found = re.fullmatch(r"(-?[\d.e-]+)(?: ± ([\d.e-]+))?(°| [nµmkMG]?)(m/s|m|Pa|N/m|)", text)
    assert found, text
    value, bound, prefix, unit = found.groups()
    factor = 1.0 if prefix == "°" or not unit else FACTORS[prefix.strip()]
    if bound is None:
        # half of the last digit, and the tenth that it may be off; zeros at the end are not written
        digits, _, power = value.partition("e")
        bound = 0.6 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
    return factor * float(value), factor * float(bound)


def true_value(run, field, frame, block):
    if field == "displacement":
        return np.hypot(*(run.field(f"displacement_{axis}", frame)[block] for axis in "xy"))
    if field == "velocity":
        return np.hypot(*(run.field(f"velocity_{axis}", frame)[block] for axis in "xy"))
    if field == "rotation":
        return np.degrees(run.field("rotation", frame)[block])
    xx, yy, xy = (run.field(f"sigma_{part}", frame)[block] for part in ("xx", "yy", "xy"))
    radius = np.hypot(0.5 * (xx - yy), xy)
    principal = {"sigma_1": 0.5 * (xx + yy) + radius, "sigma_3": 0.5 * (xx + yy) - radius}
    return {"sigma_xx": xx, "sigma_yy": yy, "sigma_xy": xy, **principal}[field]


def rows_of(page, frame, **chosen):
    """Return the rows of text of what is chosen in a frame."""
    rows = page.evaluate(
        "(state) => modules.chosen.numbersOfChosen(clastPage.run, state)[1]",
        {"frame": frame, "chosen": -1, "joint": None, **chosen},
    )
    # behind the comma: which sign of stresses is positive
    return {label.partition(",")[0]: text for label, text in rows}


def test_numbers_of_blocks_are_those_of_the_file_in_the_digits_shown(opened, dropped):
    page = opened(dropped)
    frames = len(dropped.times)
    slowest = 1.0
    for frame in (1, frames // 2, frames - 1):
        for block in range(len(dropped.block_name)):
            rows = rows_of(page, frame, chosen=block)
            for label, field in FIELDS.items():
                said, off = read(rows[label])
                true = true_value(dropped, field, frame, block)
                assert abs(said - true) <= off + 1e-15, (frame, block, label, rows[label], true)
                if label == "Velocity" and 0.0 < true < slowest:
                    slowest = true
                    # what lies below the quantum is told as such, not as a number of four digits
                    assert said == 0.0 or off > 0.0
    # the fixture does have speeds far below the quantum
    assert slowest < 0.01 * page.evaluate("clastPage.run.fields.velocity_y.step")


def test_numbers_of_joints_are_those_of_the_file_in_the_digits_shown(opened, dropped):
    page = opened(dropped)
    columns = {
        "Normal force": "normal_force",
        "Shear force": "shear_force",
        "Slip": "slip",
        "Opening": "opening",
    }
    for frame in (len(dropped.times) // 2, len(dropped.times) - 1):
        table = dropped.contacts(frame)
        for row in range(len(table)):
            joint, at = page.evaluate(
                """([k, frame]) => {
                  const { run } = clastPage;
                  const first = run.contacts.first[frame];
                  const [x, y] = [run.contacts.x[first + k], run.contacts.y[first + k]];
                  const joint = modules.joints.jointAt(run, frame, x, y, 1);
                  return [joint, modules.joints.rowOf(run, joint, frame) - first];
                }""",
                [row, frame],
            )
            rows = rows_of(page, frame, joint=joint)
            for label, column in columns.items():
                said, off = read(rows[label])
                assert abs(said - table[column][at]) <= off + 1e-15, (label, rows[label])
            friction = rows["Mobilised friction"]
            if friction != "–":
                said, off = read(friction)
                normal, shear = table.normal_force[at], abs(table.shear_force[at])
                assert abs(said - np.degrees(np.arctan2(shear, normal))) <= off, friction


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (5e-9, 6.14e-6, "0 ± 7 µm/s"),
        (12.28e-6, 6.14e-6, "12 ± 7 µm/s"),
        (150.4e-6, 6.14e-6, "150 ± 7 µm/s"),
        (1.23456, 6.14e-6, "1.235 m/s"),
        (-1.23456e-2, 6.14e-6, "−12.3 mm/s"),
        (-1.23456e-3, 6.14e-6, "−1.235 ± 0.007 mm/s"),
        (0.123456, 6.14e-6, "123.5 mm/s"),
        (0.0, 0.0, "0 m/s"),
        (1.5, 0.0, "1.5 m/s"),
    ],
)
def test_how_a_number_is_written(opened, wall, value, error, text):
    page = opened(wall(2, 2))
    found = page.evaluate("([v, e]) => modules.colours.withUnit(v, 'm/s', 4, e)", [value, error])
    assert found == text


def test_curves_and_tables_of_a_block_have_the_digits_that_are_known(opened, dropped, tmp_path):
    last = len(dropped.times) - 1
    page = opened(dropped, address=f"#t={dropped.times[last]}&field=velocity")
    page.evaluate("clastPage.choose({ chosen: 4 })")
    settled(page)
    error = page.evaluate("clastPage.run.error('velocity')")
    until(page, "document.querySelectorAll('.u-legend .u-value')[1]?.innerText")
    said = page.locator(".u-legend .u-value").all_inner_texts()[1]
    assert said.startswith("0 ± ")
    with page.expect_download() as taken:
        page.click("[data-part=csv]")
    taken.value.save_as(tmp_path / "block.csv")
    lines = (tmp_path / "block.csv").read_text("utf-8").splitlines()
    assert float(lines[0].split(" ± ")[1].strip('"')) == pytest.approx(error, rel=0.5)
    found = np.array([float(line.split(",")[1]) for line in lines[1:]])
    true = [true_value(dropped, "velocity", frame, 4) for frame in range(last + 1)]
    assert np.abs(found - true).max() <= 1.6 * error
    assert found[-1] == 0.0


def test_rest_has_no_colour_of_its_own(opened, dropped):
    # in the last frame all blocks move slower than the quantum, or a few times that
    page = opened(dropped, address="#field=velocity_y&layers=")
    fastest = max(true_value(dropped, "velocity", -1, block) for block in range(5))
    quantum = page.evaluate("clastPage.run.fields.velocity_y.step")
    low, high = page.evaluate("['low', 'high'].map((end) => Number(clastPage.$(end).value))")
    assert max(-low, high) == pytest.approx(max(5.0 * quantum, fastest), rel=0.5)
    settled(page)


def test_noise_of_a_direction_in_which_nothing_moves_is_zero(opened, tmp_path):
    builder = clast.ModelBuilder(title="Column", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=2e9, poisson=0.0, density=2500.0)
    builder.block(name="foot", vertices=[(0, -1), (1, -1), (1, 0), (0, 0)], fixed=True)
    for k in range(3):
        square = [(0, k), (1, k), (1, k + 1), (0, k + 1)]
        builder.block(name=f"stone {k}", vertices=square)
    run = clast.simulate(builder.build(), step=1e-3, end=0.02, output=tmp_path / "column.vtkhdf")
    noise = [np.abs(run.field(name, -1)).max() for name in ("velocity_x", "sigma_xy")]
    kinds = [np.abs(run.field(name, -1)).max() for name in ("velocity_y", "sigma_yy")]
    assert all(small < 0.1 * NOISE * large for small, large in zip(noise, kinds, strict=True))
    page = opened(run)
    for field in ("velocity_x", "sigma_xy", "rotation", "displacement_x"):
        values = page.evaluate(
            "(field) => Array.from(clastPage.run.values(field, clastPage.run.frameCount - 1))",
            field,
        )
        assert not np.any(values), field
