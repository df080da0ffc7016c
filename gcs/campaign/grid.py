"""A grid of settings: each flight of a campaign with every combination of their values."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from gcs.campaign.flight import FlightPlan
from gcs.campaign.folder import digest, plain
from gcs.config import SystemConfig
from gcs.config.overrides import with_settings

Grid = Mapping[str, Sequence[Any]]
"""Values of each setting, by its path."""


def combinations(grid: Grid) -> Iterator[dict[str, Any]]:
    """Yield every combination of the values, as settings by path."""
    return (dict(zip(grid, values, strict=True)) for values in product(*grid.values()))


def check_grid(system: SystemConfig, grid: Grid) -> None:
    """Raise :class:`gcs.errors.UnusableInput` for settings that ``system`` cannot have."""
    for settings in combinations(grid):
        with_settings(system, settings)


def variants(plan: FlightPlan, grid: Grid) -> Iterator[FlightPlan]:
    """Yield a flight with every combination of settings; without any, as it is."""
    for settings in combinations(grid):
        label = " ".join(f"{path}={json.dumps(value)}" for path, value in settings.items())
        name = f"{plan.name}-{plain(label)[:60]}-{digest(label)}" if label else plan.name
        yield replace(plan, name=name, settings=settings, labels={**plan.labels, "variant": label})
