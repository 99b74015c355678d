"""Settings shared by all tests: tiers by folder, what is drawn, how long a core test may take.

Hypothesis draws the same examples on every run.  What decides about tiers is in scenes/tiers.py.
"""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from _pytest.runner import runtestprotocol
from hypothesis import HealthCheck, settings

from scenes import tiers

settings.register_profile(
    "repeatable",
    derandomize=True,
    database=None,
    deadline=None,  # the first example compiles kernels
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("repeatable")

TIER = pytest.StashKey[str]()
SECONDS = pytest.StashKey[float]()
OWN_SECONDS = pytest.StashKey[float]()


def pytest_addoption(parser: Any) -> None:
    group = parser.getgroup("tiers of clast")
    group.addoption(
        "--long-one-in",
        type=int,
        default=1,
        metavar="N",
        help="of the long tests, run one in N, drawn by the hash of the commit",
    )
    group.addoption(
        "--undrawn",
        action="store_true",
        help="run all tests of which otherwise some are drawn by the hash of the commit",
    )
    group.addoption(
        "--no-core-limit",
        action="store_true",
        help="let core tests take as long as they like",
    )
    group.addoption(
        "--longest-first",
        action="store_true",
        help="begin with the tier and the files that take longest, for several processes",
    )


def pytest_configure(config: Any) -> None:
    # tests interrupt runs; a shell has its background jobs ignore the interrupt key
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    for tier, meaning in tiers.TIERS.items():
        config.addinivalue_line("markers", f"{tier}: {meaning}; given by the folder")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: Any, log: Any) -> Any:
    """Give files to processes as ``--dist loadfile`` does, and some tests one by one."""
    from xdist.scheduler import LoadFileScheduling

    if config.option.dist != "loadfile":
        return None
    scheduler = LoadFileScheduling(config, log)
    scheduler._split_scope = tiers.one_process
    return scheduler


def pytest_ignore_collect(collection_path: Path, config: Any) -> bool | None:
    """Leave files alone that have no tests of the only tier that is asked for."""
    asked = config.option.markexpr
    if asked in tiers.TIERS and collection_path.match("test_*.py"):
        return not tiers.can_have(collection_path, asked) or None
    return None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: Any, items: list[Any]) -> None:
    """Mark tests by their tier, in the order of the tiers, and leave out those not drawn."""
    for item in items:
        tier = tiers.tier_of(item.path)
        if item.get_closest_marker("slow"):
            tier = tiers.lifted(tier)
        item.stash[TIER] = tier
        item.add_marker(tier)
    order = list(tiers.TIERS)
    if config.option.longest_first:
        items.sort(key=lambda item: tiers.longest_first(item.path, item.stash[TIER]))
    else:
        items.sort(key=lambda item: order.index(item.stash[TIER]))
    out = [item for item in items if not _is_drawn(config, item)]
    config.hook.pytest_deselected(items=out)
    left = set(out)
    items[:] = [item for item in items if item not in left]


def _is_drawn(config: Any, item: Any) -> bool:
    if config.option.undrawn:
        return True
    drawn = item.get_closest_marker("one_in")
    one_in = drawn.args[0] if drawn else 1
    if item.stash[TIER] == "long":
        one_in = max(one_in, config.option.long_one_in)
    return tiers.drawn(item.nodeid, one_in, tiers.commit())


# Time of core tests ------------------------------------------------------------------------------


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: Any, nextitem: Any) -> bool | None:
    """Run a core test a second time where it took too long, and fail it if it does so again.

    The first test that uses a kernel loads or compiles it.  The time is that of this thread: it
    does not grow when others compute, as that of threads that wait for each other (BLAS) does.  See
    scenes/tiers.py for what is allowed.
    """
    if item.stash[TIER] != "core" or item.config.option.no_core_limit:
        return None
    hook = item.ihook
    hook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    reports = runtestprotocol(item, nextitem=nextitem, log=False)
    if _fits(reports) and tiers.too_long(item.stash[OWN_SECONDS]):
        item._initrequest()
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
        if said := tiers.too_long(item.stash[OWN_SECONDS]):
            _fail(reports, said)
    for report in reports:
        hook.pytest_runtest_logreport(report=report)
    hook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_call(item: Any) -> Iterator[None]:
    start, own = tiers.processor_time(), time.thread_time()
    try:
        return (yield)
    finally:
        item.stash[SECONDS] = tiers.processor_time() - start
        item.stash[OWN_SECONDS] = time.thread_time() - own


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: Any, call: Any) -> Iterator[None]:
    """Send tier and processor time along with a report."""
    report: Any = yield
    if call.when == "call":
        report.user_properties.append(("tier", item.stash[TIER]))
        report.user_properties.append(("processor_seconds", item.stash[SECONDS]))
    return report


def _fits(reports: list[Any]) -> bool:
    """Return whether a test passed, so that its time is the one thing to look at."""
    return all(report.passed for report in reports)


def _fail(reports: list[Any], said: str) -> None:
    for report in reports:
        if report.when == "call" and report.passed:
            report.outcome, report.longrepr = "failed", f"{report.nodeid} {said}"


# Summary -----------------------------------------------------------------------------------------


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say of each tier how many tests there were and how much processor time their calls took.

    And which files are so long that they had better begin before others.
    """
    count: Counter[str] = Counter()
    seconds: Counter[str] = Counter()
    files: Counter[str] = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            known = dict(getattr(report, "user_properties", ()))
            if hasattr(report, "duration"):
                files[report.nodeid.split("::")[0].removeprefix("tests/")] += report.duration
            if "tier" in known and report.when == "call":
                count[known["tier"]] += 1
                seconds[known["tier"]] += known["processor_seconds"]
    for tier in tiers.TIERS:
        if count[tier]:
            terminalreporter.write_line(
                f"{tier}: {count[tier]} tests, {seconds[tier]:.0f} s of processor time"
            )
    for name, taken in files.items():
        in_turn = terminalreporter.config.option.longest_first
        if in_turn and taken > tiers.LONG_FILE and name not in tiers.LONGEST:
            terminalreporter.write_line(f"{name} took {taken:.0f} s: see LONGEST in tiers.py")
