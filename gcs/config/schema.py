"""Schema of declared settings: a validator by which pydantic reads them strictly.

A table of the system file is a frozen dataclass. Its fields are keys, those that are such dataclasses tables within the
table, except what is ``derived`` from other settings. Those declared with :func:`idc_controller.settings.setting` are
listed, with the bounds that they state; a plain default is held to its type, its sign, and, as a
:data:`idc_controller.settings.Share`, to 1.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from functools import cache
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from pydantic_core import CoreSchema, SchemaValidator
from pydantic_core.core_schema import (
    bool_schema,
    float_schema,
    int_schema,
    no_info_after_validator_function,
    nullable_schema,
    str_schema,
    tuple_schema,
    typed_dict_field,
    typed_dict_schema,
    with_info_after_validator_function,
)

from idc_controller.errors import ParameterError
from idc_controller.settings import DERIVED_KEY, METADATA_KEY, SettingsTable, Share


@cache
def table_validator(cls: type[Any]) -> SchemaValidator:
    """Return the validator that reads a table into an object of the dataclass ``cls``.

    Unknown keys and values outside the declared bounds are refused; keys that are missing have their defaults. The
    bounds of a setting with several numbers hold for each of them.
    """
    return SchemaValidator(_table_schema(cls))


def _table_schema(cls: type[Any]) -> CoreSchema:
    """Return the schema of a table, and of those within it: its keys; those without a default must be there."""

    def construct(values: dict[str, Any]) -> Any:
        try:
            return cls(**values)
        except ParameterError as error:
            raise ValueError(str(error)) from error

    keys = {
        name: typed_dict_field(
            _table_schema(hint) if _is_table(hint) else _schema(hint, _bounds(hint, field)),
            required=_default(field) is dataclasses.MISSING,
        )
        for name, hint, field in _keys(cls)
    }
    return no_info_after_validator_function(construct, typed_dict_schema(keys, extra_behavior="forbid"))


def paths(cls: type[Any], table: str = "") -> Iterator[str]:
    """Yield the dotted path of every key below the dataclass ``cls``."""
    for name, hint, _ in _keys(cls):
        path = f"{table}.{name}" if table else name
        yield from paths(hint, path) if _is_table(hint) else (path,)


def table_of(values: Any) -> dict[str, Any]:
    """Return an object of a settings dataclass as the table of its keys: arrays as lists, absent what is None."""
    table = {}
    for name, hint, _ in _keys(type(values)):
        value = getattr(values, name)
        if value is not None:
            table[name] = table_of(value) if _is_table(hint) else _plain(value)
    return table


def _reads_itself(hint: Any) -> bool:
    """Return True for a type that is read by its method ``from_text``, and is that text again by ``str``."""
    return hasattr(hint, "from_text")


def _plain(value: Any) -> Any:
    if _reads_itself(type(value)):
        return str(value)
    if isinstance(value, SettingsTable):
        return table_of(value)
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


_Keys = tuple[tuple[str, Any, dataclasses.Field[Any]], ...]


_keys_of: dict[type[Any], _Keys] = {}


def _keys(cls: type[Any]) -> _Keys:
    """Return name, type and field of every key of ``cls``; found once, as resolving types takes long."""
    if cls not in _keys_of:
        hints = get_type_hints(cls, include_extras=True)
        _keys_of[cls] = tuple(
            (field.name, hints[field.name], field)
            for field in dataclasses.fields(cls)
            if DERIVED_KEY not in field.metadata
        )
    return _keys_of[cls]


def _is_table(hint: Any) -> bool:
    return isinstance(hint, type) and issubclass(hint, SettingsTable)


def _default(field: dataclasses.Field[Any]) -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _bounds(hint: Any, field: dataclasses.Field[Any]) -> dict[str, Any]:
    """Return the bounds of a setting: as declared, or else those of a plain default."""
    if (declared := field.metadata.get(METADATA_KEY)) is not None:
        bounds = {"gt": declared.gt, "ge": declared.ge, "lt": declared.lt, "le": declared.le}
        return {name: bound for name, bound in bounds.items() if bound is not None}
    default = _default(field)
    least, largest = (min(default), max(default)) if isinstance(default, tuple) else (default, default)
    below = {"gt": 0} if least > 0 else {"ge": 0} if least == 0 else {}
    above = ({"lt": 1} if largest < 1 else {"le": 1}) if hint == Share else {}
    return below | above


def _schema(hint: Any, bounds: Mapping[str, Any]) -> CoreSchema:
    """Return the schema of a setting of the type ``hint``, with ``bounds`` on every number in it."""
    if _is_table(hint):  # of an array of tables
        return _table_schema(hint)
    if hint is bool:
        return bool_schema()
    if hint is float or hint == Share:
        return float_schema(allow_inf_nan=False, **bounds)
    if hint is int:
        return int_schema(**bounds)
    if _reads_itself(hint):
        return with_info_after_validator_function(hint.from_text, str_schema(min_length=1))
    parts = get_args(hint)
    items = [_schema(part, bounds) for part in parts if part not in (Ellipsis, NoneType)]
    if get_origin(hint) is tuple:
        return tuple_schema(items, variadic_item_index=0 if Ellipsis in parts else None)
    if get_origin(hint) in (Union, UnionType) and NoneType in parts and len(items) == 1:
        return nullable_schema(items[0])
    raise TypeError(f"a setting of the type {hint} cannot be read")
