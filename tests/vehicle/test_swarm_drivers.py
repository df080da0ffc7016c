"""The drivers: lockstep over real sockets, real time on a clock of the test's own."""

import contextlib
import select
import socket
import threading

import pymavlink.dialects.v20.common as mavlink
import pytest
from programs import PATIENCE, process
from scripted_ground import LockstepClient, ScriptedGround
from test_swarm import CONFIG

from gcs.mavlink.codec import Codec
from gcs.mavlink.lockstep import Done, decode_tick
from gcs.record.reader import read_table
from vehicle_sim.app.drivers import LockstepDriver, RealTimeClock, RealTimeDriver
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.swarm_sockets import SwarmSockets
from vehicle_sim.swarm import Swarm

pytestmark = pytest.mark.slow

SYSTEM = CONFIG.parameters()


def scripted_ground(addresses, lift=0.6):
    return ScriptedGround(addresses, float(SYSTEM.hover_thrust.mean()), SYSTEM.thrust_max, lift=lift)


@pytest.fixture
def lockstep(request):
    """A driver in a thread of its own: (swarm, sockets, ending, thread); its parameter: how long it waits (s)."""
    with contextlib.ExitStack() as opened:
        swarm = opened.enter_context(Swarm(CONFIG, seed=1))
        sockets = opened.enter_context(SwarmSockets("127.0.0.1", 0, 4, with_clock=True))
        ending = opened.enter_context(contextlib.closing(Ending()))
        driver = LockstepDriver(swarm, sockets, ending, answer_time=getattr(request, "param", PATIENCE))
        thread = threading.Thread(target=driver.run)
        thread.start()
        try:
            yield swarm, sockets, ending, thread
        finally:
            ending.request()
            thread.join(PATIENCE)


def client_of(sockets, lift=0.6):
    ground = scripted_ground([endpoint.getsockname() for endpoint in sockets.vehicles], lift)
    return LockstepClient(ground, sockets.clock.getsockname())


def fly_and_leave(clock, vehicles, end):
    """A ground that flies until the payload is up and then ends in the way that ``end`` does."""
    client = LockstepClient(scripted_ground(vehicles), clock)
    client.join()
    client.run(lambda: client.ground.finished)
    end(client)
    client.close()
    return client


def check_landed(truth):
    assert truth["payload_z_m"].min() < -0.9
    assert truth["payload_z_m"][-1] == pytest.approx(-0.30, abs=0.01)
    assert max(truth[f"uav{i}_thrust_n"][-1] for i in (1, 2, 3, 4)) < 0.2
    assert not truth["contacts"].any()


def test_parallel_swarms_of_equal_seed_fly_alike_and_land_after_link_loss(tmp_path):
    def started(name, seed):
        arguments = ("--lockstep", "--base-port", 0, "--with-parent", "--run-dir", tmp_path / name, "--seed", seed)
        return process(*arguments)

    with started("a", 5) as first, started("b", 5) as second:
        ports = {port for _, clock, vehicles in (first, second) for _, port in (clock, *vehicles)}
        assert len(ports) == 10
        # The first says that it leaves, the other one just vanishes.
        ends = (LockstepClient.leave, LockstepClient.close)
        flights = [
            threading.Thread(target=fly_and_leave, args=(clock, vehicles, end))
            for (_, clock, vehicles), end in zip((first, second), ends, strict=True)
        ]
        for flight in flights:
            flight.start()
        for flight in flights:
            flight.join(PATIENCE)
            assert not flight.is_alive()
        second[0].stdin.close()
        for running, _, _ in (first, second):
            assert running.wait(PATIENCE) == 0
            assert running.stdout.read() == ""
    for name in "ab":
        check_landed(read_table(tmp_path / name / "truth.csv"))
        assert {path.name for path in (tmp_path / name).iterdir()} == {"truth.csv", "modes.csv", "forces.csv"}
    first_truth, second_truth = ((tmp_path / name / "truth.csv").read_bytes() for name in "ab")
    assert first_truth == second_truth  # of another seed they differ: tests/vehicle/test_swarm.py


def test_lockstep_time_starts_when_a_ground_joins(lockstep):
    swarm, sockets, _, _ = lockstep
    client = client_of(sockets)
    client.join()
    client.run(lambda: True)
    assert client.last_tick.time_us == 0
    assert swarm.time == 0.0
    client.close()


def test_second_ground_may_join_after_first_has_left(lockstep):
    swarm, sockets, _, _ = lockstep
    first = client_of(sockets)
    first.join()
    first.run(lambda: first.ground.finished)
    first.leave()
    first.close()

    second = client_of(sockets)
    second.join()
    second.ground.commanded = True  # it only listens
    ticks = []
    second.run(lambda: ticks.append(second.now) or second.ground.of_type("HEARTBEAT", 3))
    landed = ticks[0]
    assert first.now + 6.0 < landed < first.now + 30.0
    assert swarm.at_rest
    assert swarm.world.touching_ground()
    second.close()


@pytest.mark.parametrize("lockstep", [3.0], indirect=True)  # as long as it takes a busy machine to answer, and to wait
def test_ground_that_stops_answering_times_out(lockstep):
    swarm, sockets, _, _ = lockstep
    first = client_of(sockets, lift=0.3)
    first.join()
    first.run(lambda: first.ground.finished)  # the last tick stays without an answer

    second = client_of(sockets)
    second.join()
    second.run(lambda: True)
    assert swarm.at_rest
    assert second.now > first.now + 6.0
    first.close()
    second.close()


@pytest.mark.parametrize("has_parent", [False, True])
def test_ground_that_started_the_simulation_has_all_the_time_it_needs(has_parent):
    """On a busy machine a step may take longer than a ground of its own may be silent."""

    class Slow:
        """An end that never comes; the ground answers when it has been waited for five times."""

        requested = parent_gone = False
        waits = 0

        def wait(self, sockets, timeout):
            self.waits += 1
            if self.waits == 5:
                ground.sendto(Done(0, None).encode(), sockets[0].getsockname())
                select.select(sockets, (), (), PATIENCE)

    ending = Slow()
    ending.has_parent = has_parent
    with contextlib.ExitStack() as opened:
        swarm = opened.enter_context(Swarm(CONFIG, seed=1))
        sockets = opened.enter_context(SwarmSockets("127.0.0.1", 0, 4, with_clock=True))
        ground = opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        ground.bind(("127.0.0.1", 0))
        answer = LockstepDriver(swarm, sockets, ending, answer_time=0.0)._answer(ground.getsockname())
    assert (answer is not None) == has_parent


def test_only_the_joined_ground_advances_lockstep_time(lockstep):
    swarm, sockets, _, _ = lockstep
    client = client_of(sockets)
    client.join()
    client.run(lambda: True)
    tick = client.last_tick
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        forged = (Done(tick.serial, 10**9), Done(tick.serial, None, leaving=True))
        for junk in (b"", b"CLDN", b"\xfd" * 400, *[done.encode() for done in forged]):
            other.sendto(junk, client.clock)
    client.socket.sendto(Done(tick.serial + 7, 10**9).encode(), client.clock)  # an answer to nothing
    client.socket.sendto(Done(tick.serial, 123).encode(), client.clock)
    datagram, _ = client.socket.recvfrom(65535)
    assert decode_tick(datagram).time_us == 123
    assert swarm.time < 0.001
    client.close()


def test_answers_of_vehicles_arrive_at_the_same_time(lockstep):
    _, sockets, _, _ = lockstep
    client = client_of(sockets)
    client.join()
    client.run(lambda: True)
    tick = client.last_tick
    codec = Codec(255, 1)
    known = codec.encode(mavlink.MAVLink_mission_ack_message(3, 1, 0))  # shows that it knows the vehicle
    ping = known + codec.encode(mavlink.MAVLink_ping_message(0, 42, 0, 0))
    client.socket.sendto(ping, sockets.vehicles[2].getsockname())
    client.socket.sendto(Done(tick.serial, 5_000_000).encode(), client.clock)
    answers = []
    while (again := decode_tick((datagram := client.socket.recvfrom(65535))[0])) is None:
        received = [received.message for received in Codec(255, 1).decode(datagram[0])]
        answers += [(datagram[1], m) for m in received if m.get_type() == "PING"]
    assert [(address, m.seq) for address, m in answers] == [(sockets.vehicles[2].getsockname(), 42)]
    assert (again.serial, again.time_us) == (tick.serial + 1, tick.time_us)
    client.close()


def test_end_request_ends_simulation_at_once(lockstep):
    _, sockets, ending, thread = lockstep
    client = client_of(sockets)
    client.join()
    client.run(lambda: client.ground.finished)  # in the air, an answer awaited
    ending.request()
    thread.join(PATIENCE)
    assert not thread.is_alive()
    client.close()


class Wall:
    """A wall clock that goes on while the driver waits, as long as it waits, and sometimes much longer."""

    def __init__(self, stop_at, stalls=()):
        self.now = 1e6
        self.stop_at = self.now + stop_at
        self.stalls = [self.now + when for when in stalls]
        self.requested = False
        self.parent_gone = False

    def __call__(self):
        return self.now

    def wait(self, sockets, timeout):
        self.now += timeout + 1e-5
        if self.stalls and self.now >= self.stalls[0]:
            self.stalls.pop(0)
            self.now += 3600.0
            self.stop_at += 3600.0
        self.requested = self.now >= self.stop_at


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_real_time_follows_the_clock_at_the_speed(speed):
    wall = Wall(stop_at=0.5)
    with Swarm(CONFIG, seed=1) as swarm, SwarmSockets("127.0.0.1", 0, 4, with_clock=False) as sockets:
        RealTimeDriver(swarm, sockets, wall, speed, wall).run()
        assert swarm.time == pytest.approx(0.5 * speed, abs=0.01 * max(1.0, speed))


def test_real_time_resumes_without_jump_after_stall():
    wall = Wall(stop_at=0.5, stalls=(0.2, 0.3))
    with Swarm(CONFIG, seed=1) as swarm, SwarmSockets("127.0.0.1", 0, 4, with_clock=False) as sockets:
        RealTimeDriver(swarm, sockets, wall, 1.0, wall).run()
        assert 0.48 < swarm.time < 0.5 + 2 * 0.4 + 0.02


def test_real_time_clock_limits_its_lag():
    now = [100.0]
    clock = RealTimeClock(5.0, 2.0, 0.4, lambda: now[0])
    assert clock.now() == 5.0
    now[0] += 0.05
    assert clock.follow(5.0) == pytest.approx(5.1)
    assert clock.wall_until(5.2) == pytest.approx(0.05)
    now[0] += 1000.0
    assert clock.follow(5.1) == pytest.approx(5.1 + 2 * 0.4)
    assert clock.now() == pytest.approx(5.1 + 2 * 0.4)
    assert clock.wall_until(5.0) == 0.0


def test_real_time_over_udp_sends_each_sample_when_it_is_due():
    wall = Wall(stop_at=1.0)
    with (
        Swarm(CONFIG, seed=1) as swarm,
        SwarmSockets("127.0.0.1", 0, 4, with_clock=False) as sockets,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ground,
    ):
        ground.bind(("127.0.0.1", 0))
        ground.setblocking(False)
        codec = Codec(255, 1)
        heartbeat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
        for i, endpoint in enumerate(sockets.vehicles, start=1):
            known = mavlink.MAVLink_mission_ack_message(i, 1, 0)  # shows that it knows the vehicle
            ground.sendto(codec.encode(heartbeat) + codec.encode(known), endpoint.getsockname())
        RealTimeDriver(swarm, sockets, wall, 1.0, wall).run()
        stamps = {}
        with contextlib.suppress(BlockingIOError):
            while True:
                datagram, sender = ground.recvfrom(65535)
                for received in codec.decode(datagram):
                    message = received.message
                    if message.get_type() == "LOCAL_POSITION_NED" and message.get_srcComponent() == 1:
                        stamps.setdefault(sender, []).append(message.time_boot_ms)
        assert sorted(stamps) == sorted(endpoint.getsockname() for endpoint in sockets.vehicles)
        for of_one in stamps.values():
            interval = 1000 // CONFIG.rates.telemetry
            assert of_one[1:] == list(range(interval, interval * len(of_one), interval))
            assert len(of_one) >= 0.95 * CONFIG.rates.telemetry


@pytest.mark.parametrize("rubbish", [b"x" * 60, bytes([0xFD]) * 60, bytes(8000)], ids=["text", "markers", "long"])
def test_flood_at_one_port_takes_nothing_from_another_vehicles_telemetry(rubbish):
    """A sender that is never empty-handed: what is read of it in one pass is bounded, and time goes on."""

    class Flooded(Wall):
        def wait(self, watched, timeout):
            for _ in range(300):  # more than a pass reads
                flood.sendto(rubbish, watched[0].getsockname())
            super().wait(watched, timeout)

    wall = Flooded(stop_at=0.5)
    with (
        Swarm(CONFIG, seed=1) as swarm,
        SwarmSockets("127.0.0.1", 0, 4, with_clock=False) as sockets,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as flood,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ground,
    ):
        ground.bind(("127.0.0.1", 0))
        ground.setblocking(False)
        codec = Codec(255, 1)
        known = mavlink.MAVLink_mission_ack_message(2, 1, 0)
        ground.sendto(codec.encode(known), sockets.vehicles[1].getsockname())
        RealTimeDriver(swarm, sockets, wall, 1.0, wall).run()
        assert select.select([sockets.vehicles[0]], [], [], 0.0)[0]  # there was always more
        messages = []
        with contextlib.suppress(BlockingIOError):
            while True:
                messages += [received.message for received in codec.decode(ground.recv(65535))]
    stamps = [m.time_boot_ms for m in messages if m.get_type() == "LOCAL_POSITION_NED" and m.get_srcSystem() == 2]
    interval = 1000 // CONFIG.rates.telemetry
    assert stamps[1:] == list(range(interval, interval * len(stamps), interval))
    assert len(stamps) >= 0.95 * 0.5 * CONFIG.rates.telemetry


def test_real_time_vehicles_land_when_parent_process_ends(tmp_path):
    arguments = (
        "--base-port",
        0,
        "--ground-port",
        0,
        "--sdk-port",
        0,
        "--with-parent",
        "--speed",
        20,
        "--run-dir",
        tmp_path / "run",
    )
    with process(*arguments) as (running, clock, vehicles):
        assert clock is None
        assert len(vehicles) == 4
        running.stdin.close()
        assert running.wait(PATIENCE) == 0
    assert read_table(tmp_path / "run" / "truth.csv")["time_s"][0] == 0.0
