"""Options of ``gcs fly``, and the mission as it will be flown with them: all that can be wrong before a flight."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from gcs.errors import UnusableInput
from gcs.mavlink.address import ConnectionUrl
from gcs.mission.faults import check_faults_of
from gcs.mission.model import Mission
from gcs.mission.read import read_mission


@dataclass(frozen=True)
class FlyOptions:
    """Options of the command line of ``gcs fly``."""

    mission: Path
    config: Path | None = None
    vehicles: int | None = None
    seed: int | None = None
    run_dir: Path | None = None
    realtime: bool = False
    speed: float = 1.0
    controller: str = "idc"
    connect: tuple[ConnectionUrl, ...] = ()

    @property
    def listens(self) -> bool:
        """Return True if the vehicles call in at an address of the ground, which does not know theirs."""
        return any(url.listens for url in self.connect)


def prepare(options: FlyOptions) -> Mission:
    """Read the mission as it will be flown. Raises :class:`UnusableInput`."""
    _check_urls(options)
    mission = read_mission(options.mission, options.config)
    vehicles = options.vehicles
    if options.connect and not options.listens:
        if vehicles is not None and vehicles != len(options.connect):
            raise UnusableInput(f"--vehicles {vehicles} does not agree with {len(options.connect)} URLs")
        vehicles = len(options.connect)
    if vehicles is not None:
        mission = dataclasses.replace(mission, system=mission.system.with_vehicles(vehicles))
    if options.seed is not None:
        mission = dataclasses.replace(mission, seed=options.seed)
    check_faults_of(mission)  # the number of vehicles may be another than the file's
    return mission


def _check_urls(options: FlyOptions) -> None:
    urls = options.connect
    if options.listens:
        if len(urls) > 1:
            raise UnusableInput(f"--connect {urls[0]}: all vehicles offer themselves at one URL; name no other")
        if not options.realtime:
            raise UnusableInput(f"--connect {urls[0]}: vehicles offer themselves in real time only; add --realtime")
    for i, url in enumerate(urls):
        if url in urls[:i]:
            raise UnusableInput(f"--connect {url}: named twice; every vehicle has an address of its own")
