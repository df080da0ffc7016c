"""The payload loses most of its mass in the air: it is set down under control, and without a ground, too."""

from __future__ import annotations

import pytest
from flights import HOP, InProcessFlight, system_file, truth_of

from gcs.record.landing import is_set_down

LOST = 8.0  # s after take-off: in the hold


def hop_that_loses(folder, change, *faults):
    """Path of a hop whose payload changes by a mass (kg) in the hold."""
    system_file(folder)
    mission = folder / "hop.toml"
    change_of_mass = f'\n[[fault]]\nkind = "payload_mass"\nchange = {change}\nstart = {LOST}\n'
    mission.write_text(
        HOP.replace("-0.8", "-2.0").replace("hold = 1.0", "hold = 6.0") + change_of_mass + "".join(faults)
    )
    return mission


@pytest.mark.slow
@pytest.mark.parametrize("change", [-2.8, pytest.param(-2.0, marks=pytest.mark.long)])
def test_ground_sets_down_a_payload_of_another_mass(tmp_path, change: float) -> None:
    with InProcessFlight(hop_that_loses(tmp_path, change), tmp_path / "run", seed=3) as flight:
        flight.fly()
        assert flight.flight.completed, flight.flight.reason
        summary = flight.summary()
    assert is_set_down(summary["landing"]), summary["landing"]
    assert summary["contacts"] == 0 and summary["landing"]["speed_mps"] < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("change", [-2.0, -2.9, pytest.param(1.0, marks=pytest.mark.long)])
def test_vehicles_set_down_a_payload_of_another_mass_without_ground(tmp_path, change: float) -> None:
    lost = f'\n[[fault]]\nkind = "partition"\nstart = {LOST + 0.1}\n'
    mission = hop_that_loses(tmp_path, change, lost)
    with InProcessFlight(mission, tmp_path / "run", seed=3) as flight:
        flight.fly()
        assert "no vehicle sends telemetry" in flight.flight.reason
        assert flight.run_without_ground()
        summary = flight.summary()
    assert is_set_down(summary["landing"]), summary["landing"]
    assert summary["contacts"] == 0 and summary["landing"]["speed_mps"] < 1.0
    assert -truth_of(tmp_path / "run")["payload_z_m"].min() > 1.5
