"""System-id check: id swaps found by reported positions and estimated positions of the vehicles."""

import numpy as np
import pytest

from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.settings import IdCheckSettings
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position

STEPS = IdCheckSettings.steps

PLACES = np.array([[0.7, 0.7, -5.0], [-0.7, 0.7, -5.0], [-0.7, -0.7, -5.0], [0.7, -0.7, -5.0]])
NONE = np.zeros(3)


def fly(id_check, sources, steps=2 * STEPS, off=0.0, missing=()):
    """Let vehicle i report the data of ``sources[i]``, with an error of ``off`` (m) to the north."""
    rng = np.random.default_rng(1)
    for k in range(steps):
        for i, actual in enumerate(sources):
            if i not in missing:
                position = PLACES[actual] + [off, 0.0, 0.0] + rng.normal(0.0, 0.02, 3)
                id_check.add(Position(0.1 * k, id_check.vehicle_of(i), position, NONE))
        id_check.add(Position(0.1 * k, PAYLOAD, PLACES[1], NONE))
        id_check.add(Attitude(0.1 * k, 0, np.array([1.0, 0.0, 0.0, 0.0]), NONE))
        id_check.compare(PLACES)
    return id_check


@pytest.mark.parametrize("sources", [(0, 2, 1, 3), (3, 1, 2, 0), (1, 2, 0, 3), (1, 0, 3, 2)])
def test_id_swap_is_detected_and_samples_are_assigned_to_true_vehicle(sources):
    id_check = fly(SystemIdCheck(4), sources)
    assert tuple(id_check.vehicle_of(i) for i in range(4)) == sources
    assert id_check.swapped == {i: actual for i, actual in enumerate(sources) if i != actual}


def test_end_of_id_swap_is_detected():
    id_check = fly(fly(SystemIdCheck(4), (0, 2, 1, 3)), (0, 1, 2, 3))
    assert not id_check.swapped


def test_id_swap_shorter_than_window_is_not_detected():
    id_check = fly(SystemIdCheck(4), (0, 2, 1, 3), steps=STEPS - 1)
    assert not id_check.swapped
    fly(id_check, (0, 1, 2, 3), steps=1)
    assert not fly(id_check, (0, 2, 1, 3), steps=STEPS - 1).swapped


@pytest.mark.parametrize(
    ("sources", "off", "missing"),
    [((0, 1, 2, 3), 1.4, ()), ((0, 2, 2, 3), 0.0, ()), ((0, 2, 1, 3), 0.0, (2,)), ((0, 1, 2, 3), np.nan, ())],
    ids=[
        "all biased by the spacing",
        "two vehicles at one position",
        "one vehicle of the pair missing",
        "not a number",
    ],
)
def test_other_position_errors_are_no_id_swap(sources, off, missing):
    assert not fly(SystemIdCheck(4), sources, off=off, missing=missing).swapped
