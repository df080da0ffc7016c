"""The ground is killed on the way, behind links that lose, repeat or broadcast: the vehicles set the payload down."""

from functools import partial

import pytest
from flights import MISSIONS, InProcessFlight, address_of, system_file, truth_of

from gcs.flight.phase import Phase
from gcs.mission.read import read_mission

pytestmark = pytest.mark.slow

LEG = """
[mission]
name = "leg"
system = "system.toml"
seed = 1

[reference]
kind = "waypoints"
points = [[0.0, 0.0, -2.0], [10.0, 0.0, -2.0]]
speed = {speed}
return_home = false
"""


class Router:
    """A world behind links: of a ``lost`` vehicle nothing passes, what is for one is repeated after a delay (s)."""

    def __init__(self, world, *, repeats_to=None, delay=0.0):
        self._world, self._repeats_to, self._delay = world, repeats_to, delay
        self._late, self.lost = [], None

    def __getattr__(self, name):
        return getattr(self._world, name)

    def advance_to(self, now):
        while self._late and self._late[0][0] <= now:
            due, datagram, address = self._late.pop(0)
            self._world.advance_to(due)
            self._world.receive([(datagram, address)], due)
        self._world.advance_to(now)

    def receive(self, datagrams, now):
        self._world.receive([(datagram, address) for datagram, address in datagrams if address != self.lost], now)
        self._late += [(now + self._delay, *each) for each in datagrams if each[1] == self._repeats_to]

    def datagrams_to_send(self, now):
        return [(datagram, sender) for datagram, sender in self._world.datagrams_to_send(now) if sender != self.lost]


class BroadcastingRouter(Router):
    """One address in place of the vehicles': every vehicle gets what is for any of them."""

    addresses = (("10.0.0.1", 14550),) * 4

    def receive(self, datagrams, now):
        each = self._world.addresses
        self._world.receive([(datagram, address) for datagram, _ in datagrams for address in each], now)

    def datagrams_to_send(self, now):
        return [(datagram, self.addresses[0]) for datagram, _ in self._world.datagrams_to_send(now)]


def flown(folder, *, speed, lost_before=None, **router):
    """The summary of a flight whose ground is killed in full motion, ``lost_before`` (s) after vehicle 2 is lost."""
    system_file(folder)
    (folder / "leg.toml").write_text(LEG.format(speed=speed))
    mission, behind = read_mission(folder / "leg.toml"), partial(Router, **router)
    with InProcessFlight(mission, folder / "run", behind=behind) as flight:
        v_north = flight.flight.control.controller.layout.v_0.start

        def in_full_motion():
            record = flight.flight.last_record
            return flight.flight.phase is Phase.FLY and record.estimate.x[v_north] > 0.65 * speed

        flight.fly(stop=in_full_motion)
        assert not flight.ended
        if lost_before is not None:
            flight.world.lost = address_of(2)
            flight.fly(until=flight.now + lost_before)
        assert flight.run_without_ground()
        return flight.summary(), truth_of(folder / "run")


def check_set_down(summary, truth):
    """Assert that payload and vehicles were set down upright and apart."""
    figures = {key: summary[key] for key in ("contacts", "uav_separation_min_m", "payload_tilt_max_deg", "landing")}
    assert summary["contacts"] == 0 and summary["uav_separation_min_m"] >= 0.6, figures
    assert summary["landing"]["on_ground"] and summary["landing"]["speed_mps"] < 1.0, figures
    assert max(summary["payload_tilt_max_deg"].values()) < 15.0, figures
    assert all(truth[f"uav{i}_thrust_n"][-1] < 0.5 for i in range(1, 5)), "rotors still turn"


@pytest.mark.parametrize(("speed", "lost_before"), [(1.5, 0.3), (1.5, 1.5), (3.0, 0.4)])
def test_vehicle_lost_and_then_the_ground(tmp_path, speed, lost_before):
    check_set_down(*flown(tmp_path, speed=speed, lost_before=lost_before))


@pytest.mark.parametrize("delay", [0.8, 1.2])
def test_link_to_one_vehicle_repeats_late(tmp_path, delay):
    check_set_down(*flown(tmp_path, speed=3.0, repeats_to=address_of(2), delay=delay))


@pytest.mark.parametrize(
    ("ground_lost", "wind"),
    [(8.5, 0.0), pytest.param(7.8, 0.0, marks=pytest.mark.long), pytest.param(8.5, 4.0, marks=pytest.mark.long)],
)
def test_position_of_all_is_lost_and_the_ground(tmp_path, ground_lost, wind):
    system_file(tmp_path)
    faults = ['kind = "position_lost"\nstart = 8.0', f'kind = "partition"\nstart = {ground_lost}']
    faults += [f'kind = "wind"\nvelocity = [{wind}, 0.0, 0.0]\nstart = 0.0'] * (wind > 0.0)
    (tmp_path / "leg.toml").write_text(LEG.format(speed=1.5) + "".join(f"\n[[fault]]\n{fault}\n" for fault in faults))
    with InProcessFlight(read_mission(tmp_path / "leg.toml"), tmp_path / "run") as flight:
        flight.fly()
        assert flight.run_without_ground()
        check_set_down(flight.summary(), truth_of(tmp_path / "run"))


def test_ground_is_killed_on_the_figure_eight_behind_a_router_that_broadcasts(tmp_path):
    with InProcessFlight(MISSIONS / "figure_eight.toml", tmp_path / "run", behind=BroadcastingRouter) as flight:
        flight.fly(stop=lambda: flight.swarm.take_off_time is not None)
        flight.fly(until=flight.swarm.take_off_time + 25.0)
        assert flight.flight.phase is Phase.FLY and not flight.flight.reason
        assert flight.run_without_ground()
        check_set_down(flight.summary(), truth_of(tmp_path / "run"))


@pytest.mark.parametrize("reckons", [False, True])
def test_ground_is_lost_as_the_payload_sinks_from_two_metres(tmp_path, reckons):
    """All descend together, and no faster for it; a vehicle that has gone by dead reckoning for long, too."""
    system_file(tmp_path)
    faults = ['kind = "partition"\nstart_phase = "land"\nstart_offset = 1.4']
    faults += ['kind = "position_lost"\nstart = 3.0\nvehicles = [2]'] * reckons
    (tmp_path / "leg.toml").write_text(LEG.format(speed=1.5) + "".join(f"\n[[fault]]\n{fault}\n" for fault in faults))
    with InProcessFlight(read_mission(tmp_path / "leg.toml"), tmp_path / "run") as flight:
        flight.fly()
        assert flight.run_without_ground()
        summary = flight.summary()
    check_set_down(summary, truth_of(tmp_path / "run"))
    assert summary["landing"]["speed_mps"] < 0.7
    assert max(summary["payload_tilt_max_deg"][axis] for axis in ("roll", "pitch")) < 5.0
