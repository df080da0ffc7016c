"""Fixtures of the tests of free vehicles."""

from collections.abc import Iterator

import pytest
from free_bench import FreeBench


@pytest.fixture
def bench() -> Iterator[FreeBench]:
    """A vehicle that stands, and has measured where."""
    with FreeBench() as bench:
        bench.run(0.5)
        yield bench


@pytest.fixture
def flying() -> Iterator[FreeBench]:
    """A vehicle that holds at a height of 5 m."""
    with FreeBench() as bench:
        bench.take_off()
        yield bench
