"""Single faults of one vehicle, of one channel of all, or of the payload's unit: the team goes on, within limits.

A flight has several of them one after the other, with time to recover; the last one lasts through the landing.
Flights of one process: tests/campaign/test_pytest_plugin.py and the last of these fly faults with the two programs.
"""

from dataclasses import replace

import pytest
from flights import InProcessFlight, short_figure

from gcs.app.exit_status import ExitStatus
from gcs.campaign.testing import fault
from gcs.faults.link import BandwidthCap, Jitter, Latency, Partition, Reordering
from gcs.faults.sensors import AttitudeLost, PositionDrift, PositionLost, RatesLost
from gcs.faults.values import Bias, Drift, NotANumber, Stuck, SwappedVehicles
from gcs.faults.world import Wind
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.record.run_data import read_run

pytestmark = pytest.mark.slow

pytest_plugins = ["gcs.campaign.pytest_plugin"]

START = 9.0  # s after take-off: on the figure
LIMITS = Limits(position_rmse=0.15, settle=0.0, payload_tilt_deg=4.0, uav_separation=0.75)


def of_one(parameters, direction=None, vehicle=3, start=START, duration=None):
    return [fault(parameters, start, duration, vehicles=[vehicle], direction=direction)]


def of_all(*parameters, start=START, duration=None):
    return [fault(each, start, duration) for each in parameters]


FIRST = {"start": START, "duration": 4.0}
THEN = {"start": START + 5.5, "duration": 4.0}
LAST = {"start": START + 11.0}  # and through the landing
FAULTS = {
    "one link late, velocity unknown, position drifting": [
        *of_one(Latency(delay=0.06), **FIRST),
        *of_one(NotANumber(channel="velocity"), vehicle=1, **THEN),
        *of_one(Drift(rate=0.1, channel="position"), **LAST),
    ],
    "one link's set-points late, rates lost, position stuck": [
        *of_one(Latency(delay=0.06), "command", **FIRST),
        *of_one(RatesLost(), vehicle=1, **THEN),
        *of_one(Stuck(channel="position"), **LAST),
    ],
    "all links late, attitude lost, all positions drifting": [
        *of_all(Latency(delay=0.06), Jitter(spread=0.02), **FIRST),
        *of_one(AttitudeLost(), **THEN),
        *of_all(PositionDrift(velocity=(0.1, 0.0, 0.0)), **LAST),
    ],
    "out of order, position biased, all attitudes stuck": [
        *of_all(Reordering(probability=0.2), **FIRST),
        *of_one(Bias(amount=0.5, channel="position"), **THEN),
        *of_all(Stuck(channel="attitude"), **LAST),
    ],
    "payload's position stuck, position lost, two vehicles' data swapped": [
        *of_all(Stuck(channel="payload_position"), **FIRST),
        *of_one(PositionLost(), vehicle=1, **THEN),
        *of_one(SwappedVehicles(other=1), **LAST),
    ],
    "all velocities biased": of_all(Bias(amount=0.5, channel="velocity")),
    "position lost from the climb on": of_one(PositionLost(), start=5.0),
}


def check_flown_within(limits, mission, folder, faults, seed):
    """Fly ``mission`` with ``faults``; assert that it completes within ``limits`` and without contact."""
    mission = replace(read_mission(mission), faults=tuple(faults), limits=limits)
    with InProcessFlight(mission, folder, seed=seed) as flight:
        flight.fly()
        result = flight.result()
    assert result.exit_code == ExitStatus.DONE, (result.reason, result.summary["limits"])
    assert result.summary["contacts"] == 0


#: Of what a flight of :data:`FAULTS` has, the others have the like.
LONG = {
    "one link late, velocity unknown, position drifting",
    "one link's set-points late, rates lost, position stuck",
    "out of order, position biased, all attitudes stuck",
    "all velocities biased",
    "position lost from the climb on",
}


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.long] * (name in LONG)) for name in FAULTS])
def test_flight_with_faults_one_after_another_completes_within_limits(name, tmp_path):
    duration = 18.0 if "," in name else 8.0
    mission = short_figure(tmp_path, duration=duration, altitude=2.5 if "climb" in name else 1.5)
    check_flown_within(LIMITS, mission, tmp_path / "run", FAULTS[name], seed=31)


@pytest.mark.parametrize("rate", [0.15, *(pytest.param(rate, marks=pytest.mark.long) for rate in (0.05, 0.4))])
def test_velocity_that_drifts_does_not_outweigh_the_right_position(rate, tmp_path):
    """The state follows it at first, so that it is the position that does not fit: the team once collided."""
    drift = of_one(Drift(rate=rate, channel="velocity", axes=("y",)), start=8.0, duration=8.0)
    mission = short_figure(tmp_path, duration=12.0)
    limits = Limits(position_rmse=0.15, settle=0.0, payload_tilt_deg=10.0, uav_separation=0.75)
    check_flown_within(limits, mission, tmp_path / "run", drift, seed=36)


def test_bias_of_attitude_on_board_is_compensated(tmp_path):
    """The disturbance force is estimated, then the vehicle deviates no more."""
    wrong = of_one(Bias(amount=0.05, channel="attitude", at_source=True))
    mission = short_figure(tmp_path, duration=16.0)
    check_flown_within(Limits(uav_separation=0.7), mission, tmp_path / "run", wrong, seed=34)
    run = read_run(tmp_path / "run")
    # It began 9 s after lift-off, which comes about 3 s after the records begin.
    assert run.uav_separation()[run.time > START + 10.0].min() > 0.93


@pytest.mark.long
def test_wind_drag_is_compensated_along_trajectory(tmp_path):
    """After half a minute of estimation the drag of 3 m/s against the payload's own motion costs little."""
    limits = Limits(position_rmse=0.3, settle=15.0, payload_tilt_deg=4.0, uav_separation=0.75)
    wind = [fault(Wind(velocity=(2.1, -2.1, 0.0), gust=0.3), start=2.0)]
    check_flown_within(limits, short_figure(tmp_path, duration=25.0), tmp_path / "run", wind, seed=32)


@pytest.mark.long
def test_growing_link_latency_ends_in_simultaneous_stop(fly_with_faults, tmp_path):
    """A link that carries less than is sent: what was sent last comes later and later."""
    cap = [fault(BandwidthCap(rate=5000.0), start=START, vehicles=[2])]
    summary = fly_with_faults(short_figure(tmp_path, duration=12.0), cap, seed=33).figures
    assert summary["outcome"] == "aborted" and summary["landing"]["on_ground"] and summary["contacts"] == 0
    assert summary["uav_separation_min_m"] > 0.9
    assert max(summary["payload_tilt_max_deg"].values()) < 15.0


@pytest.mark.parametrize("start", [1.45, *(pytest.param(start, marks=pytest.mark.long) for start in (1.3, 1.6))])
def test_vehicles_hold_when_links_are_lost_at_lift_off_in_wind(start, fly_with_faults, tmp_path):
    """Links lean before lift-off: the vehicles hold and do not detect that they are on ground."""
    faults = [
        fault(Wind(velocity=(2.8, -2.8, 0.0), gust=0.5), start=0.0),
        fault(Partition(), start=start, direction="both"),
    ]
    summary = fly_with_faults(short_figure(tmp_path), faults, seed=35).figures
    assert summary["landing"]["on_ground"] and summary["contacts"] == 0
    assert summary["landing"]["speed_mps"] < 1.0
    assert summary["uav_separation_min_m"] > 0.6
