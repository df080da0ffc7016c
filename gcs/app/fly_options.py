"""Options of ``gcs fly``, and the mission as it will be flown with them: all that can be wrong before a flight."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import Any

from gcs.app.arguments import VEHICLES_MIN
from gcs.drivers.simulator import VEHICLES_MAX
from gcs.errors import UnusableInput
from gcs.mavlink.address import GROUND_PORT, SDK_PORT, THIS_MACHINE, VEHICLE_PORT, Address, ConnectionUrl
from gcs.mission.faults import check_faults_of
from gcs.mission.model import Mission
from gcs.mission.read import read_mission
from gcs.record.run_folder import check_run_folder


@dataclass(frozen=True)
class FlyOptions:
    """Options of the command line of ``gcs fly``."""

    mission: Path
    config: Path | None = None
    settings: Mapping[str, Any] | None = None
    """By dotted path, in place of the system file's."""
    vehicles: int | None = None
    seed: int | None = None
    run_dir: Path | None = None
    realtime: bool = False
    speed: float | None = None
    """Simulated seconds per second of wall time; None: 1 in real time or with a view, else as many as can be."""
    view: bool = False
    """Show it in a browser while it flies."""
    controller: str = "idc"
    connect: tuple[ConnectionUrl, ...] | None = None
    """URLs of a running swarm, empty: the ports of this machine where it listens by default; None: one is started."""

    @property
    def urls(self) -> tuple[ConnectionUrl, ...]:
        """The URLs that were named."""
        return self.connect or ()

    @property
    def pace(self) -> float:
        """Simulated seconds per second of wall time, in real time or with a view."""
        return 1.0 if self.speed is None else self.speed

    @property
    def listens(self) -> bool:
        """Return True if the vehicles call in at an address of the ground, which does not know theirs."""
        return any(url.listens for url in self.urls)

    def addresses(self, vehicles: int) -> list[Address | None]:
        """Return the addresses of a number of vehicles that run already; None until the vehicle calls in.

        A single URL is that of a router, behind which all of them are.
        """
        if self.listens:
            return [None] * vehicles
        if not self.urls:
            return [(THIS_MACHINE, VEHICLE_PORT + i) for i in range(vehicles)]
        named: list[Address | None] = [url.address for url in self.urls]
        return named * vehicles if len(named) == 1 else named

    def clock_address(self) -> Address:
        """Return the address of the clock of a swarm in lockstep that runs already: the port before its vehicles'."""
        first = min((url.address for url in self.urls), key=itemgetter(1), default=(THIS_MACHINE, VEHICLE_PORT))
        return first[0], first[1] - 1


def prepare(options: FlyOptions) -> Mission:
    """Read the mission as it will be flown. Raises :class:`UnusableInput`."""
    _check_urls(options)
    if options.speed is not None and not (options.realtime or options.view):
        raise UnusableInput(f"--speed {options.speed:g}: lockstep is as fast as it can be; add --realtime or --view")
    check_run_folder(options.run_dir)
    vehicles = options.vehicles
    if len(options.urls) > 1:
        if vehicles is not None and vehicles != len(options.urls):
            raise UnusableInput(f"--vehicles {vehicles} does not agree with {len(options.urls)} URLs")
        vehicles = len(options.urls)
        if vehicles < VEHICLES_MIN:
            raise UnusableInput(
                f"--connect {options.urls[0]}: {vehicles} of the team's vehicles, which are {VEHICLES_MIN} or more: "
                "name the URL of each"
            )
    mission = read_mission_for(options.mission, options.config, vehicles, options.settings)
    vehicles = mission.system.team.vehicles
    if options.connect is None and vehicles > VEHICLES_MAX:
        raise UnusableInput(f"{vehicles} vehicles: vehicle-sim simulates {VEHICLES_MAX} at most: see --vehicles")
    return mission if options.seed is None else dataclasses.replace(mission, seed=options.seed)


def read_mission_for(
    path: Path, config: Path | None = None, vehicles: int | None = None, settings: Mapping[str, Any] | None = None
) -> Mission:
    """Read a mission for a team of ``vehicles`` in place of the system file's. Raises :class:`UnusableInput`."""
    mission = read_mission(path, config, settings)
    if vehicles is not None:
        mission = dataclasses.replace(mission, system=mission.system.with_vehicles(vehicles))
        check_faults_of(mission)
    return mission


def _check_urls(options: FlyOptions) -> None:
    urls = options.urls
    for url in urls:
        if not url.listens and SDK_PORT <= url.port < GROUND_PORT:
            new = ConnectionUrl(url.host, url.port - SDK_PORT + VEHICLE_PORT, listens=False)
            raise UnusableInput(
                f"--connect {url}: vehicles listen on port {VEHICLE_PORT} and on, as PX4's do, and SDKs on {SDK_PORT} "
                f"and on; use --connect {new}, or --connect alone for a swarm on this machine"
            )
    if options.listens:
        if len(urls) > 1:
            raise UnusableInput(f"--connect {urls[0]}: all vehicles offer themselves at one URL; name no other")
        if not options.realtime:
            raise UnusableInput(f"--connect {urls[0]}: vehicles offer themselves in real time only; add --realtime")
    elif len(urls) == 1 and not options.realtime:
        raise UnusableInput(
            f"--connect {urls[0]}: one address of all vehicles is a router's, in real time only; add --realtime, "
            "or name the address of every vehicle"
        )
    for i, url in enumerate(urls):
        if url in urls[:i]:
            raise UnusableInput(f"--connect {url}: named twice; every vehicle has an address of its own")
