"""The commands: what they print, write and return."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

import clast
from clast.case.templates import TEMPLATES
from clast.results import read_results
from clast.run.progress import status_text
from clast.run.schedule import Progress
from scenes.command_line import clast_command, good

SHORT = ["--set", "time.end=0.005", "--set", "output.every=0.001"]
TOO_FAST = ["--set", "time.max_displacement=1e-4", "--set", "time.smallest_step=5e-4"]
"""The slider needs smaller steps than it may take after some hundredths of a second."""


def test_run_prints_tables_and_writes_the_file_named_after_the_case(incline):
    printed = good("run", incline, *SHORT)
    assert "the run reached its end" in printed
    assert "measured points at the end" in printed
    results = read_results("incline.vtkhdf")
    assert len(results.times) == 6
    assert clast.Case.from_toml(results.case_text).time.end == 0.005


def test_run_for_a_program(incline):
    content = json.loads(good("run", incline, *SHORT, "--json", "-o", "out.vtkhdf"))
    assert content["finished"] is True
    assert content["steps"] == 5
    assert content["output"].endswith("out.vtkhdf")
    u, v = content["measured_points"]["A"]["displacement"]
    assert u > 0.0 > v
    assert set(content) >= {"title", "time", "ledger", "seconds", "warnings", "outcome"}


def test_a_run_that_cannot_go_on_keeps_its_results(incline):
    result = clast_command("run", incline, *TOO_FAST)
    assert result.exit_code == 3
    assert "max_displacement" in result.stderr
    assert "incline.vtkhdf" in result.stderr
    assert "Traceback" not in result.output
    results = read_results("incline.vtkhdf")
    assert 0.0 < results.times[-1] < 0.1
    assert results.report is not None
    assert not results.report.finished


def test_an_interrupted_run_keeps_its_results(incline, monkeypatch):
    @contextmanager
    def impatient(_):
        def watch(progress: Progress) -> None:
            if progress.steps == 3:
                raise KeyboardInterrupt

        yield watch

    monkeypatch.setattr("clast.run.launch.shown", impatient)
    result = clast_command("run", incline, *SHORT)
    assert result.exit_code == 130
    assert "interrupted" in result.stderr
    assert read_results("incline.vtkhdf").times[-1] == pytest.approx(0.003)


@pytest.mark.parametrize(("cause", "said"), [(KeyboardInterrupt(), True), (ValueError(), False)])
def test_the_interrupt_key_while_a_kernel_is_loaded(incline, monkeypatch, cause, said):
    """Python makes a SystemError of it; any other SystemError stays what it is."""

    @contextmanager
    def loading(_):
        raise SystemError("returned a result with an exception set") from cause
        yield

    monkeypatch.setattr("clast.run.launch.shown", loading)
    result = clast_command("run", incline, *SHORT)
    assert ("interrupted" in result.stderr) == said
    assert (result.exit_code == 130) == said
    assert isinstance(result.exception, SystemError) != said


def test_warnings_go_to_stderr(incline):
    result = clast_command("run", incline, *SHORT, "--set", "rock.granite.density=2.7")
    assert "warning: rock 'granite': density is 2.7" in result.stderr
    assert "warning:" not in result.stdout


def test_check(incline):
    printed = good("check", incline)
    assert "incline, 50 m2" in printed
    assert "slider, 4.5 m2" in printed
    assert "nothing to object to" in printed


def test_check_for_a_program(incline):
    content = json.loads(good("check", incline, "--json"))
    assert content["blocks"] == 2
    assert content["mass"] == pytest.approx(54.5 * 2700.0)
    assert content["box"] == [0.0, 0.0, 10.0, 10.0]
    assert content["touching_pairs"] == 1
    assert content["unsupported"] == []
    assert content["warnings"] == []


@pytest.mark.parametrize(
    ("settings", "phrase"),
    [
        (["method.process=modified", "method.contact_law.normal_stiffness=1e12"], "p h2/m"),
        (["rock.granite.young=50"], "Pa"),
        (["rock.granite.density=2.7"], "kg/m3"),
        (["joint.default.friction_angle=0"], "frictionless"),
        (["time.max_displacement=1"], "max_displacement is 1 m"),
        (["method.critdis=1"], "critdis is 1 m"),
        (["fixed_point=[]"], "nothing is fixed"),
    ],
)
def test_check_warns(incline, settings, phrase):
    options = [part for setting in settings for part in ("--set", setting)]
    result = clast_command("check", incline, *options)
    assert result.exit_code == 0
    assert phrase in result.stderr


def test_info(incline):
    good("run", incline, *SHORT)
    printed = good("info", "incline.vtkhdf")
    assert "6, from 0 to 0.005 s" in printed
    content = json.loads(good("info", "incline.vtkhdf", "--json"))
    assert content["blocks"] == 2
    assert set(content["measured_points"]) == {"A"}


def test_plot(incline):
    pytest.importorskip("matplotlib")
    good("run", incline, *SHORT)
    good("plot", "incline.vtkhdf")
    assert Path("incline.png").stat().st_size > 1000
    good("plot", "incline.vtkhdf", "-o", "speed.png", "--frame", "2", "--field", "velocity")
    assert Path("speed.png").stat().st_size > 1000


def test_plot_as_wished(incline):
    matplotlib = pytest.importorskip("matplotlib.image")
    good("run", incline, *SHORT)
    wishes = ("--size", "16,12", "--dpi", "127", "--limits=-1e-3,2e-3", "--zoom", "0,5,5,10")
    good("plot", "incline.vtkhdf", "-o", "part.png", *wishes)
    assert matplotlib.imread("part.png").shape[:2] == (600, 800)


NOT_THERE = [
    ("--field", "displacment"),
    ("--frame", "77"),
    ("--limits", "1"),
    ("--limits", "2,1"),
    ("--limits", "nan,1"),
    ("--zoom", "1,2,3"),
    ("--zoom", "50,50,60,60"),
    ("--size", "wide"),
    ("--size", "16,12,3"),
    ("--dpi", "3"),
]


def test_plot_of_what_is_not_there(incline):
    good("run", incline, *SHORT)
    for option, value in NOT_THERE:
        result = clast_command("plot", "incline.vtkhdf", option, value)
        assert result.exit_code == 2, (option, value)
        assert result.stderr.startswith("error: ")


@pytest.mark.parametrize("template", TEMPLATES)
def test_new(template, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    told, case = good("new", "mine", "--template", template), clast.load("mine.toml")
    if case.rockfall is not None:
        assert "clast rockfall mine.toml" in told
        assert "200 rocks over 10 segments" in good("check", "mine.toml")
    else:
        assert "clast run mine.toml" in told
        assert case.model().block_count >= 2
    result = clast_command("new", "mine", "--template", template)
    assert result.exit_code == 2
    assert "already exists" in result.stderr


def test_a_case_called_as_a_template_is_made_from_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, template in {"heap": "heap", "arch.toml": "arch", "mine": "incline"}.items():
        assert f"from the template {template};" in good("new", name)
        written = (tmp_path / f"{name.removesuffix('.toml')}.toml").read_text("utf-8")
        assert written == TEMPLATES[template]
    assert "from the template wall;" in good("new", "dominoes", "--template", "wall")


def test_run_counts_the_notes_that_check_lists(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    good("new", "slope")
    run = ["run", "slope.toml", *(f"--set=stage.{k}.time=0.002" for k in (1, 2, 3))]
    listed, short, long = good("check", "slope.toml"), good(*run), good(*run, "--verbose")
    assert all("wets" in text for text in (listed, long)) and "wets" not in short
    assert "notes on the model, which clast check lists: 2" in short
    assert "normal_stiffness = " in short


AFTER_A_WARMUP = """
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.compute.compilation import COMPILATION
for process in ("modified", "open-close", "convex"):
    for law in ("penalty", "augmented-lagrangian"):
        choices = [f"method.process={process}", f"method.contact_law.name={law}"]
        run = Case.from_toml(INCLINE, ["time.end=0.003", *choices]).run()
        assert "compilation" not in run.report.seconds
print(COMPILATION.kernels)
"""


@pytest.mark.slow
def test_after_a_warmup_nothing_is_left_to_compile():
    assert "kernels are ready" in good("warmup")
    done = run_python("-c", AFTER_A_WARMUP)
    assert (done.returncode, done.stdout.strip()) == (0, "0"), done.stderr


def test_verify():
    printed = good("verify", "patch", "--quick")
    assert "tolerance" in printed
    assert "0 missed" in printed


def test_verify_for_a_program(tmp_path):
    content = json.loads(good("verify", "patch", "--quick", "--json", "--report", tmp_path))
    assert content["passed"] is True
    assert {"problem", "computed", "exact", "verdict"} <= set(content["rows"][0])
    assert (tmp_path / "verification.md").exists()


def test_verify_fails_where_a_tolerance_is_missed(monkeypatch):
    monkeypatch.setattr("clast.verification.misses", list)
    assert clast_command("verify", "patch", "--quick").exit_code == 1


def run_python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=False, timeout=60
    )


@pytest.mark.slow
def test_version_as_a_module():
    done = run_python("-m", "clast", "--version")
    assert done.returncode == 0
    assert done.stdout.strip() == f"clast {clast.__version__}"


@pytest.mark.slow
def test_errors_as_a_module(tmp_path):
    done = run_python("-m", "clast", "run", str(tmp_path / "nothing.toml"))
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")


@pytest.mark.slow
def test_help_starts_without_loading_anything_heavy():
    code = (
        "import sys, clast.cli.commands; "
        "heavy = {'numba', 'numpy', 'scipy', 'h5py', 'pydantic', 'shapely',"
        " 'matplotlib'} & set(sys.modules); sys.exit(str(heavy) if heavy else 0)"
    )
    done = run_python("-c", code)
    assert done.returncode == 0, done.stderr


NOT_FOR_CHECK = (
    "numba.np.polynomial",  # what compiles, not what loads kernels
    *("h5py", "matplotlib", "ezdxf", "PIL", "scipy.linalg", "scipy.signal", "scipy.sparse"),
    *("scipy.optimize", "scipy.stats", "scipy.spatial", "scipy.interpolate", "numpy.testing"),
    *("rich.progress", "rich.live", "concurrent.futures", "unittest", "http.client"),
    *("clast.results", "clast.rockmass", "clast.studies", "clast.verification"),
    *("clast.pictures.plot", "clast.exports.vtu", "clast.run.simulate"),
)
"""What `clast check` of blocks that are given does not need, and would wait for."""


@pytest.mark.slow
def test_a_check_loads_only_what_it_needs(incline):
    code = (
        "import atexit, sys; from clast.cli.commands import main;"
        f" sys.argv = ['clast', 'check', {str(incline)!r}];"
        f" atexit.register(lambda: print(*(set({NOT_FOR_CHECK!r}) & sys.modules.keys()))); main()"
    )
    done = run_python("-c", code)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-2:] == ["nothing to object to", ""]


@pytest.mark.slow
def test_help_is_printed_without_rich():
    code = (
        "import atexit, sys; from clast.cli.commands import main; sys.argv = ['clast', '--help'];"
        " atexit.register(lambda: print('rich' in sys.modules)); main()"
    )
    done = run_python("-c", code)
    assert done.returncode == 0, done.stderr
    assert "warmup" in done.stdout
    assert done.stdout.splitlines()[-1] == "False"


def test_python_runs_a_case_and_watches_it(incline, capsys):
    seen: list[Progress] = []
    case = clast.Case.from_toml(incline.read_text(), ["time.end=0.005"])
    run = case.run(progress=seen.append)
    assert [progress.steps for progress in seen] == [1, 2, 3, 4, 5]
    assert run.history("A").displacement.shape == (6, 2)
    assert run.final.vertices.shape == (6, 2)
    assert run.output is None
    assert capsys.readouterr().out == ""


def test_progress_is_silent_where_there_is_no_terminal(incline, capsys):
    clast.Case.from_toml(incline.read_text(), ["time.end=0.002"]).run()  # compilation would be said
    clast.Case.from_toml(incline.read_text(), ["time.end=0.002"]).run(progress=True)
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


def test_status_line():
    progress = Progress(time=0.5, end=2.0, step=1e-3, steps=500, contacts=42, penetration=1e-5)
    text = status_text(progress, speed=0.001)
    assert text == "t 0.5 of 2 s  step 0.001 s  42 contacts  0.001 s/s  0:25:00 left"


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.one_in(3)
def test_signals_end_a_run_and_keep_its_results(incline, number):
    command = [sys.executable, "-m", "clast", "run", str(incline), "--set", "time.end=1e3"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # tests that run in the background may have been told to ignore it, and hand that on
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 60.0
    while not Path("incline.vtkhdf").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.2)
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 128 + number, said
    assert "interrupted" in said
    results = read_results("incline.vtkhdf")
    assert results.report.outcome in said
    assert results.times[-1] == results.steps["time"][-1] > 0.0


def test_impossible_numbers_of_threads_are_refused(incline):
    for number in ("0", "100000", "many"):
        refused = clast_command("run", incline, "--threads", number)
        assert refused.exit_code == 2
        assert "--threads" in refused.output


def test_schema():
    assert json.loads(good("schema"))["properties"]["time"]
