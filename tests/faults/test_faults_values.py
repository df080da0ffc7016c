"""Effects of value faults on samples."""

import math
import pickle

import numpy as np
import pytest
from fault_injection import STILL, SYSTEM, TAKE_OFF, at, fault, injected, positions, reported

from gcs.faults import KINDS
from vehicle_sim.world.range_sensor import RangeSample


def test_bias_drift_scale_sign_frame_and_quantisation():
    assert positions(injected(fault("bias", channel="position", amount=0.5, axes=["x", "z"])), 3) == pytest.approx(
        np.tile([0.5, 0.0, 0.5], (3, 1))
    )
    drift = injected(fault("drift", start=2.0, channel="position", rate=0.1, axes=["y"]))
    assert reported(drift, 1.9).position.position[1] == 2.0
    assert reported(drift, 7.0).position.position[1] == pytest.approx(2.5)
    everywhere = injected(fault("drift", start=2.0, channel="velocity", rate=-0.1))
    assert reported(everywhere, 7.0).position.velocity == pytest.approx((-0.4, -0.3, -0.2))
    assert reported(injected(fault("scale", channel="velocity", factor=2.0)), 1.0).position.velocity == (0.2, 0.4, 0.6)
    assert reported(injected(fault("flipped_sign", channel="velocity")), 1.0).position.velocity == (-0.1, -0.2, -0.3)
    assert reported(injected(fault("flipped_sign", channel="rates")), 1.0).attitude.rates == (-0.01, -0.02, -0.03)
    assert reported(injected(fault("swapped_frame", channel="position")), 1.0).position.position == (2.0, 1.0, 5.0)
    coarse = injected(fault("quantisation", channel="velocity", step=0.25))
    assert reported(coarse, 1.0).position.velocity == (0.0, 0.25, 0.25)


def test_stuck_values_stay_and_begin_anew_each_time():
    disturbed = injected(fault("stuck", 1.0, 1.0, every=2.0, channel="velocity"))
    reported_values = [reported(disturbed, t / 2, velocity=(t, t, t)).position.velocity[0] for t in range(10)]
    assert reported_values == [0, 1, 2, 2, 4, 5, 6, 6, 8, 9]


def test_spikes_are_single_samples_of_the_right_size_and_number():
    off = positions(injected(fault("spikes", channel="position", probability=0.1, amount=2.0)), 5000)
    hit = np.any(off != 0.0, axis=1)
    assert hit.sum() == pytest.approx(500, abs=90)
    assert np.abs(off[hit]) == pytest.approx(np.full((hit.sum(), 3), 2.0))
    assert (off[hit] > 0.0).mean() == pytest.approx(0.5, abs=0.08)


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_nan_is_reported(value):
    velocity = reported(injected(fault("not_a_number", channel="velocity", value=value)), 0.0).position.velocity
    assert [repr(v) for v in velocity] == [value] * 3
    attitude = reported(injected(fault("not_a_number", channel="attitude", value=value)), 0.0).attitude
    assert not any(math.isfinite(q) for q in attitude.attitude) and attitude.rates == STILL.rates
    half = injected(fault("not_a_number", channel="velocity", axes=["y"], probability=0.5))
    reported_values = [reported(half, i * 0.01).position.velocity for i in range(1000)]
    assert sum(v[1] != v[1] for v in reported_values) == pytest.approx(500, abs=65)
    assert all(v[0] == 0.1 for v in reported_values)


def test_noise_adds_up_to_the_factor():
    off = positions(injected(fault("noise", channel="position", factor=5.0)), 5000)
    own = SYSTEM.sensors.position
    assert math.hypot(off.std(), own) == pytest.approx(5.0 * own, rel=0.03)
    assert abs(off.mean()) < 5.0 * own * 0.05
    assert not np.any(positions(injected(fault("noise", channel="position", factor=1.0)), 5))


def test_intermittent_values_are_stuck_for_random_times():
    disturbed = injected(fault("intermittent", channel="velocity", good=1.0, stuck=0.5))
    reported_values = [reported(disturbed, i * 0.01, velocity=(i, i, i)).position.velocity[0] for i in range(60_000)]
    stuck = np.diff(reported_values) == 0
    assert stuck.mean() == pytest.approx(1 / 3, abs=0.06)
    assert reported_values[0] == 0 and max(np.array(range(60_000)) - reported_values) > 50


def test_attitude_is_disturbed_as_a_rotation():
    tilted = (math.cos(0.1), math.sin(0.1), 0.0, 0.0)
    bias = injected(fault("bias", channel="attitude", amount=0.3, axes=["x"]))
    off = reported(bias, 1.0, attitude=tilted).attitude.attitude
    assert off == pytest.approx((math.cos(0.25), math.sin(0.25), 0.0, 0.0))
    back = reported(injected(fault("flipped_sign", channel="attitude")), 1.0, attitude=tilted).attitude.attitude
    assert back == pytest.approx((math.cos(0.1), -math.sin(0.1), 0.0, 0.0))


def test_value_fault_is_in_telemetry_only_unless_at_source():
    outside = injected(fault("bias", channel="position", amount=1.0))
    assert outside.own_sample(1, at(1.0)) == at(1.0)
    assert outside.reported_sample(1, at(1.0)).attitude == at(1.0)  # of the position alone
    inside = injected(fault("bias", channel="position", amount=1.0, at_source=True))
    assert inside.own_sample(1, at(1.0)).position == (2.0, 3.0, -4.0)
    assert inside.reported_sample(1, at(1.0)).position == at(1.0)  # is given what the autopilot has


def test_payload_fault_is_in_all_relays_or_in_one():
    unit = injected(fault("noise", channel="payload_position", at_source=True))
    sample = at(1.0)
    relayed = {unit.payload_sample(i, sample).position for i in (1, 2, 3, 4)}
    assert len(relayed) == 1 and relayed != {STILL.position}
    relays = injected(fault("noise", channel="payload_position"))
    assert len({relays.payload_sample(i, sample).position for i in (1, 2, 3, 4)}) == 4
    one = injected(fault("bias", channel="payload_velocity", amount=1.0, vehicles=(3,)))
    assert [one.payload_sample(i, sample).velocity[0] for i in (1, 2, 3, 4)] == pytest.approx([0.1, 0.1, 1.1, 0.1])
    assert one.reported_sample(3, sample).position is sample


def test_points_of_obstacles_are_a_channel():
    def scan(time, distance):
        points = np.array([[distance, float(k), 0.0] for k in range(3)])
        return RangeSample(TAKE_OFF + time, 9.0, points)

    far = injected(fault("scale", channel="obstacles", factor=2.0)).range_sample(1, scan(1.0, 4.0))
    assert far.points.tolist() == [[8.0, 0.0, 0.0], [8.0, 2.0, 0.0], [8.0, 4.0, 0.0]]
    stuck = injected(fault("stuck", channel="obstacles"))
    stuck.range_sample(1, scan(1.0, 4.0))
    later = stuck.range_sample(1, scan(1.1, 3.0))
    assert later.points[:, :2].tolist() == [[4, 0], [4, 1], [4, 2]]


def test_swapped_vehicles_report_each_others_data():
    disturbed = injected(fault("swapped_vehicles", vehicles=(1,), other=2))
    samples = {i: at(1.0)._replace(position=(float(i), 0.0, 0.0)) for i in (1, 2, 3)}
    for _ in range(2):
        reported_values = [disturbed.reported_sample(i, samples[i]).position.position[0] for i in (1, 2, 3)]
    assert reported_values == [2.0, 1.0, 3.0]


VALUE_KINDS = [k.name for k in KINDS.values() if k.family == "values" and k.name != "swapped_vehicles"]


@pytest.mark.parametrize("kind", VALUE_KINDS)
@pytest.mark.parametrize("channel", ["position", "velocity", "attitude", "rates", "payload_position", "obstacles"])
def test_every_value_fault_acts_on_every_channel_and_repeats(kind, channel):
    def run(seed=1):
        more = {"good": 0.05} if kind == "intermittent" else {}
        disturbed = injected(fault(kind, channel=channel, **more), seed=seed)
        reported_values = []
        for i in range(100):
            sample = at(i * 0.02)._replace(
                position=(0.3 + i, 2.0, -5.0), velocity=(0.1 + i, 0.2, 0.3), rates=(0.01 * i, 0.02, 0.03),
                attitude=(math.cos(0.01 * i), math.sin(0.01 * i), 0.0, 0.0),
            )  # fmt: skip
            scan = RangeSample(sample.time, 9.0, np.array([[1.3 + 0.01 * i, 2.0, 3.0]]))
            reported_values += [
                disturbed.reported_sample(1, sample),
                disturbed.payload_sample(1, sample),
                disturbed.range_sample(1, scan),
            ]
        assert disturbed.faults[0].disturbed > 0
        return pickle.dumps(reported_values)

    assert run() == run()
    if kind in ("spikes", "noise", "intermittent"):
        assert run(2) != run()
