"""The payload on the ground after the flight, while the thrust fades."""

from gcs.config.flight_settings import TakeoffLandingSettings
from idc_controller.trajectory.trajectory import Trajectory


class Touchdown:
    """The payload at rest where it touched down, and the spool-down, which waits until leaning links are upright."""

    def __init__(self, trajectory: Trajectory, yaw: float, time: float, settings: TakeoffLandingSettings) -> None:
        """``trajectory``: rest where it touched down at ``time`` (s); ``yaw`` in rad."""
        self.trajectory, self.yaw = trajectory, yaw
        self._since, self._settings = time, settings
        self._leaning, self._least = True, settings.standing_share

    def share(self, time: float, lean: float) -> float:
        """Return the share of the hover thrust at ``time`` (s).

        ``lean``: largest sine of a link's tilt by axis, now or soon.
        """
        s = self._settings
        if self._leaning:
            share = max(1.0 - (time - self._since) / s.spool_down_time, self._least)
            if share > s.standing_share:
                return share
            if lean > s.upright_lean and time - self._since < s.upright_timeout:
                self._least = s.leaning_share  # with more of it a payload slides in wind
                return share
            self._leaning, self._since = False, time - (1.0 - share) * s.spool_down_time
        return max(1.0 - (time - self._since) / s.spool_down_time, 0.0)
