"""The ground is killed on the way, behind links that lose, repeat and broadcast: the vehicles set the payload down."""

import pytest
from flights import InProcessFlight, address_of, system_file, truth_of

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
    """A world behind a MAVLink router: to a ``lost`` vehicle and from it nothing comes, datagrams to one come again."""

    def __init__(self, world, *, broadcasts=False, repeats_to=None, delay=0.0):
        self._world, self._broadcasts, self._repeats_to, self._delay = world, broadcasts, repeats_to, delay
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
        for datagram, address in datagrams:
            to = [address_of(i) for i in range(1, 5)] if self._broadcasts else [address]
            self._world.receive([(datagram, each) for each in to if each != self.lost], now)
            if self._repeats_to == address:
                self._late.append((now + self._delay, datagram, address))

    def datagrams_to_send(self, now):
        return [(datagram, sender) for datagram, sender in self._world.datagrams_to_send(now) if sender != self.lost]


def flown(folder, *, speed, lost_before=None, **router):
    """The summary of a flight whose ground is killed in full motion, ``lost_before`` (s) after vehicle 2 is lost."""
    system_file(folder)
    (folder / "leg.toml").write_text(LEG.format(speed=speed))
    with InProcessFlight(read_mission(folder / "leg.toml"), folder / "run") as flight:
        world = flight.lockstep.world = Router(flight.lockstep.world, **router)
        v_north = flight.flight.control.controller.layout.v_0.start

        def in_full_motion():
            record = flight.flight.last_record
            return flight.flight.phase is Phase.FLY and record.estimate.x[v_north] > 0.65 * speed

        flight.fly(stop=in_full_motion)
        assert not flight.ended
        if lost_before is not None:
            world.lost = address_of(2)
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


def test_router_broadcasts_everything(tmp_path):
    check_set_down(*flown(tmp_path, speed=3.0, broadcasts=True))
