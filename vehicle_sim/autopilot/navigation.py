"""A vehicle's estimate of its own state, also while a sensor on board fails."""

import math

from gcs.config.vehicle_settings import NavigationSettings
from idc_controller.rotations_float import Quaternion, Vector, half_rotation, turned
from vehicle_sim.autopilot.attitude_check_kernels import CHECKED_AT, INERTIAL, REFUSED_UNTIL
from vehicle_sim.autopilot.inertial import accelerated
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import FRESH_AT, SAMPLE_TIME, THRUST, WEIGHT
from vehicle_sim.world.sensors import ACCELEROMETER_RANGE, Measurement, is_rotation


class Navigation:
    """Takes the sensors' samples, and for a sensor that is stuck or gives no numbers, an estimate from the others.

    The attitude then goes on with the rates; the rates are those that explain the attitude and the torque, by an
    observer of second order; position and velocity go on with the specific force (inertial dead reckoning), and the
    attitude then with the body rates, aligned with the measured one but for a step of that. A vehicle needs its rates
    hundreds of times a second: with old ones it turns over.

    Fresh samples are taken with those of the whole team, in :func:`.onboard_kernels.take_fresh_samples`; the others
    come to :meth:`update`.
    """

    specific_force: Vector | None = None
    """Mean of the time since the last step, in the body frame (m/s2); None: it is not measured."""

    def __init__(self, motor_lag: float, g: float, settings: NavigationSettings, arrays: OnboardArrays) -> None:
        """``motor_lag`` (s): time constant with which torques follow their commands; ``g`` in m/s2.

        ``arrays`` of one vehicle.
        """
        self._motor_lag, self._g = motor_lag, g
        self._settings = settings
        self.arrays = arrays
        self._row, self._stamps = arrays.estimates[0], arrays.stamps[0]
        self._usable_at = self._updated_at = -math.inf
        self._known: Measurement | None = None
        self._fresh: tuple[float, Measurement | None] = -math.inf, None
        """The last fresh sample that was read from the row, and when it came."""
        self._raw: Measurement | None = None
        self._repeated = {"attitude": 0, "rates": 0}
        self._observed: tuple[Quaternion, Vector, Vector] | None = None  # attitude, rates, their derivative
        self._has_rates = True
        self._still = 0.0
        """For how long it has stood, while its velocity was not measured (s)."""
        self._reckons = False

    @property
    def estimate(self) -> Measurement | None:
        """The state to fly by; None before the first usable sample."""
        if not self._is_fresh:
            return self._known
        fresh_at = self._stamps.item(FRESH_AT)
        if fresh_at != self._fresh[0]:
            self._fresh = fresh_at, Measurement.of_row(self._stamps.item(SAMPLE_TIME), self._row.tolist())
        return self._fresh[1]

    @property
    def is_reckoned(self) -> bool:
        """Return True while position and velocity go on by dead reckoning."""
        return self._reckons and not self._is_fresh

    @property
    def has_estimate(self) -> bool:
        """Return True from the first usable sample on."""
        return self._known is not None or self._is_fresh

    @property
    def _is_fresh(self) -> bool:
        return bool(self._stamps.item(FRESH_AT) > self._updated_at)

    def is_valid(self, now: float) -> bool:
        """Return True if usable samples come."""
        return now - max(self._usable_at, float(self._stamps[FRESH_AT])) <= self._settings.timeout

    @property
    def reported(self) -> Measurement | None:
        """The estimate as telemetry sends it: rates that were not measured are NaN, as in MAVLink."""
        if self._known is None or self._has_rates or self._is_fresh:
            return self.estimate
        return self._known._replace(rates=(math.nan, math.nan, math.nan))

    def update(self, sample: Measurement, commanded: Vector, now: float) -> Measurement | None:
        """Return the estimate after a ``sample`` that came at ``now`` (s) and is not fresh; None before a usable one.

        ``commanded``: the angular acceleration for which the torque was last set (rad/s2).
        """
        if self._is_fresh:  # the sample before this one was
            self._known = self._raw = self.estimate
            self._observed = None
            self._repeated["attitude"] = self._repeated["rates"] = 0
            self._still = 0.0
        self._updated_at = now
        if sample.is_usable():
            self._usable_at = now
        known = self._known
        if known is None:
            if not sample.is_usable():
                return None
            self._known = self._raw = sample
            return sample
        time = sample.time if math.isfinite(sample.time) else known.time
        step = time - known.time
        has_attitude = self._is_alive("attitude", sample.attitude) and is_rotation(sample.attitude)
        refused = time < self.arrays.rate_checks.item(REFUSED_UNTIL)  # they contradict the attitude
        has_rates = self._has_rates = self._is_alive("rates", sample.rates) and not refused
        # One measured anew is never the same, but for a vehicle at rest in a world without noise.
        has_position = _are_numbers(sample.position) and not (
            self._raw is not None and sample.position == self._raw.position and any(sample.rates)
        )
        if has_position:
            self._still = 0.0
        self._reckons = not has_position and self.specific_force is not None
        self._raw, raw = sample, self._raw
        if has_rates and has_attitude and has_position and sample.is_usable():
            self._known, self._observed = sample, None
            return sample
        if has_rates:
            rates = sample.rates
        elif has_attitude:
            rates = self._rates_of(sample.attitude, step, commanded)
        else:
            rates = (0.0, 0.0, 0.0)
        if has_rates or not has_attitude:
            self._observed = None
        attitude = sample.attitude if has_attitude else turned(known.attitude, rates, step)
        check = self.arrays.rate_checks[0]
        if has_rates and has_attitude and not has_position and check.item(CHECKED_AT) == time:
            w, x, y, z = check[INERTIAL : INERTIAL + 4].tolist()
            attitude = w, x, y, z
        if has_position or self.specific_force is None:
            position = sample.position if has_position else known.position
            velocity = sample.velocity if _are_numbers(sample.velocity) else known.velocity
        else:
            has_velocity = _are_numbers(sample.velocity) and not (raw is not None and sample.velocity == raw.velocity)
            velocity = sample.velocity if has_velocity else self._accelerated(known.velocity, attitude, step)
            x, y, z = (r + step * v for r, v in zip(known.position, velocity, strict=True))
            position = x, y, z
        self._known = Measurement(time, attitude, rates, position, velocity)
        return self._known

    def _accelerated(self, velocity: Vector, attitude: Quaternion, step: float) -> Vector:
        """Return the ``velocity`` (m/s) after a ``step`` (s) of the specific force.

        It is zero at an impact, and where the vehicle stands (zero-velocity update): nothing accelerates it, although
        its thrust is below its weight.
        """
        assert self.specific_force is not None
        size = math.hypot(*self.specific_force)
        carried = self.arrays.targets.item(0, THRUST) < self.arrays.detectors.item(0, WEIGHT)
        self._still = self._still + step if carried and abs(size - self._g) < self._settings.still_force else 0.0
        if size > ACCELEROMETER_RANGE or self._still > self._settings.still_time:
            return 0.0, 0.0, 0.0
        return accelerated(velocity, attitude, self.specific_force, self._g, step)

    def _is_alive(self, channel: str, value: Quaternion | Vector) -> bool:
        # A vehicle at rest in a world without noise has rates of exactly zero.
        repeats = self._raw is not None and getattr(self._raw, channel) == value and any(value)
        self._repeated[channel] = self._repeated[channel] + 1 if repeats else 0
        return _are_numbers(value) and self._repeated[channel] < self._settings.stuck_after

    def _rates_of(self, attitude: Quaternion, step: float, commanded: Vector) -> Vector:
        """Body rates (rad/s) by an observer that follows the ``attitude``, ``step`` (s) after the last one."""
        assert self._known is not None
        if self._observed is None or not 0.0 < step < self._settings.gap_max:
            self._observed = self._known.attitude, self._known.rates, commanded
        guess, rates, turning = self._observed
        guess = turned(guess, rates, step)
        off = tuple(2.0 * x for x in half_rotation(guess, attitude))
        share = 1.0 - math.exp(-step / self._motor_lag)
        a, b, c = (now + share * (then - now) for now, then in zip(turning, commanded, strict=True))
        p, q, r = (
            rate + step * (acceleration + self._settings.rates_bandwidth**2 * x)
            for rate, acceleration, x in zip(rates, (a, b, c), off, strict=True)
        )
        i, j, k = (2.0 * self._settings.rates_bandwidth * x for x in off)
        self._observed = turned(guess, (i, j, k), step), (p, q, r), (a, b, c)
        return p, q, r


def _are_numbers(values: Quaternion | Vector) -> bool:
    return -1e6 < sum(values) < 1e6
