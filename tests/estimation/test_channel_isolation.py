"""Channel isolation: channels rejected for long are isolated, and restored when they are consistent again."""

import numpy as np
import pytest

from idc_controller.estimation.health.channel_isolation import ChannelIsolation
from idc_controller.estimation.kalman_filter import Innovation, SparseRows
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Channel, Position
from idc_controller.estimation.settings import ChannelIsolationSettings

SOURCES = (PAYLOAD, 0, 1, 2, 3)
SETTINGS = ChannelIsolationSettings()
REJECTIONS, ACCEPTANCES = SETTINGS.rejections, SETTINGS.acceptances


def stack_of(sources=SOURCES):
    keys = tuple((source, kind) for source in sources for kind in (Position, Attitude))
    sizes = np.full(len(keys), 6)
    of_payload = np.repeat([source == PAYLOAD for source, _ in keys], 6)
    return ObservationStack(keys, np.full(6 * len(keys), 0.01), sizes, np.cumsum(sizes) - sizes, of_payload)


STACK = stack_of()
ALL = np.ones(len(STACK.variance), dtype=bool)
POSITION_OF_1, VELOCITY_OF_1 = Channel(1, Position, 0), Channel(1, Position, 1)
RATES_OF_1 = Channel(1, Attitude, 1)


def rows_of(*channels):
    rows = ~ALL
    for channel in channels:
        start = int(STACK.starts[STACK.keys.index((channel.source, channel.kind))]) + 3 * channel.part
        rows[start : start + 3] = True
    return rows


def rejecting(*channels, times=REJECTIONS, isolation=None, inconsistent=True):
    isolation = isolation or ChannelIsolation(4)
    for _ in range(times):
        isolation.learn(STACK, ALL, ~rows_of(*channels), lambda uav: inconsistent)
    return isolation


def accept(isolation, residual, times):
    m = len(ALL)
    rows = SparseRows(np.zeros((m, 1), dtype=int), np.zeros((m, 1)))
    innovation = Innovation(rows, residual, np.zeros((m, m)))
    for _ in range(times):
        isolation.restore(STACK, innovation, 1.0)


def test_channel_is_isolated_after_rejections():
    isolation = rejecting(RATES_OF_1, times=REJECTIONS - 1)
    assert isolation.isolated == ()
    rejecting(RATES_OF_1, times=1, isolation=isolation)
    assert isolation.isolated == (RATES_OF_1,)
    assert [Channel(1, kind, which).name for kind in (Position, Attitude) for which in (0, 1)] == [
        "position", "velocity", "attitude", "rates",
    ]  # fmt: skip
    assert (isolation.rows(STACK) == rows_of(RATES_OF_1)).all()
    assert isolation.rows(stack_of((PAYLOAD, 0, 2, 3))).sum() == 0


def test_position_channels_are_not_isolated_when_consistent_with_each_other():
    same = rejecting(VELOCITY_OF_1, POSITION_OF_1, inconsistent=False)
    assert same.isolated == ()
    rejecting(VELOCITY_OF_1, times=1, isolation=same)
    assert set(same.isolated) == {POSITION_OF_1, VELOCITY_OF_1}
    assert rejecting(RATES_OF_1, inconsistent=False).isolated == (RATES_OF_1,)


@pytest.mark.parametrize("rejected", [POSITION_OF_1, VELOCITY_OF_1])
def test_position_and_velocity_that_contradict_each_other_are_isolated_until_one_is_consistent(rejected):
    """The state may follow the wrong one, as it did a velocity that drifted, and reject the right one."""
    isolation = rejecting(rejected)
    assert isolation.uavs_without_position == (1,)
    residual = np.zeros(len(ALL))
    residual[rows_of(VELOCITY_OF_1)] = 1.0
    accept(isolation, residual, ACCEPTANCES)
    assert isolation.isolated == (VELOCITY_OF_1,)


def test_both_position_and_velocity_are_isolated_of_one_vehicle_at_a_time():
    isolation = rejecting(POSITION_OF_1)
    rejecting(Channel(2, Position, 0), isolation=isolation)
    assert set(isolation.isolated) == {POSITION_OF_1, VELOCITY_OF_1, Channel(2, Position, 0)}
    rejecting(Channel(2, Position, 1), isolation=isolation)
    assert isolation.uavs_without_position == (1, 2)


def test_channel_is_not_isolated_when_acceptances_balance_rejections():
    isolation = ChannelIsolation(4)
    for _ in range(3 * REJECTIONS):
        rejecting(RATES_OF_1, times=1, isolation=isolation)
        rejecting(times=1, isolation=isolation)
    assert isolation.isolated == ()


def test_isolation_excludes_payload_unit_and_majority_of_vehicles():
    assert rejecting(Channel(PAYLOAD, Position, 1)).isolated == ()
    most = rejecting(RATES_OF_1, Channel(2, Attitude, 0), Channel(3, Attitude, 0))
    assert set(most.isolated) == {RATES_OF_1, Channel(2, Attitude, 0)}
    same = rejecting(VELOCITY_OF_1, POSITION_OF_1)
    assert set(same.isolated) == {VELOCITY_OF_1, POSITION_OF_1}
    assert (most.uavs_without_position, same.uavs_without_position) == ((), (1,))


@pytest.mark.parametrize(("size", "restored"), [(0.1, True), (0.5, False)])
def test_channel_is_restored_after_consistent_samples(size, restored):
    isolation = rejecting(RATES_OF_1)
    accept(isolation, size * rows_of(RATES_OF_1), ACCEPTANCES - 1)
    assert isolation.isolated == (RATES_OF_1,)
    accept(isolation, size * rows_of(RATES_OF_1), 1)
    assert (isolation.isolated == ()) is restored


def test_restoration_starts_anew_after_one_inconsistent_sample():
    isolation = rejecting(RATES_OF_1)
    accept(isolation, 0.1 * rows_of(RATES_OF_1), ACCEPTANCES - 1)
    accept(isolation, 0.5 * rows_of(RATES_OF_1), 1)
    accept(isolation, 0.1 * rows_of(RATES_OF_1), ACCEPTANCES - 1)
    assert isolation.isolated == (RATES_OF_1,)


def test_copy_of_isolation_is_independent():
    isolation = rejecting(RATES_OF_1, times=REJECTIONS - 1)
    other = isolation.copy()
    rejecting(RATES_OF_1, times=1, isolation=other)
    assert (len(isolation.isolated), len(other.isolated)) == (0, 1)
    again = other.copy()
    accept(again, 0.1 * rows_of(RATES_OF_1), ACCEPTANCES)
    assert (len(other.isolated), len(again.isolated)) == (1, 0)
