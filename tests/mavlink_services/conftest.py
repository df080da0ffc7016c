"""Fixtures of the tests of MAVLink services."""

from __future__ import annotations

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import MissionBench


@pytest.fixture
def free() -> MissionBench:
    """A vehicle with plans of its own, and a ground that it has heard."""
    bench = MissionBench()
    bench.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    return bench
