"""Take-off with a payload whose mass the ground does not know."""

from __future__ import annotations

import numpy as np
import pytest
from flights import HOP, InProcessFlight, system_file, truth_of

from gcs.record.reader import read_table

MASS = 3.1  # kg, by the system file


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "wind"),
    [(-2.0, 0.0), (1.0, 0.0), *[pytest.param(*of, marks=pytest.mark.long) for of in ((-1.0, 3.0), (-0.5, 0.0))]],
)
def test_payload_of_unknown_mass_takes_off_smoothly_and_its_mass_is_found(tmp_path, change: float, wind: float) -> None:
    system_file(tmp_path)
    faults = f'\n[[fault]]\nkind = "payload_mass"\nchange = {change}\nstart_phase = "arm"\n'
    faults += f'\n[[fault]]\nkind = "wind"\nvelocity = [{wind}, 0.0, 0.0]\nstart_phase = "arm"\n' if wind else ""
    (tmp_path / "hop.toml").write_text(HOP + faults)
    with InProcessFlight(tmp_path / "hop.toml", tmp_path / "run", seed=3) as flight:
        flight.fly()
        assert flight.flight.completed, flight.flight.reason
        summary = flight.summary()
    assert summary["contacts"] == 0 and summary["landing"]["speed_mps"] < 0.5
    assert max(summary["payload_tilt_max_deg"].values()) < 5.0
    truth, estimate = truth_of(tmp_path / "run"), read_table(tmp_path / "run" / "estimate.csv")
    height = truth["payload_z_m"][0] - truth["payload_z_m"]
    assert height.max() < 0.5 + 0.1
    lift_off = truth["time_s"][np.argmax(height > 0.02)]
    after = estimate["payload_mass_kg"][(estimate["time_s"] > lift_off + 1.0) & (estimate["time_s"] < lift_off + 5.0)]
    assert after[-1] == pytest.approx(MASS + change, rel=0.05 if wind else 0.01)
    assert after == pytest.approx(MASS + change, rel=0.1 if wind else 0.03)
