"""Fault campaigns: figures of a flight, statistics, tables and pictures."""

import dataclasses
import json

import pandas
import pytest
from scipy.stats import binomtest
from small_campaign import OUTSIDE, SUMMARY, campaign_file, judged

from gcs.campaign.engine import Campaign
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.judgement import COLUMNS, first_start, is_safe, meets, outcome, stop_time, team_stop
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.faults.rates import interval, rates_of
from gcs.campaign.faults.report import draw_matrix, report
from gcs.campaign.result import Flown
from gcs.campaign.tables import flight_columns, write_parquet
from gcs.record.outcome import Outcome


def results(tmp_path, within, outside=0, **figures):
    campaign = Campaign(FaultFlights(read_campaign(campaign_file(tmp_path))), tmp_path / "out")
    flown = [Flown(0, SUMMARY, "", 1.0)] * within + [Flown(1, SUMMARY | OUTSIDE, "", 1.0)] * outside
    made = [judged(campaign, campaign.plans[0], one) for one in flown]
    return [dataclasses.replace(result, **figures) for result in made]


def test_rates_have_wilson_intervals(tmp_path):
    [rates] = rates_of(results(tmp_path, 7, 3))
    assert [rates[name] for name in ("flights", "within_limits", "safe", "safe_rate")] == [10, 7, 10, 1.0]
    # Wilson (1927), by hand: z = 1.96, n = 10, p = 0.7.
    assert (rates["within_limits_low"], rates["within_limits_high"]) == pytest.approx((0.3968, 0.8922), abs=1e-4)
    assert interval(0, 5) == pytest.approx(tuple(binomtest(0, 5).proportion_ci(method="wilson")))
    [hit] = rates_of(results(tmp_path, 1, contacts=2))
    assert hit["safe"] == 0


def test_csv_and_parquet_agree(tmp_path):
    made = results(tmp_path, 2, 1)
    made.append(dataclasses.replace(made[0], clearance_min_m=0.25, contacts=None, outcome=Outcome.FAILED, level=2))
    _, [table, timing, rates, *_] = report("a test", made, tmp_path)
    frame = pandas.read_parquet(write_parquet(tmp_path / "results.parquet", flight_columns(COLUMNS), made))
    assert tuple(frame.columns) == flight_columns(COLUMNS) and len(frame) == 4
    assert pandas.read_csv(timing)["wall_s"].tolist() == [1.0] * 4
    assert frame["clearance_min_m"].isna().tolist() == [True, True, True, False]
    assert frame["seed"].dtype == "Int64" and frame["within_limits"].tolist() == [True, True, False, True]
    some = ["fault", "seed", "within_limits", "clearance_min_m", "contacts", "tilt_max_deg"]
    read = pandas.read_csv(table)
    pandas.testing.assert_frame_equal(read[some].astype(frame[some].dtypes), frame[some])
    assert pandas.read_csv(rates)["flights"].tolist() == [3, 1]


def test_report_covers_all_outcomes(tmp_path, pictures):
    [result] = results(tmp_path, 1)
    made = [dataclasses.replace(result, outcome=o, level=i % 3 + 1, notes="x") for i, o in enumerate(Outcome)]
    made.append(dataclasses.replace(result, within_limits=False))
    draw_matrix("a test", made, tmp_path)
    shown = {*Outcome, "within limits", "outside limits"} - {Outcome.COMPLETED}
    assert shown <= set(pictures["matrix.png"])
    report("a test", made, tmp_path)


def test_flight_without_a_summary_has_failed():
    assert outcome(Flown(1, {}, "no memory", 1.0)) is Outcome.FAILED


@pytest.mark.parametrize(
    ("changes", "safe"),
    [
        ({"outcome": "interrupted"}, True),
        ({"outcome": "aborted"}, True),
        ({"outcome": "lost"}, False),
        ({"outcome": "completed", "contacts": 1}, False),
        ({"outcome": "failed"}, False),  # nothing is known of it
        # Beside its goal, but set down; and fallen over.
        ({"outcome": "failed", "landed": True, "end_tilt_deg": 0.3, "touchdown_mps": 0.4, "failures": "arrival"}, True),
        ({"outcome": "failed", "landed": True, "end_tilt_deg": 80.0, "touchdown_mps": 0.4}, False),
    ],
)
def test_safe_is_what_was_set_down_without_contact(tmp_path, changes, safe):
    [made] = results(tmp_path, 1)
    flown = dataclasses.replace(made, **{"within_limits": False, "landed": None, **changes})
    assert is_safe(flown) == safe
    assert meets("safe", flown) == safe and not meets("within limits", flown)


def test_team_stop_counts_from_first_fault_of_case(tmp_path):
    faults = [{"activations": [[5.0, None]]}]
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert team_stop(tmp_path, first_start(tmp_path, 1)) == (None, None)
    rows = ["1.0,1,OFFBOARD,1,0", "1.0,2,OFFBOARD,1,0", "8.45,2,AUTO.LOITER,1,1", "8.5,1,AUTO.LOITER,1,1"]
    (tmp_path / "modes.csv").write_text("\n".join(["time_s,vehicle,mode,armed,failsafe", *rows, ""]))
    assert team_stop(tmp_path, first_start(tmp_path, 1)) == (0.5, 0.05)
    faults.insert(0, {"kind": "wind", "activations": [[0.0, None]]})  # not what they stopped for
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert team_stop(tmp_path, first_start(tmp_path, 2)) == (0.5, 0.05)


def test_stop_time_counts_from_first_fault_of_case(tmp_path):
    faults = [{"activations": [[5.0, 6.0]]}, {"activations": []}, {"activations": [[4.0, None]]}]
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert stop_time({"broken_off_s": 9.25}, first_start(tmp_path, 3)) == 2.25
    faults[:0] = [{"activations": [[1.0, None]]}]  # the mission's own
    (tmp_path / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))
    assert stop_time({"broken_off_s": 9.25}, first_start(tmp_path, 3)) == 2.25
    assert stop_time({"broken_off_s": 6.5}, first_start(tmp_path, 3)) is None  # for another reason
    assert stop_time({"broken_off_s": None}, first_start(tmp_path, 3)) is None
    assert stop_time({"broken_off_s": 6.25}, first_start(tmp_path / "none", 3)) is None
