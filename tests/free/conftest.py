"""Fixtures of the tests of free vehicles."""

from collections.abc import Iterator

import pytest
from free_bench import FreeBench


@pytest.fixture
def bench(standing: FreeBench) -> FreeBench:
    """A vehicle that stands, and has measured where."""
    return standing


@pytest.fixture
def flying() -> Iterator[FreeBench]:
    """A vehicle that holds at a height of 5 m."""
    with FreeBench() as bench:
        bench.take_off()
        yield bench
