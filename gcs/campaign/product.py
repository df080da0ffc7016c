"""The product code that decides how a flight ends: its digest, by which verdicts are kept, and its commit."""

import hashlib
import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import gcs
from gcs.campaign.folder import digest
from gcs.errors import GcsError
from gcs.mission.read import read_mission
from gcs.record.run_folder import to_json

PACKAGES = ("gcs", "idc_controller", "vehicle_sim")


@cache
def code_digest() -> str:
    """Return a text that is another for other sources of the packages."""
    root, found = Path(gcs.__file__).parents[1], hashlib.sha256()
    for path in sorted(path for package in PACKAGES for path in (root / package).rglob("*.py")):
        found.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def verdict_key(mission: Path, config: Path | None, *options: str) -> str:
    """Return a text that is another for another code, mission with its system and seed, or for other options."""
    try:
        as_read = json.dumps(to_json(replace(read_mission(mission, config), path=Path())))
    except GcsError as error:  # as it will be refused
        as_read = str(error)
    return digest(code_digest(), as_read, *options)
