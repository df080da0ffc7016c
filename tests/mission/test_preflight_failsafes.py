"""Checks on the pad that refuse a take-off: armed, pre-arm checks, positions, places over the payload."""

import math
from types import SimpleNamespace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest

from gcs.config import read_system
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.alarms import AlarmLog
from gcs.flight.autopilot_requirements import PARAMETERS as NEEDED
from gcs.flight.condition import Check, Moment, System
from gcs.flight.failsafe import Failsafe
from gcs.flight.failsafe_state import FailsafeState
from gcs.flight.phase import Phase
from gcs.flight.preflight import Preflight
from gcs.mavlink import px4
from gcs.mavlink.link_queue import LinkQueue
from idc_controller.estimation.measurements import PAYLOAD, Position
from idc_controller.geometry.shapes import Pole
from idc_controller.perception.standing_obstacles import MapObstacle, StandingObstacles

PARAMETERS = read_system().parameters()
PAD = np.array([3.0, -2.0, -0.3])
PLACES = PAD + PARAMETERS.p - PARAMETERS.l[:, None] * np.array([0.0, 0.0, 1.0])
BEGIN = 1000.0  # s, when all had connected
SETTLED = BEGIN + DEFAULTS.takeoff_landing.settle_time
LIMIT = DEFAULTS.failsafe.placement_tolerance


EXPECTED = {
    px4.PARAM_THRUST_MAX: PARAMETERS.thrust_max, px4.PARAM_ATTITUDE_KP: PARAMETERS.attitude_kp,
    px4.PARAM_ATTITUDE_KD: PARAMETERS.attitude_kd, px4.PARAM_MOTOR_LAG: PARAMETERS.motor_time_constant,
}  # fmt: skip


def checked(
    time, armed=(), failing=(), places=PLACES, silent=(), begin=BEGIN, poles=(), later=(), round_trip=0.0, **parameters
):
    """(Failsafe, trigger) of a team on the pad, or None."""
    statuses = [
        SimpleNamespace(
            armed=i in armed,
            prearm_ok=i not in failing,
            last_text=": no GPS",
            autopilot=mavlink.MAV_AUTOPILOT_PX4,
            landed_state=mavlink.MAV_LANDED_STATE_ON_GROUND,
            parameters=dict.fromkeys(NEEDED, 1.0) | EXPECTED | (parameters if i == 1 else {}),
        )
        for i in range(len(places))
    ]
    clock = SimpleNamespace(
        queue=LinkQueue(1.0),
        round_trip_excess=0.0,
        delay=0.0,
        round_trip_max=round_trip,
        least_delay=lambda *_: 0.0,
        answered_at=0.0,
    )
    links = [
        SimpleNamespace(
            system_id=i + 1, status=status, clock=clock, attitude_received_at=0.0, position_received_at=0.0,
            payload_received_at=0.0, setpoints=SimpleNamespace(loss=0.0),
        )
        for i, status in enumerate(statuses)
    ]  # fmt: skip
    team = SimpleNamespace(links=links, parameters=PARAMETERS)
    preflight = Preflight(team)
    preflight.check_start = begin
    for source, place in ((PAYLOAD, PAD), *enumerate(places)):
        if source not in silent:
            preflight.add(Position(begin, source, place, np.zeros(3)))
    for measurement in later:
        preflight.add(measurement)
    standing = StandingObstacles(
        [MapObstacle(f"pole {r:g}", Pole(r, 6.0), np.array([x, y, -3.0])) for x, y, r in poles]
    )
    on_map = SimpleNamespace(predict=lambda times: standing.predict(len(times), None))
    nothing = np.zeros((len(links), 2))
    estimator = SimpleNamespace(attitude_steps=SimpleNamespace(total=nothing, drift=nothing))
    failsafes = FailsafeState(System(team, estimator, None, None, preflight, None, None, on_map), AlarmLog())
    return failsafes.evaluate(Check.PREFLIGHT, Moment(Phase.CHECK, time, 0.0), Phase.CHECK.state)


def test_team_in_its_places_is_cleared():
    assert checked(BEGIN + 0.9 * DEFAULTS.failsafe.connect_timeout) is None


def test_armed_vehicle_and_failing_prearm_checks_are_refused_at_once_and_named():
    found, trigger = checked(BEGIN, armed=(2,))
    assert found is Failsafe.ALREADY_ARMED and trigger.reason.startswith("vehicle 3 is armed already")
    found, trigger = checked(BEGIN, failing=(1,))
    assert found is Failsafe.PREARM_CHECK_FAILED
    assert trigger.reason == "vehicle 2 fails its pre-arm checks: no GPS"


@pytest.mark.parametrize("name", EXPECTED)
@pytest.mark.parametrize("share", [-1.1, -0.9, 0.9, 1.1])
def test_parameter_that_differs_by_more_than_the_tolerance_is_refused_but_more_thrust_is_not(name, share):
    value = float(EXPECTED[name] * (1.0 + share * DEFAULTS.failsafe.parameter_tolerance))
    found = checked(BEGIN, **{name: value})
    is_refused = share < -1.0 or (share > 1.0 and name != px4.PARAM_THRUST_MAX)
    assert (found and found[0]) is (Failsafe.PARAMETER_MISMATCH if is_refused else None)
    if found is not None:
        assert found[1].reason == f"vehicle 2 has {name} = {value:g}, the system file says {EXPECTED[name]:g}"


@pytest.mark.parametrize("source", [PAYLOAD, 0, 3])
@pytest.mark.parametrize("begin", [-1000.0, 1000.0])
@pytest.mark.parametrize(("late", "is_refused"), [(-0.1, False), (0.0, False), (0.1, True)])
def test_position_that_never_comes_is_refused_after_the_timeout(source, begin, late, is_refused):
    found = checked(begin + DEFAULTS.failsafe.connect_timeout + late, silent=(source,), begin=begin)
    assert (found and found[0]) is (Failsafe.POSITION_UNKNOWN if is_refused else None)


@pytest.mark.parametrize(("late", "is_refused"), [(-0.1, False), (0.1, True)])
def test_positions_that_cease_are_refused_after_the_timeout(late, is_refused):
    found = checked(BEGIN + DEFAULTS.failsafe.connect_timeout + late)
    assert (found and found[0]) is (Failsafe.POSITION_UNKNOWN if is_refused else None)


@pytest.mark.parametrize(("share", "is_refused"), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize("direction", np.vstack([np.eye(3), -np.eye(3)]).tolist(), ids=str)
def test_vehicle_out_of_its_place_is_refused_once_settled(share, is_refused, direction):
    places = PLACES.copy()
    places[1] += share * LIMIT * np.array(direction)
    assert checked(SETTLED - 0.01, places=places) is None
    found = checked(SETTLED, places=places)
    assert (found is not None) is is_refused
    if found is not None:
        assert (found[0], found[1].vehicles) == (Failsafe.MISPLACED, (1,))
        expected = f"vehicle 2 stands {share * LIMIT:.1f} m from its place over the payload (limit {LIMIT:g} m)"
        assert found[1].reason == expected


@pytest.mark.parametrize(("gap", "is_refused"), [(0.05, False), (-0.05, True), (-0.6, True)])
def test_obstacle_that_reaches_into_the_formation_is_refused_and_named(gap, is_refused):
    """The discs reach 0.8 m ahead of the payload; farther away stands another pole, which is in nobody's way."""
    poles = [(PAD[0] + 0.8 + 0.3 + gap, PAD[1] + 0.5, 0.3), (PAD[0] + 4.0, PAD[1], 0.5)]
    assert checked(SETTLED - 0.01, poles=poles) is None
    found = checked(SETTLED, poles=poles)
    assert (found and found[0]) is (Failsafe.OBSTRUCTED if is_refused else None)
    if found is not None:
        assert found[1].source == "pole 0.3"
        assert found[1].reason.startswith("on the pad, pole 0.3 reaches ")
        assert found[1].reason.endswith(" m into the formation there")


@pytest.mark.parametrize(("interval", "is_refused"), [(0.05, False), (0.052, True), (0.2, True)])
@pytest.mark.parametrize("source", [PAYLOAD, 2])
def test_telemetry_that_comes_less_often_than_setpoints_are_sent_is_refused(source, interval, is_refused):
    later = [
        Position(BEGIN + k * interval, source, PAD if source == PAYLOAD else PLACES[2], np.zeros(3)) for k in (1, 2)
    ]
    found = checked(SETTLED, later=later)
    assert (found is not None) == is_refused
    if is_refused:
        name = "the payload unit" if source == PAYLOAD else "vehicle 3"
        assert found[0] is Failsafe.AUTOPILOT_UNFIT
        assert (
            found[1].reason
            == f"{name} sends positions at {1.0 / interval:.3g} Hz; a flight needs 20 Hz (rates.control)"
        )


def test_vehicles_that_do_not_answer_timesync_are_refused():
    found, trigger = checked(SETTLED, round_trip=math.inf)
    assert found is Failsafe.AUTOPILOT_UNFIT and trigger.reason == "vehicle 1 has not sent TIMESYNC answers"
