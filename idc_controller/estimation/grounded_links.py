"""Links over a payload on the ground: their tilts, and by how much each UAV's thrust is off its attitude.

The ground holds the payload, so the model of flight does not apply: each UAV is a pendulum above its attachment point,

    m l s'' = -(f - m g) s - f (n + b) - w,

with the link's tilt s and the thrust direction n as in :mod:`idc_controller.model.linear`, the thrust f, the drag w of
the wind, and b what the thrust is off the attitude: by an attitude that is wrong on board, and by what else of its own
pulls the UAV aside. One Kalman filter a UAV takes its positions and attitudes, about the payload as its unit reports
it, without those that contradict each other. A UAV without a position goes on by its attitudes and set-points, by the
payload's motion, and by its own part of the b that was found before; the wind's part is that of the others.
"""

import math
from collections import deque
from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.grounded_payload import GroundedPayload
from idc_controller.estimation.health.attitude_steps import AttitudeStep
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise, Position
from idc_controller.estimation.settings import GroundedLinksSettings
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import rotation_from_quaternion

S, S_DOT, OFF, N, N_DOT, N_ACC = range(6)
"""Rows of a state: s, s', b, n, n', n''."""
_TERMS = 9
"""Of the series of a matrix exponential: over :data:`_STEP_MAX` the attitude loop's next one is below 1e-6."""
_STEP_MAX = 0.05  # s
_AHEAD_MAX = 0.5  # s; of a measurement after the newest set-points act: its time is wrong


DEFAULTS = GroundedLinksSettings()


class LinkStates(NamedTuple):
    """State of the links at one time."""

    x: Array
    """s, s', b, n, n', n'' by axis, north and east (6, N, 2)."""
    thrust: Array
    """f (N,) (N)"""
    drag: Array
    """w (2,) (N)"""
    payload_velocity: Array = np.zeros(3)
    """(3,) (m/s)"""
    located: Mask = np.array(True)
    """Which UAVs have a position (N,)."""


class _Command(NamedTuple):
    """Set-points from ``time`` (s) on: tilts (N, 2), thrusts (N,) (N)."""

    time: float
    tilts: Array
    thrusts: Array


class _Consistency:
    """Whether positions of a UAV follow from its velocities: where they do not, one of the two is wrong.

    The health's dead reckoning compares medians over two seconds: in that time a link leans too far.
    """

    def __init__(self, limit: float, settings: GroundedLinksSettings) -> None:
        """``limit`` (m) of the difference of two positions that is none of their noise."""
        self._limit, self._settings = limit, settings
        self._last: Position | None = None
        self._off = np.zeros(2)
        """Way of the positions less that of the velocities, as lately summed up (2,) (m)."""

    def holds(self, sample: Position) -> bool:
        """Take a ``sample``; return whether its position and its velocity may be used."""
        if not (sample.has_pose and sample.has_motion):
            return True
        last, self._last, s = self._last, sample, self._settings
        interval = math.inf if last is None else sample.time - last.time
        if last is not None and interval < s.position_gap:
            moved = sample.pose - last.pose - 0.5 * interval * (sample.motion + last.motion)
            self._off = (1.0 - interval / s.reckoning_memory) * self._off + moved[:2]
        return float(np.linalg.norm(self._off)) < self._limit


class GroundedLinks:
    """Estimates the links of a team on the ground. Times are those of the measurements' clock (s)."""

    def __init__(
        self,
        parameters: SystemParameters,
        noise: MeasurementNoise = MeasurementNoise(),
        settings: GroundedLinksSettings = DEFAULTS,
    ) -> None:
        """``noise`` of the sensors."""
        self._parameters, self._settings = p, s = parameters, settings
        number = p.number_of_uavs
        self._weight, self._inertia = p.m * p.g, p.m * p.l
        self._loop = np.array([-p.attitude_kp, -p.attitude_kd, -1.0]) / p.motor_time_constant
        self._variance = np.square(
            [max(noise.position, s.position_noise_min), max(noise.uav_velocity, s.velocity_noise_min)]
        )
        self._direction_variance = max(noise.attitude, s.attitude_noise_min) ** 2
        self._density = np.square([0.0, s.link_acceleration, s.thrust_error_walk, 0.0, 0.0, s.uav_jerk])
        self._initial = np.square([s.tilt, s.tilt_rate, s.thrust_error, s.direction, 0.0, 0.0])
        self._times = np.zeros(number)
        self._x, self._P = np.zeros((number, 6, 2)), np.zeros((number, 6, 6))
        self._drag = np.zeros(2)
        self._located = np.zeros(number)
        """Time of the last position of each UAV (s)."""
        self._newest = -math.inf
        """Time of the newest measurement (s)."""
        self._common, self._own = np.zeros(2), np.zeros((number, 2))
        """What all have of b (2,), and what each UAV has beside it (N, 2), low-passed."""
        self._offsets = np.zeros((number, 2))
        """What each UAV had beside it in the air (N, 2), and what its attitude has stepped since."""
        self._arm = float(np.linalg.norm(p.p, axis=1).max())
        self._payload = GroundedPayload(0.0, np.zeros(12), self._arm, s)
        self._contradiction = s.innovation_max * math.sqrt(2.0 * float(self._variance[0]))
        self._consistency = [_Consistency(self._contradiction, s) for _ in range(number)]
        self._commands: deque[_Command] = deque()

    def start(
        self, time: float, payload: Array, x: Array, thrusts: Array, drag: Array, unlocated: Collection[int] = ()
    ) -> None:
        """Begin at ``time`` (s).

        Args:
            time: s.
            payload: position, velocity, Euler angles and body rates of the payload (12,).
            x: state of the links (6, N, 2).
            thrusts: of the UAVs (N,) (N).
            drag: of the wind on each of them (2,) (N).
            unlocated: UAVs (from 0) without a position.
        """
        self._payload = GroundedPayload(time, payload, self._arm, self._settings)
        self._consistency = [_Consistency(self._contradiction, self._settings) for _ in self._consistency]
        self._times[:] = time
        self._located[:] = time
        self._located[[*unlocated]] = -math.inf
        self._common = np.median(x[OFF], axis=0)
        self._own = x[OFF] - self._common
        self._offsets = self._own.copy()
        self._x[:] = x.transpose(1, 0, 2)
        self._P[:] = np.diag(self._initial)
        self._drag = drag
        self._commands = deque([_Command(time, x[N], thrusts)])

    def command(self, effective: float, tilts: Array, thrusts: Array) -> None:
        """Take set-points that act from ``effective`` (s) on: tilts (N, 2), thrusts (N,) (N)."""
        commands, oldest = self._commands, float(self._times.min())
        self._share_errors(effective - commands[-1].time)
        commands.append(_Command(effective, tilts, thrusts))
        while len(commands) > 1 and commands[1].time <= oldest:
            commands.popleft()

    def _share_errors(self, step: float) -> None:
        """Let UAVs without a position have what the others have in common: the wind, as it is now.

        Where no UAV has a position that stays as it was. Their own is what it was in the air, unless another one was
        found that is more than noise.
        """
        s, errors, located = self._settings, self._x[:, OFF], self._is_located
        if located.any():
            share = 1.0 - math.exp(-step / s.error_time_constant)
            # Without offsets: the median of a few of which one is far off is not in the middle of the others.
            common = np.median(errors[located] - self._offsets[located], axis=0)
            self._common = self._common + share * (common - self._common)
            self._own[located] += share * (errors[located] - common - self._own[located])
        else:
            common = self._common
        found = np.linalg.norm(self._own - self._offsets, axis=1, keepdims=True) > s.error_min
        errors[~located] = np.where(found, self._own, self._offsets)[~located] + common

    def add(self, measurement: Measurement) -> None:
        """Take a ``measurement`` of the payload's unit, or of a UAV unless a later one was taken before."""
        i, p = measurement.source, self._parameters
        self._newest = max(self._newest, measurement.time)
        if i == PAYLOAD:
            before = self._payload.velocities(p.p)
            self._payload.add(measurement)
            # A payload that is stopped, or turned, by the ground moves the feet of the links.
            self._x[:, S_DOT] += (self._payload.velocities(p.p) - before)[:, :2] / p.l[:, None]
            return
        if not self._times[i] <= measurement.time <= self._commands[-1].time + _AHEAD_MAX:
            return
        self._times[i], self._x[i], self._P[i] = self._advanced(i, measurement.time)
        if isinstance(measurement, Attitude):
            if measurement.has_pose:
                direction = -rotation_from_quaternion(measurement.pose)[:2, 2]
                self._update(i, N, direction, self._direction_variance)
            return
        if not self._consistency[i].holds(measurement):
            return
        position, velocity = self._payload.positions(p.p[i]), self._payload.velocities(p.p[i])
        if measurement.has_pose or measurement.has_motion:
            self._located[i] = measurement.time
        if measurement.has_pose:
            self._update(i, S, (position - measurement.pose)[:2] / p.l[i], self._variance[0] / p.l[i] ** 2)
        if measurement.has_motion:
            self._update(i, S_DOT, (velocity - measurement.motion)[:2] / p.l[i], self._variance[1] / p.l[i] ** 2)

    def take_attitude_step(self, step: AttitudeStep) -> None:
        """Take a ``step`` of a UAV's attitude, by which its thrust is off its attitude from now on."""
        self._x[step.uav, OFF] -= step.angle
        self._own[step.uav] -= step.angle
        self._offsets[step.uav] -= step.angle

    def locate(self, measurement: Measurement) -> None:
        """Take a ``measurement`` in the air: which UAVs have a position."""
        self._newest = max(self._newest, measurement.time)
        if isinstance(measurement, Position) and measurement.source != PAYLOAD and measurement.has_pose:
            self._located[measurement.source] = measurement.time

    @property
    def unlocated(self) -> frozenset[int]:
        """UAVs that have sent no position for a while, by the newest measurement: links may be slow."""
        return frozenset(np.flatnonzero(self._newest - self._located > self._settings.position_gap).tolist())

    @property
    def _is_located(self) -> Mask:
        """Which UAVs have a position (N,)."""
        return np.asarray(self._times.max() - self._located < self._settings.position_gap)

    @property
    def payload_velocity(self) -> Array:
        """Velocity of the payload (3,) (m/s), as its unit measured it last."""
        return self._payload.velocity

    def at(self, time: float) -> LinkStates:
        """Return the states at ``time`` (s), by the set-points until then."""
        states = [self._advanced(i, time)[1] for i in range(len(self._times))]
        states_of_links = np.array(states).transpose(1, 0, 2)
        return LinkStates(
            states_of_links, self._command_at(time).thrusts, self._drag, self.payload_velocity, self._is_located
        )

    def _command_at(self, time: float) -> _Command:
        at = self._commands[0]
        for command in self._commands:
            if command.time > time:
                break
            at = command
        return at

    def _advanced(self, i: int, time: float) -> tuple[float, Array, Array]:
        """Return time, state (6, 2) and covariance (6, 6) of UAV ``i`` at ``time`` (s), or at its last one if later."""
        now, x, P = float(self._times[i]), self._x[i], self._P[i]
        while now < time:
            command = self._command_at(now)
            later = [c.time for c in self._commands if c.time > now]
            step = min(time, now + _STEP_MAX, *later) - now
            F, driven = self._transition(i, command, step)
            x = F @ x + driven
            P = F @ P @ F.T + step * np.diag(self._density)
            now += step
        return max(now, time), x, P

    def _transition(self, i: int, command: _Command, step: float) -> tuple[Array, Array]:
        """Return the transition (6, 6) over a ``step`` (s), and what set-points and drag add (6, 2)."""
        f, inertia = command.thrusts[i], self._inertia[i]
        A, driven = np.zeros((6, 6)), np.zeros((6, 2))
        A[N, N_DOT] = A[N_DOT, N_ACC] = 1.0
        A[N_ACC, N:] = self._loop
        driven[N_ACC] = -self._loop[0] * command.tilts[i]
        if f > self._weight[i]:  # below, a cradle may hold it
            A[S, S_DOT] = 1.0
            A[S_DOT, [S, OFF, N]] = -(f - self._weight[i]) / inertia, -f / inertia, -f / inertia
            driven[S_DOT] = -self._drag / inertia
        F, integral, term = np.eye(6), step * np.eye(6), step * np.eye(6)
        for k in range(2, _TERMS + 1):  # term: A^(k-2) step^(k-1) / (k-1)!
            F = F + A @ term
            term = A @ term * (step / k)
            integral = integral + term
        return F, integral @ driven

    def _update(self, i: int, row: int, value: Array, variance: float) -> None:
        """Correct the state of UAV ``i`` by a measured ``value`` (2,) of a ``row`` of it."""
        P = self._P[i]
        total = P[row, row] + variance
        gain = P[:, row] / total
        bound = self._settings.innovation_max * np.sqrt(total)
        self._x[i] += np.outer(gain, np.clip(value - self._x[i, row], -bound, bound))
        self._P[i] = P - np.outer(gain, P[row])
