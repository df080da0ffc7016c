"""Whose data a vehicle tells, by where it says it is and where the vehicles are."""

import numpy as np
import pytest

from gcs.mavlink.id_check import STEPS, Identities
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

PLACES = np.array([[0.7, 0.7, -5.0], [-0.7, 0.7, -5.0], [-0.7, -0.7, -5.0], [0.7, -0.7, -5.0]])
NONE = np.zeros(3)


def fly(identities, whose, steps=2 * STEPS, off=0.0, silent=()):
    """Vehicle i tells the data of ``whose[i]``, with an error of ``off`` (m) to the north."""
    rng = np.random.default_rng(1)
    for k in range(steps):
        for i, actual in enumerate(whose):
            if i not in silent:
                position = PLACES[actual] + [off, 0.0, 0.0] + rng.normal(0.0, 0.02, 3)
                identities.told(Position(0.1 * k, identities.whose(i), position, NONE))
        identities.told(Position(0.1 * k, PAYLOAD, PLACES[1], NONE))
        identities.told(Attitude(0.1 * k, 0, np.array([1.0, 0.0, 0.0, 0.0]), NONE))
        identities.compare([Position(0.1 * k, i, place, NONE) for i, place in enumerate(PLACES)])
    return identities


@pytest.mark.parametrize("whose", [(0, 2, 1, 3), (3, 1, 2, 0), (1, 2, 0, 3), (1, 0, 3, 2)])
def test_mixed_up_vehicles_are_found_out_and_their_data_taken_for_whose_they_are(whose):
    identities = fly(Identities(4), whose)
    assert tuple(identities.whose(i) for i in range(4)) == whose
    assert identities.mixed_up == {i: actual for i, actual in enumerate(whose) if i != actual}


def test_so_is_the_end_of_it():
    identities = fly(fly(Identities(4), (0, 2, 1, 3)), (0, 1, 2, 3))
    assert not identities.mixed_up


def test_it_must_last():
    identities = fly(Identities(4), (0, 2, 1, 3), steps=STEPS - 1)
    assert not identities.mixed_up
    fly(identities, (0, 1, 2, 3), steps=1)
    assert not fly(identities, (0, 2, 1, 3), steps=STEPS - 1).mixed_up


@pytest.mark.parametrize(
    ("whose", "off", "silent"),
    [((0, 1, 2, 3), 1.4, ()), ((0, 2, 2, 3), 0.0, ()), ((0, 2, 1, 3), 0.0, (2,)), ((0, 1, 2, 3), np.nan, ())],
    ids=["all off by a whole place", "one tells the same as another", "the other is silent", "not a number"],
)
def test_what_is_otherwise_wrong_is_nobody_elses(whose, off, silent):
    assert not fly(Identities(4), whose, off=off, silent=silent).mixed_up
