"""Association of clusters with obstacles, and the memory of which a vehicle's cluster number stands for."""

from itertools import product

import numpy as np
import pytest

from idc_controller.geometry.box import Wall
from idc_controller.geometry.sphere import Sphere
from idc_controller.perception.association import ClusterMemory, associate, gating_shape
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.settings import AssociationSettings

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


SETTINGS = AssociationSettings()


def best_by_trial(uavs, distances, gates, remembered):
    """Of all assignments within the gates, vehicle by vehicle, that with most clusters, then that of least cost."""
    result = [None] * len(uavs)
    for uav in set(uavs):
        rows = [row for row, of in enumerate(uavs) if of == uav]
        best = None
        for bodies in product([None, *range(distances.shape[1])], repeat=len(rows)):
            taken = [body for body in bodies if body is not None]
            if len(set(taken)) < len(taken):
                continue
            costs = []
            for row, body in zip(rows, bodies, strict=True):
                if body is None:
                    continue
                distance, gate, gain = distances[row, body], gates[body], 0.0
                if remembered[row] == body and distance < max(SETTINGS.remembered_gate, gate):
                    gate, gain = np.inf, SETTINGS.remembered_gain
                costs.append(distance - gain if distance < gate else np.inf)
            key = (-len(taken), sum(costs))
            if np.isfinite(key[1]) and (best is None or key < best[0]):
                best = key, bodies
        for row, body in zip(rows, best[1], strict=True):
            result[row] = body
    return result


def test_clusters_of_a_vehicle_are_the_nearest_different_bodies_within_their_gates():
    random = np.random.default_rng(5)
    for _ in range(60):
        uavs = random.integers(0, 2, 4).tolist()
        distances = random.uniform(0.0, 2.0, (4, 3))
        gates = random.choice([0.25, 0.9, 1.8], 3)
        remembered = [None if k == 3 else int(k) for k in random.integers(0, 4, 4)]
        clusters = [cluster(uav, number) for number, uav in enumerate(uavs)]
        found = associate(clusters, distances.copy(), gates, remembered, SETTINGS)
        assert found == best_by_trial(uavs, distances, gates, remembered)


def test_remembered_body_is_preferred_by_its_gain_and_kept_up_to_its_gate():
    def bodies(distances, remembered=0):
        return associate([cluster(0, 5)], np.array([distances]), np.array([0.4, 2.0]), [remembered], SETTINGS)

    gate, gain = SETTINGS.remembered_gate, SETTINGS.remembered_gain
    assert bodies([0.99 * gate, 9.0]) == [0] and bodies([1.01 * gate, 9.0]) == [None]
    assert bodies([0.3 + gain, 0.31]) == [0] and bodies([0.3 + gain, 0.29]) == [1]
    assert bodies([0.39, 9.0], None) == [0] and bodies([0.41, 9.0], None) == [None]
    assert bodies([9.0, 1.9], 1) == [1] and bodies([9.0, 2.0], 1) == [None]
    assert associate([cluster(0, 5)], np.empty((1, 0)), np.empty(0), [None], SETTINGS) == [None]


def test_wall_is_gated_as_wide_and_high_as_it_may_prove_to_be():
    wall = gating_shape(Wall((0.3, 2.0, 5.0), 0.7), 4.0)
    assert (tuple(wall.size), wall.yaw) == ((0.3, 6.0, 9.0), 0.7)
    ball = Sphere(0.5)
    assert gating_shape(ball, 4.0) is ball
