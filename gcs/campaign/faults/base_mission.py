"""Missions made of a mission: with another seed, with faults, with other limits, as files that ``gcs fly`` repeats."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.campaign.folder import digest
from gcs.campaign.toml_text import tables_text
from gcs.config.mesh_file import read_mesh
from gcs.config.system import SystemConfig
from gcs.config.text_file import read_text
from gcs.config.toml_file import read_toml
from gcs.mission.model import Fault, Limits
from gcs.mission.read import mission_format, read_mission

_NAME = 200  # characters, the longest that a mission may have


@dataclass(frozen=True)
class BaseMission:
    """A mission as read, and the text of the files that it needs by their names in the folder of what is made of it."""

    name: str
    seed: int
    system: SystemConfig
    tables: Mapping[str, Any]
    files: Mapping[str, str]

    def tables_for(self, seed: int) -> Mapping[str, Any]:
        """Return the tables of the mission that is flown with a seed: with every seed the same."""
        return self.tables

    def text(
        self, name: str, seed: int | None = None, faults: Sequence[Fault] = (), limits: Limits | None = None
    ) -> str:
        """The mission with ``faults`` after its own; another ``seed`` or ``limits`` in place of its own."""
        seed = self.seed if seed is None else seed
        own = self.tables_for(seed)
        tables = {**own, "mission": {**own["mission"], "name": name[:_NAME], "seed": seed}}
        if faults:
            tables["fault"] = [*own.get("fault", ()), *map(fault_table, faults)]
        if limits is not None:
            tables["limits"] = {key: value for key, value in dataclasses.asdict(limits).items() if value is not None}
        return tables_text(tables)


def read_base(path: Path) -> BaseMission:
    """Read a mission of any format. Raises :class:`gcs.config.UnusableFile` like :func:`read_mission`."""
    mission = read_mission(path)
    path = mission.path
    if mission_format(path, read_text(path)) == "toml":
        tables = read_toml(path).data
    else:
        tables = {"mission": {"name": mission.name}, "reference": {"kind": "waypoints", "file": path.name}}
    files = {}

    def copied(source: Path, text: str) -> str:
        """Named after its content: flights with other files are other flights."""
        name = f"{source.stem}-{digest(text)}{source.suffix}"
        files[name] = text
        return name

    def copied_mesh(file: Path) -> str:
        from trimesh.exchange.obj import export_obj  # half a second, spent only where there is a mesh

        return copied(file.with_suffix(".obj"), export_obj(read_mesh(file), include_normals=False, digits=17))

    system_tables = mission.system.tables()
    if mesh := mission.system.payload.mesh:
        system_tables["payload"]["mesh"] = copied_mesh(mesh.path)
    system = copied(Path("system.toml"), tables_text(system_tables))
    if obstacles := tables.get("obstacle"):
        copied_files = [
            {**table, "file": copied_mesh(path.parent / table["file"])} if "file" in table else table
            for table in obstacles
        ]
        tables = {**tables, "obstacle": copied_files}
    tables = {**tables, "mission": {**tables["mission"], "system": system}}
    if "file" in tables["reference"]:
        source = path.parent / tables["reference"]["file"]
        file = copied(source, read_text(source))
        tables["reference"] = {**tables["reference"], "file": file}
    return BaseMission(mission.name, mission.seed, mission.system, tables, files)


def fault_table(fault: Fault | Mapping[str, Any]) -> dict[str, Any]:
    """A fault as the keys of a ``[[fault]]`` table; a mapping is one already."""
    if isinstance(fault, Mapping):
        return dict(fault)
    own = {key: value for key, value in dataclasses.asdict(fault).items() if key not in ("settings", "line")}
    return {key: value for key, value in own.items() if value is not None} | dict(fault.settings)
