"""Faults in a whole swarm: on the wire, in the world, on record."""

import json
import math
import signal

import numpy as np
import pytest
from fault_injection import SYSTEM, fault
from programs import PATIENCE, process
from scripted_ground import ScriptedGround, exchange

from gcs.record.faults import fault_notes
from gcs.record.incomplete import IncompleteRecords
from gcs.record.reader import read_table
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.fault_injector import FaultInjector, record_faults
from vehicle_sim.faults.world import Wind, WorldFaults
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world import World


def lifted(*faults, seed=1, until=4.0, folder=None):
    """A swarm that a scripted ground lifts: (ground, injector, swarm)."""
    system = SYSTEM.parameters()
    ground = ScriptedGround([("uav", i) for i in (1, 2, 3, 4)], float(system.hover_thrust.mean()), system.thrust_max)
    injector = FaultInjector(faults, seed, SYSTEM)
    with Swarm(SYSTEM, seed=seed, faults=injector) as swarm:
        if folder is not None:
            swarm.record(TruthLog(folder, 4))
        exchange(swarm, ground, until)
        if faults:
            assert all(f.schedule.origin == swarm.take_off_time for f in injector.faults)
    return ground, injector, swarm


def stamps(ground, vehicle, kind, component=1):
    return [
        m for m in ground.messages
        if m.get_type() == kind and m.get_srcSystem() == vehicle and m.get_srcComponent() == component
    ]  # fmt: skip


def of_payload(ground, vehicle):
    """Positions of the payload unit that a vehicle forwarded."""
    return [m for sender, m in ground.of_payload if sender == ("uav", vehicle) and m.get_type() == "LOCAL_POSITION_NED"]


MIXED = (
    fault("packet_loss", probability=0.2),
    fault("latency", delay=0.03),
    fault("jitter", 0.2, spread=0.02, vehicles=(1, 2)),
    fault("reordering", probability=0.1),
    fault("duplication", probability=0.1),
    fault("corruption", probability=0.1),
    fault("noise", channel="position", factor=5.0),
    fault("position_glitch", size=1.0),
    fault("wind", velocity=[2.0, 0.0, 0.0], gust=1.0),
    fault("payload_mass", 0.3, change=0.2),
)


@pytest.mark.slow
def test_truth_repeats_to_the_byte_with_same_seed_and_faults(tmp_path):
    runs = {"a": (MIXED, 1), "b": (MIXED, 1), "c": (MIXED, 2), "d": ((*MIXED[:8], *MIXED[9:]), 1)}
    truth, faults = {}, {}
    for name, (mixed, seed) in runs.items():
        (tmp_path / name).mkdir()
        _, injector, swarm = lifted(*mixed, seed=seed, folder=tmp_path / name)
        record_faults(tmp_path / name, injector, swarm.time, IncompleteRecords())
        faults[name] = (tmp_path / name / "faults.json").read_bytes()
        truth[name] = (tmp_path / name / "truth.csv").read_bytes()
    assert truth["a"] == truth["b"] and faults["a"] == faults["b"]
    assert truth["a"] != truth["c"] and truth["a"] != truth["d"]
    record = json.loads(faults["a"])
    assert record["take_off_s"] > 1.0
    assert [f["number"] for f in record["faults"]] == list(range(1, 11))
    assert all(f["occurrences"] == 1 and f["seen"] >= f["disturbed"] > 0 for f in record["faults"])
    assert (record["faults"][2]["vehicles"], record["faults"][8]["vehicles"]) == ([1, 2], None)
    assert record["faults"][2]["activations"] == [[0.2, None]]
    assert not fault_notes(tmp_path / "a")


def test_nan_is_sent_in_floats_and_omitted_from_integer_messages():
    ground, *_ = lifted(
        fault("not_a_number", channel="position", vehicles=(2,)),
        fault("not_a_number", channel="attitude", value="inf", vehicles=(3,)),
        fault("not_a_number", channel="payload_velocity", vehicles=(4,)),
    )
    assert math.isnan(stamps(ground, 2, "LOCAL_POSITION_NED")[-1].x)
    assert stamps(ground, 3, "ATTITUDE_QUATERNION")[-1].q1 == math.inf
    assert math.isnan(of_payload(ground, 4)[-1].vx)
    counts = [len(stamps(ground, i, "GLOBAL_POSITION_INT")) for i in (1, 2, 3, 4)]
    assert counts[0] == counts[3] > counts[1] == counts[2] > 0
    assert len({len(stamps(ground, i, "LOCAL_POSITION_NED")) for i in (1, 2, 3, 4)}) == 1


def test_lost_sensors_clocks_and_half_rate_on_the_wire():
    ground, _, swarm = lifted(
        fault("position_lost", vehicles=(1,)),
        fault("payload_unit_lost", vehicles=(2,)),
        fault("clock_step", step=10.0, vehicles=(3,)),
        fault("low_rate", vehicles=(4,)),
    )
    flown = swarm.time - swarm.take_off_time
    last = {i: stamps(ground, i, "LOCAL_POSITION_NED")[-1].time_boot_ms * 1e-3 for i in (1, 2, 3)}
    assert last[1] == pytest.approx(swarm.take_off_time, abs=0.05)
    assert last[2] == pytest.approx(swarm.time, abs=0.05)
    assert last[3] == pytest.approx(swarm.time + 10.0, abs=0.05)
    assert stamps(ground, 1, "ATTITUDE_QUATERNION")[-1].time_boot_ms * 1e-3 == pytest.approx(swarm.time, abs=0.05)
    assert of_payload(ground, 2)[-1].time_boot_ms < (swarm.take_off_time + 0.05) * 1e3
    late = [m for m in stamps(ground, 4, "LOCAL_POSITION_NED") if m.time_boot_ms * 1e-3 > swarm.take_off_time]
    assert len(late) == pytest.approx(SYSTEM.rates.telemetry / 2 * flown, abs=2)


def test_latency_fault_is_the_latency_the_ground_measures():
    ground, _, swarm = lifted(fault("latency", 0.5, delay=0.06, direction="telemetry"))
    begin = swarm.take_off_time + 0.5
    delays = [now - stamp * 1e-3 for stamp, now in ground.stamps[1] if now > begin + 0.07]
    assert delays and max(delays) == pytest.approx(0.06, abs=0.005) and min(delays) == pytest.approx(0.06, abs=0.005)
    assert max(now - stamp * 1e-3 for stamp, now in ground.stamps[1] if now < begin) < 0.005


def active(entry, seed=1):
    made = ActiveFault.of(1, entry, seed, 4)
    made.schedule.origin = 0.0
    return made


def test_gusts_have_their_deviation_and_correlation_time():
    wind = Wind(active(fault("wind", velocity=[3.0, 0.0, 0.0], gust=1.5, gust_time=0.5, rise=0.0)))
    air = np.array([wind.velocity(k * 0.01) for k in range(60_000)]) - [3.0, 0.0, 0.0]
    assert air.mean(axis=0) == pytest.approx(np.zeros(3), abs=0.25)
    assert air.std(axis=0) == pytest.approx([1.5, 1.5, 0.75], rel=0.1)
    centred = air - air.mean(axis=0)
    later = (centred[50:] * centred[:-50]).mean(axis=0) / centred.var(axis=0)
    assert later == pytest.approx(np.full(3, math.exp(-1.0)), abs=0.1)


def test_drag_is_quadratic_in_the_area_across_the_wind():
    def forces(velocity, now=10.0):
        with World(SYSTEM.true_parameters()) as world:
            return WorldFaults([active(fault("wind", velocity=velocity))]).act(world, now)

    payload, uavs = forces([3.0, 0.0, 0.0])
    assert payload == pytest.approx((0.5 * 1.225 * 1.05 * 0.5 * 9.0, 0.0, 0.0))
    assert np.array(uavs) == pytest.approx(np.tile([0.5 * 1.225 * 0.03 * 9.0, 0.0, 0.0], (4, 1)))
    down, _ = forces([0.0, 0.0, 2.0])
    assert down == pytest.approx((0.0, 0.0, 0.5 * 1.225 * 1.05 * 1.0 * 4.0))
    slant, _ = forces([3.0, 3.0, 0.0])
    assert math.hypot(*slant) == pytest.approx(0.5 * 1.225 * 1.05 * (1.0 * math.sqrt(0.5)) * 18.0)
    with World(SYSTEM.true_parameters()) as world:
        both = [active(fault("wind", velocity=velocity)) for velocity in ([1.0, -2.0, 0.5], [2.0, 2.0, -0.5])]
        assert WorldFaults(both).act(world, 10.0)[0] == pytest.approx(payload)
    rising, _ = forces([3.0, 0.0, 0.0], now=1.0)
    assert rising[0] == pytest.approx(payload[0] / 4.0)
    with World(SYSTEM.true_parameters()) as world:
        assert WorldFaults([active(fault("wind", 5.0, velocity=[3.0, 0.0, 0.0]))]).act(world, 1.0) is None


def test_wind_displaces_the_load(tmp_path):
    ends = []
    for name, faults in (("still", ()), ("windy", (fault("wind", velocity=[0.0, 5.0, 0.0]),))):
        (tmp_path / name).mkdir()
        lifted(*faults, folder=tmp_path / name)
        ends.append(read_table(tmp_path / name / "truth.csv")["payload_y_m"][-1])
    assert abs(ends[0]) < 0.05 and ends[1] > 0.3


def test_changed_payload_mass_acts_on_motion_and_is_restored():
    def flown(parameters, faults, steps):
        with World(parameters) as world:
            worlds = WorldFaults([active(entry) for entry in faults])
            for k in range(steps):
                worlds.act(world, k / world.physics_hz)
                world.step([14.5, 14.9, 14.5, 14.5], [(0.0, 0.0, 0.0)] * 4)
            return world.state()

    true = SYSTEM.true_parameters()
    lighter = flown(true.with_payload_mass(true.m_0 - 0.5), (), 500)
    changed = flown(true, (fault("payload_mass", change=-0.8), fault("payload_mass", change=0.3)), 500)
    assert np.allclose(changed.payload_position_in_world, lighter.payload_position_in_world, rtol=0.0, atol=1e-12)
    assert np.allclose(changed.payload_quaternion, lighter.payload_quaternion, rtol=0.0, atol=1e-12)
    assert flown(true, (fault("payload_mass", 0.0, 0.1, change=-0.5),), 50) != flown(true, (), 50)
    assert flown(true, (fault("payload_mass", 0.5, 0.1, change=-0.5),), 100) == flown(true, (), 100)


@pytest.mark.slow
def test_vehicle_sim_records_effects_of_faults(tmp_path):
    mission = tmp_path / "mission.toml"
    mission.write_text(
        '[mission]\nname = "m"\n[reference]\nkind = "waypoints"\npoints = [[0, 0, -2]]\n'
        '[[fault]]\nkind = "partition"\nstart = 1.0\n'
    )
    with process("--lockstep", "--base-port", "0", "--mission", mission, "--run-dir", tmp_path / "run") as (swarm, *_):
        swarm.send_signal(signal.SIGTERM)
        said = swarm.communicate(timeout=PATIENCE)[1]
    assert swarm.returncode == 0
    assert "fault 1, partition (line 6 of the mission), never came: nothing took off" in said
    assert json.loads((tmp_path / "run" / "faults.json").read_text())["faults"][0]["occurrences"] == 0
    assert fault_notes(tmp_path / "run")
