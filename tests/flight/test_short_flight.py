"""One short flight with every part in it, as fast tests of how the parts fit together.

Up 0.8 m, a second in the air, and down, between an obstacle of the mission's map and one that only the range sensors
know. Assertions share the flight; what a part does by itself is tested elsewhere.
"""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from estimator_truth import known_to_the_world, true_state
from flights import HOP, InProcessFlight, system_file
from obstacle_scene import outside
from pymavlink import mavutil

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.phase import IN_AIR, Phase
from gcs.mavlink import px4
from gcs.mission.model import Obstacle
from gcs.mission.read import read_mission
from gcs.record.reader import read_table
from idc_controller.geometry.shapes import Pole, Sphere
from idc_controller.model.linear import LinearModel

BALL = Obstacle("ball", (5.0, 1.0, -3.5), Sphere(0.5), known=False)
POLE = Obstacle("pole", (-5.0, 1.0, -3.0), Pole(0.3, 6.0))


class Watched(InProcessFlight):
    """A flight that keeps, at every step, its record and the true state at the time of the estimate."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.phases = {}
        self.steps = []
        self.pads = []
        self.thrusts = []
        write = self.recorder.step

        def step(flight, time, record):
            write(flight, time, record)
            self.phases.setdefault(flight.phase, time)
            if record is not None:
                self.steps.append([flight.phase, time, record, flight.control.stop_plan])

        self.recorder.step = step

    def watch(self, _):
        if self.steps and len(self.steps[-1]) == 4:
            self.swarm.advance_to(self.steps[-1][2].estimate.time)
            plans = [vehicle.autopilot.state.stop_plan for vehicle in self.swarm.vehicles]
            self.steps[-1] += [true_state(self.swarm.world.state(), self.swarm.world.parameters), plans]

    def in_air(self):
        return [step for step in self.steps if step[0] in IN_AIR]


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("short")
    system_file(folder)
    (folder / "hop.toml").write_text(HOP)
    mission = replace(read_mission(folder / "hop.toml"), obstacles=(BALL, POLE))
    with Watched(mission, folder / "run", seed=3, obstacles=mission.obstacles) as flight:
        flight.fly(flight.watch)
        flight.end = flight.result()
    return flight


def test_flight_passes_through_its_phases_and_completes(flown):
    assert list(flown.phases) == [
        Phase.CONNECT, Phase.CHECK, Phase.ARM, Phase.SPOOL_UP, Phase.CLIMB, Phase.HOLD, Phase.LAND, Phase.SPOOL_DOWN,
        Phase.DISARM, Phase.ENDED,
    ]  # fmt: skip
    assert flown.flight.completed and flown.flight.reason == "" and flown.flight.failsafes.alarms.alarms == []
    assert flown.end.summary["contacts"] == 0 and flown.end.summary["landing"]["on_ground"]
    assert not any(vehicle.autopilot.armed for vehicle in flown.swarm.vehicles)
    # Telemetry was averaged before the rotors were started.
    assert flown.phases[Phase.ARM] - flown.phases[Phase.CHECK] >= DEFAULTS.takeoff_landing.settle_time - 1e-9
    assert flown.flight.takeoff_time == flown.phases[Phase.SPOOL_UP]


def test_positions_on_the_pad_are_those_of_payload_and_vehicles(flown):
    first = flown.steps[0][4]
    p = flown.swarm.world.parameters
    preflight = flown.flight.system.preflight
    assert preflight.payload == pytest.approx(first[:3], abs=0.02)
    expected = first[:3] + p.p - p.l[:, None] * np.array([0.0, 0.0, 1.0])
    assert preflight.vehicles == pytest.approx(expected, abs=0.1)


def test_estimate_is_of_the_time_and_the_state_that_setpoints_act_on(flown):
    """Errors are as large as their covariance says: in a wrong time, frame, order or unit they would not be."""
    layout = LinearModel(flown.mission.system.parameters()).layout
    known = known_to_the_world(layout)
    for part in ("r_0", "v_0", "Theta", "omega", "s", "s_dot", "n", "n_dot", "f"):
        which = np.arange(layout.size)[getattr(layout, part)]
        assert set(which) <= set(known)
        squared = []
        for _, _, record, _, truth, _ in flown.in_air()[10:]:
            error = (record.estimate.x - truth)[which]
            squared.append(
                error @ np.linalg.solve(record.estimate.covariance[np.ix_(which, which)], error) / len(which)
            )
        # One short flight: the errors of successive steps are correlated, so the mean is not sharp.
        assert 0.3 < np.mean(squared) < 1.5, part


def test_measurements_agree_with_their_predictions(flown):
    records = [r for _, _, record, *_ in flown.in_air()[10:] for r in record.estimate.innovations]
    # Of each moment the payload unit and four vehicles, position and attitude.
    assert {len(record.keys) for record in records} == {10}
    assert sum(r.normalised_squared for r in records) == pytest.approx(
        sum(r.degrees_of_freedom for r in records), rel=0.1
    )
    assert not any(record.rejected for record in records)
    assert flown.flight.control.estimator.health.isolation.isolated == ()


def test_payload_follows_the_reference_of_every_phase(flown):
    for phase, time, record, _, truth, _ in flown.in_air()[10:]:
        reference, velocity = flown.flight.reference(np.array([time]))
        if phase in (Phase.CLIMB, Phase.HOLD):
            assert truth[:3] == pytest.approx(reference[0], abs=0.06), (phase, time)
            assert truth[3:6] == pytest.approx(velocity[0], abs=0.12), (phase, time)
        assert record.decision.flat.payload[0, 0] == pytest.approx(truth[:3], abs=0.06)
    top = -min(step[4][2] for step in flown.in_air())
    assert top == pytest.approx(0.8, abs=0.03)


def test_vehicles_fly_the_setpoints_decided_for_them(flown):
    """Tilt and thrust follow their set-points, which differ by more than this between vehicles on the way."""
    layout = LinearModel(flown.mission.system.parameters()).layout
    steps = flown.in_air()
    decided = np.array([step[2].decision.u for step in steps[10:-1]])
    later = np.array([step[4] for step in steps[11:]])  # a period later
    assert np.abs(later[:, layout.f] - decided[:, layout.f_setpoint]).mean() < 0.15
    assert np.abs(later[:, layout.n] - decided[:, layout.n_setpoint]).mean() < 0.01


def test_links_report_what_the_vehicles_are(flown):
    for link, vehicle in zip(flown.station.links, flown.swarm.vehicles, strict=True):
        assert link.system_id == vehicle.system_id
        assert link.status.parameters[px4.PARAM_THRUST_MAX] == pytest.approx(flown.mission.system.uav.thrust_max)
        assert link.setpoints.lost == 0 and link.setpoints.copies == 1
        # In memory nothing is late: what is left is the wait for the next step on board.
        assert link.clock.delay == pytest.approx(0.0, abs=1e-3)
        assert 0.0 <= link.setpoints.delay <= 2.5 / flown.mission.system.rates.onboard
        assert link.statistics.damaged == 0
    assert flown.station.router.refused == 0


def test_every_vehicle_has_its_own_part_of_the_stop_plan_that_was_sent(flown):
    for _, _, _, plan, _, on_board in flown.in_air()[10::20]:
        for i, own in enumerate(on_board):
            assert own.start == pytest.approx(plan.start, abs=0.01)
            assert own.descent == pytest.approx(plan.descent, abs=0.01)
            assert own.duration == pytest.approx(plan.duration, rel=1e-6)
            assert np.array(own.control_points) == pytest.approx(plan.control_points[i], abs=1e-5)


def test_each_vehicle_is_sent_one_setpoint_and_one_stop_plan_a_step(flown):
    sent = Counter()
    log = mavutil.mavlink_connection(str(flown.folder / "telemetry.tlog"))
    while (message := log.recv_match(type=["SET_ATTITUDE_TARGET", "TUNNEL"])) is not None:
        sent[message.get_type()] += 1
    log.close()
    # From arming to disarming, and from when the thrust lifts the UAVs from their cradles.
    config = flown.mission.system
    parameters, period = config.parameters(), 1.0 / config.rates.control
    share = float((parameters.m * parameters.g / parameters.hover_thrust).max())
    lifted = flown.phases[Phase.SPOOL_UP] + share * config.flight.takeoff_landing.spool_up_time
    steps = {
        "SET_ATTITUDE_TARGET": (flown.phases[Phase.ENDED] - flown.phases[Phase.ARM]) / period,
        "TUNNEL": (flown.phases[Phase.ENDED] - lifted) / period,
    }
    for kind, number in steps.items():
        assert sent[kind] == pytest.approx(4 * number, rel=0.03), kind


def test_log_has_what_each_vehicle_is_its_time_and_all_of_its_parameters(flown):
    log = mavutil.mavlink_connection(str(flown.folder / "telemetry.tlog"))
    found = {vehicle.system_id: Counter() for vehicle in flown.swarm.vehicles}
    parameters = {system_id: {} for system_id in found}
    versions = set()
    while (message := log.recv_match()) is not None:
        sender = message.get_srcSystem()
        if sender in found:
            found[sender][message.get_type()] += 1
        if message.get_type() == "PARAM_VALUE":
            parameters[sender][message.param_id] = message.param_value
        elif message.get_type() == "AUTOPILOT_VERSION":
            versions.add((sender, message.uid))
    log.close()
    # Each identifies itself by its system id.
    assert versions == {(system_id, system_id) for system_id in found}
    for vehicle in flown.swarm.vehicles:
        of_vehicle = found[vehicle.system_id]
        known = {
            parameter.name: px4.parameter_to_wire(parameter.value, parameter.type) for parameter in vehicle.parameters
        }
        read = parameters[vehicle.system_id]
        assert read.pop("_HASH_CHECK") is not None and read == pytest.approx(known, nan_ok=True)
        seconds = flown.phases[Phase.ENDED] - flown.phases[Phase.CHECK]
        assert of_vehicle["AUTOPILOT_VERSION"] == 1
        assert of_vehicle["SYSTEM_TIME"] >= seconds - 1 and of_vehicle["MISSION_CURRENT"] >= seconds - 1


def test_map_has_the_detected_obstacle_and_the_known_one(flown):
    obstacle_map, time = flown.flight.system.obstacle_map, flown.flight.time
    predicted = {o.name: o for o in obstacle_map.predict(np.array([time]))}
    assert obstacle_map.placement.discarded == 0
    assert predicted.pop("pole").positions[0] == pytest.approx(POLE.position, abs=1e-9)
    assert predicted and all(name.startswith("piece") for name in predicted)
    towards = -np.array(BALL.position) / np.linalg.norm(BALL.position[:2]) * [1.0, 1.0, 0.0]
    facing = np.array(BALL.position) + 0.5 * towards
    assert outside(obstacle_map, time, facing[None], "piece")[0] < 0.1
    # Nothing stands but the ball: no piece of it is farther from its surface than noise takes a return.
    for _, shape, centre in obstacle_map.seen.pieces:
        assert np.linalg.norm(centre - BALL.position) + shape.reach < 1.2


def test_records_hold_the_flight_from_connection_to_disarming(flown):
    truth, estimate = (read_table(flown.folder / f"{name}.csv") for name in ("truth", "estimate"))
    down = truth["payload_z_m"]
    assert down[0] == pytest.approx(down[-1], abs=0.06) and down.min() == pytest.approx(-0.8, abs=0.03)
    # Most at touch-down, where the pad takes over the load: 14 to 30 mm over five seeds.
    at_steps = np.interp(estimate["time_s"], truth["time_s"], down)
    assert estimate["payload_z_m"] == pytest.approx(at_steps, abs=0.04)


def test_controller_stays_within_its_limits(flown):
    decisions = [step[2].decision for step in flown.in_air()]
    assert not any(decision.infeasible for decision in decisions)
    assert all(decision.progress_rate == 1.0 for decision in decisions) and decisions[-1].detours == 0
    assert all(np.linalg.norm(decision.directions, axis=1) == pytest.approx(1.0) for decision in decisions)
