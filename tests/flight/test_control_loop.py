"""The control step as a whole: telemetry comes in, an estimate and a decision are made of it, set-points go out."""

from itertools import count
from types import SimpleNamespace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from one_measurement import measurement
from test_control_step import AT_REST, HOVER, LAYOUT, MODEL, REST, SYSTEM, N, P, estimated, received

from gcs.flight import stack
from gcs.flight.compute_times import ComputeTimes, Part
from gcs.flight.control_loop import ControlLoop, Hold, Setpoints, StepRecord
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.setpoints import attitude_target
from idc_controller.estimation.grounded_links import LinkStates, S
from idc_controller.estimation.measurements import Position, SensorGroup
from idc_controller.rotations import rotation_from_quaternion
from idc_controller.safety.filter_protocol import NoObstacles
from idc_controller.trajectory.stop_plan import Braking
from vehicle_sim.autopilot.setpoints import read_setpoint

PERIOD = 1.0 / SYSTEM.rates.control
SPOTS = np.array([HOVER, *(HOVER + P.p - P.l[:, None] * [0.0, 0.0, 1.0])])


def control_loop(brake=lambda time, state: Braking(), stopwatch=lambda: 0.0):
    controller = stack.controller(SYSTEM, MODEL, NoObstacles(), stopwatch)
    loop = ControlLoop(
        stack.estimator(SYSTEM, MODEL), controller, ComputeTimes(stopwatch), stack.grounded_links(SYSTEM, MODEL), brake
    )
    loop.estimator.start(5.0, AT_REST)
    return loop


def telemetry(time, shift):
    """Messages of payload and vehicles at rest in formation, all ``shift`` (m) from where they should be."""
    for source, spot in enumerate(SPOTS + shift, start=-1):
        unit = px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT
        sender = unit if source < 0 else (source + 1, px4.AUTOPILOT_COMPONENT)
        for message in (
            mavlink.MAVLink_local_position_ned_message(round(1000 * time), *spot, 0.0, 0.0, 0.0),
            mavlink.MAVLink_attitude_quaternion_message(round(1000 * time), 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        ):
            yield measurement(received(message, *sender), source, time)


def flown(loop, steps, shift):
    """Control steps with telemetry before each; what was recorded."""
    records = []
    for k in range(steps):
        time = 5.0 + PERIOD * k
        for taken in telemetry(time, shift):
            loop.estimator.add(taken)
        estimate = loop.estimate(time + PERIOD, REST)
        records.append(loop.decide(estimate, REST, learn_load=False))
        loop.send(records[-1], time + PERIOD, np.full(N, time))
    return records


@pytest.mark.parametrize(("axis", "sign"), [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)])
def test_measured_shift_of_the_team_is_answered_by_thrust_against_it(axis, sign):
    shift = 0.1 * sign * np.eye(3)[axis]
    loop = control_loop()
    loop.estimator.start(5.0, AT_REST + np.concatenate([shift, np.zeros(LAYOUT.size - 3)]))
    [record] = flown(loop, 1, shift)
    assert record.estimate.time == pytest.approx(5.0 + PERIOD)
    assert record.decision.time == record.estimate.time
    assert record.estimate.x[LAYOUT.r_0] == pytest.approx(HOVER + shift, abs=0.01)
    for i in range(N):
        message = attitude_target(
            i + 1, record.estimate.time, record.decision.directions[i], record.decision.thrusts[i], P.thrust_max
        )
        [on_wire] = Codec(i + 1, 1).decode(Codec(255, 190).frame(message))
        setpoint = read_setpoint(on_wire.fields, SYSTEM.onboard().setpoints)
        thrust = -setpoint.thrust * P.thrust_max * rotation_from_quaternion(np.array(setpoint.attitude))[:, 2]
        assert sign * thrust[axis] < -1e-3
        assert abs(thrust[1 - axis]) < 0.3 * abs(thrust[axis])
        assert thrust[2] == pytest.approx(-P.hover_thrust[i], rel=0.05)


def test_sent_setpoints_act_on_the_estimate_from_their_time_on():
    pulled = control_loop()
    estimate = pulled.estimate(5.0 + PERIOD, REST)
    record = pulled.decide(estimate, REST, learn_load=False)
    north = record.decision.u.copy()
    north[0 : 2 * N : 2] = 0.2
    leaning = StepRecord(record.estimate, record.decision._replace(u=north))
    pulled.send(leaning, 5.0 + PERIOD, np.full(N, 5.0))
    before = pulled.estimate(5.0 + PERIOD, REST)
    after = pulled.estimate(5.0 + 8 * PERIOD, REST)
    assert before.x[LAYOUT.n] == pytest.approx(np.zeros(2 * N), abs=1e-6)
    assert np.all(after.x[LAYOUT.n][0::2] > 0.05)
    assert after.x[LAYOUT.n][1::2] == pytest.approx(np.zeros(N), abs=1e-3)


def test_stop_plan_goes_out_with_the_setpoints_and_brakes_as_asked():
    asked = []

    def brake(time, state):
        asked.append((time, state))
        return Braking(share=2.0)

    usual, slow = control_loop(), control_loop(brake)
    assert usual.stop_plan is None
    for loop in (usual, slow):
        record = loop.decide(estimated(v_0=np.array([0.5, 0.0, 0.0])), REST, learn_load=False)
        loop.send(record, 5.0, np.full(N, 4.95))
    assert slow.stop_plan.start == usual.stop_plan.start == 5.0
    assert slow.stop_plan.duration == pytest.approx(2.0 * usual.stop_plan.duration)
    assert all(time == 5.0 for time, _ in asked) and asked
    formation = SPOTS[1:]
    assert usual.stop_plan.control_points[:, 0] == pytest.approx(formation, abs=1e-3)


def test_stop_plan_goes_on_only_with_what_all_vehicles_have_received(monkeypatch):
    loop = control_loop()
    assert loop.stop_plan is None
    record = loop.decide(estimated(), REST, learn_load=False)
    hold = Hold(5.0, 0.9)
    times = [PERIOD * k for k in range(12)]

    def send(time, received):
        monkeypatch.setattr(loop.estimator.setpoints, "received_by_all", lambda effective, age_max: received)
        loop.send(record, time, np.full(N, time), hold)
        return loop.stop_plan.start, loop.stop_plan.descent

    assert send(times[0], times[0]) == (times[0], times[0] + hold.duration)
    assert send(times[1], times[0]) == (times[0], times[0] + hold.duration)
    assert [send(time, times[1])[0] for time in times[2:8]] == [times[1]] * 6
    assert loop.stop_plans[-1].start == times[7]  # kept for later
    assert send(times[8], times[5] + 0.2 * PERIOD) == (times[5], times[5] + hold.duration)
    assert send(times[9], times[9])[0] == times[9]


@pytest.fixture
def unconfirmed(monkeypatch):
    """A control loop that keeps all stop plans: no vehicle confirms any set-point."""
    loop = control_loop()
    monkeypatch.setattr(loop.estimator.setpoints, "received_by_all", lambda effective, age_max: 0.0)
    return loop


def test_vehicles_without_setpoints_land_when_the_payload_would_and_go_on_with_its_landing(unconfirmed):
    loop = unconfirmed
    record = loop.decide(estimated(v_0=np.array([0.0, 0.0, 0.3])), REST, learn_load=False)
    for until_landing in (0.1, 0.05, 0.0):
        loop.send(record, 5.1 - until_landing, np.full(N, 4.95), Hold(5.0, 0.9), until_landing)
    assert [plan.descent for plan in loop.stop_plans] == pytest.approx([5.1, 5.1, 4.5])


def test_landing_that_is_decided_late_brings_the_descent_forward_step_by_step(unconfirmed):
    loop = unconfirmed
    record = loop.decide(estimated(v_0=np.array([0.0, 0.0, 0.3])), REST, learn_load=False)
    for k in range(100):
        loop.send(record, 5.0 + PERIOD * k, np.full(N, 4.95), Hold(5.0, 0.9), 0.0 if k else np.inf)
    changes = np.diff([plan.descent for plan in loop.stop_plans])
    assert changes[:49] == pytest.approx(-PERIOD) and changes[50:] == pytest.approx(PERIOD)


def test_landing_that_begins_to_wait_puts_the_descent_off_step_by_step(unconfirmed):
    loop = unconfirmed
    record = loop.decide(estimated(), REST, learn_load=False)
    for k in range(120):
        loop.send(record, 5.0 + PERIOD * k, np.full(N, 4.95), Hold(5.0, 0.9), np.inf if k else 0.0)
    changes = np.diff([plan.descent for plan in loop.stop_plans])
    assert changes[:100] == pytest.approx(2.0 * PERIOD) and changes[101:] == pytest.approx(PERIOD)


UPRIGHT = LinkStates(np.zeros((6, N, 2)), SYSTEM.parameters().hover_thrust, np.zeros(2))


def test_load_is_learnt_in_the_air_where_it_is_clear():
    on_uavs = np.zeros((N, 3))
    on_uavs[:, 0] = 0.3
    for options, learns in (
        ({"learn_load": True}, True),
        ({"learn_load": False}, False),
        ({"links": UPRIGHT, "learn_load": True}, False),
    ):
        loop = control_loop()
        for _ in range(20):
            loop.decide(estimated(uav_force=on_uavs), REST, **options)
        assert (loop.controller.load.estimate.uav_force[0, 0] > 0.01) == learns


def test_links_on_the_ground_take_no_isolated_channel():
    loop, taken = control_loop(), []
    loop.links = SimpleNamespace(add=taken.append)
    sample = Position(1.0, 2, np.ones(3), np.ones(3))
    loop.add_to_links(sample)
    loop.estimator.health.isolated_groups[SensorGroup(False, Position)] = (True, False)
    loop.add_to_links(sample)
    assert [(each.has_pose, each.has_motion) for each in taken] == [(True, True), (False, True)]


def test_compute_times_of_a_step_go_to_their_parts():
    ticks = count()
    loop = control_loop(stopwatch=lambda: float(next(ticks)))
    loop.compute_times.resume()
    flown(loop, 1, np.zeros(3))
    spent = loop.compute_times.take()
    busy = {part for part in Part if spent[part] > 0.0}
    assert busy == {Part.MONITORING, Part.ESTIMATION, Part.PLANNING, Part.CONTROL, Part.STOP_PLAN}
    assert loop.compute_times.take() == (0.0,) * len(Part)


def test_idle_setpoints_are_upright_rotors_without_thrust():
    idle = Setpoints.idle(3)
    assert idle.directions.tolist() == [[0.0, 0.0, -1.0]] * 3
    assert idle.thrusts.tolist() == [0.0] * 3


def test_stop_plan_over_a_payload_that_stands_descends_at_once_with_the_thrust_that_is_flown():
    loop = control_loop()
    record = loop.decide(estimated(), REST, learn_load=False)
    loop.send(record, 5.0, np.full(N, 4.95))
    x = np.zeros((6, N, 2))
    x[S, :, 0] = 0.1
    thrusts = 0.6 * P.hover_thrust
    setpoints = Setpoints(np.tile([0.0, 0.0, -1.0], (N, 1)), thrusts)
    loop.stand(record, 5.1, UPRIGHT._replace(x=x), setpoints)
    plan = loop.stop_plan
    assert plan.start == plan.descent == 5.1
    assert -plan.hover_forces[:, 2] == pytest.approx(thrusts)
    assert plan.control_points[:, :, 0] == pytest.approx((SPOTS[1:, 0] - 0.1 * P.l)[:, None] * np.ones(5), abs=1e-3)
