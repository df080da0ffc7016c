"""The filter notices what its assumptions leave out: sensors that are noisier, forces that change faster."""

import numpy as np
import pytest
from flight_in_process import Rehearsal, check_within_limits, short_figure

from gcs.mission.read import read_mission
from idc_controller.estimation.health.noise_adaptation import LEVELS, Adaptation

pytestmark = pytest.mark.slow

KEYS = tuple(range(10))
SIZES = np.full(10, 5)
PAYLOAD_ROWS = np.arange(50) < 10


def learnt(innovations):
    adaptation = Adaptation()
    for k, white in enumerate(innovations):
        mean_squares = np.add.reduceat(white**2, np.arange(0, 50, 5)) / SIZES
        adaptation.learn(0.04 * k, KEYS, white, mean_squares, np.ones(50, dtype=bool), PAYLOAD_ROWS)
    return adaptation


def test_sound_innovations_change_nothing():
    random = np.random.default_rng(1)
    for _ in range(20):
        adaptation = learnt(random.standard_normal((500, 50)))
        assert (adaptation.noise, adaptation.level) == (1.0, 0)


def test_large_white_innovations_are_noise():
    adaptation = learnt(3.0 * np.random.default_rng(2).standard_normal((100, 50)))
    assert adaptation.noise > 50.0
    assert adaptation.level == 0


@pytest.mark.parametrize("of_payload", [True, False])
def test_innovations_that_point_one_way_are_forces(of_payload):
    random = np.random.default_rng(3)
    pushed = np.where(of_payload == PAYLOAD_ROWS, 1.0, 0.0)
    adaptation = learnt(random.standard_normal((200, 50)) + pushed)
    assert adaptation.level == LEVELS
    assert adaptation.noise == 1.0


def test_what_has_passed_is_forgotten():
    random = np.random.default_rng(4)
    calm = 0.3 * random.standard_normal((500, 50))
    pushed, noisy = random.standard_normal((200, 50)) + 1.0, 5.0 * random.standard_normal((100, 50))
    adaptation = learnt([*pushed, *noisy, *calm])
    assert (adaptation.noise, adaptation.level) == (1.0, 0)


def with_faults(folder, *faults):
    mission = short_figure(folder, duration=8.0)
    mission.write_text(mission.read_text() + "".join(f"\n[[fault]]\n{fault}\n" for fault in faults))
    return read_mission(mission)


def test_noise_times_five_on_every_channel_is_flown(tmp_path):
    channels = ("position", "velocity", "attitude", "rates")
    every = [*channels, *(f"payload_{channel}" for channel in channels)]
    mission = with_faults(
        tmp_path, *(f'kind = "noise"\nchannel = "{c}"\nfactor = 5.0\nstart = 5.0' for c in every)
    )  # fmt: skip
    with Rehearsal(mission, tmp_path / "run", seed=41) as flight:
        flight.fly()
        assert flight.flight.estimator.adaptation.noise > 5.0
        check_within_limits(flight.summary(), rmse=0.1)


def test_wind_with_gusts_is_flown(tmp_path):
    wind = 'kind = "wind"\nvelocity = [2.0, 2.0, 0.0]\ngust = 0.6\nstart = 5.0'
    with Rehearsal(with_faults(tmp_path, wind), tmp_path / "run", seed=42) as flight:
        flight.fly()
        summary = flight.summary()
    assert summary["completed"]
    assert summary["contacts"] == 0
    assert max(summary["payload_tilt_max_deg"].values()) <= 5.0
    assert summary["uav_separation_min_m"] >= 0.75


def test_a_third_of_all_datagrams_may_be_lost(tmp_path):
    mission = with_faults(tmp_path, 'kind = "packet_loss"\nprobability = 0.3\nstart = 0.0')
    with Rehearsal(mission, tmp_path / "run", seed=43) as flight:
        flight.fly()
        assert min(link.copies for link in flight.station.links) > 1
        check_within_limits(flight.summary())
