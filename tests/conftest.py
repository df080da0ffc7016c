"""Fixtures that several modules share."""

from __future__ import annotations

import pymavlink.dialects.v20.common as mavlink
import pytest
from hypothesis import settings
from vehicle_bench import Bench

# The same examples at every run, however busy the machine is.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.run(0.1)
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    bench.run(0.1)
    return bench


@pytest.fixture
def flying(bench: Bench) -> Bench:
    bench.fly()
    return bench
