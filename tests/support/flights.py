"""Flights in this process for tests: worlds other than the mission's, questions at every exchange, short missions."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from gcs.app.in_process import FlightInProcess
from gcs.drivers.in_process import GROUND as GROUND
from gcs.mission.read import read_mission
from gcs.record.reader import read_table
from gcs.record.summary import within_limits
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.in_process import InProcessWorld
from vehicle_sim.swarm import Swarm

MISSIONS = Path(__file__).parents[2] / "missions"
LONGEST = 300.0  # s of simulated time after which a flight is taken for stuck

SHORT_FIGURE = """
[mission]
name = "short figure"
system = "system.toml"
seed = 1

[reference]
kind = "lissajous"
amplitude = [6.0, 3.0]
angular_frequency = 0.5
altitude = {altitude}
duration = {duration}

[limits]
position_rmse = 0.03
settle = 10.0
payload_tilt_deg = 5.0
"""

# The shortest flight there is: up, a second in the air, and down.
HOP = """
[mission]
name = "hop"
system = "system.toml"

[reference]
kind = "waypoints"
points = [[0.0, 0.0, -0.8]]
hold = 1.0
"""


def address_of(system_id):
    return ("127.0.0.1", 14579 + system_id)


def system_file(folder, **changes):
    """A copy of the system file with keys replaced, each given as table__key="toml text" or key="toml text"."""
    text = (MISSIONS / "system.toml").read_text()
    for name, value in changes.items():
        key = name.split("__")[-1]
        lines = text.splitlines()
        at = [i for i, line in enumerate(lines) if line.removeprefix("# ").startswith(f"{key} =")]
        if "__" in name:
            table = lines.index(f"[{name.split('__')[0]}]")
            at = [i for i in at if i > table][:1]
        assert len(at) == 1, name
        lines[at[0]] = f"{key} = {value}"
        text = "\n".join(lines) + "\n"
    path = folder / "system.toml"
    path.write_text(text)
    return path


def short_figure(folder, duration=10.0, altitude=2.5, **changes):
    """Path of a figure eight of ``duration`` (s) in ``folder``, with a system file of its own beside it."""
    system_file(folder, **changes)
    path = folder / "short_figure.toml"
    path.write_text(SHORT_FIGURE.format(duration=duration, altitude=altitude))
    return path


class InProcessFlight(FlightInProcess):
    """One flight, in a world that may be another one than the mission's."""

    def __init__(
        self, mission, folder, *, seed=None, world=None, faults=None, controller="idc", obstacles=(), addresses=None,
        behind=lambda world: world,
    ):  # fmt: skip
        """``mission``: a path or a Mission; ``world``: the system file's config of the world when it differs.

        ``obstacles``: those of the world; the mission's own are on the map only. ``addresses``: of the vehicles, as
        the ground is given them; None: the true ones. ``behind``: returns a world as the ground is connected with it.
        """
        if isinstance(mission, Path):
            mission = read_mission(mission)
        mission = mission if seed is None else replace(mission, seed=seed)
        folder.mkdir(parents=True, exist_ok=True)
        config = world or mission.system
        if faults is None and mission.faults:
            faults = FaultInjector(mission.faults, mission.seed, config, mission)
        self.swarm = Swarm(config, seed=mission.seed, home=mission.home, faults=faults, obstacles=obstacles)
        world = behind(InProcessWorld(self.swarm, folder))
        super().__init__(mission, folder, controller=controller, world=world, addresses=addresses)
        self.folder = folder

    def fly(self, on_exchange=lambda in_process: None, until=LONGEST, stop=lambda: False):
        """Fly to the end of the flight, to ``until`` (s), or until ``stop()`` is true."""
        super().fly(lambda: on_exchange(self), until=until, stop=stop)
        assert self.now <= LONGEST, "the flight does not end"
        return self

    def run_without_ground(self, duration=120.0):
        """Advance the world without a ground until all is at rest (at most ``duration``, s); return whether it is."""
        return self.lockstep.let_land(duration)

    def summary(self):
        return self.result().summary


def flown(mission, folder, **options):
    """The summary of a flight to its end."""
    with InProcessFlight(mission, folder, **options) as in_process:
        in_process.fly()
        return in_process.summary()


def check_within_limits(summary, rmse=0.03):
    """Assert the limits of every flight."""
    assert summary["completed"], summary
    assert summary["position_rmse_m"]["total"] <= rmse, summary
    assert max(summary["payload_tilt_max_deg"].values()) <= 5.0, summary
    assert summary["uav_separation_min_m"] >= 0.7, summary
    assert summary["contacts"] == 0, summary
    if rmse == 0.03:
        assert within_limits(summary)


def truth_of(folder):
    """The rows of truth.csv."""
    return read_table(folder / "truth.csv")


def position_rmse(truth_folder, run_folder):
    """Position RMSE (m) of the payload about the mission, 10 s after take-off and on."""
    truth = truth_of(truth_folder)
    reference = read_table(run_folder / "reference.csv")
    at = reference["time_s"]
    late = at > at[0] + 10.0
    squared = sum(
        (np.interp(at, truth["time_s"], truth[f"payload_{axis}_m"]) - reference[f"{axis}_m"]) ** 2 for axis in "xyz"
    )
    return float(np.sqrt(squared[late].mean()))
