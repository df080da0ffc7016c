"""A plugin for pytest: the fixture ``fly_with_faults``, for tests that fly missions with faults.

Nothing but pytest is imported until a test requests the fixture.
"""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Generator
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from gcs.campaign.testing import FaultFlights

_FLIGHTS = pytest.StashKey["FaultFlights"]()
_FAILED = pytest.StashKey[bool]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option for the folder of failed tests' run folders."""
    parser.getgroup("cooplift").addoption(
        "--fault-runs", metavar="DIR", default="fault-test-failures",
        help="where the run folders of failed tests with faults are kept (default: fault-test-failures)",
    )  # fmt: skip


@pytest.fixture
def fly_with_faults(request: pytest.FixtureRequest) -> Generator[FaultFlights, None, None]:
    """Call :func:`gcs.fly`: ``fly_with_faults("hover.toml", [fault, ...], seed=3)``."""
    from gcs.campaign.folder import digest, plain
    from gcs.campaign.testing import FaultFlights

    node = request.node
    here = request.config.invocation_params.dir
    root = here / request.config.getoption("fault_runs")
    folder = root / f"{plain(node.name)[:80]}-{digest(node.nodeid)}"
    shutil.rmtree(folder, ignore_errors=True)  # of an earlier run of the same test
    node.stash[_FLIGHTS] = flights = FaultFlights(folder, beside=node.path.parent)
    yield flights
    if not node.stash.get(_FAILED, False):
        shutil.rmtree(folder, ignore_errors=True)
        with contextlib.suppress(OSError):  # others have failed
            root.rmdir()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Report how the flights of a failed test are repeated."""
    report = yield
    flights = item.stash.get(_FLIGHTS, None)
    if flights is not None and report.failed:
        item.stash[_FAILED] = True
        report.sections.append(("flights with faults", "\n".join(flights.log)))
    return report
