"""Innovation monitor: biases, noise and repeated rejections of one sensor."""

import numpy as np
import pytest

from idc_controller.estimation.health.innovation_monitor import Finding, InnovationMonitor
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.estimation.settings import InnovationMonitorSettings

KEYS = ((PAYLOAD, Position), (0, Position), (1, Position), (1, Attitude))
SIZES = np.array([6, 6, 6, 4])
GATE = 1.0 - 1e-6
REJECTIONS = InnovationMonitorSettings().rejections


def findings(samples, *, changed=lambda k, i, nu: nu, rejected=lambda k: ()):
    """Return sensor and finding with the time of its first report, after so many moments of normal innovations."""
    random, monitor, found = np.random.default_rng(5), InnovationMonitor(GATE), {}
    for k in range(samples):
        time = 0.04 * k
        nu = [changed(k, i, random.standard_normal(size)) for i, size in enumerate(SIZES)]
        monitor.learn(time, KEYS, SIZES, np.concatenate(nu), rejected(k))
        for key, names in monitor.findings(time).items():
            for name in names:
                found.setdefault((key, name), time)
    return found


def test_monitor_has_no_finding_for_consistent_innovations_and_single_rejections():
    single = [((0, Position),) if k % 15 == 0 else () for k in range(5000)]
    assert findings(5000, rejected=lambda k: single[k]) == {}


def test_monitor_has_no_finding_for_single_outliers():
    assert findings(2000, changed=lambda k, i, nu: nu + 1e6 * (i == 1 and k % 100 == 50)) == {}


def test_monitor_finds_repeated_rejections():
    found = findings(200, rejected=lambda k: [(1, Position)] if k >= 100 else ())
    assert found == {((1, Position), Finding.REJECTED): pytest.approx(0.04 * (100 + REJECTIONS - 1))}


def test_rejections_count_for_their_time_and_no_longer():
    settings = InnovationMonitorSettings()
    monitor, none = InnovationMonitor(GATE), np.zeros(SIZES.sum())
    times = np.linspace(0.0, 0.9 * settings.rejection_time, REJECTIONS)
    for time in times:
        monitor.learn(time, KEYS, SIZES, none, [(1, Position)])
    assert monitor.findings(times[-1]) == {(1, Position): [Finding.REJECTED]}
    assert monitor.findings(0.999 * settings.rejection_time) == {(1, Position): [Finding.REJECTED]}
    assert monitor.findings(1.001 * settings.rejection_time) == {}


@pytest.mark.parametrize("which", [0, 1])
def test_monitor_finds_bias_far_below_the_gate(which):
    push = np.array([0.0, 0.0, 1.5, 0.0, 0.0, 0.0])
    found = findings(300, changed=lambda k, i, nu: nu + push if i == which and k >= 100 else nu)
    assert {key for key, _ in found} == {KEYS[which]}
    assert 4.0 < found[KEYS[which], Finding.BIASED] < 6.5


def test_monitor_finds_noise_of_one_sensor():
    found = findings(300, changed=lambda k, i, nu: nu * (2.0 if i == 2 and k >= 100 else 1.0))
    assert {key for key, _ in found} == {KEYS[2]}
    assert 4.0 < found[KEYS[2], Finding.NOISY] < 6.0


@pytest.mark.parametrize("channel", [slice(0, 3), slice(3, 6)])
def test_noise_of_one_channel_is_not_diluted_by_the_other(channel):
    """The mean square of all rows, 1.8, would take 1.5 s on average to reach its limit of 1.6."""
    factor = np.ones(6)
    factor[channel] = 1.6
    random, delays = np.random.default_rng(7), []
    for _ in range(40):
        monitor = InnovationMonitor(GATE)
        for k in range(250):
            monitor.learn(0.04 * k, KEYS[:1], SIZES[:1], random.standard_normal(6) * (factor if k >= 50 else 1.0), ())
            if monitor.findings(0.04 * k):
                break
        delays.append(0.04 * (k - 49))
    assert min(delays) > 0.0 and np.mean(delays) < 1.2


def test_monitor_allows_attitudes_larger_innovations():
    assert findings(300, changed=lambda k, i, nu: nu * (1.5 if i == 3 else 1.0)) == {}
    assert (KEYS[3], Finding.NOISY) in findings(300, changed=lambda k, i, nu: nu * (3.0 if i == 3 else 1.0))


def test_monitor_forgets_attitudes_of_uavs_only():
    monitor = InnovationMonitor(GATE)
    for k in range(50):
        monitor.learn(0.04 * k, KEYS, SIZES, np.full(SIZES.sum(), 5.0), ())
    monitor.forget_attitudes()
    assert set(monitor.findings(2.0)) == set(KEYS[:3])


def test_monitor_treats_single_channel_by_itself():
    rng, monitor, key = np.random.default_rng(4), InnovationMonitor(GATE), (1, Position)
    for k in range(200):
        nu = rng.standard_normal(6) if k < 50 else rng.standard_normal(3) + (2.0 if k >= 100 else 0.0)
        monitor.learn(0.04 * k, [key], np.array([len(nu)]), nu, [])
        found = monitor.findings(0.04 * k)
        if k < 100:
            assert found == {}
    assert Finding.BIASED in found[key]


def test_monitor_counts_replayed_moment_once():
    monitor = InnovationMonitor(GATE)
    for k in range(2 * REJECTIONS):
        monitor.learn(0.1, KEYS[:1], SIZES[:1], np.zeros(6), [(PAYLOAD, Position)])
        assert monitor.findings(0.1 + 0.01 * k) == {}
