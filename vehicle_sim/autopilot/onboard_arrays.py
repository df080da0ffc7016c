"""The arrays that the kernels of the onboard loop work on."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from gcs.config.vehicle_settings import LandDetectorSettings, NavigationSettings
from idc_controller.arrays import Array, Mask
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.attitude_check_kernels import (
    ALIGNMENT_TIME,
    RATE_CHECK_COLUMNS,
    RATES_ERROR_MAX,
    RATES_REFUSED,
    RATES_WINDOW,
)
from vehicle_sim.autopilot.onboard_kernels import (
    IN_AIR,
    LANDING_COLUMNS,
    LAST_TIME,
    LIFT,
    LIFTED_AT,
    RATE,
    STAMP_COLUMNS,
    STANDING_SINCE,
    TARGET_COLUMNS,
    TOUCHING_SINCE,
    VELOCITY,
)
from vehicle_sim.world.state_kernels import STATE_COLUMNS

_NAVIGATION = NavigationSettings()


@dataclass(frozen=True, eq=False)
class OnboardArrays:
    """One row for each of N vehicles; columns as in :mod:`.onboard_kernels`.

    Every vehicle owns its row, and a vehicle alone is a team of one.
    """

    airframes: Array
    detectors: Array
    last_samples: Array
    """The newest sample of each, as it came."""
    fresh: Mask
    """Vehicles whose newest sample is the new estimate."""
    estimates: Array
    stamps: Array
    """Times of the last fresh samples, and when they came (N, 2) (s)."""
    learns: Mask
    """Vehicles that fly set-points of the ground, and learn the thrust that they hover with."""
    landings: Array
    targets: Array
    accelerations: Array
    """Angular accelerations (N, 3) for which the torques were last set (rad/s2)."""
    speeds: Array
    """Commanded rotor speeds (N, 4) (rad/s)."""
    idle_until: Array
    """Times (N,) (s) before which the vehicles have nothing to decide; -inf: they have at the next step."""
    rate_checks: Array
    """Comparison of body rates with the attitude (N, 17)."""

    @classmethod
    def of(
        cls,
        airframes: Sequence[Airframe],
        settings: LandDetectorSettings,
        attitude_noise: float = math.inf,
        navigation: NavigationSettings = _NAVIGATION,
    ) -> Self:
        """Return the arrays of vehicles that have not begun.

        ``attitude_noise``: standard deviation of measured attitudes (rad), by which rates are compared with them; inf:
        they are not.
        """
        n = len(airframes)
        rate_checks = np.full((n, RATE_CHECK_COLUMNS), -np.inf)
        of_two = 2.0**0.5 * attitude_noise
        rate_checks[:, RATES_ERROR_MAX] = max(navigation.rates_sigmas * of_two, navigation.rates_error)
        rate_checks[:, [RATES_WINDOW, RATES_REFUSED]] = navigation.rates_window, navigation.rates_refused
        rate_checks[:, ALIGNMENT_TIME] = navigation.alignment_time
        landings = np.full((n, LANDING_COLUMNS), np.nan)
        landings[:, [VELOCITY, RATE, LIFT, LAST_TIME, IN_AIR]] = 0.0
        landings[:, LIFTED_AT] = -np.inf
        landings[:, [STANDING_SINCE, TOUCHING_SINCE]] = np.inf
        return cls(
            np.array([_airframe(airframe) for airframe in airframes]),
            np.array([_detector(airframe, settings) for airframe in airframes]),
            np.full((n, STATE_COLUMNS), np.nan),
            np.zeros(n, dtype=np.bool_),
            np.full((n, STATE_COLUMNS), np.nan),
            np.full((n, STAMP_COLUMNS), -np.inf),
            np.zeros(n, dtype=np.bool_),
            landings,
            np.zeros((n, TARGET_COLUMNS)),
            np.zeros((n, 3)),
            np.zeros((n, 4)),
            np.full(n, -np.inf),
            rate_checks,
        )

    def of_vehicle(self, i: int) -> Self:
        """Return the row of vehicle ``i`` (from 0), shared with these arrays."""
        return type(self)(*(getattr(self, field.name)[i : i + 1] for field in fields(self)))


def _airframe(airframe: Airframe) -> list[float]:
    (j_xx, j_xy, j_xz), (_, j_yy, j_yz), (_, _, j_zz) = airframe.inertia
    rotors = airframe.rotors
    return [
        j_xx, j_yy, j_zz, j_xy, j_xz, j_yz, 2.0 * airframe.attitude_kp, airframe.attitude_kd,
        rotors.thrust_max / 4.0, 1.0 / (4.0 * rotors.lever), 1.0 / (4.0 * rotors.torque_to_thrust), 1.0 / rotors.k_f,
    ]  # fmt: skip


def _detector(airframe: Airframe, settings: LandDetectorSettings) -> list[float]:
    return [
        airframe.mass * airframe.g, airframe.rotors.thrust_max, settings.lifted, settings.vertical_speed_max,
        settings.time, settings.touchdown_thrust, settings.touchdown_sinking, settings.velocity_filter,
        settings.altitude_filter, settings.hover_filter, settings.altitude_tolerance,
        settings.time_elsewhere, airframe.g,
    ]  # fmt: skip
