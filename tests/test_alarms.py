"""The alarm record: what is noticed, when, of whom; nothing where nothing is wrong."""

import json
from dataclasses import replace

import numpy as np
import pytest
from flight_in_process import HOP, Rehearsal, system_file

from gcs.campaign.faults.detection import detection, first_start
from gcs.flight.alarms import QUIET, AlarmBook, Events
from gcs.mavlink.link_statistics import PATIENCE, LinkStatistics
from gcs.mission.model import Fault
from gcs.mission.read import read_mission
from gcs.record.tables import ALARM_COLUMNS, read_text_table
from idc_controller.estimation.health.consistency import REFUSALS, Consistency
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from vehicle_sim.faults import FaultPassage

pytestmark = pytest.mark.slow

KEYS = ((PAYLOAD, Position), (0, Position), (1, Position), (1, Attitude))
SIZES = (6, 6, 6, 4)
GATE = 1.0 - 1e-6


def test_one_trouble_is_one_alarm_until_it_is_over():
    book = AlarmBook()
    for k in range(100):
        book.tell(0.05 * k, "vehicle 2", "silent", f"{k}")
    assert [(alarm.time, alarm.detail) for alarm in book.alarms] == [(0.0, "0")]
    book.tell(5.0, "vehicle 3", "silent")
    book.tell(5.0, "vehicle 2", "frozen")
    book.tell(4.95 + QUIET + 0.05, "vehicle 2", "silent")
    told = [(alarm.source, alarm.what) for alarm in book.alarms[1:]]
    assert told == [("vehicle 3", "silent"), ("vehicle 2", "frozen"), ("vehicle 2", "silent")]


def test_events_are_forgotten():
    events = Events(2.0)
    events.add(("vehicle 1", "messages lost"), 0.0)
    events.add(("vehicle 1", "messages lost"), 1.0, 2)
    assert events.recent(1.5) == {("vehicle 1", "messages lost"): 3}
    assert events.recent(2.5) == {("vehicle 1", "messages lost"): 2}
    assert events.recent(9.0) == {}


def told(numbers, interval=0.01):
    link = LinkStatistics()
    for k, number in enumerate(numbers):
        link.message(number % 256, interval * k)
    link.settle(interval * len(numbers) + 2.0 * PATIENCE)
    return link.lost, link.overtaken, link.twice


@pytest.mark.parametrize(
    ("numbers", "counts"),
    [
        ([*range(200, 600)], (0, 0, 0)),
        ([*range(10), *range(11, 300)], (1, 0, 0)),
        ([*range(10), *range(25, 300)], (1, 0, 0)),  # what is lost together
        ([0, 1, 3, 2, 4, 5], (0, 1, 0)),
        ([0, 1, 4, 5, 2, 3, 6], (0, 2, 0)),
        ([0, 1, 1, 2, 3, 2, 3, 4], (0, 0, 3)),
        ([250, 255, 254, 256, 257], (1, 1, 0)),
    ],
)
def test_sequence_numbers_tell_what_became_of_messages(numbers, counts):
    assert told(numbers) == counts


def learnt(samples, *, changed=lambda k, i, white: white, refused=lambda k: ()):
    """A judge that has seen so many moments of normal innovations, changed as told; all its complaints on the way."""
    random, judge, found = np.random.default_rng(5), Consistency(GATE), {}
    for k in range(samples):
        time = 0.04 * k
        white = [changed(k, i, random.standard_normal(size)) for i, size in enumerate(SIZES)]
        judge.learn(time, KEYS, white, refused(k))
        for key, complaints in judge.complaints(time).items():
            for complaint in complaints:
                found.setdefault((key, complaint), time)
    return found


def test_sound_innovations_and_single_refusals_are_no_alarm():
    single = [((0, "Position"),) if k % 15 == 0 else () for k in range(5000)]
    assert learnt(5000, refused=lambda k: single[k]) == {}


def test_single_wild_samples_are_no_alarm():
    assert learnt(2000, changed=lambda k, i, white: white + 1e6 * (i == 1 and k % 100 == 50)) == {}


def test_refusals_one_after_the_other_are_one():
    found = learnt(200, refused=lambda k: [(1, "Position")] if k >= 100 else ())
    assert found == {((1, Position), "refused"): pytest.approx(0.04 * (100 + REFUSALS - 1))}


@pytest.mark.parametrize("which", [0, 1])
def test_a_bias_far_below_the_gate_is_found_without_a_refusal(which):
    push = np.array([0.0, 0.0, 1.5, 0.0, 0.0, 0.0])
    found = learnt(300, changed=lambda k, i, white: white + push if i == which and k >= 100 else white)
    assert {key for key, _ in found} == {KEYS[which]}
    assert 4.0 < found[KEYS[which], "disagrees"] < 6.5


def test_noise_on_one_channel_is_found():
    found = learnt(300, changed=lambda k, i, white: white * (2.0 if i == 2 and k >= 100 else 1.0))
    assert {key for key, _ in found} == {KEYS[2]}
    assert 4.0 < found[KEYS[2], "noisy"] < 6.0


def test_attitudes_may_be_off_in_manoeuvres():
    assert learnt(300, changed=lambda k, i, white: white * (1.5 if i == 3 else 1.0)) == {}
    assert (KEYS[3], "noisy") in learnt(300, changed=lambda k, i, white: white * (3.0 if i == 3 else 1.0))


def test_attitudes_that_are_left_out_are_forgotten_and_nothing_else():
    judge = Consistency(GATE)
    for k in range(50):
        judge.learn(0.04 * k, KEYS, [np.full(size, 5.0) for size in SIZES], ())
    judge.forget_attitudes()
    assert set(judge.complaints(2.0)) == set(KEYS[:3])


def test_half_of_a_measurement_is_judged_by_itself():
    rng, judge, key = np.random.default_rng(4), Consistency(GATE), (1, Position)
    for k in range(200):
        white = rng.standard_normal(6) if k < 50 else rng.standard_normal(3) + (2.0 if k >= 100 else 0.0)
        judge.learn(0.04 * k, [key], [white], [])
        complaints = judge.complaints(0.04 * k)
        if k < 100:
            assert complaints == {}
    assert "disagrees" in complaints[key]


def test_what_is_judged_again_counts_once():
    judge = Consistency(GATE)
    for k in range(2 * REFUSALS):
        judge.learn(0.1, KEYS[:1], [np.zeros(6)], [(PAYLOAD, "Position")])
        assert judge.complaints(0.1 + 0.01 * k) == {}


def write_records(folder, rows, starts):
    lines = [",".join(ALARM_COLUMNS), *(f"{time},vehicle 2,refused,position" for time in rows)]
    (folder / "alarms.csv").write_text("\n".join(lines) + "\n")
    faults = [{"activations": [] if start is None else [[start, None]]} for start in starts]
    (folder / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))


def test_detection_counts_from_the_first_fault_of_the_case(tmp_path):
    write_records(tmp_path, [4.0, 7.5, 9.0], [2.0, None, 5.0, 4.0])
    assert first_start(tmp_path) == 5.0
    assert first_start(tmp_path, 3) == 7.0
    found = detection(tmp_path, 3)
    assert (found.after, found.told, found.false) == (0.5, "refused, vehicle 2", 1)


def test_detection_without_faults_or_records(tmp_path):
    assert detection(tmp_path, 1).false is None
    write_records(tmp_path, [4.0], [None])
    assert detection(tmp_path, 1) == replace(detection(tmp_path, 1), after=None, told="", false=1)
    (tmp_path / "faults.json").unlink()
    assert detection(tmp_path, 0).false == 1


def hop(folder, *faults):
    system_file(folder)
    path = folder / "hop.toml"
    path.write_text(HOP.replace("hold = 1.0", "hold = 3.0"))
    return replace(read_mission(path), faults=faults)


def test_a_flight_without_a_fault_has_no_alarm(tmp_path):
    with Rehearsal(hop(tmp_path), tmp_path / "run", seed=51) as flight:
        flight.fly()
        assert flight.flight.completed
        assert flight.station.watch.alarms == []
    assert read_text_table(tmp_path / "run" / "alarms.csv") == {name: [] for name in ALARM_COLUMNS}


def test_a_biased_position_is_noticed_of_its_vehicle_at_once(tmp_path):
    fault = Fault("bias", 3.0, vehicles=(3,), settings={"channel": "position", "amount": 0.3, "axes": ["x"]})
    mission = hop(tmp_path, fault)
    passage = FaultPassage(mission.faults, 52, mission.system)
    with Rehearsal(mission, tmp_path / "run", seed=52, passage=passage) as flight:
        flight.fly()
    begin = passage.faults[0].schedule.take_off + fault.start
    rows = read_text_table(tmp_path / "run" / "alarms.csv")
    assert (rows["source"][0], rows["alarm"][0]) == ("vehicle 3", "refused")
    assert 0.0 < float(rows["time_s"][0]) - begin < 0.5
    assert set(rows["source"]) == {"vehicle 3"}
    assert len(rows["time_s"]) <= 4


@pytest.mark.parametrize("start", [3.0, 3.04, 3.044])
def test_a_link_that_flaps_is_noticed_whenever_it_does(tmp_path, start):
    """Down for 0.2 s in every 1.2 s, of which steps and samples are whole shares: always at the same moment between."""
    fault = Fault("flapping", start, vehicles=(2,), settings={"down": 0.2, "up": 1.0})
    mission = hop(tmp_path, fault)
    passage = FaultPassage(mission.faults, 53, mission.system)
    with Rehearsal(mission, tmp_path / "run", seed=53, passage=passage) as flight:
        flight.fly()
    begin = passage.faults[0].schedule.take_off + start
    rows = read_text_table(tmp_path / "run" / "alarms.csv")
    silent = [float(t) for t, alarm in zip(rows["time_s"], rows["alarm"], strict=True) if alarm == "silent"]
    assert silent and 0.0 < silent[0] - begin < 0.4
