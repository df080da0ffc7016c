"""The failsafe table: complete, documented, and the more severe reaction wins."""

import math
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from failsafes_page import listing

from gcs.config import read_system
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.alarms import AlarmLog
from gcs.flight.command_sequences import AutonomousLanding
from gcs.flight.condition import Check, Moment, System, Trigger
from gcs.flight.delivery import DeliveryAlarm
from gcs.flight.detectors import MonitorAlarm
from gcs.flight.failsafe import Failsafe
from gcs.flight.failsafe_state import FailsafeState
from gcs.flight.guarantee import GuaranteeAlarm
from gcs.flight.payload_monitor import PayloadMonitor
from gcs.flight.phase import Phase
from gcs.flight.plan_monitor import ImpactMonitor, PlanMonitor
from gcs.mavlink.team_failsafe import Reaction, TeamState
from gcs.mavlink.vehicle_link import AddressConflict
from idc_controller.geometry.shapes import Sphere
from idc_controller.model.drag import Air
from idc_controller.perception.standing_obstacles import MapObstacle, StandingObstacles
from idc_controller.trajectory.trajectory import RestTrajectory

DOCS = Path(__file__).parents[2] / "docs"
PAGE, SETTINGS = DOCS / "failsafes.md", DOCS / "settings.md"


def link(
    number, *, age=0.0, attitude_age=0.0, position_age=0.0, latency=0.0, loss=0.0, answer_age=0.0, armed=True,
    offboard=True,
):  # fmt: skip
    """Link of a vehicle at ground time 100 s."""
    clock = SimpleNamespace(
        delay=latency, round_trip_max=math.inf, least_delay=lambda window, now: 0.0, answered_at=100.0 - answer_age
    )
    status = SimpleNamespace(
        armed=armed, offboard=offboard, custom_mode=0, last_text="", parameters={"COM_OF_LOSS_T": 0.46}
    )
    return SimpleNamespace(
        system_id=number, telemetry_received_at=100.0 - age,
        attitude_received_at=100.0 - max(age, attitude_age), position_received_at=100.0 - max(age, position_age),
        complete_telemetry_received_at=100.0 - max(age, attitude_age, position_age), received_at=100.0 - age,
        clock=clock, setpoints=SimpleNamespace(loss=loss), status=status, address=("10.0.0.7", number),
        conflict=AddressConflict(),
    )  # fmt: skip


def state(*links, lost=()):
    estimator = SimpleNamespace(health=SimpleNamespace(isolation=SimpleNamespace(uavs_without_position=lost)))
    system = System(
        SimpleNamespace(links=links),
        estimator,
        SimpleNamespace(blocked=lambda time: ""),
        None,
        None,
        PlanMonitor(4),
        None,
        None,
    )
    return FailsafeState(system, AlarmLog())


def evaluated(flight, check=Check.LINK, phase=Phase.FLY):
    return flight.evaluate(check, Moment(phase, 50.0, 100.0), phase.state)


def test_page_is_made_from_the_tables():
    assert PAGE.read_text(encoding="utf-8") == listing(), "run make docs"


def test_codes_are_unique():
    codes = [row.code for row in (*Failsafe, *MonitorAlarm, *GuaranteeAlarm, *DeliveryAlarm)]
    assert len(codes) == len(set(codes))
    assert all(row.condition is not None for row in Failsafe if row.check is not Check.EVENT)


def test_vehicle_without_all_telemetry_is_not_lifted_off_with_and_flies_on_in_the_air():
    flight = state(link(1), link(2, attitude_age=0.5))
    assert evaluated(flight) is None
    failsafe, trigger = evaluated(flight, phase=Phase.SPOOL_UP)
    assert failsafe is Failsafe.POSE_MISSING and trigger.vehicles == (1,)
    assert failsafe.reaction is Reaction.DISARM


@pytest.mark.parametrize(("phase", "rise", "steps", "raised"), [
    (Phase.SPOOL_DOWN, 0.4, 2, True), (Phase.SPOOL_DOWN, 0.4, 1, False), (Phase.SPOOL_DOWN, 0.2, 5, False),
    (Phase.LAND, 0.4, 5, False),
])  # fmt: skip
def test_payload_that_rises_after_touch_down_faster_than_it_bounces_is_landed_anew(phase, rise, steps, raised):
    flight = state(link(1))
    flight.system.payload = PayloadMonitor(read_system().parameters())
    flight.system.links = SimpleNamespace(payload_velocity=np.array([0.0, 0.0, -rise]))
    found = [evaluated(flight, Check.STEP, phase) for _ in range(steps)][-1]
    assert (found is not None and found[0] is Failsafe.LIFTED_AGAIN) is raised


def test_healthy_links_raise_no_failsafe():
    assert evaluated(state(*(link(i) for i in range(1, 5)))) is None
    assert evaluated(state(link(1, latency=0.1, loss=0.1), link(2, latency=0.045, loss=0.5, answer_age=1.4))) is None


@pytest.mark.parametrize(
    ("links", "failsafe", "reason"),
    [
        ([link(1), link(2, age=0.5)], Failsafe.TELEMETRY_LOST, "vehicle 2 sends no telemetry for 0.46 s"),
        ([link(1, age=0.5), link(2, age=0.6)], Failsafe.ALL_TELEMETRY_LOST, "no vehicle sends telemetry"),
        (
            [link(1), link(2, latency=0.13)],
            Failsafe.LINK_LATENCY_EXCEEDED, "link latency to vehicle 2 is 130 ms (limit 110 ms)",
        ),
        (
            [link(1), link(2, latency=0.08, loss=0.2)],
            Failsafe.LINK_LATENCY_EXCEEDED,
            "link latency to vehicle 2 is 80 ms (limit 73 ms at 20% loss of set-points)",
        ),
        (
            [link(1, answer_age=1.6), link(2)], Failsafe.LINK_LATENCY_EXCEEDED,
            "link latency to vehicle 1 is not known: no TIMESYNC answer for 1.6 s",
        ),
        ([link(1), link(2, armed=False)], Failsafe.DISARMED_IN_FLIGHT, "vehicle 2 has disarmed itself"),
        ([link(1, offboard=False), link(2)], Failsafe.OFFBOARD_LEFT, "vehicle 1 has left OFFBOARD"),
        (
            [link(1, attitude_age=0.5), link(2), link(3, attitude_age=0.5)],
            Failsafe.TELEMETRY_INCOMPLETE, "vehicles 1 and 3 do not send all telemetry",
        ),
        (
            [link(1, attitude_age=0.5), link(2), link(3, position_age=0.5)],
            Failsafe.TELEMETRY_INCOMPLETE, "vehicles 1 and 3 do not send all telemetry",
        ),
        (
            [link(1, position_age=0.5), link(2), link(3, position_age=0.5)],
            Failsafe.POSITIONS_LOST, "the positions of vehicles 1 and 3 are not known",
        ),
    ],
)  # fmt: skip
def test_link_failsafe_names_vehicle_value_and_limit(links, failsafe, reason):
    found, trigger = evaluated(state(*links))
    assert found is failsafe
    assert trigger.reason.startswith(reason)


@pytest.mark.parametrize(
    ("isolated", "silent", "failsafe"),
    [((1,), False, None), ((0, 1), False, Failsafe.POSITIONS_LOST), ((1,), True, Failsafe.POSITIONS_LOST)],
)
def test_positions_of_two_vehicles_silent_or_isolated_are_lost(isolated, silent, failsafe):
    found = evaluated(state(link(1, position_age=0.5 if silent else 0.0), link(2), lost=isolated))
    assert (found and found[0]) is failsafe


def test_one_vehicle_without_attitude_is_no_failsafe():
    assert evaluated(state(link(1, attitude_age=0.5), link(2))) is None


def test_first_vehicle_counts_where_reactions_are_equal():
    found, trigger = evaluated(state(link(1, offboard=False), link(2, age=0.5), link(3)))
    assert (found, trigger.vehicles) == (Failsafe.OFFBOARD_LEFT, (0,))


def test_one_vehicle_counts_before_several_where_reactions_are_equal():
    partial = [link(number, attitude_age=0.5) for number in (1, 2)]
    found, trigger = evaluated(state(*partial))
    assert (found, trigger.vehicles) == (Failsafe.TELEMETRY_INCOMPLETE, (0, 1))
    flight = state(*partial, link(3, age=0.5))
    found, trigger = evaluated(flight)
    assert (found, trigger.vehicles) == (Failsafe.TELEMETRY_LOST, (2,))
    flight.raise_failsafe(50.0, TeamState.OFFBOARD, found, trigger)
    flight.raise_failsafe(50.0, TeamState.OFFBOARD, *evaluated(state(*partial)))
    assert [alarm.source for alarm in flight.alarms.alarms] == ["vehicle 3", "team"]


def test_more_severe_reaction_wins_and_a_milder_one_is_only_recorded():
    flight = state(link(1))
    raised = [
        flight.raise_failsafe(time, TeamState.OFFBOARD, failsafe, Trigger(failsafe.code))
        for time, failsafe in ((1.0, Failsafe.NO_PATH), (2.0, Failsafe.TELEMETRY_LOST), (3.0, Failsafe.INTERRUPTED))
    ]
    assert raised == [Reaction.BRAKE_AND_LAND, Reaction.AUTONOMOUS_LANDING, Reaction.NONE]
    assert (flight.reason, flight.time, flight.interrupted) == ("no_path", 1.0, True)
    assert [alarm.code for alarm in flight.alarms.alarms] == [
        Failsafe.NO_PATH, Failsafe.TELEMETRY_LOST, Failsafe.INTERRUPTED
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("phase", "reaction"),
    [(Phase.CHECK, Reaction.REFUSE), (Phase.SPOOL_UP, Reaction.DISARM), (Phase.LAND, Reaction.AUTONOMOUS_LANDING)],
)
def test_reaction_on_the_ground_is_to_stay_there(phase, reaction):
    assert phase.state.reaction(Failsafe.TELEMETRY_LOST.reaction) is reaction
    assert phase.state.reaction(Failsafe.DATA_LINK_LOST.reaction) is Reaction.END_CONTROL


def test_threshold_follows_its_setting():
    assert "for 0.46 s" in listing()
    late = state(link(1), link(2, age=DEFAULTS.failsafe.telemetry_timeout - 0.01))
    assert evaluated(late) is None


def test_data_link_loss_waits_for_a_pending_descent():
    flight = state(link(1, age=4.0))
    pending = AutonomousLanding(SimpleNamespace(command_all=lambda *command: None), 40.0)
    moment = Moment(Phase.AUTONOMOUS_LANDING, 50.0, 100.0, pending)
    assert flight.evaluate(Check.STEP, moment, moment.phase.state) is None
    found, _ = evaluated(flight, Check.STEP, Phase.AUTONOMOUS_LANDING)
    assert found is Failsafe.DATA_LINK_LOST


def test_data_link_of_vehicles_that_never_answered_is_not_lost():
    assert evaluated(state(link(1, age=math.inf)), Check.STEP, Phase.CONNECT) is None


@pytest.mark.parametrize(
    ("phase", "height", "below", "stalled"),
    [
        (Phase.CLIMB, 0.05, 0.61, True),
        (Phase.CLIMB, 0.05, 0.59, False),
        (Phase.CLIMB, 0.5, 0.61, False),  # it has risen
        (Phase.LAND, 0.05, 0.61, False),
    ],
)
def test_climb_that_does_not_rise_is_ended_when_its_plan_has_risen(phase, height, below, stalled):
    config = read_system()
    payload = PayloadMonitor(config.parameters(), config.flight)
    estimate = SimpleNamespace(x=np.zeros(60))
    estimate.x[2] = -config.parameters().payload.below - height
    plan = PlanMonitor(4)
    team = SimpleNamespace(links=[], parameters=config.parameters())
    system = System(team, None, None, payload, None, plan, None, None, config.flight.failsafe, 0.6)
    moment = Moment(phase, 50.0, 100.0, estimate=estimate)
    assert Failsafe.CLIMB_STALLED.condition(system, moment) is None  # no plan yet
    plan.compare(50.0, np.zeros((4, 3)), payload_down=estimate.x[2] - below)
    trigger = Failsafe.CLIMB_STALLED.condition(system, moment)
    assert (trigger is not None) == stalled
    if trigger is not None:
        assert trigger.reason == "the payload does not rise: it is 0.6 m below its plan (limit 0.6 m)"


def test_obstacle_over_the_landing_place_is_named_with_the_missing_metres():
    config = read_system()
    parameters = config.parameters()
    payload = PayloadMonitor(parameters, config.flight)
    estimate = SimpleNamespace(x=np.zeros(60))
    estimate.x[2] = -3.0
    rest = RestTrajectory(np.array([4.0, 0.0, -parameters.payload.below]), 20.0)
    ball = MapObstacle("ball", Sphere(0.5), np.array([4.0, 1.6, -2.0]))
    on_map = SimpleNamespace(predict=lambda times: StandingObstacles([ball]).predict(len(times), None))
    team = SimpleNamespace(links=[], parameters=parameters)
    system = System(team, None, None, payload, None, PlanMonitor(4), None, on_map, config.flight.failsafe, 0.6)
    moment = Moment(Phase.LAND, 50.0, 100.0, estimate=estimate, descent=(50.0, rest))
    reason = Failsafe.DESCENT_STALLED.condition(system, moment).reason
    found = re.fullmatch(
        r"the payload does not descend: at the landing place, "
        r"ball is (0\.\d\d) m from the formation there, (0\.\d\d) m are missing",
        reason,
    )
    assert found and float(found[1]) + float(found[2]) == pytest.approx(0.6, abs=0.011)
    assert float(found[1]) == pytest.approx(1.6 - 0.5 - 0.65, abs=0.1)
    on_map = SimpleNamespace(predict=lambda times: [])
    system = System(team, None, None, payload, None, PlanMonitor(4), None, on_map, config.flight.failsafe, 0.6)
    assert Failsafe.DESCENT_STALLED.condition(system, moment).reason == "the payload does not descend"


def impact(height, counts, payload=0, monitor=None):
    """(trigger of IMPACT, the monitor) at a ``height`` (m), by the counts of the vehicles and of the payload unit."""
    config = read_system()
    estimate = SimpleNamespace(x=np.zeros(60))
    estimate.x[2] = -config.parameters().payload.below - height
    links = [
        SimpleNamespace(system_id=i, status=SimpleNamespace(clipping=count, payload_clipping=payload))
        for i, count in enumerate(counts, start=1)
    ]
    team = SimpleNamespace(links=links, parameters=config.parameters())
    monitor = monitor or ImpactMonitor([])
    monitor.links = links
    system = System(team, None, None, PayloadMonitor(config.parameters(), config.flight), None, None, monitor, None)
    return Failsafe.IMPACT.condition(system, Moment(Phase.FLY, 50.0, 100.0, estimate=estimate)), monitor


def test_accelerometer_that_clips_clear_of_the_ground_is_an_impact():
    before, monitor = impact(2.0, [0, 3, 0, 0])  # of the flight before
    assert before is None
    hit, _ = impact(2.0, [0, 4, 0, 0], monitor=monitor)
    assert hit.vehicles == (1,) and hit.reason == "an impact: the accelerometer of vehicle 2 clipped"
    hit, _ = impact(2.0, [0, 3, 0, 0], payload=1, monitor=monitor)
    assert (hit.vehicles, hit.source) == ((), "payload") and "accelerometer of the payload" in hit.reason


def test_count_that_is_first_reported_in_the_air_is_no_impact():
    before, monitor = impact(2.0, [None, 0, 0, 0], payload=None)
    assert before is None
    assert impact(2.0, [3, 0, 0, 0], payload=2, monitor=monitor)[0] is None, "clipped on flights before"
    assert impact(2.0, [4, 0, 0, 0], payload=2, monitor=monitor)[0].vehicles == (0,)


def test_touch_down_is_no_impact():
    _, monitor = impact(2.0, [0, 0, 0, 0])
    assert impact(0.01, [2, 2, 2, 2], payload=5, monitor=monitor)[0] is None
    assert impact(2.0, [2, 2, 2, 2], payload=5, monitor=monitor)[0] is None  # lifted again


@pytest.mark.parametrize(
    ("share", "excess", "lost", "ends"),
    [
        (None, 0.0, 0, False),
        (0.9, 0.0, 0, False),
        (1.1, 0.0, 0, True),
        (1.1, 0.0, 1, True),
        (1.1, 0.0, 2, False),
        (0.9, -0.5, 0, True),
        (1.1, 0.9, 0, False),
    ],
)
def test_wind_that_pushes_the_payload_by_more_than_a_share_of_its_weight_ends_a_flight_of_vehicles_with_positions(
    share, excess, lost, ends
):
    p = read_system().parameters()
    air = None
    if share is not None:
        drag = share * DEFAULTS.failsafe.wind_drag * p.m_0 * p.g
        air = Air(np.array([0.0, -4.0, 0.0]), np.array([0.1, drag / 16.0, 0.1]), 0.0)
    links = [link(i + 1, position_age=1.0 if i < lost else 0.0) for i in range(4)]
    isolation = SimpleNamespace(uavs_without_position=())
    system = SimpleNamespace(
        load=SimpleNamespace(payload_mass=p.m_0 + excess, estimate=SimpleNamespace(air=air)),
        settings=DEFAULTS.failsafe,
        team=SimpleNamespace(parameters=p, links=links),
        estimator=SimpleNamespace(health=SimpleNamespace(isolation=isolation)),
    )
    # For a moment the estimate of a payload that has lost a part of its mass is far below its weight.
    estimate = SimpleNamespace(mass_excess=-1.0, force=np.array([5.0, 0.0, -9.0]))
    found = Failsafe.WIND_EXCEEDED.condition(system, Moment(Phase.FLY, 100.0, 100.0, estimate=estimate))
    assert (found is not None) == ends
