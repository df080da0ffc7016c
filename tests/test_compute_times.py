"""Compute times of the control step, by a stopwatch that is moved by hand."""

from itertools import pairwise

import pytest
from flights import HOP, InProcessFlight, system_file

from gcs.flight.compute_times import ComputeTimes, Part
from gcs.record.reader import read_table


class Stopwatch:
    now = 0.0

    def __call__(self):
        return self.now


def test_laps_add_up_by_part_and_idle_times_count_for_nothing():
    stopwatch = Stopwatch()
    times = ComputeTimes(stopwatch)
    for _ in range(2):
        stopwatch.now += 10.0
        times.resume()
        stopwatch.now += 1.0
        times.lap(Part.TELEMETRY)
        stopwatch.now += 4.0
        times.lap(Part.CONTROL)
    times.shift(3.0, Part.CONTROL, Part.PLANNING)
    expected = [0.0] * len(Part)
    expected[Part.TELEMETRY], expected[Part.CONTROL], expected[Part.PLANNING] = 2.0, 5.0, 3.0
    assert times.take() == tuple(expected)
    assert times.take() == (0.0,) * len(Part)


def test_first_lap_begins_with_the_compute_times():
    stopwatch = Stopwatch()
    stopwatch.now = 1000.0
    times = ComputeTimes(stopwatch)
    stopwatch.now += 2.0
    times.lap(Part.TELEMETRY)
    assert times.take()[Part.TELEMETRY] == 2.0


@pytest.mark.slow
def test_all_that_the_ground_computes_in_flight_is_in_one_part(tmp_path, monkeypatch):
    """Each reading of the stopwatch is 1 ms after the one before: a step lasts as many as there were readings."""
    system_file(tmp_path)
    mission = tmp_path / "hop.toml"
    mission.write_text(HOP)
    readings = 0
    at_step = []

    def stopwatch():
        nonlocal readings
        readings += 1
        return readings * 1e-3

    monkeypatch.setattr("gcs.app.fly.time.perf_counter", stopwatch)
    with InProcessFlight(mission, tmp_path / "run") as flight:
        resume, compute_times = flight.station.resume, flight.recorder.compute_times
        idle = 0

        def counted():
            nonlocal idle
            idle += 1
            resume()

        def kept(time, decision, parts):
            at_step.append(readings - idle)
            compute_times(time, decision, parts)

        flight.station.resume, flight.recorder.compute_times = counted, kept
        flight.fly(stop=lambda: len(at_step) == 40)
    steps = read_table(tmp_path / "run" / "steps.csv")
    parts = [name for name in steps.dtype.names if name.endswith("_ms") and name not in ("total_ms", "mpc_ms")]
    assert len(parts) == len(Part)
    assert steps["total_ms"] == pytest.approx(sum(steps[name] for name in parts))
    assert steps["total_ms"][1:] == pytest.approx([after - before for before, after in pairwise(at_step)])
    assert {name for name in parts if not steps[name].any()} <= {"stop_plan_ms"}  # none on the ground
