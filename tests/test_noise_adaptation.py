"""Noise adaptation: sensors that are noisier, forces that change faster than assumed."""

import numpy as np
import pytest
from flight_in_process import InProcessFlight, check_within_limits, short_figure

from gcs.mission.read import read_mission
from idc_controller.estimation.health.noise_adaptation import NoiseAdaptation
from idc_controller.estimation.settings import NoiseAdaptationSettings

KEYS = tuple(range(10))
SIZES = np.full(10, 5)
PAYLOAD_ROWS = np.arange(50) < 10


def adapted(innovations):
    adaptation = NoiseAdaptation(3)
    for k, normalised in enumerate(innovations):
        mean_squares = np.add.reduceat(normalised**2, np.arange(0, 50, 5)) / SIZES
        adaptation.learn(0.04 * k, KEYS, normalised, mean_squares, np.ones(50, dtype=bool), PAYLOAD_ROWS)
    return adaptation


def test_scales_stay_one_for_consistent_innovations():
    random = np.random.default_rng(1)
    for _ in range(20):
        adaptation = adapted(random.standard_normal((500, 50)))
        assert (adaptation.measurement_scale, adaptation.level) == (1.0, 0)


def test_measurement_scale_grows_for_large_uncorrelated_innovations():
    adaptation = adapted(3.0 * np.random.default_rng(2).standard_normal((100, 50)))
    assert adaptation.measurement_scale > 50.0
    assert adaptation.level == 0


@pytest.mark.parametrize("of_payload", [True, False])
def test_process_level_rises_for_correlated_innovations(of_payload):
    random = np.random.default_rng(3)
    pushed = np.where(of_payload == PAYLOAD_ROWS, 1.0, 0.0)
    adaptation = adapted(random.standard_normal((200, 50)) + pushed)
    assert adaptation.level == NoiseAdaptationSettings().process_levels
    assert adaptation.measurement_scale == 1.0


def test_scales_return_to_one_after_disturbance():
    random = np.random.default_rng(4)
    calm = 0.3 * random.standard_normal((500, 50))
    pushed, noisy = random.standard_normal((200, 50)) + 1.0, 5.0 * random.standard_normal((100, 50))
    adaptation = adapted([*pushed, *noisy, *calm])
    assert (adaptation.measurement_scale, adaptation.level) == (1.0, 0)


def with_faults(folder, *faults):
    mission = short_figure(folder, duration=8.0)
    mission.write_text(mission.read_text() + "".join(f"\n[[fault]]\n{fault}\n" for fault in faults))
    return read_mission(mission)


@pytest.mark.slow
def test_flight_stays_within_limits_with_five_times_noise_on_every_channel(tmp_path):
    channels = ("position", "velocity", "attitude", "rates")
    every = [*channels, *(f"payload_{channel}" for channel in channels)]
    mission = with_faults(
        tmp_path, *(f'kind = "noise"\nchannel = "{c}"\nfactor = 5.0\nstart = 5.0' for c in every)
    )  # fmt: skip
    with InProcessFlight(mission, tmp_path / "run", seed=41) as flight:
        flight.fly()
        assert flight.flight.control.estimator.health.adaptation.measurement_scale > 5.0
        check_within_limits(flight.summary(), rmse=0.1)


@pytest.mark.slow
def test_flight_completes_in_gusty_wind(tmp_path):
    wind = 'kind = "wind"\nvelocity = [2.0, 2.0, 0.0]\ngust = 0.6\nstart = 5.0'
    with InProcessFlight(with_faults(tmp_path, wind), tmp_path / "run", seed=42) as flight:
        flight.fly()
        summary = flight.summary()
    assert summary["completed"]
    assert summary["contacts"] == 0
    assert max(summary["payload_tilt_max_deg"].values()) <= 5.0
    assert summary["uav_separation_min_m"] >= 0.75


@pytest.mark.slow
def test_flight_stays_within_limits_with_a_third_of_datagrams_lost(tmp_path):
    mission = with_faults(tmp_path, 'kind = "packet_loss"\nprobability = 0.3\nstart = 0.0')
    with InProcessFlight(mission, tmp_path / "run", seed=43) as flight:
        flight.fly()
        assert min(link.setpoints.copies for link in flight.station.links) > 1
        check_within_limits(flight.summary())
