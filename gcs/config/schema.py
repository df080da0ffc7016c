"""Schema of declared settings: a type that pydantic validates strictly, and a listing.

A table of the system file is a frozen dataclass whose fields are declared with
:func:`idc_controller.settings.setting`; a field that is such a dataclass itself is a table within the table. Other
fields are no keys of the file: constants, and what is ``derived`` from other settings.
"""

import dataclasses
from collections.abc import Iterator
from functools import reduce
from operator import or_
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

from pydantic import AfterValidator, ConfigDict, Field, create_model

from idc_controller.errors import ParameterError
from idc_controller.settings import DERIVED_KEY, METADATA_KEY, Setting

_STRICT = ConfigDict(extra="forbid", allow_inf_nan=False, protected_namespaces=())


@dataclasses.dataclass(frozen=True)
class ListedSetting:
    """One setting with its table and key in the system file."""

    table: str
    key: str
    default: Any
    setting: Setting


def table_type(cls: type[Any]) -> Any:
    """Return the type by which pydantic reads a table into an object of the dataclass ``cls``.

    Unknown keys and values outside the declared bounds are refused; keys that are missing have their defaults. The
    bounds of a setting with several numbers hold for each of them.
    """
    fields: dict[str, Any] = {}
    for name, hint, field in _declared(cls):
        bounds = _bounds(field.metadata[METADATA_KEY]) if METADATA_KEY in field.metadata else {}
        fields[name] = (_bounded(hint, bounds), _default(field))
    model: Any = create_model(cls.__name__, __config__=_STRICT, **fields)

    def construct(values: Any) -> Any:
        try:
            return cls(**vars(values))
        except ParameterError as error:
            raise ValueError(str(error)) from error

    return Annotated[model, AfterValidator(construct)]


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
    """Return True for a type that is read from a text, and is that text again by ``str``."""
    return hasattr(hint, "__get_pydantic_core_schema__")


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


def _bounded(hint: Any, bounds: dict[str, Any]) -> Any:
    """Return the type ``hint`` with ``bounds`` on every number in it, and tables as the types they are read by."""
    if _reads_itself(hint):
        return hint
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return table_type(hint)
    if hint in (int, float):
        return Annotated[hint, Field(**bounds)]
    parts = tuple(part if part is Ellipsis else _bounded(part, bounds) for part in get_args(hint))
    if get_origin(hint) is tuple:
        return tuple.__class_getitem__(parts)
    if get_origin(hint) in (Union, UnionType):
        return reduce(or_, parts)
    return hint
