"""The payload loses most of its mass in the air, and then the ground is lost: that must not pass for a landing."""

from __future__ import annotations

import pytest
from flights import HOP, InProcessFlight, system_file, truth_of

from gcs.record.landing import is_set_down

LOST = 8.0  # s after take-off: in the hold


@pytest.mark.slow
@pytest.mark.parametrize("change", [-2.0, -2.9, pytest.param(1.0, marks=pytest.mark.long)])
def test_vehicles_set_down_a_payload_of_another_mass_without_ground(tmp_path, change: float) -> None:
    system_file(tmp_path)
    mission = tmp_path / "hop.toml"
    mission.write_text(
        HOP.replace("-0.8", "-2.0").replace("hold = 1.0", "hold = 6.0")
        + f'\n[[fault]]\nkind = "payload_mass"\nchange = {change}\nstart = {LOST}\n'
        + f'\n[[fault]]\nkind = "partition"\nstart = {LOST + 0.1}\n'
    )
    with InProcessFlight(mission, tmp_path / "run", seed=3) as flight:
        flight.fly()
        assert "no vehicle sends telemetry" in flight.flight.reason
        assert flight.run_without_ground()
        summary = flight.summary()
    assert is_set_down(summary["landing"]), summary["landing"]
    assert summary["contacts"] == 0 and summary["landing"]["speed_mps"] < 1.0
    assert -truth_of(tmp_path / "run")["payload_z_m"].min() > 1.5
