"""The state now, from measurements that come late, twice, out of order or not at all.

A Kalman filter on the linear model, run on the error about the exact flat reference, so that the manoeuvre itself is no
disturbance to it. Measurements are kept in order of the time they were true; one that comes late takes the filter back
to before it, and all later ones are applied again. Steady forces on the payload and on each UAV and an excess
of the payload's mass are estimated along with the state, so that none of them leaves an offset.
"""

from __future__ import annotations

import bisect
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from idc_controller.estimation.estimate import Estimate, InnovationRecord
from idc_controller.estimation.health.channel_isolation import Distrust, Half
from idc_controller.estimation.health.covariance_reset import FirstDoubt, Surprise
from idc_controller.estimation.health.dead_reckoning import DeadReckoning, Group
from idc_controller.estimation.health.innovation_test import Judgement, OutlierGate
from idc_controller.estimation.health.noise_adaptation import Adaptation
from idc_controller.estimation.health.stuck_sensor import FrozenSensors
from idc_controller.estimation.measurement_history import MeasurementHistory, Moment
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise, Position, middle
from idc_controller.estimation.process_model import ProcessModel, ProcessNoise
from idc_controller.estimation.propagation import Way
from idc_controller.estimation.setpoint_history import Confirmation, SetpointHistory
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import quaternion_from_euler
from idc_controller.trajectory.flatness import FlatReference
from idc_controller.trajectory.reference import Reference

Array = NDArray[np.float64]

PATIENCE = 3
"""So many times in a row the payload unit may disagree with the prediction before the prediction is doubted."""

OUTLIER = 25.0
"""Square of an innovation with variance 1 that is certainly none."""

PAYLOAD_SILENT = 0.3
"""Without the payload's unit for longer, a payload that stands is taken to stay (s)."""

_POSES, _MOTIONS = (True, False), (False, True)

DISTRUST = 0.5
"""For how long what was left out counts as wrong (s)."""


@dataclass(frozen=True)
class EstimatorSettings:
    """Noise, gates and memory of the filter."""

    measurement: MeasurementNoise = field(default_factory=MeasurementNoise)
    process: ProcessNoise = field(default_factory=ProcessNoise)
    gate_probability: float = 1.0 - 1e-6
    """Share of sound measurements that the outlier gate lets through."""
    history: float = 1.0
    """How late a measurement may come and still count (s)."""
    simultaneous: float = 0.002
    """Measurements closer than this are taken as of one moment (s)."""
    first_doubt: FirstDoubt = field(default_factory=FirstDoubt)
    surprise: Surprise = field(default_factory=Surprise)


@dataclass(frozen=True, eq=False)
class _Snapshot:
    time: float
    x: Array  # absolute, augmented
    P: Array
    adaptation: Adaptation
    distrust: Distrust


class Estimator:
    """Kalman filter with memory. Times are those of the measurements' clock (s)."""

    def __init__(self, model: LinearModel, settings: EstimatorSettings) -> None:
        self.model, self.settings, self.layout = model, settings, model.layout
        self.measurement_model = MeasurementModel(model, settings.measurement)
        self.process_model = ProcessModel(model, settings.process)
        self.size = self.process_model.size
        self._filter = KalmanFilter(dim_x=self.size, dim_z=1)
        self._filter.x = np.zeros(self.size)
        self._history = MeasurementHistory(settings.simultaneous)
        self._snapshots: list[_Snapshot] = []
        self._setpoints = SetpointHistory(model.layout.number_of_uavs, settings.process.setpoint_loss)
        self._gate = OutlierGate(settings.gate_probability)
        self.innovations: list[InnovationRecord] = []
        self.discarded_late = 0
        self.frozen = FrozenSensors(settings.measurement)
        self._reckoning = DeadReckoning(model.layout.number_of_uavs)
        self.left_out: dict[Group, tuple[bool, bool]] = {}
        """Of what has contradicted itself: whether the poses, or the motions, are used no more, which explain less."""
        self._untrusted: dict[tuple[int, type], float] = {}
        self.adaptation = Adaptation()
        self._distrust = Distrust(model.layout.number_of_uavs)
        self._adapts = True

    def start(self, time: float, x: Array) -> None:
        """Begin at ``time`` from the state ``x`` (12 + 11 N,), known to within a start on the ground."""
        P = self.settings.first_doubt.covariance(self.process_model)
        full = np.concatenate([x, np.zeros(self.size - len(x))])
        self._history.clear()
        self._setpoints.clear()
        self.adaptation = Adaptation()
        self._distrust = Distrust(self.layout.number_of_uavs)
        self._snapshots = [_Snapshot(time, full, P, copy(self.adaptation), copy(self._distrust))]

    @property
    def time(self) -> float:
        """Time of the last measurement that was applied (s)."""
        return self._snapshots[-1].time

    def add_setpoint(self, effective: float, u: Array | None, leaves: Array | None = None) -> None:
        """Set-points (3 N,) that act from ``effective`` on; None: the vehicles are held (cradles, pad), errors stay.

        ``leaves`` (N,): when they leave the ground (s), where that is known.
        """
        self._setpoints.add(effective, u, leaves)

    def confirm_setpoint(
        self, uav: int, since: float, until: float, told: Array, spread: float = 0.0, longest: float = np.inf
    ) -> Confirmation | None:
        """What a vehicle says it flew from ``since`` to ``until`` (s), see :meth:`SetpointHistory.confirm`."""
        confirmation = self._setpoints.confirm(uav, since, until, told, spread, longest)
        if confirmation is not None and confirmation.corrected_from is not None:
            self._back_to(confirmation.corrected_from)
        return confirmation

    def untrusted(self, kind: type[Measurement]) -> frozenset[int]:
        """UAVs whose pose of this ``kind`` was missing, frozen or refused within :data:`DISTRUST`.

        Of positions a refusal of the velocity counts as well: poses between two samples are told by it.
        """
        if Group(False, kind) in self.left_out:
            return frozenset(range(self.layout.number_of_uavs))
        return frozenset(
            source
            for (source, of), time in self._untrusted.items()
            if of is kind and source != PAYLOAD and self.time - time < DISTRUST
        )

    @property
    def distrusted(self) -> tuple[Half, ...]:
        """What of the vehicles has been refused for so long that it is left out."""
        return self._distrust.halves

    @property
    def lost(self) -> tuple[int, ...]:
        """UAVs whose positions and velocities have been refused for so long that neither is believed any more."""
        return self._distrust.lost

    def vehicles(self, estimate: Estimate) -> list[Measurement]:
        """Positions and attitudes of the UAVs."""
        return self.measurement_model.vehicles(estimate.time, estimate.x)

    def _back_to(self, time: float) -> None:
        """Take the filter back to before ``time`` (s), as far as it remembers."""
        while len(self._snapshots) > 1 and self._snapshots[-1].time >= time:
            self._snapshots.pop()

    def add(self, measurement: Measurement) -> Measurement | None:
        """Take a measurement; returns what is used of it: nothing of sensors that are frozen, or of what is too old."""
        frozen = self.frozen.frozen(measurement)
        if any(frozen):
            measurement = measurement.without(*frozen)
        if not measurement.has_pose:
            self._untrusted[measurement.source, type(measurement)] = measurement.time
        if all(frozen):
            return None
        oldest = max(self._snapshots[0].time, self.time - self.settings.history)
        if measurement.time <= oldest:
            self.discarded_late += 1
            return None
        moment = self._history.add(measurement, self.time)
        if moment is not None:
            self._back_to(moment)
        return measurement

    def payload_stands(self, time: float, position: Array, yaw: float) -> None:
        """On the ground at ``position`` (3,) (m) with ``yaw`` (rad): taken for measured, where its unit is silent.

        The ground holds it, which no model here knows: unmeasured, it would be believed to go where its links pull.
        """
        if self._history.has((PAYLOAD, Position), since=time - PAYLOAD_SILENT):
            return
        none, upright = np.zeros(3), quaternion_from_euler(0.0, 0.0, yaw)
        self._back_to(time)
        for kind, pose in ((Position, position), (Attitude, upright)):
            self._history.add(kind(time, PAYLOAD, pose, none), self.time)

    def estimate(self, time: float, reference: Reference) -> Estimate:
        """Apply all that was added and predict to ``time`` (s), the moment at which the next set-points act."""
        for group in self._reckoning.astray:
            if group not in self.left_out:
                self._leave_out(group, time, reference)
        estimate = self._advance(time, reference)
        self._forget()
        return estimate

    def _leave_out(self, group: Group, time: float, reference: Reference) -> None:
        """Poses or motions of a ``group``, since they contradict each other: what fits the rest less.

        The filter's memory is gone through without the ones and without the others, all else taken for sound.
        """
        kept, known = self._snapshots[:1], len(self.innovations)
        misfits = []
        self._adapts = False
        for choice in _POSES, _MOTIONS:
            self.left_out[group] = choice
            self._snapshots = kept.copy()
            self._advance(time, reference)
            misfits.append(np.mean([_misfit(record) for record in self.innovations[known:]] or [0.0]))
            del self.innovations[known:]
        self.left_out[group] = _POSES if misfits[0] <= misfits[1] else _MOTIONS
        self._snapshots, self._adapts = kept, True

    def _advance(self, time: float, reference: Reference) -> Estimate:
        pending = self._history.after(self.time)
        time = max(time, self.time, pending[-1].time if pending else time)
        way = Way(self.time, [m.time for m in pending], time, self._setpoints, reference)
        process = self.process_model
        # Drag is believed to change with the velocity, so what is estimated of it is what is left over.
        believed = np.empty((len(way.edges), self.size - self.layout.size))
        believed[:, :3] = way.flat.links.on_payload
        believed[:, 3:-1] = way.flat.links.on_uavs[..., :2].reshape(len(way.edges), -1)
        believed[:, -1] = reference.load.mass - self.model.parameters.m_0
        n = self.layout.size

        def absolute(error: Array, k: int) -> Array:
            x = error.copy()
            x[:n] += way.flat.x[k]
            x[n:] += believed[k]
            return x

        kf = self._filter
        last = self._snapshots[-1]
        kf.x, kf.P = last.x.copy(), last.P
        self.adaptation, self._distrust = copy(last.adaptation), copy(last.distrust)
        kf.x[:n] -= way.flat.x[0]
        kf.x[n:] -= believed[0]
        waiting = iter(pending)
        moment = next(waiting, None)
        for k in range(len(way.edges)):
            if k:
                self._predict(way, k - 1)
            while moment is not None and moment.time == way.edges[k]:
                self._update(moment, way.flat, k)
                now = absolute(kf.x, k), kf.P, copy(self.adaptation), copy(self._distrust)
                self._snapshots.append(_Snapshot(moment.time, *now))
                moment = next(waiting, None)
        x = absolute(kf.x, len(way.edges) - 1)
        on_uavs = np.zeros((self.layout.number_of_uavs, 3))
        on_uavs[:, :2] = x[process.uav_force].reshape(-1, 2)
        return Estimate(time, x[:n], x[process.force], on_uavs, float(x[process.mass]), kf.P)

    def _predict(self, way: Way, k: int) -> None:
        """From edge ``k`` to the next, under the set-points in force."""
        u, change, doubt = way.setpoints[k]
        delta_u = np.zeros(self.layout.inputs) if u is None else u - way.u(k)
        F, B = self.process_model.transition(way.interval_us(k), way.acceleration(k))
        Q = self.process_model.noise(way.interval_us(k), self.adaptation.restlessness)
        if change is not None:
            Q = Q + self.process_model.doubt_noise(B, change, doubt)
        self._filter.predict(u=delta_u, F=F, B=B, Q=Q)

    def _update(self, moment: Moment, flat: FlatReference, k: int) -> None:
        """Correct the filter's error state, at time ``k`` of ``flat``, by what was measured then."""
        kf, n = self._filter, self.layout.size
        told = [middle(copies) for copies in moment.measurements.values()]
        for measurement in told:
            self._reckoning.add(measurement)
        stack = self.measurement_model.stack(tuple(moment.measurements))
        y = np.concatenate([self.measurement_model.innovation(self._used(m), flat, k) for m in told])
        H = np.zeros((len(y), self.size))
        self.measurement_model.observe(stack, flat, k, into=H[:, :n])
        whole = stack
        present = np.isfinite(y)
        if self._distrust.halves:
            self._distrust.reconsider(stack, y - H @ kf.x, H, kf.P, self.adaptation.noise)
            present &= ~self._distrust.rows(stack)
        if not present.any():
            return
        if not present.all():
            stack, y, H = stack.only(present), y[present], H[present]
        keys = stack.keys
        residual = y - H @ kf.x
        adaptation = self.adaptation

        def judge() -> Judgement:
            return self._gate.judge(residual, H @ kf.P @ H.T, stack, adaptation.noise)

        found = judge()
        surprised = False
        if found.accepted.all():
            adaptation.payload_refused = 0
        elif self._adapts:
            by_payload, by_most = self._refusals(keys, found.accepted)
            surprised = by_payload or (by_most and adaptation.persists(moment.time, keys, found.white))
            if surprised:
                kf.P = kf.P + self.settings.surprise.covariance(self.process_model, kf.P)
            elif by_most:
                adaptation.noisier(found.mean_squares)
            if surprised or by_most:
                found = judge()
        keep = self._gate.sound_rows(residual, found, stack)
        refused = [c for c, good in enumerate(found.accepted.tolist()) if not good]
        for c in refused:
            if keys[c][1] is Position or not keep[stack.starts[c]]:
                self._untrusted[keys[c]] = moment.time
        for half in self._distrust.halves:
            if half.kind is Position or not half.which:
                self._untrusted[half.source, half.kind] = moment.time
        kept = present.copy()
        kept[present] = keep
        if self._adapts:
            self._distrust.learn(whole, present, kept, self._reckoning.contradicts_itself)
            adaptation.learn(moment.time, keys, found.white, found.mean_squares, keep, stack.of_payload)
        nis = 0.0
        if keep.any():
            kf.update(y[keep], R=np.diag(found.variance[keep]), H=H[keep])
            nis = float(kf.y @ kf.SI @ kf.y)
            seen = kept[whole.heights] & kept[whole.heights + 3]
            kf.P = (kf.P + kf.P.T) / 2
            kf.P.flat[:: self.size + 1] += self.process_model.own_noise(whole.uavs[seen])
        rejected = tuple((keys[c][0], keys[c][1].__name__) for c in refused)
        white = stack.split(found.white)
        self.innovations.append(InnovationRecord(moment.time, nis, int(keep.sum()), rejected, surprised, keys, white))

    def _used(self, told: Measurement) -> Measurement:
        """Without what has contradicted itself."""
        choice = self.left_out.get(Group(told.source == PAYLOAD, type(told)))
        return told if choice is None else told.without(*choice)

    def _refusals(self, keys: tuple[tuple[int, type], ...], accepted: NDArray[np.bool_]) -> tuple[bool, bool]:
        """Whether the payload unit insists on what the prediction excludes, and whether most sources exclude it.

        Sound sensors do not fail together, so most sources of three or more are right. The payload unit, which alone
        sees at once what pushes the payload, is right when it insists. Otherwise a filter that went on believing itself
        would refuse every measurement from here on.
        """
        sources = {source for source, _ in keys}
        refused = {source for (source, _), good in zip(keys, accepted, strict=True) if not good}
        adaptation = self.adaptation
        if PAYLOAD in sources:
            adaptation.payload_refused = adaptation.payload_refused + 1 if PAYLOAD in refused else 0
        return adaptation.payload_refused >= PATIENCE, len(sources) >= 3 and 2 * len(refused) > len(sources)

    def _forget(self) -> None:
        horizon = self.time - self.settings.history
        keep = max(bisect.bisect_right(self._snapshots, horizon, key=lambda s: s.time) - 1, 0)
        del self._snapshots[:keep]
        oldest = self._snapshots[0].time
        self._history.forget(oldest)
        self._setpoints.forget(oldest)


def _misfit(record: InnovationRecord) -> float:
    """Mean square of the innovations with variance 1, each counted as an outlier at most."""
    return float(np.mean([min(float(white @ white) / len(white), OUTLIER) for white in record.white]))
