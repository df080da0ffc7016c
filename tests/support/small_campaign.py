"""A small fault campaign, and what its flights would come to."""

from concurrent.futures import Executor, Future

from flights import short_figure

from gcs.campaign import flight
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights

CAMPAIGN = """
[campaign]
name = "a test"
missions = ["short_figure.toml"]
seeds = [3, 7]

[[fault]]
name = "loss"
kind = "packet_loss"
start = 5.0
severity = { probability = [0.1, 0.3] }

[[fault]]
name = "slow"
kind = "latency"
start = 4.0
duration = 2.0
delay = 0.05
"""


def campaign_file(folder, text=CAMPAIGN):
    short_figure(folder, 2.0, 1.5)
    path = folder / "campaign.toml"
    path.write_text(text)
    return path


class InThisThread(Executor):
    """Calls are carried out as they are submitted."""

    def __init__(self, *_):
        pass

    def submit(self, call, /, *arguments, **keywords):
        future = Future()
        future.set_result(call(*arguments, **keywords))
        return future


def fly_nothing(monkeypatch, fly):
    """Whatever campaign flies from here on, a flight is ``fly(plan, run_dir)``."""
    monkeypatch.setattr(flight, "fly", fly)
    monkeypatch.setattr("gcs.app.campaigns.WorkerProcesses", InThisThread)
    monkeypatch.setattr("fault_tables_page.WorkerProcesses", InThisThread)


def flown_in(campaign, ended=lambda result: None):
    """Fly a campaign in this thread."""
    campaign.fly(InThisThread(), ended)
    return campaign


def judged(campaign, plan, flown):
    """The result of a flight that is over."""
    return campaign.judged(plan, plan.result(flown, campaign.run_dir(plan)))


def flights(folder, text=CAMPAIGN):
    return list(FaultFlights(read_campaign(campaign_file(folder, text))).plans(folder / "out"))


SUMMARY = {
    "completed": True, "outcome": "completed", "contacts": 0, "clearance_min_m": None, "uav_separation_min_m": 0.9,
    "payload_tilt_max_deg": {"roll": 1.0, "pitch": 2.5, "yaw": None}, "duration_s": 20.0,
    "position_rmse_m": {"total": 0.02}, "limits": {"position_rmse": {"value": 0.02, "limit": 0.03, "held": True}},
}  # fmt: skip
OUTSIDE = {"limits": {"position_rmse": {"value": 0.2, "limit": 0.03, "held": False}}}
