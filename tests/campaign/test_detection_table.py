"""The source of a fault against the one that alarms name, and the tables of detection and of false alarms."""

import json

import pytest
from fault_tables_page import detections_markdown, false_alarms_markdown
from scipy.stats import poisson
from small_campaign import CAMPAIGN, SUMMARY, campaign_file, judged

from gcs.campaign.engine import Campaign
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.cases import CLEAN
from gcs.campaign.faults.detection_table import DetectionRow, detections, seconds
from gcs.campaign.faults.false_alarms import false_alarms, upper_bound
from gcs.campaign.faults.judgement import clean_time
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.faults.sources import (
    AMBIGUOUS,
    CLOCK,
    FORCE,
    LINK,
    NAMED_PARTS,
    NAVIGATION,
    NONE,
    PARTS,
    RANGE_SENSOR,
    RIGHT,
    SYSTEM_ID,
    WRONG,
    AlarmRow,
    FaultSource,
    isolation,
    source_of,
    sources_of,
)  # fmt: skip
from gcs.campaign.result import Flown, Result
from gcs.config import UnusableFile
from gcs.faults import KINDS
from gcs.flight.detectors import MonitorAlarm
from gcs.flight.failsafe import Failsafe
from gcs.mission.model import Fault

NO_SOURCE = {
    # Their cause may be anything, or is no fault of a part.
    "track_lost", "interrupted", "interrupted_twice", "simulation_lost", "connect_timeout", "parameter_mismatch",
    "already_armed", "prearm_check_failed", "position_unknown", "misplaced", "arming_failed", "disarming_failed",
    "landing_unconfirmed", "landing_aborted", "disarmed_in_flight", "data_link_lost", "no_path", "off_plan",
    "payload_control_lost",
    "overturned", "impact", "climb_stalled", "descent_stalled", "obstructed", "safety_guarantee_void",
}  # fmt: skip


def test_every_alarm_code_has_a_part_or_names_none():
    codes = {alarm.code for enum in (MonitorAlarm, Failsafe) for alarm in enum}
    assert codes <= NAMED_PARTS.keys() | NO_SOURCE
    assert not NAMED_PARTS.keys() & NO_SOURCE
    assert {part for parts in NAMED_PARTS.values() for part in parts} <= set(PARTS)


@pytest.mark.parametrize(
    ("fault", "source", "text"),
    [
        (Fault("latency", 1.0, vehicles=(2,)), FaultSource(LINK, (2,)), "link of vehicle 2"),
        (Fault("partition", 1.0), FaultSource(LINK), "link of all vehicles"),
        (Fault("low_rate", 1.0, vehicles=(1, 3)), FaultSource(LINK, (1, 3)), "link of vehicles 1, 3"),
        (Fault("stale_stamps", 1.0, vehicles=(2,)), FaultSource(CLOCK, (2,)), "clock of vehicle 2"),
        (Fault("bias", 1.0, settings={"channel": "payload_rates"}), FaultSource(NAVIGATION, None, True),
         "navigation of payload"),
        # One vehicle's relay of the payload's measurements.
        (Fault("bias", 1.0, vehicles=(2,), settings={"channel": "payload_rates"}), FaultSource(NAVIGATION, (2,)),
         "navigation of vehicle 2"),
        (Fault("bias", 1.0, vehicles=(2,), settings={"channel": "obstacles"}), FaultSource(RANGE_SENSOR, (2,)),
         "range sensor of vehicle 2"),
        (Fault("payload_unit_lost", 1.0), FaultSource(NAVIGATION, None, True), "navigation of payload"),
        (Fault("swapped_vehicles", 1.0, vehicles=(3,), settings={"other": 2}), FaultSource(SYSTEM_ID, (2, 3)),
         "system id of vehicles 2, 3"),
        (Fault("wind", 1.0), FaultSource(FORCE), "wind or load"),
    ],
)  # fmt: skip
def test_source_of_a_fault_follows_from_kind_channel_and_vehicles(fault, source, text):
    assert (source_of(fault), str(source)) == (source, text)


def test_every_kind_of_fault_has_a_source():
    for kind in KINDS:
        assert source_of(Fault(kind, 1.0, settings={"other": 1})).part in PARTS


def test_wind_beside_other_faults_is_no_source():
    wind, loss = Fault("wind", 0.0), Fault("packet_loss", 3.0)
    assert sources_of([wind, loss]) == (FaultSource(LINK),)
    assert sources_of([wind, wind]) == (FaultSource(FORCE),)


OF_VEHICLE_2 = (FaultSource(NAVIGATION, (2,)),)


@pytest.mark.parametrize(
    ("alarms", "verdict", "named"),
    [
        ([], NONE, ""),
        ([(0.2, "vehicle 2", "innovation_bias"), (0.2, "vehicle 2", "telemetry_timeout")], RIGHT, ""),
        # What comes later does not make the first one wrong.
        ([(0.9, "payload", "innovation_bias"), (0.2, "vehicle 2", "stuck_sensor")], RIGHT, ""),
        ([(0.2, "vehicle 2", "stuck_sensor"), (0.2, "payload", "innovation_bias")], AMBIGUOUS, "navigation of payload"),
        ([(0.2, "vehicle 3", "innovation_bias"), (0.5, "vehicle 2", "channel_isolated")], AMBIGUOUS,
         "navigation of vehicle 3"),
        # Another part of the vehicle; a vehicle whose number begins with the same digit; an obstacle.
        ([(0.2, "vehicle 2", "clock_error")], WRONG, "clock of vehicle 2"),
        ([(0.2, "vehicle 21", "stuck_sensor")], WRONG, "navigation of vehicle 21"),
        ([(0.2, "track 4", "track_lost")], WRONG, "track_lost of track 4"),
        ([(0.2, "team", "sensor_noise")], WRONG, "navigation of team"),
    ],
)  # fmt: skip
def test_isolation_of_a_fault_of_one_vehicle(alarms, verdict, named):
    found = isolation(OF_VEHICLE_2, [AlarmRow(*alarm) for alarm in alarms])
    assert (found.verdict, found.named) == (verdict, named)


@pytest.mark.parametrize(
    ("source", "alarm", "right"),
    [
        (FaultSource(NAVIGATION), ("team", "inconsistent_state"), True),
        (FaultSource(NAVIGATION), ("vehicle 3", "innovation_bias"), True),
        (FaultSource(NAVIGATION), ("payload", "innovation_bias"), False),
        (FaultSource(NAVIGATION, None, True), ("payload", "innovation_bias"), True),
        (FaultSource(NAVIGATION, None, True), ("vehicle 1", "innovation_bias"), False),
        (FaultSource(FORCE), ("payload", "disturbance_force"), True),
        (FaultSource(FORCE), ("team", "covariance_reset"), True),
        (FaultSource(FORCE), ("payload", "innovation_bias"), False),
        (FaultSource(SYSTEM_ID, (2, 3)), ("vehicle 3", "id_swap"), True),
        (FaultSource(SYSTEM_ID, (2, 3)), ("vehicle 1", "id_swap"), False),
    ],
)
def test_alarm_names_a_source(source, alarm, right):
    assert source.is_named_by(AlarmRow(0.1, *alarm)) == right


def write_records(run_dir, *alarms):
    run_dir.mkdir(parents=True)
    rows = [",".join(["time_s,source,code,severity,text"]), *(f"{t},{s},{c},warning,x" for t, s, c in alarms)]
    (run_dir / "alarms.csv").write_text("\n".join([*rows, ""]))
    record = {"take_off_s": 3.0, "end_s": 20.0, "faults": [{"kind": "x", "activations": [[5.0, None]]}]}
    (run_dir / "faults.json").write_text(json.dumps(record))


def test_campaign_judges_alarms_since_the_fault(tmp_path):
    text = CAMPAIGN.replace("start = 5.0", "start = 5.0\nvehicles = [2]")
    campaign = Campaign(FaultFlights(read_campaign(campaign_file(tmp_path, text))), tmp_path / "out")
    [plan, other, *_] = campaign.plans
    # Before the fault, which starts at 8 s, it is a false alarm.
    write_records(
        campaign.run_dir(plan), (7.9, "vehicle 1", "clock_error"), (8.25, "vehicle 2", "messages_lost"),
        (8.5, "vehicle 3", "clock_error"),
    )  # fmt: skip
    result = judged(campaign, plan, Flown(0, SUMMARY, "", 1.0))
    assert (result.true_source, result.isolation, result.named_source) == ("link of vehicle 2", RIGHT, "")
    assert (result.detected_s, result.detected_as, result.false_alarms) == (0.25, "messages_lost, vehicle 2", 1)
    assert (result.clean_s, result.false_codes) == (8.0, "clock_error")  # of 20 s, which end at 20 s
    # Without a record it is not known.
    result = judged(campaign, other, Flown(1, {}, "", 1.0))
    assert (result.true_source, result.isolation) == ("link of vehicle 2", "")


def flown(fault, severity, delay, verdict=RIGHT, code="stuck_sensor", **columns):
    detected_as = f"{code}, vehicle 2" if delay is not None else ""
    return Result(
        fault=fault, severity=severity, detected_s=delay, detected_as=detected_as, isolation=verdict,
        true_source="clock of vehicle 2", **columns,
    )  # fmt: skip


FLOWN = [
    flown("bias", "amount 0.1", 0.876),
    flown("bias", "amount 0.1", 0.5, WRONG, "innovation_bias", named_source="navigation of payload"),
    flown("bias", "amount 1", 0.126, AMBIGUOUS, "innovation_bias", named_source="clock of vehicle 1"),
    flown("drift", "rate 0.2", None, NONE),
    flown("stuck", "", 0.12),
    flown("no fault", "", None, ""),
]


def test_rows_of_detection_by_fault():
    found = detections([], FLOWN)
    assert [row.fault for row in found] == ["bias", "drift", "stuck"]
    row = found[0]
    assert (row.flights, row.right, row.ambiguous, row.wrong, row.none) == (3, 1, 1, 1, 0)
    assert (row.median_s, row.worst_s, row.latest_s) == (0.5, 0.876, 0.876)
    assert row.first_alarms == "innovation_bias, stuck_sensor"
    assert row.named_wrongly == "navigation of payload; clock of vehicle 1"
    assert (found[1].none, found[1].median_s, found[1].worst_s, found[1].latest_s) == (1, None, None, None)


def test_rows_of_several_seeds_have_the_figures_of_the_middle_one():
    delays = {1: (0.1, 0.3, 0.5), 2: (0.2, 0.4, 2.0), 3: (0.9, 1.0, 1.1)}
    [row] = detections([], [flown("loss", "", delay, seed=seed) for seed in delays for delay in delays[seed]])
    assert (row.flights, row.median_s, row.worst_s, row.latest_s) == (9, 0.4, 1.1, 2.0)


def test_rows_of_detection_by_severity_and_the_rest_by_fault():
    rows = [DetectionRow("small", ("drift", "bias: amount 0.1")), DetectionRow("never flown", ("loss",))]
    found = detections(rows, FLOWN)
    assert [(row.fault, row.flights, row.none) for row in found] == [("small", 3, 1), ("bias", 1, 0), ("stuck", 1, 0)]


@pytest.mark.parametrize(
    ("limits", "problems"),
    [
        ({}, []),
        ({"median": 0.5, "worst": 0.88}, []),  # 0.876 s is printed as 0.88 s
        ({"median": 0.49, "worst": 0.88}, ["bias: detected within 0.50 s (median; limit 0.49 s)"]),
        ({"worst": 0.87}, ["bias: detected within 0.88 s (worst; limit 0.87 s)"]),
    ],
)
def test_row_later_than_its_limits_is_a_problem(limits, problems):
    [row] = detections([DetectionRow("bias", ("bias",), **limits)], FLOWN[:3])
    assert list(row.problems) == problems


def test_row_with_a_limit_and_a_fault_not_detected_is_a_problem():
    [row] = detections([DetectionRow("both", ("drift", "stuck"), worst=1.0)], FLOWN[3:5])
    assert list(row.problems) == ["both: 1 of 2 not detected"]
    [row] = detections([DetectionRow("both", ("drift", "stuck"))], FLOWN[3:5])
    assert list(row.problems) == []


def test_seconds_have_two_digits():
    times = (0.042, 0.6, 0.876, 0.996, 1.0, 1.96, 9.96, 12.3)
    assert [seconds(time) for time in times] == ["0.04", "0.60", "0.88", "1.0", "1.0", "2.0", "10", "12"]


def test_detection_table_in_markdown():
    text = detections_markdown(detections([], FLOWN[2:5]))
    assert text.splitlines()[2:] == [
        "| bias | clock of vehicle 2 | 1 |  | 1 |  |  | `innovation_bias` | 0.13 s | 0.13 s | 0.13 s "
        "| clock of vehicle 1 |",
        "| drift | clock of vehicle 2 | 1 |  |  |  | 1 |  |  |  |  |  |",
        "| stuck | clock of vehicle 2 | 1 | 1 |  |  |  | `stuck_sensor` | 0.12 s | 0.12 s | 0.12 s |  |",
    ]


def test_rows_of_a_campaign_name_its_faults(tmp_path):
    row = '[[row]]\nname = "some"\nfaults = ["slow", "loss: probability 0.3"]\nworst = 1.0\n'
    assert read_campaign(campaign_file(tmp_path, CAMPAIGN + row)).rows == (
        DetectionRow("some", ("slow", "loss: probability 0.3"), None, 1.0),
    )
    with pytest.raises(UnusableFile, match=r"line 21: row\[1\].faults\[2\]: there is no fault 'loss: probability 0.2'"):
        read_campaign(campaign_file(tmp_path, CAMPAIGN + row.replace("0.3", "0.2")))
    with pytest.raises(UnusableFile, match=r"'slow' appears 2 times"):
        read_campaign(campaign_file(tmp_path, CAMPAIGN + row + row))


def test_seeds_of_a_row_are_in_place_of_the_campaigns(tmp_path):
    row = '[[row]]\nname = "some"\nfaults = ["slow"]\nseeds = [5, 6, 9]\n'
    plans = [*FaultFlights(read_campaign(campaign_file(tmp_path, CAMPAIGN + row))).plans(tmp_path)]
    seeds = {name: {plan.labels["seed"] for plan in plans if plan.labels["fault"] == name} for name in ("slow", "loss")}
    assert seeds == {"slow": {5, 6, 9}, "loss": {3, 7}}
    with pytest.raises(UnusableFile, match=r"row\[1\].seeds: 5 appears 2 times"):
        read_campaign(campaign_file(tmp_path, CAMPAIGN + row.replace("6", "5")))


@pytest.mark.parametrize("events", [0, 1, 7])
def test_upper_bound_of_a_rate_is_exact(events):
    # So many events or fewer come with probability 5 % at the bound.
    assert poisson.cdf(events, upper_bound(events, 0.25) * 0.25) == pytest.approx(0.05)


def test_upper_bound_without_exposure_is_infinite():
    assert upper_bound(0, 0.0) == float("inf")


def test_false_alarms_per_hour_by_mission():
    results = [
        Result(fault="bias", mission="hover", duration_s=2000.0, clean_s=450.0, false_alarms=1, false_codes="a"),
        Result(fault=CLEAN, mission="hover", clean_s=1800.0, false_alarms=0),
        Result(fault=CLEAN, mission="hover", clean_s=900.0, false_alarms=0),
        Result(fault=CLEAN, mission="forest", clean_s=450.0, false_alarms=4, false_codes="a b b b"),
        Result(fault=CLEAN, mission="forest", clean_s=None, false_alarms=None),
    ]
    hover, forest, until, all_of_them = false_alarms(results)
    assert (hover.mission, hover.flights, hover.hours, hover.alarms, hover.per_hour) == ("hover", 2, 0.75, 0, 0.0)
    assert hover.per_hour_bound == pytest.approx(2.9957 / 0.75, rel=1e-4)  # ln 20
    assert (forest.alarms, forest.flights_with_alarms, forest.per_hour, forest.not_counted) == (4, 1, 32.0, 1)
    assert (until.mission, until.hours, until.alarms) == ("hover, until the fault", 0.125, 1)
    assert (all_of_them.flights, all_of_them.hours, all_of_them.alarms, all_of_them.per_hour) == (4, 1.0, 5, 5.0)
    lines = false_alarms_markdown([hover, all_of_them]).splitlines()
    assert "upper 95 % bound" in lines[0] and lines[2] == "| hover | 2 | 0.750 | 0 | 0 | 0.0 | 4.0 |  |"
    assert lines[3] == "| all | 4 (1 without a record) | 1.000 | 5 | 2 | 5.0 | 10.5 | 3 b, 2 a |"


def test_clean_time_ends_with_the_first_fault(tmp_path):
    assert clean_time(16.0, tmp_path) == 16.0  # no fault
    write_records(tmp_path / "run")  # from 4 s, the fault at 8 s, to 20 s
    assert clean_time(16.0, tmp_path / "run") == 4.0
    assert clean_time(None, tmp_path / "run") is None
