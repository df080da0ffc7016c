"""Settings of the drivers: how long they wait, in wall time, for the simulated world and for datagrams."""

from dataclasses import dataclass

from idc_controller.settings import SettingsTable


@dataclass(frozen=True, eq=False, repr=False)
class DriverSettings(SettingsTable):
    """Wall times of the drivers."""

    join_interval: float = 0.5  # s; after which an unanswered request to join the world is repeated
    tick_timeout: float = 20.0  # s; without a tick, after which the simulated world is lost
    wait_max: float = 0.1  # s; for datagrams in real time, so that an interrupt is noticed
    landing_timeout: float = 60.0  # s; for vehicle-sim to land what is in the air after the flight
    end_timeout: float = 10.0  # s; after that, for vehicle-sim to close its records
