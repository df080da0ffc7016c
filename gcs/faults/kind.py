"""What describes a kind of fault, and how its parameters are declared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

from pydantic import Field

from gcs.config import SystemConfig
from gcs.config.validate import strict

Direction = Literal["telemetry", "command", "both"]
Family = Literal["link", "timing", "values", "sensors", "world"]
Vehicles = tuple[int, ...] | None
Problem = tuple[str, str] | None
Check = Callable[[Any, SystemConfig, Vehicles], Problem]

T = TypeVar("T")


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    ``settings``: the dataclass of its parameters. ``direction``: what holds where a mission gives none; None: the kind
    has no direction. ``of_vehicles``: it disturbs vehicles, of which some may be named; else the world. ``bounded``:
    it must have a duration. ``check(settings, system, vehicles)``: the key and the reason of what cannot be, or None.
    """

    name: str
    family: Family
    settings: type[Any]
    summary: str
    direction: Direction | None
    of_vehicles: bool
    bounded: bool
    check: Check | None


KINDS: dict[str, Kind] = {}
"""All kinds by their names, in the order of their families; filled by :mod:`gcs.faults.kinds`."""


def kind(
    name: str,
    family: Family,
    *,
    direction: Direction | None = None,
    of_vehicles: bool = True,
    bounded: bool = False,
    check: Check | None = None,
) -> Callable[[type[T]], type[T]]:
    """Class decorator for the parameters of a kind; the docstring is what people read."""

    def register(cls: type[T]) -> type[T]:
        summary = " ".join((cls.__doc__ or "").split())
        KINDS[name] = Kind(name, family, strict(cls), summary, direction, of_vehicles, bounded, check)
        return cls

    return register


def parameter(description: str, unit: str = "", **bounds: Any) -> Any:
    """Return the annotation of a parameter: description, unit, and pydantic's bounds (ge, le, ...)."""
    return Field(description=description, json_schema_extra={"unit": unit}, **bounds)
