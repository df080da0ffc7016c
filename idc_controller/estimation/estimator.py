"""State estimator: the state now, from measurements that are late, repeated, out of order or missing.

A Kalman filter on the linear model, run on the error about the exact flat reference, so that the manoeuvre itself is no
disturbance to it; what the linear model leaves out of the error is added to the prediction. Measurements are applied in
order of their time of validity; a late one returns the filter to before it, and all later ones are applied again.
Disturbance forces on the payload and on each UAV and an excess of the payload's mass are estimated along with the
state, so that none of them leaves an offset.
"""

import bisect
import math
from collections.abc import Sequence
from itertools import pairwise
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.health.attitude_steps import AttitudeStep, AttitudeSteps
from idc_controller.estimation.health.sensor_health import HealthSnapshot, SensorHealth
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurement_update import MeasurementUpdate, Moment
from idc_controller.estimation.measurements import (
    PAYLOAD,
    Attitude,
    Estimate,
    InnovationRecord,
    Measurement,
    MeasurementNoise,
    Position,
    SensorGroup,
)
from idc_controller.estimation.process_model import ProcessModel
from idc_controller.estimation.propagation import ErrorStateFilter, Outlook, PropagationInterval
from idc_controller.estimation.setpoint_history import Confirmation, SetpointHistory
from idc_controller.estimation.settings import EstimatorSettings
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import quaternion_from_euler
from idc_controller.trajectory.flatness import Load, Reference


class Snapshot(NamedTuple):
    """The filter after the measurements of one time (s)."""

    time: float
    x: Array
    """Absolute state (n,)."""
    P: Array
    """(n, n)"""
    health: HealthSnapshot


class ReplayBuffer:
    """Measurements of the last ``duration`` (s), in moments, and snapshots of the filter between them. Times in s."""

    def __init__(self, duration: float, simultaneous: float) -> None:
        """``simultaneous``: measurements closer than this (s) are of one moment."""
        self._duration, self._simultaneous = duration, simultaneous
        self._times: list[float] = []
        self._moments: list[Moment] = []
        self.snapshots: list[Snapshot] = []

    def start(self, first: Snapshot) -> None:
        """Discard all and begin with a snapshot."""
        self._times, self._moments, self.snapshots = [], [], [first]

    @property
    def time(self) -> float:
        """Time of the last measurement that was applied (s); -inf before the start."""
        return self.snapshots[-1].time if self.snapshots else -math.inf

    def add(self, measurement: Measurement) -> bool:
        """Add a measurement and return to before it; returns False for one that is too old."""
        if measurement.time <= self.snapshots[0].time or measurement.time <= self.time - self._duration:
            return False
        moment = self.insert(measurement)
        if moment is not None and moment <= self.time:
            self.rewind(moment)
        return True

    def insert(self, measurement: Measurement) -> float | None:
        """Add a measurement; return the time of its moment, or None if it adds nothing to what was applied."""
        time, times = measurement.time, self._times
        at = bisect.bisect_left(times, time - self._simultaneous)
        if at == len(times) or times[at] > time + self._simultaneous:
            times.insert(at, time)
            self._moments.insert(at, Moment(time, {}))
        moment, key = self._moments[at], (measurement.source, type(measurement))
        copies = moment.measurements.get(key)
        if copies is None:
            moment.measurements[key] = [measurement]
        elif measurement.source == PAYLOAD and moment.time <= self.time:
            return None  # another vehicle's relay of what was applied already
        else:
            copies.append(measurement)
        return moment.time

    def rewind(self, time: float) -> None:
        """Return to before ``time`` (s), as far as there are snapshots."""
        while len(self.snapshots) > 1 and self.snapshots[-1].time >= time:
            self.snapshots.pop()

    def after(self, time: float) -> list[Moment]:
        """Return the moments after ``time`` (s)."""
        return self._moments[bisect.bisect_right(self._times, time) :]

    def forget(self) -> float:
        """Discard what is older than the duration; return the oldest time that is left (s)."""
        horizon = self.time - self._duration
        keep = max(bisect.bisect_right(self.snapshots, horizon, key=attrgetter("time")) - 1, 0)
        del self.snapshots[:keep]
        oldest = self.snapshots[0].time
        old = bisect.bisect_right(self._times, oldest)
        del self._times[:old], self._moments[:old]
        return oldest


_POSES, _MOTIONS = (True, False), (False, True)


class Estimator:
    """Kalman filter with memory. Times are those of the measurements' clock (s)."""

    def __init__(
        self,
        model: LinearModel,
        noise: MeasurementNoise = MeasurementNoise(),
        settings: EstimatorSettings = EstimatorSettings(),
    ) -> None:
        """``noise`` of the sensors."""
        number_of_uavs = model.layout.number_of_uavs
        self.settings = s = settings
        self.measurement_model = MeasurementModel(model, noise, s.measurement)
        self.health = SensorHealth(number_of_uavs, noise, s)
        self.attitude_steps = AttitudeSteps(model.parameters, noise, s.attitude_steps)
        """Compares attitudes with body rates, also before the start."""
        self._process = ProcessModel(model, s.process)
        self._nominal_mass = model.parameters.m_0
        self._other_mass_since = math.inf
        """Time since when the learnt mass is another than the model's (s); inf: it is not."""
        self._follows_mass = False
        """True once the model has taken a learnt mass in the air."""
        self._filter = ErrorStateFilter(self._process)
        self._update = MeasurementUpdate(self.measurement_model, self.health, s)
        self._replay = ReplayBuffer(s.history, s.simultaneous)
        self._steps: list[AttitudeStep] = []
        """Within the filter's memory."""
        self._directions: dict[float, tuple[Array, Array]] = {}
        """n' of the UAVs (2 N,) at each moment, predicted and corrected."""
        self.setpoints = SetpointHistory(number_of_uavs, s.setpoints)
        """Set-points in force; their confirmations go by :meth:`confirm_setpoint`."""

    def start(self, time: float, x: Array, load: Load | None = None) -> None:
        """Begin at ``time`` (s) from the state ``x`` (12 + 11 N,) of a team on the ground, under ``load``."""
        self.setpoints.clear()
        self.health.start()
        self._other_mass_since, self._follows_mass = math.inf, False
        self._begin(time, np.concatenate([x, self._process.forces_of(load)]))

    def _begin(self, time: float, x: Array) -> None:
        P = self._process.initial_covariance(self.settings.initial)
        self._replay.start(Snapshot(time, x, P, self.health.snapshot()))

    def lift_off(self, thrusts: Array, speed: float, load: Load) -> None:
        """Begin anew at the last measurement, with what the ground has hidden until the payload lifted off.

        The model is that of the mass of ``load`` from now on.

        Args:
            thrusts: of the UAVs (N,) (N).
            speed: upward (m/s).
            load: payload's mass; its forces on payload and UAVs are those that the filter has.
        """
        process = self._take_model(load.mass)
        last = self._replay.snapshots[-1]
        x = last.x.copy()
        x[process.layout.f], x[process.layout.v_0.start + 2] = thrusts, -speed
        x[process.force.start + 2], x[process.mass] = load.force[2], load.mass - process.model.parameters.m_0
        self._begin(last.time, x)

    def follow_mass(self, mass: float) -> None:
        """Take a learnt payload ``mass`` (kg) into the model, where that has been another for a while. Once a step.

        The links' tension is then that of the model, and with it the motion of payload and UAVs about each other. A
        blow is learnt as a mass, too, but does not last.
        """
        before, s = self._process, self.settings
        nominal, g = before.model.parameters.m_0, before.model.parameters.g
        off = abs(mass - nominal) / nominal
        # One that was taken may be of a blow, or learnt by half: it is corrected when it has settled.
        if off <= (s.model_mass_settled if self._follows_mass else s.model_mass_error):
            self._other_mass_since = math.inf
            return
        self._other_mass_since = min(self._other_mass_since, self.time)
        lasts = s.model_mass_time if off > s.model_mass_error else s.model_mass_settling
        if self.time - self._other_mass_since < lasts:
            return
        self._other_mass_since, self._follows_mass = math.inf, True
        vertical = before.force.start + 2
        process = self._take_model(mass)
        for k, snapshot in enumerate(self._replay.snapshots):
            x = snapshot.x.copy()
            carried = nominal + x[process.mass] + x[vertical] / g  # at rest mass and vertical force are the same
            x[process.mass], x[vertical] = carried - mass, 0.0
            self._replay.snapshots[k] = snapshot._replace(x=x)

    def _take_model(self, mass: float) -> ProcessModel:
        """Return the model of a payload of ``mass`` (kg), which is used from now on."""
        parameters = self._process.model.parameters.with_payload_mass(mass)
        self._process = process = ProcessModel(LinearModel(parameters), self.settings.process)
        self._filter = ErrorStateFilter(process)
        return process

    @property
    def time(self) -> float:
        """Time of the last measurement that was applied (s)."""
        return self._replay.time

    def confirm_setpoint(
        self, uav: int, since: float, until: float, reported: Sequence[float], jitter: float = 0.0,
        latency_max: float = np.inf,
    ) -> Confirmation | None:  # fmt: skip
        """Take a vehicle's report of the set-point it flew, see :meth:`SetpointHistory.confirm`."""
        confirmation = self.setpoints.confirm(uav, since, until, reported, jitter, latency_max)
        if confirmation is not None and confirmation.corrected_from is not None:
            self._replay.rewind(confirmation.corrected_from)
        return confirmation

    def add(self, measurement: Measurement) -> Measurement | None:
        """Take a measurement; return what may be used of it: nothing where it is stuck or too old."""
        usable = self.health.received(measurement)
        return usable if usable is not None and self._replay.add(usable) else None

    def new_attitude_steps(self) -> list[AttitudeStep]:
        """Return the steps that vehicles fly by, as found since the last time; call it after an estimate."""
        return self.attitude_steps.confirmed(self._explained)

    def _explained(self, uav: int, since: float, until: float) -> Array:
        """Return the change of n' (2,) (1/s) of a UAV between two times (s) that the filter has predicted."""
        gap = self.settings.simultaneous
        times = sorted(t for t in self._directions if since - gap <= t <= until + gap)
        part = slice(2 * uav, 2 * uav + 2)
        changes = [self._directions[b][0][part] - self._directions[a][1][part] for a, b in pairwise(times)]
        return np.sum(changes, axis=0) if changes else np.zeros(2)

    def take_attitude_step(self, step: AttitudeStep) -> None:
        """Take a ``step`` of a UAV's attitude, by which its thrust is off its attitude from then on."""
        self._steps = sorted([*self._steps, step], key=attrgetter("time"))
        self._replay.rewind(step.time - self.settings.simultaneous)

    def hold_payload(self, time: float, position: Array, yaw: float) -> None:
        """Take the payload to stand at ``time`` (s) where its unit's telemetry has timed out.

        The ground holds it, which the linear model does not contain: unmeasured, its estimate would follow the pull of
        the links.

        Args:
            time: s.
            position: NED (3,) (m).
            yaw: rad.
        """
        since = time - self.settings.payload_timeout
        if any((PAYLOAD, Position) in moment.measurements for moment in self._replay.after(since)):
            return
        zero, level = np.zeros(3), quaternion_from_euler(0.0, 0.0, yaw)
        self._replay.rewind(time)
        self._replay.insert(Position(time, PAYLOAD, position, zero))
        self._replay.insert(Attitude(time, PAYLOAD, level, zero))

    def estimate(self, time: float, reference: Reference) -> Estimate:
        """Apply all measurements that were added, and predict to ``time``, when the next set-points take effect (s)."""
        for group in self.health.dead_reckoning.inconsistent_groups:
            if group not in self.health.isolated_groups:
                self._isolate(group, time, reference)
        estimate = self._advance(time, reference)
        oldest = self._replay.forget()
        self.setpoints.forget(oldest)
        self._steps = [step for step in self._steps if step.time > oldest]
        self._directions = {time: value for time, value in self._directions.items() if time > oldest}
        return estimate

    def _isolate(self, group: SensorGroup, time: float, reference: Reference) -> None:
        """Isolate poses or motions of a ``group`` that contradicts itself, whichever fits all other measurements less.

        The filter's memory is replayed without the ones and without the others, without adaptation.
        """
        replay, first = self._replay, self._replay.snapshots[:1]
        misfits = []
        for choice in _POSES, _MOTIONS:
            self.health.isolated_groups[group] = choice
            replay.snapshots = first.copy()
            innovations = self._advance(time, reference, adapt=False).innovations
            misfits.append(np.mean([self._misfit(record) for record in innovations] or [0.0]))
        self.health.isolated_groups[group] = _POSES if misfits[0] <= misfits[1] else _MOTIONS
        replay.snapshots = first

    def _misfit(self, record: InnovationRecord) -> float:
        """Return the mean square of the normalised innovations, each bounded."""
        limit = self.settings.dead_reckoning.misfit_limit
        innovations = np.split(record.normalised, np.cumsum(record.sizes)[:-1])
        return float(np.mean([min(float(y @ y) / len(y), limit) for y in innovations]))

    def _advance(self, time: float, reference: Reference, adapt: bool = True) -> Estimate:
        """Apply the pending measurements and predict to ``time`` (s)."""
        process, health, kf, last = self._process, self.health, self._filter, self._replay.snapshots[-1]
        pending = self._replay.after(self.time)
        time = max(time, last.time, pending[-1].time if pending else time)
        times = [moment.time for moment in pending]
        interval = PropagationInterval(process, last.time, times, time, self.setpoints, reference)
        kf.start(last.x, last.P, interval)
        health.restore(last.health)
        innovations = []
        near = self.settings.simultaneous
        steps = [step for step in self._steps if step.time - near > last.time]
        moments = iter(pending)
        moment, k = next(moments, None), 0
        while moment is not None:
            if moment.time > interval.times[k]:
                kf.advance(interval, k, health.adaptation.process_scale)
                k += 1
                continue
            while steps and steps[0].time - near <= moment.time:
                kf.move(*process.attitude_step(steps.pop(0)))
            predicted = kf.state(k)[process.layout.n_dot]
            record = self._update.apply(kf, moment, interval.flat, k, adapt)
            self._directions[moment.time] = predicted, kf.state(k)[process.layout.n_dot]
            if record is not None:
                innovations.append(record)
            self._replay.snapshots.append(Snapshot(moment.time, kf.state(k), kf.P, health.snapshot()))
            moment = next(moments, None)
        ahead = Outlook(process, interval, k, kf.P, health.adaptation.process_scale)
        x, n = kf.state_ahead(interval, k), process.layout.size
        mass_excess = float(x[process.mass]) + process.model.parameters.m_0 - self._nominal_mass
        on_uavs = np.zeros((process.layout.number_of_uavs, 3))
        on_uavs[:, :2] = x[process.uav_force].reshape(-1, 2)
        return Estimate(
            time, x[:n], x[process.force], on_uavs, mass_excess,
            ahead.force_covariance(), ahead.covariance, tuple(innovations), ahead.payload_variances, time - self.time,
        )  # fmt: skip
