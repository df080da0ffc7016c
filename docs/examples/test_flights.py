"""Tests of another project, which has installed the package: by the fixture that comes with it, and by the call."""

import gcs


def test_hop_stays_within_its_limits_with_a_tenth_of_all_datagrams_lost(fly_with_faults):
    flight = fly_with_faults("hop", [{"kind": "packet_loss", "start": 0.0, "probability": 0.1}], seed=4)
    assert flight.within_limits, flight


def test_a_payload_heavier_than_assumed_is_lifted():
    flight = gcs.fly("hop", seed=1, settings={"world.payload_mass_factor": 1.1})
    assert flight.completed and flight.truth["payload_z_m"].min() < -0.7, flight
