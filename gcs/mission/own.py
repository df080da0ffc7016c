"""The files that come with the package: missions, and campaigns of faults, by their names."""

from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

from gcs.config.text_file import read_text
from gcs.config.validate import UnusableFile


def own_folder() -> Path:
    """Return the folder of the package's missions; relative where it is below the current one."""
    folder = Path(import_module("gcs.missions").__path__[0])  # apart from the package in a checkout
    here = Path.cwd()
    return folder.relative_to(here) if folder.is_relative_to(here) else folder


def own_files(table: str = "mission") -> dict[str, Path]:
    """Return by name the package's own missions; for ``table`` "campaign" its campaigns."""
    files = {}
    for path in sorted(own_folder().iterdir()):
        if path.suffix == ".toml":
            is_one = f"[{table}]" in read_text(path).splitlines()
        else:
            is_one = table == "mission" and path.suffix in (".plan", ".waypoints")
        if is_one:
            files[path.stem] = path
    return files


def description(path: Path) -> str:
    """Return the line that says what one of the package's files is."""
    if path.suffix == ".toml":
        return read_text(path).partition("\n")[0].partition(": gcs faults")[0].removeprefix("#").strip()
    return str(import_module("gcs.missions").DESCRIPTIONS[path.stem])


def named(path: Path | str, table: str = "mission") -> Path:
    """Return the path of a mission (or campaign), which may be the name of one of the package's own.

    Raises :class:`UnusableFile`, with the nearest name, where there is neither a file nor a name.
    """
    path = Path(path)
    if path.exists() and not path.is_dir():
        return path
    files = own_files(table)
    if path.exists() or str(path) in files:
        return files.get(str(path), path)
    reason = f"{path}: cannot be read: No such file or directory"
    if near := get_close_matches(path.stem, files, 1):
        reason += f"; did you mean {near[0]}, of the package's own?"
    elif not path.suffix and path.name == str(path):
        reason += "; gcs missions lists the package's own"
    raise UnusableFile([reason])
