"""Sensors that were refused for long, and how they are believed again."""

from copy import copy

import numpy as np
import pytest

from idc_controller.estimation.health.channel_isolation import AGREES_FOR, REFUSED_FOR, Distrust, Half
from idc_controller.estimation.measurement_model import Stack, _blocks
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

SOURCES = (PAYLOAD, 0, 1, 2, 3)


def stack_of(sources=SOURCES):
    keys = tuple((source, kind) for source in sources for kind in (Position, Attitude))
    m = 6 * len(keys)
    none = np.zeros(0, dtype=int)
    of_payload = np.repeat([source == PAYLOAD for source, _ in keys], 6)
    return Stack(
        keys, np.zeros((m, 1)), np.full(m, 0.01), *_blocks(np.full(len(keys), 6)), of_payload, uavs=none, heights=none
    )


STACK = stack_of()
ALL = np.ones(len(STACK.variance), dtype=bool)
VELOCITY_OF_1 = Half(1, Position, 1)


def rows_of(*halves):
    rows = ~ALL
    for half in halves:
        start = int(STACK.starts[STACK.keys.index((half.source, half.kind))]) + 3 * half.which
        rows[start : start + 3] = True
    return rows


def refused(*halves, times=REFUSED_FOR, distrust=None, contradicts=True):
    distrust = distrust or Distrust(4)
    for _ in range(times):
        distrust.learn(STACK, ALL, ~rows_of(*halves), lambda uav: contradicts)
    return distrust


def agree(distrust, size, times):
    residual = size * rows_of(VELOCITY_OF_1)
    for _ in range(times):
        distrust.reconsider(STACK, residual, np.zeros((len(ALL), 1)), np.zeros((1, 1)), 1.0)


def test_what_is_refused_for_long_is_left_out():
    distrust = refused(VELOCITY_OF_1, times=REFUSED_FOR - 1)
    assert distrust.halves == ()
    refused(VELOCITY_OF_1, times=1, distrust=distrust)
    assert distrust.halves == (VELOCITY_OF_1,)
    assert [Half(1, kind, which).channel for kind in (Position, Attitude) for which in (0, 1)] == [
        "position", "velocity", "attitude", "rates",
    ]  # fmt: skip
    assert (distrust.rows(STACK) == rows_of(VELOCITY_OF_1)).all()
    assert distrust.rows(stack_of((PAYLOAD, 0, 2, 3))).sum() == 0


def test_positions_and_velocities_that_agree_are_not_what_is_wrong():
    same = refused(VELOCITY_OF_1, Half(1, Position, 0), contradicts=False)
    assert same.halves == ()
    refused(VELOCITY_OF_1, times=1, distrust=same)
    assert same.halves == (VELOCITY_OF_1,)
    assert refused(Half(1, Attitude, 1), contradicts=False).halves == (Half(1, Attitude, 1),)


def test_what_is_accepted_counts_against_it():
    distrust = Distrust(4)
    for _ in range(3 * REFUSED_FOR):
        refused(VELOCITY_OF_1, times=1, distrust=distrust)
        refused(times=1, distrust=distrust)
    assert distrust.halves == ()


def test_neither_the_payload_unit_nor_most_of_the_vehicles():
    assert refused(Half(PAYLOAD, Position, 1)).halves == ()
    most = refused(VELOCITY_OF_1, Half(2, Attitude, 0), Half(3, Attitude, 0))
    assert set(most.halves) == {VELOCITY_OF_1, Half(2, Attitude, 0)}
    same = refused(VELOCITY_OF_1, Half(1, Position, 0))
    assert set(same.halves) == {VELOCITY_OF_1, Half(1, Position, 0)}
    assert (most.lost, same.lost) == ((), (1,))


@pytest.mark.parametrize(("size", "trusted"), [(0.1, True), (0.5, False)])
def test_it_is_trusted_again_when_it_has_agreed_for_long(size, trusted):
    distrust = refused(VELOCITY_OF_1)
    agree(distrust, size, AGREES_FOR - 1)
    assert distrust.halves == (VELOCITY_OF_1,)
    agree(distrust, size, 1)
    assert (distrust.halves == ()) is trusted


def test_one_disagreement_begins_the_wait_anew():
    distrust = refused(VELOCITY_OF_1)
    agree(distrust, 0.1, AGREES_FOR - 1)
    agree(distrust, 0.5, 1)
    agree(distrust, 0.1, AGREES_FOR - 1)
    assert distrust.halves == (VELOCITY_OF_1,)


def test_a_copy_learns_on_its_own():
    distrust = refused(VELOCITY_OF_1, times=REFUSED_FOR - 1)
    other = copy(distrust)
    refused(VELOCITY_OF_1, times=1, distrust=other)
    assert (len(distrust.halves), len(other.halves)) == (0, 1)
    again = copy(other)
    agree(again, 0.1, AGREES_FOR)
    assert (len(other.halves), len(again.halves)) == (1, 0)
