"""Share of the hover thrust while the payload is on the ground: spool-up before the climb, spool-down after landing."""

from dataclasses import dataclass

from gcs.config.flight_settings import DEFAULTS, TakeoffLandingSettings
from idc_controller.trajectory.trajectory import Trajectory


def spool_up_share(elapsed: float, settings: TakeoffLandingSettings = DEFAULTS.takeoff_landing) -> float:
    """Return the share of the hover thrust ``elapsed`` (s) after the rotors have started."""
    return min(elapsed / settings.spool_up_time, 1.0)


class SpoolDown:
    """Spool-down from ``time`` (s) of the touchdown; it waits until links that lean in the wind are upright."""

    def __init__(self, time: float, settings: TakeoffLandingSettings = DEFAULTS.takeoff_landing) -> None:
        self._since, self._settings = time, settings
        self._leaning = True

    def share(self, time: float, lean: float) -> float:
        """Return the share of the hover thrust at ``time`` (s); ``lean``: largest sine of a link's tilt by axis."""
        s = self._settings
        if self._leaning:
            share = max(1.0 - (time - self._since) / s.spool_down_time, s.standing_share)
            if share > s.standing_share or (lean > s.upright_lean and time - self._since < s.upright_timeout):
                return share
            self._leaning, self._since = False, time - (1.0 - s.standing_share) * s.spool_down_time
        return max(1.0 - (time - self._since) / s.spool_down_time, 0.0)


@dataclass(frozen=True, eq=False)
class Touchdown:
    """The payload on the ground after the flight."""

    trajectory: Trajectory
    """Rest where it touched down."""
    yaw: float
    """rad"""
    spool_down: SpoolDown
