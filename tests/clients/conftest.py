"""Swarms that client programs fly."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from client_swarm import ClientSwarm, client_swarm


@pytest.fixture(scope="module")
def free_swarm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClientSwarm]:
    """Two vehicles without a payload."""
    with client_swarm(tmp_path_factory.mktemp("free") / "run", "--free", "--vehicles", "2") as swarm:
        yield swarm


@pytest.fixture(scope="module")
def team(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClientSwarm]:
    """Three vehicles that carry a payload."""
    with client_swarm(tmp_path_factory.mktemp("team") / "run", "--vehicles", "3") as swarm:
        yield swarm
