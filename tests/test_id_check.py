"""Whose data a vehicle tells, by where it says it is and where the vehicles are."""

import numpy as np
import pytest

from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.settings import IdCheckSettings
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

STEPS = IdCheckSettings.steps

PLACES = np.array([[0.7, 0.7, -5.0], [-0.7, 0.7, -5.0], [-0.7, -0.7, -5.0], [0.7, -0.7, -5.0]])
NONE = np.zeros(3)


def fly(id_check, whose, steps=2 * STEPS, off=0.0, silent=()):
    """Vehicle i tells the data of ``whose[i]``, with an error of ``off`` (m) to the north."""
    rng = np.random.default_rng(1)
    for k in range(steps):
        for i, actual in enumerate(whose):
            if i not in silent:
                position = PLACES[actual] + [off, 0.0, 0.0] + rng.normal(0.0, 0.02, 3)
                id_check.add(Position(0.1 * k, id_check.vehicle_of(i), position, NONE))
        id_check.add(Position(0.1 * k, PAYLOAD, PLACES[1], NONE))
        id_check.add(Attitude(0.1 * k, 0, np.array([1.0, 0.0, 0.0, 0.0]), NONE))
        id_check.compare([Position(0.1 * k, i, place, NONE) for i, place in enumerate(PLACES)])
    return id_check


@pytest.mark.parametrize("whose", [(0, 2, 1, 3), (3, 1, 2, 0), (1, 2, 0, 3), (1, 0, 3, 2)])
def test_mixed_up_vehicles_are_found_out_and_their_data_taken_for_whose_they_are(whose):
    id_check = fly(SystemIdCheck(4), whose)
    assert tuple(id_check.vehicle_of(i) for i in range(4)) == whose
    assert id_check.swapped == {i: actual for i, actual in enumerate(whose) if i != actual}


def test_so_is_the_end_of_it():
    id_check = fly(fly(SystemIdCheck(4), (0, 2, 1, 3)), (0, 1, 2, 3))
    assert not id_check.swapped


def test_it_must_last():
    id_check = fly(SystemIdCheck(4), (0, 2, 1, 3), steps=STEPS - 1)
    assert not id_check.swapped
    fly(id_check, (0, 1, 2, 3), steps=1)
    assert not fly(id_check, (0, 2, 1, 3), steps=STEPS - 1).swapped


@pytest.mark.parametrize(
    ("whose", "off", "silent"),
    [((0, 1, 2, 3), 1.4, ()), ((0, 2, 2, 3), 0.0, ()), ((0, 2, 1, 3), 0.0, (2,)), ((0, 1, 2, 3), np.nan, ())],
    ids=["all off by a whole place", "one tells the same as another", "the other is silent", "not a number"],
)
def test_what_is_otherwise_wrong_is_nobody_elses(whose, off, silent):
    assert not fly(SystemIdCheck(4), whose, off=off, silent=silent).swapped
