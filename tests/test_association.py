"""Memory of which obstacle a vehicle's cluster number stands for: for how long, and under which name."""

import pytest
from idc_controller.perception.scan_assembly import Cluster

from idc_controller.perception.association import ClusterMemory

NUMBERS = [(0, 5), (1, 5), (0, 6)]


def cluster(uav, number):
    return Cluster(**{**dict.fromkeys(Cluster._fields), "uav": uav, "number": number})


@pytest.fixture
def memory():
    memory = ClusterMemory(2.0)
    memory.set(cluster(0, 5), "a", 100.0)
    memory.set(cluster(1, 5), "b", 101.0)
    return memory


def names(memory, time):
    return [memory.name(cluster(*number), time) for number in NUMBERS]


@pytest.mark.parametrize(
    ("time", "expected"),
    [(100.0, ["a", "b", ""]), (101.99, ["a", "b", ""]), (102.0, ["", "b", ""]), (103.0, ["", "", ""])],
)
def test_number_of_each_vehicle_has_its_name_for_the_duration(memory, time, expected):
    assert names(memory, time) == expected


def test_forgetting_removes_what_is_too_old_alone(memory):
    memory.forget(102.5)
    assert names(memory, 101.5) == ["", "b", ""]
    memory.forget(200.0)
    assert names(memory, 101.0) == ["", "", ""]


def test_merged_obstacle_takes_over_the_numbers_of_the_other_for_as_long_as_they_had(memory):
    memory.rename("a", "b")
    assert names(memory, 101.5) == ["b", "b", ""]
    assert names(memory, 102.5) == ["", "b", ""]
