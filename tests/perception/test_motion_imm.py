"""IMM filter: against formulas in numpy, against exact motion, and errors against its own covariance."""

import numpy as np
import pytest
from scipy.linalg import expm

from idc_controller.perception.imm_kernels import advanced, predicted, updated
from idc_controller.perception.motion_imm import MotionImm, MotionModels

MODELS = MotionModels()
SIGMA = 0.03
VARIANCE = np.full(3, SIGMA**2)


def continuous(index):
    """A of x' = A x of the model with this index."""
    s = MODELS.settings
    if index == 0:
        return np.zeros((3, 3))
    if index == 1:
        return np.array([[0, 1, 0], [0, 0, 0], [0, 0, 0.0]])
    if index < 2 + len(s.singer_times):
        return np.array([[0, 1, 0], [0, 0, 1], [0, 0, -1 / s.singer_times[index - 2]]])
    omega = s.frequencies[index - 2 - len(s.singer_times)]
    return np.array([[0, 1, 0], [0, 0, 1], [0, -(omega**2), 0.0]])


@pytest.mark.parametrize("dt", [0.05, 0.1, 1.0, 3.0])
def test_transitions_are_matrix_exponentials(dt):
    F = MODELS.transition(np.array([dt]))[:, 0]
    for i in range(MODELS.count):
        expected = expm(continuous(i) * dt)
        # A model without velocity or acceleration forgets them.
        rows = 1 if i == 0 else 2 if i == 1 else 3
        np.testing.assert_allclose(F[i, :rows, :rows], expected[:rows, :rows], atol=1e-12)
        assert not F[i, rows:].any()


@pytest.mark.parametrize("dt", [0.1, 1.0])
def test_process_noise_is_its_integral(dt):
    Q = MODELS.noise(np.array([dt]))[:, 0]
    s = MODELS.settings
    strength = [
        0.0,
        0.0,
        *(2 * sigma**2 / tau for sigma, tau in zip(s.singer_accelerations, s.singer_times, strict=True)),
    ]
    strength += [(s.harmonic_walk * omega) ** 2 for omega in s.frequencies]
    t = np.linspace(0.0, dt, 2001)
    for i in range(2, MODELS.count):
        kernel = MODELS.transition(t)[i, :, :, 2]
        exact = np.trapezoid(kernel[:, :, None] * kernel[:, None, :], t, axis=0) * strength[i]
        np.testing.assert_allclose(Q[i], exact, rtol=0.02, atol=0.02 * exact.max())
    # A place and a velocity that walk at random.
    np.testing.assert_allclose(Q[0], s.static_walk**2 * dt * np.diag([1.0, 0.0, 0.0]))
    expected = s.velocity_walk**2 * np.array([[dt**3 / 3, dt**2 / 2, 0.0], [dt**2 / 2, dt, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(Q[1], expected)
    for i in range(MODELS.count):
        assert np.linalg.eigvalsh(Q[i]).min() > -1e-15


def followed(motion, seed=0, until=8.0, each=lambda imm: None):
    imm = None
    rng = np.random.default_rng(seed)
    for k in range(round(until * 10)):
        t = 0.1 * k
        z = motion(t) + rng.normal(0.0, SIGMA, 3)
        if imm is None:
            imm = MotionImm(MODELS, t, z, VARIANCE)
        else:
            imm.advance(t)
            imm.update(z, VARIANCE)
        each(imm)
    return imm


def harmonic(frequency):
    """Return the index of the model with that angular frequency."""
    s = MODELS.settings
    return 2 + len(s.singer_times) + s.frequencies.index(frequency)


@pytest.mark.parametrize(
    ("motion", "likely"),
    [
        (lambda t: np.zeros(3), 0),
        (lambda t: np.array([1.2 * t, -0.8 * t, 0.2 * t]), 1),
        (lambda t: np.array([1.5 * np.sin(t), 0.0, 0.0]), harmonic(1.0)),
        (lambda t: np.array([0.0, 1.0 * np.sin(2.0 * t), 0.3]), harmonic(2.0)),
        (lambda t: np.array([1.4 * np.cos(1.4 * t), 1.4 * np.sin(1.4 * t), 0.0]), harmonic(1.4)),
    ],
)
def test_true_model_is_most_probable_and_predicts(motion, likely):
    errors = []

    def watch(imm):
        if imm.time > 4.0:
            times = imm.time + np.array([0.0, 1.0])
            errors.append(imm.predict(times)[0] - [motion(t) for t in times])

    imm = followed(motion, each=watch)
    assert int(np.argmax(imm.weight)) == likely
    times = imm.time + np.array([0.0, 0.5, 1.0])
    _, covariance = imm.predict(times)
    now, ahead = np.sqrt(np.mean(np.sum(np.square(errors), axis=2), axis=0))
    assert now < 0.05
    assert ahead < 0.2
    assert np.all(np.linalg.eigvalsh(covariance) > 0.0)
    assert np.all(np.diff(np.trace(covariance, axis1=1, axis2=2)) > 0.0)


def test_update_leaves_unmeasured_axis_unchanged():
    imm = followed(lambda t: np.array([t, 0.0, 0.0]), until=2.0)
    before = imm.x[:, 1].copy()
    off = imm.update(np.array([1.9, np.nan, 0.0]), VARIANCE)
    np.testing.assert_array_equal(imm.x[:, 1], before)
    assert np.isfinite(off)


def test_returned_innovation_is_normalised():
    near, far = (followed(lambda t: np.array([t, 0.0, 0.0]), until=2.0) for _ in range(2))
    ahead = near.time + 0.1
    for imm in (near, far):
        imm.advance(ahead)
    spread = np.sqrt(near.position_variance + VARIANCE)
    expected = near.state[0]
    assert near.update(expected, VARIANCE) == pytest.approx(0.0, abs=1e-12)
    assert far.update(expected + 3.0 * spread, VARIANCE) == pytest.approx(9.0)


def advanced_in_numpy(weight, x, P, F, Q, change):
    """Mixing of Blom and Bar-Shalom (1988), then the prediction of every model."""
    m = len(weight)
    to = weight[:, None] * (np.eye(m) * (1.0 - change - change / (m - 1)) + change / (m - 1))
    share = to / to.sum(axis=0)
    mean = np.einsum("ij,iak->jak", share, x)
    second = np.einsum("ij,iakl->jakl", share, P + x[..., :, None] * x[..., None, :])
    P = second - mean[..., :, None] * mean[..., None, :]
    return to.sum(axis=0), np.einsum("mij,maj->mai", F, mean), np.einsum("mij,majk,mlk->mail", F, P, F) + Q[:, None]


def updated_in_numpy(weight, x, P, position, variance):
    measured = np.isfinite(position)
    S = P[:, :, 0, 0] + variance
    expected = weight @ x[:, :, 0]
    spread = weight @ (P[:, :, 0, 0] + (x[:, :, 0] - expected) ** 2)
    y = np.where(measured, position - x[:, :, 0], 0.0)
    likelihood = (-0.5 * (y**2 / S + np.log(2.0 * np.pi * S)) * measured).sum(axis=1)
    K = P[:, :, :, 0] / S[..., None] * measured[:, None]
    weight = weight * np.exp(np.maximum(likelihood - likelihood.max(), -50.0))
    weight = np.maximum(weight, 1e-6 * weight.sum())
    squared = np.mean((position - expected)[measured] ** 2 / (spread + variance)[measured])
    return weight / weight.sum(), x + K * y[..., None], P - K[..., :, None] * P[:, :, None, 0, :], squared


def predicted_in_numpy(weight, x, P, F, Q):
    f = F[:, :, 0]
    means = np.einsum("mkj,maj->mka", f, x)
    variances = np.einsum("mki,maij,mkj->mka", f, P, f) + Q[:, :, 0, 0, None]
    mean = np.einsum("m,mka->ka", weight, means)
    apart = means - mean
    covariance = np.einsum("m,mka,mkb->kab", weight, apart, apart)
    return mean, covariance + np.einsum("m,mka->ka", weight, variances)[:, :, None] * np.eye(3)


def test_mixing_loses_no_covariance_far_from_home():
    rng = np.random.default_rng(7)
    imm = followed(lambda t: np.array([np.sin(t), 0.3 * t, -5.0]), until=2.0)
    far = imm.x.copy()
    far[:, :, 0] += np.array([2.0e5, -3.0e5, 1.0e5]) + np.round(rng.normal(0.0, 50.0, 3))
    _, _, P = advanced(imm.weight, imm.x, imm.P, *MODELS.step(0.1), 0.01)
    _, _, P_far = advanced(imm.weight, far, imm.P, *MODELS.step(0.1), 0.01)
    np.testing.assert_allclose(P_far, P, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_kernels_agree_with_formulas_in_numpy(seed):
    rng = np.random.default_rng(seed)
    imm = followed(lambda t: np.array([np.sin(t), 0.3 * t, -5.0]), seed, until=1.0 + seed)
    for dt in (0.01, 0.1, 1.0):
        step = (*MODELS.step(dt), 0.1 * dt)
        state = imm.weight, imm.x, imm.P
        for ours, theirs in zip(advanced(*state, *step), advanced_in_numpy(*state, *step), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12)
        position = imm.state[0] + rng.normal(0.0, 0.1, 3)
        position[seed % 3] = np.nan if seed else position[0]
        for ours, theirs in zip(
            updated(*state, position, VARIANCE), updated_in_numpy(*state, position, VARIANCE), strict=True
        ):
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12)
        ahead = MODELS.horizon(np.linspace(0.0, 5.0 * dt, 8))
        for ours, theirs in zip(predicted(*state, *ahead), predicted_in_numpy(*state, *ahead), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-12)
