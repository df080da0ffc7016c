"""The live view: messages hold what has come to be on record, whoever looks, comes late, goes or sends rubbish."""

import json
import shutil
import socket
import urllib.error
import urllib.request

import numpy as np
import pytest
from decoded_page import Decoded
from growing_run import served, write_until
from recorded_run import BALL, write_plan, write_reference, write_truth
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from gcs.drivers.live_view import LiveView
from gcs.record.run_data import read_run
from gcs.record.run_folder import write_json
from gcs.record.tables import ESTIMATE_COLUMNS
from gcs.view import live
from gcs.view.live import Records
from gcs.view.page_data import QUANTUM


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A run that is over."""
    folder = tmp_path_factory.mktemp("flown")
    write_truth(folder, standing=[BALL])
    write_reference(folder)
    write_plan(folder, slack=0.0, off=0.05)
    write_json(folder / "manifest.json", {"mission": {"name": "north"}, "seed": 3})
    return folder


@pytest.fixture
def folder(tmp_path, flown):
    """The same run at its begin: :func:`write_until` lets it go on."""
    for name in ("manifest.json", "obstacles.csv"):
        shutil.copy(flown / name, tmp_path)
    return tmp_path


def test_rows_of_the_estimate_wait_for_those_of_the_truth(folder, flown):
    write_until(folder, flown, 0.5)
    records = Records(folder)
    records.message()
    estimate = folder / "estimate.csv"
    estimate.write_text(",".join(ESTIMATE_COLUMNS) + "\n" + ",".join(["6.0"] * len(ESTIMATE_COLUMNS)) + "\n")
    assert records.message() is None
    write_until(folder, flown, 1.0)
    header = json.loads(records.message())["header"]
    assert header["meta"]["source"] == "truth" and "estimate.payload.position" in header["channels"]


def decoded(message):
    return Decoded(message["header"], message["blob"])


def test_messages_together_hold_the_records(folder, flown):
    records = Records(folder)
    assert records.message() is None
    found = []
    for share in (0.2, 0.5, 0.5, 1.0):
        write_until(folder, flown, share)
        if (text := records.message()) is not None:
            found.append(json.loads(text))
    assert len(found) == 3 and not any(message["final"] for message in found)
    assert found[0]["header"]["meta"]["outcome"] == "in flight" and found[0]["header"]["clearance"] is None
    truth = read_run(flown)
    for name, time, values in (
        ("truth.payload.position", truth.time, truth.payload_position),
        ("plan.position", truth.tables["plan.csv"]["time_s"], None),
        ("clearance.nearest", truth.time, truth.clearance[:, None]),
    ):
        parts = [decoded(message).channel(name) for message in found]
        assert np.allclose(np.concatenate([t for t, _ in parts]), time, atol=1e-6)
        if values is not None:
            assert np.allclose(np.concatenate([v for _, v in parts]), values, atol=QUANTUM["m"])
    assert [obstacle["name"] for obstacle in found[-1]["header"]["obstacles"]] == ["ball"]


def test_browsers_get_what_is_on_record_and_in_the_end_the_report(folder, flown, monkeypatch):
    monkeypatch.setattr(live, "PERIOD", 0.001)
    write_until(folder, flown, 0.5)
    with served(folder) as (port, is_over):
        page = urllib.request.urlopen(f"http://127.0.0.1:{port}/").read().decode()
        assert 'class="live"' in page
        with connect(f"ws://127.0.0.1:{port}/") as gone:
            assert json.loads(gone.recv())["header"]["meta"]["mission"] == "north"
        with connect(f"ws://127.0.0.1:{port}/") as early:
            first = json.loads(early.recv())
            write_until(folder, flown, 1.0)
            later = json.loads(early.recv())
            with connect(f"ws://127.0.0.1:{port}/") as late:
                so_far = json.loads(late.recv())
                is_over.set()
                messages = [json.loads(text) for text in (*early, *late)]
    end = first["header"]["meta"]["end"]
    assert later["header"]["meta"]["begin"] > end and so_far["header"]["meta"]["begin"] == 0.0
    final = [message for message in messages if message["final"]]
    assert len(final) == 2
    for message in final:
        time, position = decoded(message).channel("truth.payload.position")
        assert len(time) == len(position) == 101
        assert message["header"]["clearance"]["obstacle"] == "ball"


def test_pages_of_others_and_other_paths_are_refused_and_rubbish_is_survived(folder, flown):
    write_until(folder, flown, 1.0)
    with served(folder) as (port, _):
        with pytest.raises(InvalidStatus) as refused:
            connect(f"ws://127.0.0.1:{port}/", origin="http://evil.example")
        assert refused.value.response.status_code == 403
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"http://127.0.0.1:{port}/summary.json")
        for rubbish in (b"\0\xff" * 100, b"GET /\r\n\r\n", b""):
            with socket.create_connection(("127.0.0.1", port)) as stranger:
                stranger.sendall(rubbish)
        with connect(f"ws://127.0.0.1:{port}/") as browser:
            assert json.loads(browser.recv())["header"]["meta"]["mission"] == "north"


@pytest.mark.slow
def test_program_serves_a_folder_until_it_is_closed(folder, flown):
    write_until(folder, flown, 1.0)
    with LiveView(folder) as view, connect(view.url.replace("http", "ws")) as browser:
        assert not json.loads(browser.recv())["final"]
        view.close()
        *_, last = browser
    assert json.loads(last)["final"]
    assert view._process.returncode == 0
