"""One vehicle lost around touch-down: the others hold with it, and all are set down together."""

from __future__ import annotations

import pytest
from flights import HOP, InProcessFlight, system_file

from gcs.flight.phase import Phase
from gcs.record.landing import is_set_down

# After take-off (s). The payload touches down 11.1 s after it, and the rotors stop 2 s later.
MOMENTS = [
    (0.0, 11.3),
    (4.0, 11.8),
    *(pytest.param(4.0, at, marks=pytest.mark.long) for at in (11.0, 11.3, 12.1, 12.4)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("wind", "start"), MOMENTS)
def test_vehicle_lost_while_rotors_spool_down_lands_with_the_others(tmp_path, wind: float, start: float) -> None:
    system_file(tmp_path)
    mission = tmp_path / "hop.toml"
    text = HOP + f'\n[[fault]]\nkind = "partition"\nstart = {start}\nvehicles = [2]\n'
    if wind:
        text += f'\n[[fault]]\nkind = "wind"\nstart = 0.0\nvelocity = [0.0, {wind}, 0.0]\ngust = 0.5\n'
    mission.write_text(text)
    phases = []
    with InProcessFlight(mission, tmp_path / "run", seed=3) as flight:
        flight.fly(lambda flown: phases.append(flown.flight.phase))
        assert "vehicle 2 sends no telemetry" in flight.flight.reason
        assert flight.run_without_ground()
        summary = flight.summary()
    assert Phase.SPOOL_DOWN in phases and Phase.AUTONOMOUS_LANDING in phases
    assert is_set_down(summary["landing"]), summary["landing"]
    assert summary["contacts"] == 0 and summary["uav_separation_min_m"] > 0.75
    assert max(summary["payload_tilt_max_deg"].values()) < 10.0


def landed_hop(folder, faults):
    """Return the summary of a hop with ``faults`` whose payload was set down."""
    system_file(folder)
    mission = folder / "hop.toml"
    mission.write_text(HOP + faults)
    with InProcessFlight(mission, folder / "run", seed=3) as flight:
        flight.fly()
        assert flight.flight.landed
        summary = flight.summary()
    assert is_set_down(summary["landing"]), summary["landing"]
    return summary


@pytest.mark.slow
def test_links_stay_upright_until_the_rotors_stop_with_a_wrong_attitude_and_a_lost_position_in_wind(tmp_path) -> None:
    summary = landed_hop(
        tmp_path,
        '\n[[fault]]\nkind = "wind"\nstart = 0.0\nrise = 0.0\nvelocity = [2.8, 2.8, 0.0]\n'
        '\n[[fault]]\nkind = "position_lost"\nstart_phase = "land"\nvehicles = [2]\n'
        '\n[[fault]]\nkind = "bias"\nchannel = "attitude"\nat_source = true\namount = 0.1\n'
        'start_phase = "spool_down"\nvehicles = [3]\n',
    )
    assert summary["contacts"] == 0 and summary["uav_separation_min_m"] > 0.6


@pytest.mark.slow
def test_payload_is_set_down_in_wind_that_rises_after_all_positions_are_lost_just_before_touch_down(tmp_path) -> None:
    summary = landed_hop(
        tmp_path,
        '\n[[fault]]\nkind = "position_lost"\nstart_phase = "land"\n'
        '\n[[fault]]\nkind = "wind"\nrise = 0.0\nvelocity = [2.8, 2.8, 0.0]\n'
        'start_phase = "land"\nstart_offset = 1.2\n',
    )
    assert summary["contacts"] == 0 and summary["uav_separation_min_m"] > 0.8
