"""Association of clusters with obstacles: the nearest different bodies of each vehicle's clusters."""

from itertools import product
from types import SimpleNamespace

import numpy as np

from idc_controller.geometry.shapes import Sphere, Wall
from idc_controller.perception.clusters import associate, gating_shape


def cluster(uav):
    return SimpleNamespace(uav=uav)


def best_by_trial(uavs, distances, gates):
    """Of all assignments within the gates, vehicle by vehicle, that with most clusters, then that of least cost."""
    result = [None] * len(uavs)
    for uav in set(uavs):
        rows = [row for row, of in enumerate(uavs) if of == uav]
        best = None
        for bodies in product([None, *range(distances.shape[1])], repeat=len(rows)):
            taken = [body for body in bodies if body is not None]
            if len(set(taken)) < len(taken):
                continue
            pairs = [(row, body) for row, body in zip(rows, bodies, strict=True) if body is not None]
            cost = sum(distances[row, body] if distances[row, body] < gates[body] else np.inf for row, body in pairs)
            key = (-len(taken), cost)
            if np.isfinite(cost) and (best is None or key < best[0]):
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
        found = associate([cluster(uav) for uav in uavs], distances.copy(), gates)
        assert found == best_by_trial(uavs, distances, gates)


def test_gate_of_each_body_is_its_own():
    def bodies(distances):
        return associate([cluster(0)], np.array([distances]), np.array([0.4, 2.0]))

    assert bodies([0.39, 9.0]) == [0] and bodies([0.41, 9.0]) == [None]
    assert bodies([9.0, 1.9]) == [1] and bodies([9.0, 2.0]) == [None]
    assert associate([cluster(0)], np.empty((1, 0)), np.empty(0)) == [None]


def test_wall_is_gated_as_wide_and_high_as_it_may_prove_to_be():
    wall = gating_shape(Wall((0.3, 2.0, 5.0), 0.7), 4.0)
    assert (tuple(wall.size), wall.yaw) == ((0.3, 6.0, 9.0), 0.7)
    ball = Sphere(0.5)
    assert gating_shape(ball, 4.0) is ball
