"""Kinds of fault and the declaration of their parameters."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar, dataclass_transform

from pydantic import Field

from gcs.config import SystemConfig
from gcs.config.validate import strict

Direction = Literal["telemetry", "command", "both"]
Family = Literal["link", "timing", "values", "sensors", "world"]
Vehicles = tuple[int, ...] | None
Problem = tuple[str, str] | None


class FaultSettings:
    """Base of the parameters of a kind."""

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Return the key and the reason of what ``system`` or the named ``vehicles`` do not allow; None: nothing."""
        return None


S = TypeVar("S", bound=FaultSettings)


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    ``settings``: the dataclass of its parameters. ``direction``: what holds where a mission gives none; None: the kind
    has no direction. ``of_vehicles``: it disturbs vehicles, of which some may be named; else the world. ``bounded``:
    it must have a duration. ``aliases``: other people's names of the same, which an error message understands.
    """

    name: str
    family: Family
    settings: type[FaultSettings]
    summary: str
    direction: Direction | None
    of_vehicles: bool
    bounded: bool
    aliases: tuple[str, ...] = ()


KINDS: dict[str, Kind] = {}
"""All kinds by their names, in the order of their families; filled by :mod:`gcs.faults.kinds`."""


@dataclass_transform(frozen_default=True, kw_only_default=True)
def kind(
    name: str,
    family: Family,
    aliases: Iterable[str],
    *,
    direction: Direction | None = None,
    of_vehicles: bool = True,
    bounded: bool = False,
) -> Callable[[type[S]], type[S]]:
    """Class decorator that makes the parameters of a kind a dataclass; the docstring is its text in the listings."""

    def register(cls: type[S]) -> type[S]:
        settings = strict(dataclass(frozen=True, kw_only=True)(cls))
        summary = " ".join((cls.__doc__ or "").split())
        KINDS[name] = Kind(name, family, settings, summary, direction, of_vehicles, bounded, tuple(aliases))
        return settings

    return register


def parameter(
    description: str, unit: str = "", *, aliases: str = "", values: Mapping[str, str] | None = None, **bounds: Any
) -> Any:
    """Return the annotation of a parameter: description, unit, and pydantic's bounds (ge, le, ...).

    ``aliases``: other names of it, between blanks; ``values``: other words for its values. Error messages know them.
    """
    words: dict[str, Any] = {"aliases": aliases.split(), "values": dict(values or {})}
    return Field(description=description, json_schema_extra={"unit": unit, **words}, **bounds)


def names(things: str, events: str) -> tuple[str, ...]:
    """Return ``thing_event`` for each of the ``things`` and ``events``, words between blanks."""
    return tuple(f"{thing}_{event}" for thing in things.split() for event in events.split())


LOST = "lost loss losses failure fail failed fault denied denial outage dropout drop off out unavailable timeout"
"""What people call it when something is no longer there."""
