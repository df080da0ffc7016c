"""Settings of the drivers: how long they wait, in wall time, for the simulated world and for datagrams."""

from dataclasses import dataclass

from idc_controller.settings import SettingsTable, setting


@dataclass(frozen=True, eq=False, repr=False)
class DriverSettings(SettingsTable):
    """Wall times of the drivers."""

    join_interval: float = setting(0.5, "s", "after which an unanswered request to join the world is repeated", gt=0.0)
    tick_timeout: float = setting(20.0, "s", "without a tick, after which the simulated world is lost", gt=0.0)
    wait_max: float = setting(0.1, "s", "for datagrams in real time, so that an interrupt is noticed", gt=0.0)
    landing_timeout: float = setting(60.0, "s", "for vehicle-sim to land what is in the air after the flight", ge=0.0)
    end_timeout: float = setting(10.0, "s", "after that, for vehicle-sim to close its records", ge=0.0)
