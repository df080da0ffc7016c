"""Strict validation of data from files: every reason why a file is refused, one line each, with its key."""

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import Annotated, Any, NamedTuple, Protocol, TypeVar

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, with_config

from gcs.errors import UnusableInput

T = TypeVar("T")
Read = TypeVar("Read", covariant=True)
Key = tuple[str | int, ...]
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]

_REASONS = {
    "missing": "missing key",
    "union_tag_not_found": "missing key",
    "unexpected_keyword_argument": "unknown key",
    "extra_forbidden": "unknown key",
    "dataclass_type": "must be a table",
    "dict_type": "must be a table",
    "model_type": "must be a table",
}


class Validator(Protocol[Read]):
    """What reads data from JSON into a type: pydantic's ``TypeAdapter`` or ``SchemaValidator``."""

    def validate_json(self, data: str, /, *, strict: bool, context: dict[str, Any]) -> Read:
        """Return the data as the type. Raises :class:`pydantic.ValidationError`."""


class UnusableFile(UnusableInput):
    """A file that cannot be used.

    ``reasons`` holds every reason that was found, one line each: file, line or item, field, reason.
    ``str(error)`` is the first of them, and says how many more there are.
    """

    def __init__(self, reasons: Sequence[str]) -> None:
        # A hostile file could bring in line breaks and control characters.
        lines = tuple("".join(c if c.isprintable() else " " for c in reason)[:1000] for reason in reasons)
        more = len(lines) - 1
        super().__init__(lines[0] + (f" (and {more} more)" if more else ""))
        self.reasons = lines


def strict(cls: type[T]) -> type[T]:
    """Class decorator for a dataclass that is read from a file: no unknown keys, no infinite numbers."""
    return with_config(ConfigDict(extra="forbid", allow_inf_nan=False))(cls)


class Suggestions(NamedTuple):
    """What the words of a file could mean that its tables do not know."""

    key_meant: Callable[[Key, Collection[str]], str | None] = lambda key, given: None
    """The name that the last part of an unknown key means, none of those given in its table."""
    value_meant: Callable[[Key, object], str | None] = lambda key, value: None
    """The value that is meant by one that the key does not take."""


_adapters: dict[type[Any], TypeAdapter[Any]] = {}


def adapter_of(kind: type[T]) -> TypeAdapter[T]:
    """Return what reads a ``kind`` of table; made once, which takes long."""
    if kind not in _adapters:
        _adapters[kind] = TypeAdapter(kind)
    return _adapters[kind]


def validated(
    kind: Validator[T] | type[T],
    data: Any,
    problem: Callable[[Key, str], str],
    context: Mapping[str, Any] | None = None,
    suggestions: Suggestions = Suggestions(),
) -> T:
    """Return ``data`` as ``kind``, a type or the validator of one.

    ``problem`` makes the line for a key and a reason. Raises :class:`UnusableFile` with every unknown key, missing key
    and wrong value: a line each, and one for a missing key that is there under another name.
    """
    validator: Validator[T] = adapter_of(kind) if isinstance(kind, type) else kind
    try:
        # Through JSON: strict types, yet arrays become tuples and tables dataclasses. Dates, which JSON does not
        # have, become text and are refused as such.
        return validator.validate_json(json.dumps(data, default=str), strict=True, context=dict(context or {}))
    except ValidationError as error:
        found = error.errors(include_url=False)
    except (ValueError, RecursionError) as error:
        raise UnusableFile([problem((), str(error))]) from error
    raise UnusableFile([problem(*line) for line in _lines(data, [dict(error) for error in found], suggestions)])


def dotted(key: Sequence[str | int]) -> str:
    """Return ``obstacle[1].radius``: arrays are counted from 1, as users count their tables."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".") or "file"


def shown(value: Any) -> str:
    """Return a value from a file, short enough for a message."""
    try:
        text = json.dumps(value, default=str)
    except (ValueError, RecursionError):
        text = type(value).__name__
    return text if len(text) <= 40 else text[:37] + "..."


def _lines(data: Any, errors: Sequence[dict[str, Any]], suggestions: Suggestions) -> list[tuple[Key, str]]:
    """Return the keys and reasons of the errors that pydantic found in ``data``, with what was meant."""
    # Items that are wrong are not counted: one mistake in a list must not make it too short.
    errors = [e for e in errors if e["type"] != "too_short" or len(e["input"]) < e["ctx"]["min_length"]]
    lines = [_explained(data, error) for error in errors]
    missing = {key for key, reason in lines if reason == "missing key"}
    found = []
    for (key, reason), error in zip(lines, errors, strict=True):
        meant = None
        if reason == "unknown key":
            table, name = key[:-1], str(key[-1])
            others = [str(other[-1]) for other in missing if other[:-1] == table]
            meant = suggestions.key_meant(key, _keys(data, table)) or next(
                iter(get_close_matches(name, others, 1)), None
            )
            missing.discard((*table, meant or ""))
        elif error["type"] == "literal_error":
            meant = suggestions.value_meant(key, error["input"])
        found.append((key, reason + (f": did you mean '{meant}'?" if meant else "")))
    return [(key, reason) for key, reason in found if reason != "missing key" or key in missing]


def _keys(data: Any, table: Key) -> Collection[str]:
    for part in table:
        data = data[part]
    return data.keys() if isinstance(data, dict) else ()


def _explained(data: Any, error: dict[str, Any]) -> tuple[Key, str]:
    """Return the key and the reason of an error that pydantic found in ``data``."""
    key: list[str | int] = []
    location = error["loc"]
    for part in location:
        if (isinstance(data, dict) and part in data) or (
            isinstance(data, list) and isinstance(part, int) and part < len(data)
        ):
            data = data[part]
            key.append(part)
        elif part == location[-1] and error["type"] == "missing":
            key.append(part)  # otherwise it is a name of pydantic's own: the tag of a union, "key", ...
    kind, context = error["type"], error.get("ctx", {})
    reason = _REASONS.get(kind, error["msg"].replace("Input should", "must"))
    if kind.startswith("union_tag"):  # the key that distinguishes several kinds of table
        key.append(str(context["discriminator"]).strip("'"))
    if kind == "union_tag_invalid":
        reason = f"'{context['tag']}' is none of {context['expected_tags']}"
    elif kind == "value_error":
        reason = str(context["error"])
    elif kind == "too_short":
        reason = f"needs at least {context['min_length']}, has {context['actual_length']}"
    elif kind == "too_long":
        reason = f"takes at most {context['max_length']}, has {context['actual_length']}"
    elif kind == "missing" and key and isinstance(key[-1], int):
        reason = "missing value"
    elif reason not in ("missing key", "unknown key"):
        reason += f", found {shown(error['input'])}"
    return tuple(key), reason[0].lower() + reason[1:]
