"""The kernels of the onboard loop agree with plain Python."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from flying import AIRFRAME
from onboard import step_alone

from gcs.config.vehicle_settings import LandDetectorSettings
from gcs.mavlink import px4
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import (
    COMMANDED,
    DETECTED,
    SAMPLED,
    THRUST,
    control_attitudes,
    detect_landings,
    step_while_idle,
    take_fresh_samples,
)
from vehicle_sim.autopilot.onboard_loop import step_together
from vehicle_sim.autopilot.parameter_table import vehicle_parameters
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.world.sensors import Measurement

SETTINGS = LandDetectorSettings()
WEIGHT, THRUST_MAX = AIRFRAME.mass * AIRFRAME.g, AIRFRAME.rotors.thrust_max


@dataclass
class PlainDetector:
    """Landing detection of one vehicle, written for a reader."""

    altitude: float | None = None
    velocity: float = 0.0
    ground: float | None = None
    last_time: float = 0.0
    light_since: float = math.inf
    touching_since: float = math.inf
    in_air: bool = False
    hover_thrust: float | None = field(default=None)

    def start(self):
        self.ground, self.in_air = self.altitude, False
        self.light_since = self.touching_since = math.inf

    def update(self, row, thrust, now, learn):
        step, self.last_time = now - self.last_time, now
        z, v_z = row[2], row[9]
        if self.altitude is None:
            self.altitude = z
            return
        self.altitude += (z - self.altitude) * step / (SETTINGS.altitude_filter + step)
        self.velocity += (v_z - self.velocity) * step / (SETTINGS.velocity_filter + step)
        lift = min(max(thrust * (1.0 - 2.0 * (row[4] ** 2 + row[5] ** 2)), WEIGHT), THRUST_MAX)
        if not self.in_air:
            if self.ground is not None and self.ground - self.altitude > SETTINGS.lifted:
                self.in_air, self.hover_thrust = True, lift
            return
        if learn:
            self.hover_thrust += (lift - self.hover_thrust) * step / (SETTINGS.hover_filter + step)
        slow = abs(self.velocity) < SETTINGS.vertical_speed_max
        if not slow or thrust > WEIGHT + SETTINGS.unloaded_share * (self.hover_thrust - WEIGHT):
            self.light_since = now
        if self.velocity > SETTINGS.touchdown_sinking or thrust > SETTINGS.touchdown_thrust * self.hover_thrust:
            self.touching_since = now
        self.light_since, self.touching_since = min(self.light_since, now), min(self.touching_since, now)
        if now - self.light_since >= SETTINGS.time:
            self.start()


def test_landings_are_detected_for_a_team_as_for_each():
    """Up, along, down, and standing, each vehicle at other heights, thrusts and speeds."""
    rng, seen = np.random.default_rng(3), set()
    arrays = OnboardArrays.of([AIRFRAME] * 3, SETTINGS)
    detectors, plain = [LandDetector(arrays.of_vehicle(i)) for i in range(3)], [PlainDetector() for _ in range(3)]
    for k in range(1, 3000):
        now = 0.004 * k
        for i in range(3):
            phase = now - 0.3 * i
            height = min(max(phase - 1.0, 0.0), 2.0) - min(max(phase - 6.0, 0.0), 2.0)
            climb = 1.0 if 1.0 < phase < 3.0 else -1.0 if 6.0 < phase < 8.0 else 0.0
            tilt = 0.05 * rng.normal(size=2)
            thrust = 0.0 if phase < 0.5 else 0.3 * WEIGHT if phase > 8.2 else (1.6 + 0.1 * i) * WEIGHT
            arrays.estimates[i] = [0.0, 0.0, -height, 1.0, *tilt, 0.0, 0.0, 0.0, 0.02 * rng.normal() - climb, 0, 0, 0]
            arrays.targets[i, THRUST] = thrust
            arrays.learns[i] = phase < 6.0
            if k == 50:
                plain[i].start()
                detectors[i].start()
            plain[i].update(arrays.estimates[i].tolist(), thrust, now, phase < 6.0)
        detect_landings(
            arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, now, arrays.landings, arrays.idle_until
        )
        for one, other in zip(detectors, plain, strict=True):
            assert (one.in_air, one.hover_thrust) == (other.in_air, pytest.approx(other.hover_thrust))
            assert one.touching == (other.touching_since < other.last_time)
            assert one.touched_down == (other.last_time - other.touching_since >= SETTINGS.time)
            seen.add((one.in_air, one.touching, one.touched_down))
    assert {in_air for in_air, _, _ in seen} == {True, False} and (True, True, True) in seen


def test_vehicles_without_an_estimate_detect_nothing():
    arrays = OnboardArrays.of([AIRFRAME], SETTINGS)
    before = arrays.landings.copy()
    detect_landings(
        arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, 1.0, arrays.landings, arrays.idle_until
    )
    assert np.array_equal(arrays.landings, before, equal_nan=True)


def test_fresh_samples_are_numbers_that_do_not_repeat():
    good = np.arange(1.0, 14.0)
    good[3:7] = 0.5, -0.5, 0.5, 0.5
    samples, last, fresh = np.tile(good, (9, 1)), np.tile(-good, (9, 1)), np.zeros(9, dtype=bool)
    samples[1, 4] = np.nan
    samples[2, 0] = np.inf
    samples[3, 8] = 1e7
    last[4, 3:7] = good[3:7]  # a stuck attitude
    last[5, 10:13] = good[10:13]  # stuck rates
    samples[6, 10:13] = last[6, 10:13] = 0.0  # at rest without noise
    samples[7, 3:7] = 0.0  # no rotation
    times = np.arange(9.0)
    times[8] = np.nan
    estimates, stamps = np.zeros((9, 13)), np.full((9, 2), -np.inf)
    take_fresh_samples(samples, times, 9.0, last, estimates, stamps, fresh)
    assert fresh.tolist() == [True, False, False, False, False, False, True, False, False]
    assert np.array_equal(last, samples, equal_nan=True)
    assert np.array_equal(estimates[fresh], samples[fresh]) and not estimates[~fresh].any()
    assert stamps[fresh].tolist() == [[0.0, 9.0], [6.0, 9.0]] and np.isneginf(stamps[~fresh]).all()
    take_fresh_samples(samples, times, 9.5, last, estimates, stamps, fresh)
    assert not fresh.any() and stamps[fresh].tolist() == []


def test_vehicles_of_a_team_fly_as_each_alone_when_samples_of_the_second_are_missing_stuck_or_late():
    """Estimates and rotor speeds, while the second gets no samples, the same rates, old samples, and good ones."""

    rng, stuck = np.random.default_rng(5), None
    arrays = OnboardArrays.of([AIRFRAME] * 3, SETTINGS)
    team = [
        Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, i + 1, 250), arrays=arrays.of_vehicle(i)) for i in range(3)
    ]
    alone, kinds = [Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, i, 250)) for i in (1, 2, 3)], set()
    for k in range(600):
        now, phase = 0.004 * k, k // 100
        samples = np.hstack([rng.normal(size=(3, 3)), rng.normal(size=(3, 4)), rng.normal(size=(3, 6))])
        samples[:, 3:7] = samples[:, 3:7] * 0.05 + (1.0, 0.0, 0.0, 0.0)
        samples[:, 3:7] /= np.linalg.norm(samples[:, 3:7], axis=1)[:, None]
        times = np.full(3, now)
        missing = [1] if phase in (0, 2) else []
        if phase == 3:
            stuck = samples[1, 10:13].copy() if stuck is None else stuck
            samples[1, 10:13] = stuck
        if phase == 4:
            times[1] = math.nan if k % 2 else now - 0.1
        given = [None if i in missing else Measurement.of_row(times[i], samples[i].tolist()) for i in range(3)]
        step_together(team, arrays, samples, times, now, missing)
        speeds = [step_alone(pilot, sample, now) for pilot, sample in zip(alone, given, strict=True)]
        assert arrays.speeds.tolist() == [list(four) for four in speeds]
        for i, (one, other) in enumerate(zip(team, alone, strict=True)):
            mine, others = one.state.navigation, other.state.navigation
            assert repr(mine.estimate) == repr(others.estimate) and repr(mine.reported) == repr(others.reported)
            assert mine.is_valid(now) == others.is_valid(now)
            assert i == 1 or mine.estimate == Measurement.of_row(now, samples[i].tolist())
        known = team[1].state.navigation
        kinds.add((known.estimate is None, known.is_valid(now), math.isnan((known.reported or given[0]).rates[0])))
        if k == 120:
            for pilot in (*team, *alone):
                pilot.enter_offboard(AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, 0), now, now)
                assert pilot.arm(now, force=True).text == ""
    assert kinds == {(True, False, False), (False, True, False), (False, False, False), (False, True, True)}


class Ground:
    """Random commands of a ground to one vehicle: often set-points, sometimes a pause of seconds, seldom all else."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._silent_until = 0.0

    def act(self, pilots: list[Autopilot], now: float) -> None:
        """Command all ``pilots`` the same."""
        rng = self._rng
        thrust, turn = 0.3 + 0.4 * rng.random(), 0.1 * rng.normal()
        setpoint = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, turn), thrust, 0)
        mode = int(rng.choice([px4.MODE_HOLD, px4.MODE_LAND, px4.MODE_MANUAL, px4.MODE_MISSION]))
        kind, loss = rng.random(), 0.2 + rng.random()
        if now < self._silent_until:
            return
        for pilot in pilots:
            if kind < 0.1:
                pilot.follow(setpoint, now)
            elif kind < 0.104:
                self._silent_until = now + 3.0 * loss
            elif kind < 0.108:
                pilot.enter_offboard(setpoint, now - thrust, now)
                if turn < 0.0:
                    pilot.arm(now, force=True)
            elif kind < 0.112:
                pilot.arm(now, force=True)
            elif kind < 0.113:
                pilot.enter_mode(mode, now)
            elif kind < 0.114:
                pilot.disarm(force=thrust < 0.4)
            elif kind < 0.115:
                pilot.state.parameters.by_name(px4.PARAM_SETPOINT_LOSS).value = loss
                pilot.ground_message_received(now)


@pytest.mark.parametrize("seed", range(3))
def test_idle_vehicles_would_decide_what_they_did(seed):
    """Equal teams, one of which decides at every step: equal targets, landings, modes and notices at every step."""
    rng, idle, seen = np.random.default_rng(seed), 0, set()
    teams, all_arrays = [], [OnboardArrays.of([AIRFRAME] * 3, SETTINGS) for _ in range(2)]
    for arrays in all_arrays:
        parameters = [vehicle_parameters(AIRFRAME, i + 1, 250) for i in range(3)]
        teams.append([Autopilot(AIRFRAME, parameters[i], arrays=arrays.of_vehicle(i)) for i in range(3)])
    grounds, heights = [Ground(10 * seed + i) for i in range(3)], np.zeros(3)
    for k in range(1, 3000):
        now = 0.004 * k
        for ground, pilots in zip(grounds, zip(*teams, strict=True), strict=True):
            ground.act(list(pilots), now)
        climbing = np.where(np.sin(0.5 * now + np.arange(3)) > 0.0, 1.0, -1.0)
        heights = np.clip(heights + 0.004 * climbing, 0.0, 2.0)
        samples = np.zeros((3, 13))
        samples[:, 2], samples[:, 9] = -heights, np.where((heights > 0.0) & (heights < 2.0), -climbing, 0.0)
        samples[:, 3:7] = (1.0, 0.0, 0.0, 0.0) + 0.01 * rng.normal(size=(3, 4))
        samples[:, 3:7] /= np.linalg.norm(samples[:, 3:7], axis=1)[:, None]
        samples[:, 10:] = 0.01 * rng.normal(size=(3, 3))
        all_arrays[1].idle_until[:] = -np.inf
        missing = [2] if 2000 < k < 2100 or k < 100 else []
        for team, arrays in zip(teams, all_arrays, strict=True):
            step_together(team, arrays, samples.copy(), np.full(3, now), now, missing)
        for name in ("targets", "landings", "learns", "speeds"):
            one, other = (getattr(arrays, name) for arrays in all_arrays)
            assert one.tobytes() == other.tobytes(), (name, now)
        flying = [pilot.armed and pilot.wants_setpoints and not pilot.failsafe for pilot in teams[0]]
        assert all_arrays[0].learns.tolist() == flying
        for one, other in zip(*teams, strict=True):
            shown, others = (
                (pilot.mode, pilot.armed, pilot.failsafe, pilot.landed_state, pilot.changes, pilot.state.hold is None,
                 pilot.state.actuation.target, pilot.state.actuation.target_since, tuple(pilot.take_notices()))
                for pilot in (one, other)
            )  # fmt: skip
            assert shown == others
            seen.add(shown[:4])
        idle += np.count_nonzero(all_arrays[0].idle_until > now)
    assert idle > 2400 and len(seen) > 8


@pytest.mark.parametrize("expected", [SAMPLED, DETECTED, COMMANDED])
def test_step_of_idle_vehicles_is_its_three_parts_up_to_the_first_decision(expected):
    random = np.random.default_rng(3)
    teams = [OnboardArrays.of([AIRFRAME] * 3, SETTINGS) for _ in range(2)]
    rows = random.normal(size=(3, 13))
    rows[:, 3:7] /= np.linalg.norm(rows[:, 3:7], axis=1, keepdims=True)
    targets = random.uniform(0.1, 1.0, teams[0].targets.shape)
    times, now = np.full(3, 1.0), 1.002
    for team in teams:
        team.targets[:] = targets
        team.idle_until[:] = [now, 5.0, 5.0] if expected == DETECTED else 5.0
        if expected == SAMPLED:
            team.last_samples[1] = rows[1]
    one, other = teams
    sampling = rows, times, now, one.last_samples, one.estimates, one.stamps, one.fresh
    detection = one.detectors, one.targets, one.learns, one.landings, one.idle_until
    assert step_while_idle(*sampling, *detection, one.airframes, one.accelerations, one.speeds) == expected
    take_fresh_samples(rows, times, now, other.last_samples, other.estimates, other.stamps, other.fresh)
    if expected != SAMPLED:
        detect_landings(
            other.detectors, other.estimates, other.targets, other.learns, now, other.landings, other.idle_until
        )
    if expected == COMMANDED:
        control_attitudes(other.airframes, other.estimates, other.targets, other.accelerations, other.speeds)
        assert one.speeds.any()
    for name in ("last_samples", "estimates", "stamps", "fresh", "landings", "idle_until", "accelerations", "speeds"):
        assert np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True), name
