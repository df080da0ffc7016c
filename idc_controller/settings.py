"""Declaration of a setting: a field of a frozen dataclass with its default, unit, meaning and range.

Every sub-package whose behaviour depends on numbers has a ``settings.py`` with such dataclasses. Each is a table of the
system file; ``docs/settings.md`` lists them all. They have neither comparison nor representation: nobody needs them,
and every command would compile them at its start.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

METADATA_KEY = "setting"
DERIVED_KEY = "derived"


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


def setting(
    default: Any,
    unit: str,
    meaning: str,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """Declare a field of a settings dataclass.

    Args:
        default: the value of the default system.
        unit: its unit, empty for a pure number.
        meaning: what it decides, and where the default comes from, in one sentence.
        gt, ge, lt, le: the bounds that a system file is held to.
    """
    return field(default=default, metadata={METADATA_KEY: Setting(unit, meaning, gt, ge, lt, le)})


def derived(default: Any) -> Any:
    """Declare a field that follows from other settings: no key of the system file.

    ``default`` is its value in the default system.
    """
    return field(default=default, metadata={DERIVED_KEY: True})


@dataclass(frozen=True, eq=False, repr=False)
class SampledSettings:
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
