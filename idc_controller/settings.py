"""Tables of settings: frozen dataclasses whose fields a system file sets, or ``--set`` by their path.

Every sub-package whose behaviour depends on numbers has a ``settings.py`` with such dataclasses. What users set is
declared by :func:`setting`, with unit, meaning and range, and listed in ``docs/settings.md``; everything else is a
plain default, with its meaning in a comment.
"""

import math
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Annotated, Any, cast

METADATA_KEY = "setting"
DERIVED_KEY = "derived"
Share = Annotated[float, "share"]
"""A share or a probability: at most 1, and less where its default is."""


@dataclass(frozen=True)
class Setting:
    """Unit, meaning and range of a setting; a bound that is None does not exist."""

    unit: str
    """SI, as it stands in the system file; empty for a pure number."""
    meaning: str
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    def allows(self, value: float) -> bool:
        """Return whether ``value`` is finite and within the bounds."""
        return (
            math.isfinite(value)
            and (self.gt is None or value > self.gt)
            and (self.ge is None or value >= self.ge)
            and (self.lt is None or value < self.lt)
            and (self.le is None or value <= self.le)
        )


def setting(default: Any, unit: str, meaning: str, **bounds: float) -> Any:
    """Declare a field of a settings dataclass.

    Args:
        default: the value of the default system; ``dataclasses.MISSING``: the key must be given.
        unit: its unit, empty for a pure number.
        meaning: what it decides, and where the default comes from, in one sentence.
        bounds: ``gt``, ``ge``, ``lt``, ``le``, that a system file is held to.
    """
    return field(default=default, metadata={METADATA_KEY: Setting(unit, meaning, **bounds)})


def derived(default: Any) -> Any:
    """Declare a field that follows from other settings: no key of the system file.

    ``default`` is its value in the default system.
    """
    return field(default=default, metadata={DERIVED_KEY: True})


class SettingsTable:
    """Base of the tables: equal if all fields are.

    For dataclasses without methods of their own for that, which every command would compile, table by table.
    """

    def __eq__(self, other: object) -> bool:
        """Return whether ``other`` is the same table with equal fields."""
        return type(other) is type(self) and self._values() == other._values()

    def __hash__(self) -> int:
        """Return the hash of the fields."""
        return hash(self._values())

    def __repr__(self) -> str:
        """Return the name of the table with its fields."""
        return f"{type(self).__name__}{self._values()}"

    def _values(self) -> tuple[Any, ...]:
        return tuple(getattr(self, entry.name) for entry in fields(cast(Any, self)))


@dataclass(frozen=True, eq=False, repr=False)
class SampledSettings(SettingsTable):
    """Settings of what counts samples: times are declared, the counts follow from the ``rate``."""

    rate: float = derived(25.0)
    """Rate of the samples (Hz)."""


class SampleCount(cached_property[int]):
    """Attribute of :class:`SampledSettings`: the number of samples, one or more, in its setting ``time`` (s)."""

    def __init__(self, time: str) -> None:
        super().__init__(lambda settings: max(round(getattr(settings, time) * settings.rate), 1))


class SampleShare(cached_property[float]):
    """Attribute of :class:`SampledSettings`: the share of a sample in a mean over its setting ``time``."""

    def __init__(self, time: str) -> None:
        super().__init__(lambda settings: 1.0 / max(round(getattr(settings, time) * settings.rate), 1))
