"""What a word could mean that a fault table does not know: by the aliases that the kinds declare, else by spelling."""

from collections.abc import Collection, Iterable, Mapping
from difflib import SequenceMatcher
from functools import cache
from typing import Any

from gcs.config.validate import adapter_of
from gcs.faults.kinds import KINDS

_WORD_ALIKE = 0.65
_ALIKE = 0.85
"""Least ratio of letters in common: two of three in each word, or all but a few of the whole."""
COMMON = (
    "start",
    "start_phase",
    "start_offset",
    "start_flight",
    "duration",
    "every",
    "times",
    "vehicles",
    "direction",
)
"""Keys of a fault of any kind."""
_COMMON_ALIASES = {
    "time": "start", "begin": "start", "at": "start", "delay": "start", "length": "duration", "period": "every",
    "end": "duration", "stop": "duration", "repeat": "times", "count": "times", "vehicle": "vehicles",
    "uav": "vehicles", "uavs": "vehicles", "drone": "vehicles", "drones": "vehicles", "target": "vehicles",
    "link": "direction", "phase": "start_phase", "in_phase": "start_phase", "offset": "start_offset",
}  # fmt: skip
_PHASES = {
    "arming": "arm", "armed": "arm", "take_off": "spool_up", "takeoff": "spool_up", "spoolup": "spool_up",
    "ascent": "climb", "cruise": "fly", "mission": "fly", "hover": "hold", "loiter": "hold", "landing": "land",
    "descent": "land", "descend": "land", "touchdown": "spool_down", "touch_down": "spool_down",
    "disarming": "disarm", "failsafe": "autonomous_landing",
}  # fmt: skip
_DIRECTIONS = {
    "up": "command", "uplink": "command", "commands": "command", "setpoints": "command", "down": "telemetry",
    "downlink": "telemetry", "all": "both", "any": "both", "bidirectional": "both",
}  # fmt: skip


@cache
def kind_meant(name: str) -> str | None:
    """Return the kind that an unknown ``name`` most probably means; None: no kind is like it."""
    return _meant(name, {**{alias: kind.name for kind in KINDS.values() for alias in kind.aliases}, **_selves(KINDS)})


def key_meant(kind: str, key: str, given: Collection[str]) -> str | None:
    """Return the key of a fault of ``kind`` that an unknown ``key`` means; None: none of those not ``given``."""
    found = {**_COMMON_ALIASES, **_selves(COMMON)}
    for name, entry in _entries(kind).items():
        found |= {**dict.fromkeys(entry.get("aliases", ()), name), name: name}
    return _meant(key, {word: meant for word, meant in found.items() if meant not in given})


def value_meant(kind: str, key: str, value: object) -> str | None:
    """Return the value of a ``key`` that an unknown ``value`` means; None: it is no word that is known."""
    if not isinstance(value, str):
        return None
    if key == "direction":
        return _meant(value, {**_DIRECTIONS, **_selves(set(_DIRECTIONS.values()))})
    if key == "start_phase":
        return _meant(value, {**_PHASES, **_selves(set(_PHASES.values()))})
    entry = _entries(kind).get(key, {})
    allowed = entry.get("enum") or entry.get("items", {}).get("enum") or ()
    return _meant(value, {**entry.get("values", {}), **_selves(allowed)})


@cache
def _entries(kind: str) -> Mapping[str, Any]:
    """Return the schema of each parameter of ``kind``; none of a kind that does not exist."""
    if kind not in KINDS:
        return {}
    entries: Mapping[str, Any] = adapter_of(KINDS[kind].settings).json_schema().get("properties", {})
    return entries


def _selves(names: Iterable[Any]) -> dict[str, str]:
    return {name: name for name in names}


def _meant(word: str, meanings: Mapping[str, str]) -> str | None:
    """Return the meaning of ``word`` or, where it has none, that of the word that is spelt most like it."""
    word = word.strip().lower().replace("-", "_").replace(" ", "_")
    if word in meanings:
        return meanings[word]
    likeness = {known: _likeness(word, known) for known in meanings}
    # Of a name and an alias that are equally alike, the name.
    nearest = max(likeness, key=lambda known: (likeness[known], known == meanings[known]), default="")
    return meanings[nearest] if nearest and likeness[nearest] > 0.0 else None


def _likeness(a: str, b: str) -> float:
    """Return how alike two names are spelt, word by word or as a whole, from 0 (too little) to 1."""
    whole = _ratio(a.replace("_", ""), b.replace("_", ""))
    words_a, words_b = a.split("_"), b.split("_")
    if len(words_a) == len(words_b) and min(map(_ratio, words_a, words_b)) >= _WORD_ALIKE:
        return whole
    return whole if whole >= _ALIKE else 0.0


def _ratio(a: str, b: str) -> float:
    return SequenceMatcher(None, a, b, autojunk=False).ratio()
