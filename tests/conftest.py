"""Fixtures that several modules share."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from gcs.numerics import choose_kernels

choose_kernels()  # before numpy is imported: what runs in this process gives the figures of a flight on any processor

import pymavlink.dialects.v20.common as mavlink  # noqa: E402
from free_bench import FreeBench  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from vehicle_bench import Bench  # noqa: E402

# The same examples at every run, however busy the machine is.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


def pytest_collection_finish() -> None:
    """Pass over what the imports have made in collections of garbage."""
    gc.freeze()


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


@pytest.fixture
def standing() -> Iterator[FreeBench]:
    """A free vehicle that stands, and has measured where."""
    with FreeBench() as bench:
        bench.run(0.5)
        yield bench


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[str]]:
    """Texts in each picture that is written, by its file name: titles, labels, legends, numbers in cells."""
    texts: dict[str, list[str]] = {}
    save = Figure.savefig

    def savefig(figure: Figure, file: Path, **options: object) -> None:
        save(figure, file, **options)
        found = figure.findobj(lambda artist: isinstance(artist, Text) and artist.get_visible())
        texts[Path(file).name] = [text.get_text() for text in found if text.get_text()]

    monkeypatch.setattr(Figure, "savefig", savefig)
    return texts
