"""Kernels of perception against the formulas in numpy: fit of round shapes, points placed in the world."""

import numpy as np
import pytest

from idc_controller.perception.scan_kernels import placed_points
from idc_controller.perception.settings import SurfaceSettings
from idc_controller.perception.surfaces.points import score, unexplained
from idc_controller.perception.surfaces.round_kernels import fitted_round
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion

S = SurfaceSettings()


def residuals(points, rays, theta, noise, own_variance, scatter):
    """Distance to the surface (n,), its derivatives by theta (n, axes + 1), its variance (n,)."""
    d = points - theta[:-1]
    distance = np.maximum(np.linalg.norm(d, axis=1), 1e-3)
    normal = d / distance[:, None]
    variance = (noise * np.einsum("ij,ij->i", normal, rays)) ** 2 + own_variance
    residual = distance - theta[-1] - 0.5 * (len(theta) - 2) * scatter / theta[-1]
    of_radius = np.full(len(points), -1.0)
    if scatter > 0.0:
        rays = rays / np.maximum(np.linalg.norm(rays, axis=1), 1e-6)[:, None]
        along = np.einsum("ij,ij->i", d, rays)
        across = d - along[:, None] * rays
        width = np.maximum(np.linalg.norm(across, axis=1), 1e-3)
        out = width - theta[-1]
        rim = np.maximum(np.hypot(along, out), 1e-3)
        behind = along > 0.0
        residual = np.where(behind, rim, residual)
        of_rim = (along[:, None] * rays + (out / width)[:, None] * across) / rim[:, None]
        normal = np.where(behind[:, None], of_rim, normal)
        of_radius = np.where(behind, -out / rim, of_radius)
    return residual, np.column_stack([-normal, of_radius]), variance


def fitted_in_numpy(points, origins, own_variance, mean, prior, noise, scatter, low, high, iterations, free):
    axes, is_pole, theta = len(mean) - 1, len(mean) == 3, mean.copy()
    rays = points - origins
    rays = (rays / np.linalg.norm(rays, axis=1)[:, None])[:, :axes]

    def on_side():
        return residual >= -S.pole_end_depth - S.pole_end_share * theta[-1]

    for _ in range(iterations):
        residual, H, variance = residuals(points[:, :axes], rays, theta, noise, own_variance, scatter)
        weight = 1.0 / (variance * (1.0 + residual**2 / (9.0 * np.maximum(variance, 0.0025))))
        if is_pole:
            weight[~on_side()] = 0.0
        information = (H.T * weight) @ H + np.diag(prior)
        step = np.linalg.solve(information, prior * (mean - theta) - (H.T * weight) @ residual)
        theta = theta + step
        theta[-1] = np.clip(theta[-1], low, high)
        if np.abs(step).max() < 0.004:
            break
    residual, _, variance = residuals(points[:, :axes], rays, theta, noise, own_variance, scatter)
    if is_pole:
        residual = np.where(on_side(), residual, np.minimum(-residual, points[:, 2] - points[:, 2].min()))
    variances = np.diag(np.linalg.inv(information))
    return theta, variances, score(residual, variance), unexplained(residual, variance, free)


@pytest.mark.parametrize("scatter", [0.0, 0.02])
@pytest.mark.parametrize("axes", [2, 3], ids=["pole", "sphere"])
@pytest.mark.parametrize("seed", range(15))
def test_fit_of_kernel_agrees_with_fit_in_numpy(seed, axes, scatter):
    rng = np.random.default_rng(seed)
    n, centre = rng.integers(1, 30), np.array([*rng.normal(0.0, 3.0, 2), -5.0])
    origins = centre + 4.0 * rng.normal(size=(n, 3))
    surface = rng.normal(size=(n, 3))
    points = centre + 0.5 * surface / np.linalg.norm(surface, axis=1)[:, None] + rng.normal(0.0, 0.05, (n, 3))
    own_variance = np.full(n, 4e-4) + scatter + S.model_sigma**2
    mean, prior = np.append(centre[:axes] + rng.normal(0.0, 0.2, axes), 0.6), np.array([0.25] * axes + [8.0])
    shared = (points, origins, own_variance, mean, prior, 0.05, scatter, 0.05, 1.6)
    ours = fitted_round(*shared, S.pole_end_depth, S.pole_end_share, 4, axes + 1, 0.004)
    theirs = fitted_in_numpy(*shared, 4, axes + 1)
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-9)


def test_points_are_placed_by_the_pose_of_their_vehicle():
    rng = np.random.default_rng(1)
    body, position = rng.normal(0.0, 5.0, (20, 3)), rng.normal(size=3)
    quaternion = quaternion_from_euler(0.1, -0.2, 2.0)
    rotation = rotation_from_quaternion(quaternion)
    world, cut, variance = placed_points(body, position, quaternion, 8.0, 0.02, 0.003)
    distance = np.linalg.norm(body, axis=1)
    np.testing.assert_allclose(world, position + body @ rotation.T, atol=1e-12)
    np.testing.assert_array_equal(cut, distance > 8.0)
    np.testing.assert_allclose(variance, 0.02**2 + (0.003 * distance) ** 2)
