"""Set-points: SET_ATTITUDE_TARGET and the stop plan beside it, and their delay and loss on the link."""

import math
from collections import deque
from collections.abc import Sequence
from statistics import median

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.layout import LAYOUTS, Packed
from gcs.mavlink.settings import LinkSettings
from idc_controller.estimation.setpoint_history import Confirmation
from idc_controller.rotations_float import attitude_of_direction

IGNORE_RATES = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
)
_NO_RATES = (0.0, 0.0, 0.0)

# What goes out with every control step is packed without a message object, its fields in the order of the wire.
_SET_ATTITUDE_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET]


def attitude_target(
    system_id: int, boot_time: float, direction: Sequence[float], thrust: float, thrust_max: float
) -> Packed:
    """Return SET_ATTITUDE_TARGET for vehicle ``system_id`` at its ``boot_time`` (s): thrust (N) along ``direction``."""
    time_boot_ms = round(boot_time * 1000.0) & 0xFFFFFFFF
    share = max(0.0, min(1.0, thrust / thrust_max))
    return _SET_ATTITUDE_TARGET.pack(
        time_boot_ms, *attitude_of_direction(direction), *_NO_RATES, share,
        system_id, px4.AUTOPILOT_COMPONENT, IGNORE_RATES,
    )  # fmt: skip


class SetpointStream:
    """Stamps, copies, delay and loss of the set-points to one vehicle. Times are the ground's (s) unless said."""

    def __init__(self, clock: RemoteClock, parameters: dict[str, float], settings: LinkSettings) -> None:
        self._clock, self._parameters, self._settings = clock, parameters, settings
        self._delays: deque[float] = deque(maxlen=settings.delays)
        self._lags: deque[float] = deque(maxlen=settings.delays)
        """Of telemetry (s), with which those delays were reported."""
        self._last_stamp = -math.inf
        self.loss = self._loss_before = 0.0
        """Share of the set-points that do not arrive, by its confirmations."""
        self.lost = 0
        """Number of set-points found to be lost."""

    @property
    def copies(self) -> int:
        """Number of times to send what must arrive; once on a congested link, whose latency copies would increase."""
        if self._clock.lag > self._settings.congestion_lag:
            return 1
        return 1 + (self.loss > self._settings.second_copy_loss) + (self.loss > self._settings.third_copy_loss)

    @property
    def delay(self) -> float:
        """Delay from sending a set-point until the vehicle flies it: by its confirmations, else by round trips.

        Confirmations are a round trip old. Where the latency of telemetry has grown since, that of set-points has grown
        as much, or not at all: the middle is wrong by half, which the loop bears (control/delay_margin.py).
        """
        if len(self._delays) == self._settings.delays:
            # Round trips are worse: on a link that loses or reorders, those that arrive are not late.
            return median(self._delays) + max(self._clock.least_lag - median(self._lags), 0.0) / 2.0
        return self._clock.delay + self._onboard_period

    @property
    def delay_max(self) -> float:
        """The longest that a set-point can take, by round trips."""
        return self._clock.round_trip_max + 2.0 * self._onboard_period + self._settings.stamp_error

    def stamp(self, now: float) -> float:
        """Return the stamp of a set-point that is sent at ``now``, by the vehicle's clock (s).

        Where that is set back, stamps are not: the vehicle would take the set-points for reordered ones.
        """
        stamp = now + self._clock.offset
        if 0.0 < self._last_stamp - stamp < self._settings.stamp_step_back:
            stamp = self._last_stamp + 0.001
        self._last_stamp = stamp
        return stamp

    def confirm(self, confirmation: Confirmation) -> None:
        """Take the vehicle's report of a set-point that it flew."""
        if confirmation.delay is not None:
            self._delays.append(confirmation.delay)
            self._lags.append(self._clock.lag)
        if confirmation.late:  # nothing was lost since: the latency has grown
            self.loss = self._loss_before
        elif (flown := confirmation.as_sent) is not None:
            self.loss += self._settings.loss_filter * (float(not flown) - self.loss)
            self.lost += not flown
            if flown:
                self._loss_before = self.loss

    @property
    def _onboard_period(self) -> float:
        rate = self._parameters.get(px4.PARAM_ONBOARD_RATE, 0.0)
        return 1.0 / rate if rate > 0.0 else 0.0
