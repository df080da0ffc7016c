"""Settings given by dotted path, such as ``avoidance.margin``, in place of those of a system file."""

from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any

from gcs.config.schema import paths
from gcs.config.system import SystemConfig, system_of
from gcs.config.tables import DEFAULT_CARGO
from gcs.config.toml_file import GivenTables
from gcs.errors import UnusableInput


def with_settings(system: SystemConfig, settings: Mapping[str, Any]) -> SystemConfig:
    """Return ``system`` with values by dotted path, checked as those of a system file.

    A value of None leaves the setting out; arrays may be numpy's; the file of a mesh is looked for from the current
    folder. Raises :class:`UnusableInput` for a path that is no setting's, with the nearest that is one, and for values
    that are out of range or do not agree with the others.
    """
    if not settings:
        return system
    tables = system.tables()
    if system.cargo == DEFAULT_CARGO:
        del tables["cargo"]  # as of a file that states none: it goes with the default payload's mass
    if (mesh := system.payload.mesh) is not None:
        tables["payload"]["mesh"] = str(mesh.path)  # not as seen from the system file
    for path, value in settings.items():
        if path not in _paths():
            raise UnusableInput(f"settings: there is no '{path}'{_hint(path)}")
        *names, key = path.split(".")
        table = tables
        for name in names:
            table = table.setdefault(name, {})
        if value is None:
            table.pop(key, None)
        else:
            table[key] = plain(value)
    return system_of(GivenTables(Path("settings"), tables, {}))


def plain(value: Any) -> Any:
    """Return the same value of Python's own types, if it is an array or a number of numpy's."""
    return value.tolist() if hasattr(value, "tolist") else value


@cache
def _paths() -> tuple[str, ...]:
    return tuple(paths(SystemConfig))


def _hint(path: str) -> str:
    """Return what is meant: the nearest path, or else the one whose last part is nearest."""
    near = get_close_matches(path, _paths(), 1, 0.75)
    if not near:
        keys = {known.rpartition(".")[2]: known for known in reversed(_paths())}
        near = [keys[key] for key in get_close_matches(path.rpartition(".")[2], keys, 1)]
    return f": did you mean '{near[0]}'?" if near else ": docs/settings.md lists all"
