"""Every end of a flight: a clear message and exit code, the payload on the ground, records closed."""

import json
import math
import os
import re
import signal

import numpy as np
import pytest
from flights import InProcessFlight, short_figure, truth_of
from programs import PATIENCE, GcsProcess, addresses_of, base_port, swarm_process
from pymavlink import mavutil

from gcs.record.landing import is_set_down
from gcs.record.modes import stops_after
from vehicle_sim.faults.fault_injector import FaultInjector


def check_records_closed(folder):
    summary = json.loads((folder / "summary.json").read_text())
    assert {"HEARTBEAT", "SET_ATTITUDE_TARGET", "LOCAL_POSITION_NED"} <= kinds_in_log(folder)
    for name in ("truth.csv", "reference.csv"):
        text = (folder / name).read_text()
        assert text.endswith("\n")
        columns = text.partition("\n")[0].count(",")
        assert text.rstrip("\n").rpartition("\n")[2].count(",") == columns  # the last row is whole
    return summary


def kinds_in_log(folder):
    """Types of the messages in the log of a flight's datagrams."""
    log = mavutil.mavlink_connection(str(folder / "telemetry.tlog"))
    kinds = set()
    while (message := log.recv_match()) is not None:
        kinds.add(message.get_type())
    log.close()
    return kinds


def check_on_the_ground(folder, height=0.25):
    truth = truth_of(folder)
    assert -truth["payload_z_m"].min() > 1.0  # it was in the air
    assert -truth["payload_z_m"][-1] == pytest.approx(height, abs=0.06)
    assert max(truth[f"uav{i}_thrust_n"][-1] for i in (1, 2, 3, 4)) < 0.5


# Two programs


@pytest.mark.slow
def test_second_ctrl_c_ends_control_and_vehicles_land(tmp_path):
    gcs = GcsProcess(short_figure(tmp_path, duration=30.0, altitude=1.5), tmp_path / "run")
    gcs.until_phase("fly")
    gcs.process.send_signal(signal.SIGINT)
    gcs.until_phase("hold")  # the first one is being obeyed
    gcs.process.send_signal(signal.SIGINT)
    code, _ = gcs.end()
    assert code == 130
    check_records_closed(gcs.folder)
    check_on_the_ground(gcs.folder, height=0.275)


@pytest.mark.slow
def test_killed_simulation_ends_the_flight_with_its_reason(tmp_path):
    gcs = GcsProcess(short_figure(tmp_path, duration=30.0, altitude=1.5), tmp_path / "run")
    gcs.until_phase("fly")
    os.kill(gcs.child(), signal.SIGKILL)
    code, errors = gcs.end()
    assert code == 1
    assert "vehicle-sim was killed by signal 9" in errors
    summary = json.loads((gcs.folder / "summary.json").read_text())
    assert summary["outcome"] == "lost" and "vehicle-sim was killed by signal 9" in summary["reason"]
    assert {"HEARTBEAT", "SET_ATTITUDE_TARGET", "LOCAL_POSITION_NED"} <= kinds_in_log(gcs.folder)


@pytest.mark.slow
def test_vehicles_hold_then_land_when_the_ground_is_killed(tmp_path):
    mission = short_figure(tmp_path, duration=30.0, altitude=1.5)
    options = ("--lockstep", "--mission", mission, "--run-dir", tmp_path / "world", "--base-port", base_port())
    swarm = swarm_process(*options)
    try:
        addresses = addresses_of(swarm)
        gcs = GcsProcess(mission, tmp_path / "run", "--connect", *(addresses[f"vehicle {i}"] for i in (1, 2, 3, 4)))
        gcs.until_phase("hold")
        gcs.process.kill()
        gcs.process.communicate()
        # A second ground that joins is served when the vehicles have landed: the sign that they have.
        again = GcsProcess(
            mission, tmp_path / "second", "--connect", *(addresses[f"vehicle {i}"] for i in (1, 2, 3, 4))
        )
        again.until_phase("check")
        again.process.kill()
        again.process.communicate()
    finally:
        swarm.terminate()
        swarm.communicate(timeout=PATIENCE)
    assert swarm.returncode == 0
    check_on_the_ground(tmp_path / "world", height=0.275)
    truth = truth_of(tmp_path / "world")
    assert truth["contacts"].max() == 0


# One process


class Cut(FaultInjector):
    """From ``at`` (s) on nothing passes between a vehicle and the ground, in the directions named."""

    def __init__(self, vehicle, at, telemetry=True, commands=True):
        super().__init__()
        self.vehicle, self.at, self.telemetry, self.commands = vehicle, at, telemetry, commands

    def to_vehicle(self, vehicle, arriving, now):
        return () if self.commands and vehicle == self.vehicle and now >= self.at else arriving

    def from_vehicle(self, vehicle, leaving, now):
        return () if self.telemetry and vehicle == self.vehicle and now >= self.at else leaving


class Radio(FaultInjector):
    """A link of a vehicle to the ground that passes ``rate`` bytes/s, from the beginning."""

    def __init__(self, vehicle, rate):
        super().__init__()
        self.vehicle, self.rate, self.free_at, self.waiting = vehicle, rate, 0.0, []

    def from_vehicle(self, vehicle, leaving, now):
        if vehicle != self.vehicle:
            return leaving
        for datagram, address in leaving:
            self.free_at = max(self.free_at, now) + len(datagram) / self.rate
            self.waiting.append((self.free_at, datagram, address))
        passed = [(datagram, address) for at, datagram, address in self.waiting if at <= now]
        self.waiting = [each for each in self.waiting if each[0] > now]
        return passed


def test_link_that_is_too_slow_is_measured_on_the_ground(tmp_path):
    with InProcessFlight(short_figure(tmp_path), tmp_path / "run", faults=Radio(2, 2500.0)) as flight:
        flight.fly()
    assert flight.flight.phase.value == "ended" and math.isnan(flight.flight.takeoff_time)
    late = r"link latency to vehicle 2 is \d+ ms \(limit 110 ms\): its link carries (.*) kB/s, less than .* needs"
    assert float(re.fullmatch(late, flight.flight.reason)[1]) == pytest.approx(2.5, rel=0.1)


def test_vehicle_that_refuses_to_arm_disarms_all(tmp_path):
    with InProcessFlight(short_figure(tmp_path), tmp_path / "run") as flight:
        flight.fly(stop=lambda: flight.flight.phase.value == "arm")
        autopilot = flight.swarm.vehicles[1].autopilot
        autopilot.arming_problem = lambda now: "the compass is upside down"
        flight.fly()
        assert "vehicle 2 answers MAV_CMD_COMPONENT_ARM_DISARM with temporarily_rejected" in flight.flight.reason
        assert "the compass is upside down" in flight.flight.reason
        assert not any(vehicle.autopilot.armed for vehicle in flight.swarm.vehicles)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("telemetry", "commands", "reason"),
    [
        pytest.param(True, True, "sends no telemetry", marks=pytest.mark.long),
        (True, False, "sends no telemetry"),
        (False, True, "has left OFFBOARD for AUTO.LOITER (Set-points lost"),
    ],
    ids=["both directions", "telemetry", "commands"],
)
def test_link_loss_of_one_vehicle_lands_all_of_them(tmp_path, telemetry, commands, reason):
    cut, followed = Cut(2, 16.4, telemetry, commands), {}

    def plans_followed(flight):
        for vehicle in flight.swarm.vehicles:
            if (hold := vehicle.autopilot.state.hold) is not None:
                followed.setdefault(vehicle.system_id, hold.plan.start)

    with InProcessFlight(short_figure(tmp_path, duration=20.0), tmp_path / "run", seed=1200, faults=cut) as flight:
        flight.fly(plans_followed)
        assert f"vehicle 2 {reason}" in flight.flight.reason
        assert flight.run_without_ground()
        summary = flight.summary()
    assert not summary["completed"]
    stops = stops_after(tmp_path / "run", 16.4)
    # Apart by a control period at most, 0.05 s, and a step on board: the last set-point or plan that reached a vehicle
    # may be one older than the others'.
    assert len(stops) == 4 and max(stops.values()) - min(stops.values()) < 0.055
    assert len(followed) == 4 and max(followed.values()) - min(followed.values()) < 0.055
    # A vehicle without commands stops and reports it; one without telemetry is detected at a control step.
    # The set-point loss time, 0.46 s, and of these two half a control period or a whole one.
    assert max(stops.values()) - 16.4 <= (0.515 if telemetry else 0.485)
    check_set_down(tmp_path / "run", summary)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("start", "velocity", "seed"),
    [(9.0, (0.0, -4.0), 9103), pytest.param(17.0, (2.83, 2.83), 7, marks=pytest.mark.long)],
)
def test_vehicles_without_ground_set_the_payload_down_in_wind(tmp_path, start, velocity, seed):
    """They have braced the payload against the wind; once it stands they must not be driven over by that."""
    mission = short_figure(tmp_path, duration=20.0)
    with mission.open("a") as file:
        file.write(f"""
[[fault]]
kind = "partition"
start = {start}

[[fault]]
kind = "wind"
start = 0.0
velocity = [{velocity[0]}, {velocity[1]}, 0.0]
gust = 0.5
""")
    with InProcessFlight(mission, tmp_path / "run", seed=seed) as flight:
        flight.fly()
        assert "no vehicle sends telemetry" in flight.flight.reason
        assert flight.run_without_ground()
        summary = flight.summary()
    assert is_set_down(summary["landing"]), summary["landing"]
    assert summary["contacts"] == 0
    assert summary["uav_separation_min_m"] >= 0.6
    stops = stops_after(tmp_path / "run", flight.swarm.take_off_time + start)
    assert len(stops) == 4
    assert max(stops.values()) - min(stops.values()) < 0.01
    assert max(stops.values()) - flight.swarm.take_off_time - start <= 0.5


@pytest.mark.slow
def test_partition_is_to_the_vehicles_as_a_killed_ground(tmp_path):
    start, truths = 8.0007, []
    mission = short_figure(tmp_path, duration=4.0, altitude=1.5)
    with InProcessFlight(mission, tmp_path / "killed", seed=4) as flight:
        flight.fly(stop=lambda: flight.swarm.take_off_time is not None)
        flight.fly(until=flight.swarm.take_off_time + start)
        assert flight.run_without_ground()
    mission.write_text(f'{mission.read_text()}\n[[fault]]\nkind = "partition"\nstart = {start}\n')
    with InProcessFlight(mission, tmp_path / "parted", seed=4) as flight:
        flight.fly()
        assert flight.run_without_ground()
    for name in ("killed", "parted"):
        truths.append((tmp_path / name / "truth.csv").read_text().splitlines())
    rows = min(map(len, truths))
    assert rows > 50 * (start + 8.0) and truths[0][:rows] == truths[1][:rows]


def check_set_down(folder, summary):
    assert summary["contacts"] == 0
    assert summary["uav_separation_min_m"] >= 0.75
    tilt = summary["payload_tilt_max_deg"]
    assert max(tilt["roll"], tilt["pitch"]) < 15.0
    check_on_the_ground(folder)
    truth = truth_of(folder)
    sinking = np.diff(truth["payload_z_m"]) / np.diff(truth["time_s"])
    assert sinking.max() < 1.0
