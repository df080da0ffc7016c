"""Exported runs: ULog files and telemetry logs, read back by the tools of others."""

import json
import subprocess
import sys
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from mission_files import MISSIONS
from pymavlink import mavutil
from pyulog import ULog

import gcs
from gcs.app.cli import main
from gcs.view.export.ulog_file import LoggedMessage, topic, ulog

SYSTEMS = {"vehicle_1": 1, "vehicle_2": 2, "vehicle_3": 3, "vehicle_4": 4, "payload": 100}


@pytest.fixture(scope="module")
def run_dir(tmp_path_factory):
    """A flight in which the position of vehicle 2 is biased from a moment on, exported in both forms."""
    folder = tmp_path_factory.mktemp("flown") / "hop"
    fault = {
        "kind": "bias", "start": 8.0, "vehicles": [2], "channel": "position", "amount": 0.5, "axes": ["x"],
    }  # fmt: skip
    flight = gcs.fly(MISSIONS / "hop.toml", seed=3, faults=[fault], run_dir=folder)
    assert flight.completed and len(flight.alarms)
    assert main(["export", str(folder), "--ulog", "--tlog"]) == 0
    return folder


@pytest.fixture(scope="module")
def summary(run_dir):
    return json.loads((run_dir / "summary.json").read_text())


def log_of(run_dir, name):
    return ULog(str(run_dir / f"{name}.ulg"), disable_str_exceptions=False)


def rows(log, name):
    """Time (s) and fields of a topic."""
    data = log.get_dataset(name).data
    return data["timestamp"] * 1e-6, data


def stacked(data, name, size):
    return np.column_stack([data[f"{name}[{k}]"] for k in range(size)])


# The file format


def test_ulog_is_read_back_with_types_order_and_texts(tmp_path):
    first = topic(
        np.array([0.25, 0.5]), x=[1.5, -2.0], q=np.array([[1.0, 2.0], [3.0, 4.0]]), ok=np.array([True, False])
    )
    second = topic(np.array([0.3, 0.1]), state=np.array([7, 200], np.uint8))
    texts = [LoggedMessage(0.4, 3, "team: Überlast"), LoggedMessage(0.05, 5, "begins")]
    path = tmp_path / "a.ulg"
    path.write_bytes(ulog({"first": first, "second": second, "none": first[:0]}, {"sys_name": "cooplift"}, texts))
    log = ULog(str(path), disable_str_exceptions=False)
    assert not log.file_corruption and log.start_timestamp == 50_000 and log.last_timestamp == 500_000
    assert log.msg_info_dict == {"sys_name": "cooplift"}
    assert {data.name: data.data["timestamp"].tolist() for data in log.data_list} == {
        "first": [250_000, 500_000], "second": [100_000, 300_000],
    }  # fmt: skip
    data = log.get_dataset("first")
    assert {field.field_name: field.type_str for field in data.field_data} == {
        "timestamp": "uint64_t", "x": "float", "q[0]": "float", "q[1]": "float", "ok": "bool",
    }  # fmt: skip
    assert stacked(data.data, "q", 2).tolist() == [[1.0, 2.0], [3.0, 4.0]] and data.data["ok"].tolist() == [1, 0]
    assert log.get_dataset("second").data["state"].tolist() == [200, 7]
    assert [(m.log_level_str(), m.timestamp, m.message) for m in log.logged_messages] == [
        ("NOTICE", 50_000, "begins"), ("ERROR", 400_000, "team: Überlast"),
    ]  # fmt: skip


# A flight


@pytest.mark.slow
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_log_is_whole_and_names_its_system(run_dir, name):
    log = log_of(run_dir, name)
    assert not log.file_corruption and not log.dropouts
    about = {"sys_name": "cooplift", "ver_sw": version("cooplift"), "system": name, "mission": "hop"}
    assert log.msg_info_dict == about
    assert all((np.diff(data.data["timestamp"].astype(int)) >= 0).all() for data in log.data_list)


@pytest.mark.slow
def test_payload_log_gives_the_figures_of_the_summary(run_dir, summary):
    log = log_of(run_dir, "payload")
    time, truth = rows(log, "vehicle_local_position_groundtruth")
    asked, reference = rows(log, "trajectory_setpoint")
    inside = (time >= asked[0]) & (time <= asked[-1])
    place, wanted = np.column_stack([truth[axis] for axis in "xyz"]), stacked(reference, "position", 3)
    error = [np.interp(time[inside], asked, wanted[:, k]) - place[inside, k] for k in range(3)]
    rmse = np.sqrt(np.mean(np.square(error), axis=1))
    assert rmse == pytest.approx([summary["position_rmse_m"][axis] for axis in "xyz"], abs=2e-6)
    estimated, estimate = rows(log, "vehicle_local_position")
    for axis in "xyz":
        off = estimate[axis] - np.interp(estimated, time, truth[axis])
        assert np.sqrt(np.mean(off[100:200] ** 2)) < 3.0 * np.mean(estimate["eph" if axis != "z" else "epv"][100:200])
    planned, plan = rows(log, "vehicle_local_position_setpoint")
    assert plan["z"].min() == pytest.approx(-0.8, abs=0.01) and asked[0] < planned[0] < planned[-1] < asked[-1]


@pytest.mark.slow
def test_vehicle_log_gives_duration_thrust_and_modes(run_dir, summary):
    log = log_of(run_dir, "vehicle_1")
    time, status = rows(log, "vehicle_status")
    changes = np.flatnonzero(np.diff(status["nav_state"].astype(int))) + 1
    assert status["nav_state"][[0, *changes]].tolist() == [4, 14, 4]
    armed = time[status["arming_state"] == 2]
    off = time[(time > armed[-1]) & (status["arming_state"] == 1)]
    assert off[0] - armed[0] == pytest.approx(summary["duration_s"], abs=0.1)
    time, truth = rows(log, "cooplift_thrust")
    hover = (time > 7.0) & (time < 8.5)
    # A quarter of the weight: 3.1 kg of the payload, 0.7 kg of the vehicle.
    assert truth["thrust"][hover].mean() == pytest.approx((3.1 / 4 + 0.7) * 9.81, rel=0.005)
    asked, setpoint = rows(log, "vehicle_attitude_setpoint")
    flown, in_force = rows(log, "vehicle_thrust_setpoint")
    for at, share in (asked, setpoint["thrust_body[2]"]), (flown, in_force["xyz[2]"]):
        within = (at > 7.0) & (at < 8.5)
        assert -30.0 * share[within].mean() == pytest.approx(truth["thrust"][hover].mean(), rel=0.005)
    time, link = rows(log, "cooplift_link")
    assert link["tension"][(time > 7.0) & (time < 8.5)].mean() == pytest.approx(3.1 / 4 * 9.81, rel=0.01)
    _, battery = rows(log, "battery_status")
    assert battery["voltage_v"] == pytest.approx(16.0) and battery["remaining"] == pytest.approx(1.0)
    time, landed = rows(log, "vehicle_land_detected")
    assert landed["landed"][0] and not landed["landed"][np.searchsorted(time, 8.0)] and landed["landed"][-1]


@pytest.mark.slow
def test_telemetry_in_vehicle_log_agrees_with_truth(run_dir):
    log = log_of(run_dir, "vehicle_3")
    true_time, truth = rows(log, "vehicle_local_position_groundtruth")
    time, position = rows(log, "vehicle_local_position")
    for axis in "xyz":
        off = position[axis] - np.interp(time, true_time, truth[axis])
        assert np.sqrt(np.mean(off**2)) == pytest.approx(0.02, rel=0.25)  # the sensors' noise
    true_time, truth = rows(log, "vehicle_attitude_groundtruth")
    time, attitude = rows(log, "vehicle_attitude")
    q = stacked(attitude, "q", 4)
    true = np.column_stack([np.interp(time, true_time, truth[f"q[{k}]"]) for k in range(4)])
    assert 2.0 * np.sqrt(np.mean((q - true)[:, 1:] ** 2)) == pytest.approx(np.radians(0.2), rel=0.25)


@pytest.mark.slow
def test_biased_position_is_rejected_in_the_log_of_its_vehicle_only(run_dir):
    for name in ("vehicle_1", "vehicle_2", "payload"):
        log = log_of(run_dir, name)
        time, ratios = rows(log, "estimator_innovation_test_ratios")
        _, flags = rows(log, "estimator_status_flags")
        since = 8.0 + json.loads((run_dir / "faults.json").read_text())["take_off_s"]
        biased = (time > since + 0.3) & (time < 15.0)
        rejected = ratios["gps_hpos[0]"] > 1.0
        assert not rejected[(time > 3.0) & (time < since)].any()
        if name == "vehicle_2":
            assert flags["reject_hor_pos"][biased].mean() > 0.9
            assert rejected.any() and {m.log_level_str() for m in log.logged_messages} >= {"WARNING"}
            assert all(m.message.startswith("vehicle 2: ") and m.timestamp > 1e6 * since for m in log.logged_messages)
        else:
            assert flags["reject_hor_pos"][biased].mean() < 0.05
            assert not any("vehicle" in message.message.split(":")[0] for message in log.logged_messages)


# Telemetry logs


def systems_in(path):
    """Messages by system, of those that the system itself has sent, and of all others."""
    log, found = mavutil.mavlink_connection(str(path), dialect="ardupilotmega"), Counter()
    while (message := log.recv_match()) is not None:
        # Of a message that its dialect lacks (CURRENT_MODE) pymavlink does not tell the sender.
        found[message.get_msgbuf()[5], message.get_type()] += 1
    return found


@pytest.mark.slow
def test_telemetry_logs_hold_all_messages_of_their_systems(run_dir):
    whole = systems_in(run_dir / "telemetry.tlog")
    for name, system in SYSTEMS.items():
        part = systems_in(run_dir / f"{name}.tlog")
        assert {key: n for key, n in part.items() if key[0] == system} == {
            key: n for key, n in whole.items() if key[0] == system
        }
        others = {key for key in part if key[0] != system}
        assert {sender for sender, _ in others} <= {255}
        if name != "payload":
            assert (255, "SET_ATTITUDE_TARGET") in others
            assert part[255, "SET_ATTITUDE_TARGET"] == whole[255, "SET_ATTITUDE_TARGET"] / 4


@pytest.mark.slow
def test_mavlogdump_reads_a_telemetry_log(run_dir):
    command = [sys.executable, str(Path(sys.executable).parent / "mavlogdump.py"), "--types", "LOCAL_POSITION_NED"]
    done = subprocess.run([*command, str(run_dir / "vehicle_2.tlog")], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert len(lines) == systems_in(run_dir / "vehicle_2.tlog")[2, "LOCAL_POSITION_NED"] > 300
    assert all("LOCAL_POSITION_NED {time_boot_ms" in line for line in lines)


# Input that cannot be used


@pytest.mark.slow
def test_log_that_is_cut_off_is_exported_to_its_last_whole_message(run_dir, tmp_path, capfd):
    for name in ("telemetry.tlog", "truth.csv"):
        content = (run_dir / name).read_bytes()
        (tmp_path / name).write_bytes(content[: len(content) // 2])
    assert main(["export", str(tmp_path), "--ulog", "--tlog"]) == 0
    assert len(capfd.readouterr().out.splitlines()) == 10
    half = systems_in(tmp_path / "vehicle_1.tlog")
    assert 0.4 < half.total() / systems_in(run_dir / "vehicle_1.tlog").total() < 0.6
    # Without what the ground has recorded the payload's log has the truth alone.
    assert {data.name for data in log_of(tmp_path, "payload").data_list} == {
        f"vehicle_{name}_groundtruth" for name in ("local_position", "attitude", "angular_velocity")
    }


@pytest.mark.parametrize(
    ("content", "words", "reason"),
    [
        (b"", "", "no format: --ulog, --tlog, or both"),
        (None, "--tlog", "telemetry.tlog: is missing: there is no telemetry to export"),
        (None, "--ulog", "telemetry.tlog: is missing: there is no telemetry to export"),
        (bytes(8) + b"no telemetry", "--tlog", "telemetry.tlog, byte 8: no MAVLink frame begins here"),
        (bytes(8) + b"no telemetry", "--ulog", "telemetry.tlog, byte 8: no MAVLink frame begins here"),
        (b"", "--tlog", "there is nothing of a vehicle or of the payload to export"),
        (b"", "--ulog", "there is nothing of a vehicle or of the payload to export"),
    ],
)
def test_run_that_cannot_be_exported_is_refused_in_one_line(tmp_path, content, words, reason, capfd):
    (tmp_path / "manifest.json").write_text("{}")
    if content is not None:
        (tmp_path / "telemetry.tlog").write_bytes(content)
    before = sorted(tmp_path.iterdir())
    assert main(["export", str(tmp_path), *words.split()]) == 2
    error = capfd.readouterr().err
    assert error.count("\n") == 1 and reason in error
    assert sorted(tmp_path.iterdir()) == before
