"""The joints of the control step: estimate -> controller -> set-points -> wire -> vehicle, with signs, order and units.

Every vehicle differs from the others here: what is swapped or crossed between two of them shows.
"""

from dataclasses import replace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from flights import MISSIONS
from one_measurement import measurement

from gcs.config import read_system
from gcs.flight import stack
from gcs.mavlink import px4
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.codec import Codec
from gcs.mavlink.setpoints import SetpointStream, attitude_target
from gcs.mavlink.settings import LinkSettings
from idc_controller.control.controller import IntegratedDecisionController
from idc_controller.control.load_adaptation import LoadAdaptation
from idc_controller.control.settings import ControllerSettings
from idc_controller.estimation.grounded_links import LinkStates, S
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Estimate, Position
from idc_controller.estimation.setpoint_history import Confirmation
from idc_controller.model.drag import Air, drag_coefficients
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import rotation_from_quaternion
from idc_controller.safety.filter_protocol import NoObstacles
from idc_controller.trajectory.flatness import Load, Reference
from idc_controller.trajectory.trajectory import RestTrajectory
from vehicle_sim.autopilot.setpoints import read_setpoint

ATTACHMENTS = ((0.5, 0.45, -0.25), (0.45, -0.5, -0.25), (-0.5, -0.4, -0.25), (-0.4, 0.5, -0.25))
SYSTEM = read_system(MISSIONS / "system.toml")
SYSTEM = replace(SYSTEM, team=replace(SYSTEM.team, attachments=ATTACHMENTS))
MODEL = LinearModel(SYSTEM.parameters())
P, LAYOUT = MODEL.parameters, MODEL.layout
N = P.number_of_uavs
HOVER = np.array([3.0, -2.0, -6.0])
REST = RestTrajectory(HOVER, 0.0)
NOMINAL = Load(P.m_0, np.zeros(3))
AT_REST = Reference(P, REST, NOMINAL).at(np.array([5.0])).x[0]


AS_FLOWN = stack.controller(SYSTEM, MODEL, NoObstacles(), lambda: 0.0)


def controller() -> IntegratedDecisionController:
    """A new one, as flights have it."""
    return IntegratedDecisionController(MODEL, AS_FLOWN.tracker, NoObstacles(), AS_FLOWN.settings)


def estimated(**errors):
    """Estimate in hover at 5 s, with errors added to parts of the state; or its other fields."""
    own = {name: errors.pop(name) for name in ("force", "uav_force", "mass_excess") if name in errors}
    x = AT_REST.copy()
    for part, error in errors.items():
        x[getattr(LAYOUT, part)] += error
    fields = {"force": np.zeros(3), "uav_force": np.zeros((N, 3)), "mass_excess": 0.0} | own
    nothing = {"force_covariance": np.zeros((3, 3)), "predict_covariance": lambda: np.zeros((LAYOUT.size + 12,) * 2)}
    return Estimate(5.0, x, **nothing, **fields)


# Telemetry -> measurement


def received(message, system, component):
    [only] = Codec(255, 190).decode(Codec(system, component).encode(message))
    return only


@pytest.mark.parametrize(
    ("sender", "source"),
    [((3, px4.AUTOPILOT_COMPONENT), 2), ((px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT), PAYLOAD)],
)
def test_telemetry_becomes_measurement_of_its_source(sender, source):
    position = measurement(
        received(mavlink.MAVLink_local_position_ned_message(1234, 1.0, -2.0, -3.0, 0.1, -0.2, 0.3), *sender),
        source, 7.5,
    )  # fmt: skip
    assert isinstance(position, Position) and (position.source, position.time) == (source, 7.5)
    assert position.pose == pytest.approx([1.0, -2.0, -3.0])
    assert position.motion == pytest.approx([0.1, -0.2, 0.3])
    attitude = measurement(
        received(mavlink.MAVLink_attitude_quaternion_message(1234, 0.8, 0.6, 0.0, 0.0, 0.1, -0.2, 0.3), *sender),
        source, 7.5,
    )  # fmt: skip
    assert isinstance(attitude, Attitude) and (attitude.source, attitude.time) == (source, 7.5)
    assert attitude.pose == pytest.approx([0.8, 0.6, 0.0, 0.0])
    assert attitude.motion == pytest.approx([0.1, -0.2, 0.3])


@pytest.mark.parametrize(
    ("values", "pose", "motion"),
    [((1, 2, 3, 4, 5, np.nan), True, False), ((1, np.nan, 3, 4, 5, 6), False, True), ((np.inf,) * 6, None, None)],
    ids=["no velocity", "no position", "neither"],
)
def test_part_of_telemetry_that_is_no_number_is_not_measured(values, pose, motion):
    message = mavlink.MAVLink_local_position_ned_message(1234, *map(float, values))
    found = measurement(received(message, 3, px4.AUTOPILOT_COMPONENT), 2, 7.5)
    assert found is None if pose is None else (found.has_pose, found.has_motion) == (pose, motion)
    turned = mavlink.MAVLink_attitude_quaternion_message(1234, *(0.8, 0.6, 0.0, 0.0), 0.1, np.nan, 0.3)
    found = measurement(received(turned, 3, px4.AUTOPILOT_COMPONENT), 2, 7.5)
    assert (found.has_pose, found.has_motion) == (True, False)
    no_rotation = mavlink.MAVLink_attitude_quaternion_message(1234, *(0.8, 0.8, 0.0, 0.0), 0.1, -0.2, 0.3)
    found = measurement(received(no_rotation, 3, px4.AUTOPILOT_COMPONENT), 2, 7.5)
    assert (found.has_pose, found.has_motion) == (False, True)


# Estimate, reference -> set-points


def test_team_at_rest_is_commanded_its_hover_thrusts_straight_up():
    decision = controller().decide(estimated(), REST)
    assert decision.time == 5.0
    assert decision.directions == pytest.approx(np.tile([0.0, 0.0, -1.0], (N, 1)), abs=1e-9)
    assert decision.thrusts == pytest.approx(P.hover_thrust, abs=1e-6)
    # N, and a share of the payload for each by its attachment point: no two alike.
    assert decision.thrusts.sum() == pytest.approx((P.m_0 + P.m.sum()) * P.g)
    assert np.ptp(decision.thrusts) > 0.1


def test_stop_plans_carry_the_thrusts_that_hold_the_learnt_load_at_rest():
    flown = controller()
    assert flown.hover_forces(5.0) == pytest.approx(np.outer(P.hover_thrust, [0.0, 0.0, -1.0]), abs=1e-6)
    flown.load.take_mass(0.5 * P.m_0)
    assert flown.hover_forces(5.0)[:, 2].sum() == pytest.approx(-(0.5 * P.m_0 + P.m.sum()) * P.g)


def test_stop_plans_carry_the_thrusts_that_hold_the_load_against_a_force():
    flown, force = controller(), np.array([2.0, -1.0, 0.0])
    for _ in range(2000):
        flown.load.learn(estimated(force=force))
    assert flown.hover_forces(5.0).sum(axis=0)[:2] == pytest.approx(-force[:2], rel=0.02)


@pytest.mark.parametrize("part", ["r_0", "v_0"])
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_all_vehicles_pull_the_payload_back_to_its_reference(part, axis, sign):
    error = np.zeros(3)
    error[axis] = 0.2 * sign
    directions = controller().decide(estimated(**{part: error}), REST).directions
    # The links follow the tilts of the UAVs: those lean to where the payload is to go.
    assert np.all(sign * directions[:, axis] < -0.01)
    assert directions[:, 1 - axis] == pytest.approx(np.zeros(N), abs=0.02)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(N))


@pytest.mark.parametrize("part", ["r_0", "v_0"])
def test_payload_below_its_reference_or_sinking_is_lifted_by_all(part):
    down = np.array([0.0, 0.0, 0.1])
    assert np.all(controller().decide(estimated(**{part: down}), REST).thrusts > P.hover_thrust + 0.05)
    assert np.all(controller().decide(estimated(**{part: -down}), REST).thrusts < P.hover_thrust - 0.05)


def test_tilted_payload_is_lifted_at_its_low_side():
    roll = controller().decide(estimated(Theta=np.array([0.03, 0.0, 0.0])), REST).thrusts - P.hover_thrust
    pitch = controller().decide(estimated(Theta=np.array([0.0, 0.03, 0.0])), REST).thrusts - P.hover_thrust
    # Rolled to the right, east is low; pitched up, south is low (body forward-right-down, heading north).
    assert np.array_equal(np.sign(roll), np.sign(P.p[:, 1]))
    assert np.array_equal(np.sign(pitch), -np.sign(P.p[:, 0]))


@pytest.mark.parametrize("uav", range(N))
@pytest.mark.parametrize("axis", [0, 1])
def test_leaning_link_is_brought_upright_by_its_own_vehicle(uav, axis):
    # s points down the link, from vehicle to payload: the vehicle is south of its place and must go north.
    lean = np.zeros(2 * N)
    lean[2 * uav + axis] = 0.1
    directions = controller().decide(estimated(s=lean), REST).directions
    assert np.argmax(np.abs(directions[:, axis])) == uav
    assert directions[uav, axis] > 0.01


def test_error_beyond_its_limit_is_answered_as_the_limit():
    limit = SYSTEM.control.controller.position_error_limit
    far, farther = (
        controller().decide(estimated(r_0=np.array([factor * limit, 0.0, 0.0])), REST).u for factor in (2.0, 5.0)
    )
    assert far == pytest.approx(farther, abs=1e-6)


def test_controller_tracks_the_reference_that_the_estimator_is_given():
    loop = controller()
    beside = HOVER + np.array([1.0, 0.0, 0.0])
    other = RestTrajectory(beside, 0.0)
    assert loop.reference(other).at(np.array([5.0])).payload[0, 0] == pytest.approx(beside)
    decision = loop.decide(estimated(), REST)
    # From now on the tracked one, whatever the mission is.
    assert loop.reference(other).at(np.array([6.0])).payload[0, 0] == pytest.approx(HOVER)
    assert decision.flat.payload[0] == pytest.approx(np.tile(HOVER, (len(decision.flat.payload[0]), 1)))


def test_vehicles_over_payload_on_the_ground_are_held_upright_by_themselves():
    x = np.zeros((6, N, 2))
    x[S, 1] = 0.05, -0.1
    links = LinkStates(x, P.hover_thrust, np.zeros(2))
    decision = controller().decide(estimated(r_0=np.array([0.3, 0.0, 0.0])), REST, links=links)
    assert decision.directions[1, 0] > 0.002 and decision.directions[1, 1] < -0.004
    assert decision.directions[[0, 2, 3]] == pytest.approx(np.tile([0.0, 0.0, -1.0], (3, 1)), abs=1e-6)
    assert decision.thrusts == pytest.approx(P.hover_thrust, rel=0.02)


# Estimate -> load of the reference


def learnt(seconds, settings, **fields):
    adaptation = LoadAdaptation(MODEL, settings)
    for _ in range(round(seconds / settings.period)):
        adaptation.learn(estimated(**fields))
    return adaptation.estimate


def test_payload_that_is_weighed_at_lift_off_is_the_load_of_the_reference():
    adaptation, settings = LoadAdaptation(MODEL, ControllerSettings()), ControllerSettings()
    adaptation.take_mass(1.1)
    assert adaptation.estimate.mass == 1.1
    adaptation.take_mass(100.0)
    assert adaptation.estimate.mass == pytest.approx(settings.mass_share[1] * P.m_0)


def test_load_follows_disturbance_force_of_each_vehicle_with_its_time_constant():
    settings = ControllerSettings()
    on_uavs = np.zeros((N, 3))
    on_uavs[0, :2], on_uavs[2, :2] = (0.2, -0.1), (-0.3, 0.0)
    assert learnt(20.0 * settings.load_time_constant, settings, uav_force=on_uavs).uav_force == pytest.approx(
        on_uavs, abs=1e-3
    )
    after_one = learnt(settings.load_time_constant, settings, uav_force=on_uavs).uav_force
    assert after_one == pytest.approx((1.0 - np.exp(-1.0)) * on_uavs, abs=0.02)


@pytest.mark.parametrize(("vehicle", "force"), [(0, 0.5), (3, -0.5)])
def test_force_on_one_vehicle_alone_leaves_the_drag_estimated_of_all_unchanged(vehicle, force):
    true = Air(np.array([3.0, 0.0, 0.0]), drag_coefficients(P.payload.areas), 0.02)

    def estimated_drag(own):
        settings = ControllerSettings()
        adaptation = LoadAdaptation(MODEL, settings)
        for time in settings.period * np.arange(150):
            velocity = np.array([2.0 * np.sin(time), 2.0 * np.cos(time), 0.0])
            uav_force = np.tile(true.on_uav(velocity), (N, 1))
            uav_force[vehicle, 0] += own
            adaptation.learn(estimated(v_0=velocity, force=true.on_payload(velocity), uav_force=uav_force))
        return adaptation.estimate.air.uav

    assert estimated_drag(force) == pytest.approx(estimated_drag(0.0)) and estimated_drag(0.0) > 0.01


def test_load_follows_disturbance_force_and_mass_of_the_payload_within_limits():
    settings = ControllerSettings()
    long = 20.0 * settings.load_time_constant
    up = learnt(long, settings, force=np.array([0.0, 0.0, -0.4]), mass_excess=0.1)
    assert up.force == pytest.approx([0.0, 0.0, -0.4], abs=1e-3)
    assert up.mass == pytest.approx(P.m_0 + 0.1, rel=1e-3)
    least, most = settings.mass_share
    assert learnt(long, settings, mass_excess=10.0).mass == pytest.approx(most * P.m_0)
    assert learnt(long, settings, mass_excess=-10.0).mass == pytest.approx(least * P.m_0)
    carried = P.m_0 * P.g
    lost = learnt(long, settings, force=np.array([30.0, 0.0, -2.0 * carried]), mass_excess=-0.1)
    assert lost.mass * P.g + lost.force[2] == pytest.approx(least * carried, rel=1e-2)
    assert lost.force[0] == pytest.approx(settings.force_limit * carried, rel=1e-2)
    hover = float(P.hover_thrust.min())
    pulled = learnt(long, settings, uav_force=np.tile([0.0, 50.0, 0.0], (N, 1)) * np.eye(N)[0][:, None]).uav_force
    assert pulled[0] == pytest.approx([0.0, settings.force_limit * hover, 0.0], rel=1e-2)
    assert pulled[1:] == pytest.approx(np.zeros((N - 1, 3)), abs=1e-6)


def test_on_the_ground_the_weight_of_the_payload_stays_and_the_lean_against_wind_goes():
    settings = ControllerSettings()
    adaptation = LoadAdaptation(MODEL, settings)
    for _ in range(200):
        adaptation.learn(estimated(force=np.array([2.0, -1.0, -16.0])))
    for _ in range(200):
        adaptation.release()
    assert adaptation.estimate.force == pytest.approx([0.0, 0.0, -16.0], abs=1e-3)


# Set-points -> wire -> vehicle


def test_setpoints_arrive_at_their_vehicle_as_decided():
    """Thrust directions are unit vectors in NED, thrusts in N; on the wire an attitude and a share of the maximum."""
    lean = np.array([0.02, -0.05, 0.08, 0.03, -0.04, 0.06, 0.0, 0.09])
    decision = controller().decide(estimated(s=lean, v_0=np.array([0.2, -0.1, 0.1])), REST)
    for i in range(N):
        message = attitude_target(i + 1, 12.3456, decision.directions[i], decision.thrusts[i], P.thrust_max)
        [on_wire] = Codec(1, 1).decode(Codec(255, 190).frame(message))
        assert on_wire.message.target_system == i + 1
        assert on_wire.message.time_boot_ms == 12346
        setpoint = read_setpoint(on_wire.fields, SYSTEM.onboard().setpoints)
        down = rotation_from_quaternion(np.array(setpoint.attitude))[:, 2]
        assert -down == pytest.approx(decision.directions[i], abs=1e-6)
        assert setpoint.thrust * P.thrust_max == pytest.approx(decision.thrusts[i], rel=1e-6)
        assert decision.u[2 * i : 2 * i + 2] == pytest.approx(decision.directions[i, :2])
        assert decision.u[2 * N + i] == pytest.approx(decision.thrusts[i])


def test_confirmations_of_setpoints_give_their_loss_and_copies():
    settings = LinkSettings()
    stream = SetpointStream(RemoteClock(settings.clock), {}, settings)
    stream.confirm(Confirmation())  # not known whether it arrived
    stream.confirm(Confirmation(as_sent=True))
    assert (stream.loss, stream.lost, stream.copies) == (0.0, 0, 1)
    stream.confirm(Confirmation(as_sent=False))
    assert (stream.loss, stream.lost) == (pytest.approx(settings.loss_filter), 1)
    for _ in range(200):
        stream.confirm(Confirmation(as_sent=False))
    assert stream.loss == pytest.approx(1.0, abs=0.01) and stream.copies == 3
    for _ in range(200):
        stream.confirm(Confirmation(as_sent=True))
    assert stream.loss == pytest.approx(0.0, abs=0.01) and stream.lost == 201
