"""Schema of declared settings: a validator by which pydantic reads them strictly, and a listing.

A table of the system file is a frozen dataclass whose fields are declared with
:func:`idc_controller.settings.setting`; a field that is such a dataclass itself is a table within the table. Other
fields are no keys of the file: constants, and what is ``derived`` from other settings.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from pydantic_core import CoreSchema, SchemaValidator
from pydantic_core.core_schema import (
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
from idc_controller.settings import DERIVED_KEY, METADATA_KEY, Setting


@dataclasses.dataclass(frozen=True)
class ListedSetting:
    """One setting with its table and key in the system file."""

    table: str
    key: str
    default: Any
    setting: Setting


def table_validator(cls: type[Any]) -> SchemaValidator:
    """Return the validator that reads a table into an object of the dataclass ``cls``.

    Unknown keys and values outside the declared bounds are refused; keys that are missing have their defaults. The
    bounds of a setting with several numbers hold for each of them.
    """
    return SchemaValidator(_table_schema(cls))


def _table_schema(cls: type[Any]) -> CoreSchema:
    """Return the schema of a table, and of those within it: its keys, none of which must be there."""

    def construct(values: dict[str, Any]) -> Any:
        try:
            return cls(**values)
        except ParameterError as error:
            raise ValueError(str(error)) from error

    keys = {
        name: typed_dict_field(
            _schema(hint, _bounds(field.metadata[METADATA_KEY])) if METADATA_KEY in field.metadata else
            _table_schema(hint),
            required=False,
        )
        for name, hint, field in _declared(cls)
    }  # fmt: skip
    return no_info_after_validator_function(construct, typed_dict_schema(keys, extra_behavior="forbid"))


def listed_settings(cls: type[Any], table: str = "") -> Iterator[ListedSetting]:
    """Yield every setting below the dataclass ``cls``, in the order of its declaration."""
    for name, hint, field in _declared(cls):
        if METADATA_KEY in field.metadata:
            yield ListedSetting(table, name, _default(field), field.metadata[METADATA_KEY])
        else:
            yield from listed_settings(hint, f"{table}.{name}" if table else name)


def table_of(values: Any) -> dict[str, Any]:
    """Return an object of a settings dataclass as the table of its keys: arrays as lists, absent what is None."""
    table = {}
    for name, _, field in _declared(type(values)):
        value = getattr(values, name)
        if value is not None:
            table[name] = _plain(value) if METADATA_KEY in field.metadata else table_of(value)
    return table


def _reads_itself(hint: Any) -> bool:
    """Return True for a type that is read by its method ``from_text``, and is that text again by ``str``."""
    return hasattr(hint, "from_text")


def _plain(value: Any) -> Any:
    if _reads_itself(type(value)):
        return str(value)
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


_Declared = tuple[tuple[str, Any, dataclasses.Field[Any]], ...]
_declared_of: dict[type[Any], _Declared] = {}


def _declared(cls: type[Any]) -> _Declared:
    """Return name, type and field of every setting and table of ``cls``; found once, as resolving types takes long."""
    if cls not in _declared_of:
        hints = get_type_hints(cls)
        _declared_of[cls] = tuple(
            (field.name, hints[field.name], field)
            for field in dataclasses.fields(cls)
            if METADATA_KEY in field.metadata or _is_table(hints[field.name], field)
        )
    return _declared_of[cls]


def _is_table(hint: Any, field: dataclasses.Field[Any]) -> bool:
    is_dataclass = isinstance(hint, type) and dataclasses.is_dataclass(hint)
    return is_dataclass and DERIVED_KEY not in field.metadata and bool(_declared(hint))


def _default(field: dataclasses.Field[Any]) -> Any:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _bounds(setting: Setting) -> dict[str, Any]:
    bounds = {"gt": setting.gt, "ge": setting.ge, "lt": setting.lt, "le": setting.le}
    return {name: bound for name, bound in bounds.items() if bound is not None}


def _schema(hint: Any, bounds: Mapping[str, Any]) -> CoreSchema:
    """Return the schema of a setting of the type ``hint``, with ``bounds`` on every number in it."""
    if hint is float:
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
