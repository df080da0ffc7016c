"""Kalman filter: blocks, one row after the other, sparse rows and compiled kernels against filterpy and plain numpy."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from flights import MISSIONS
from paper_system import system
from plain_flatness import Wave
from scipy.linalg import expm
from scipy.stats import chi2

from gcs.config import read_system
from gcs.config.flight_settings import DEFAULTS
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.health.chi_squared import lower_quantile, upper_quantile
from idc_controller.estimation.kalman_filter import Innovation, SparseRows, StructuredKalmanFilter
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import PAYLOAD, Attitude, MeasurementNoise, Position
from idc_controller.estimation.process_model import ProcessModel
from idc_controller.estimation.propagation_kernels import about_reference
from idc_controller.estimation.settings import EstimatorSettings, ProcessNoiseSettings
from idc_controller.estimation.update_kernels import gated, mean_products
from idc_controller.model.drag import AIR_DENSITY, drag_coefficients, payload_drag
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import euler_from_quaternion, rotation_from_quaternion
from idc_controller.trajectory.flatness import Load, flat_reference

N_STATES = 30
INTERVALS = (1, 800, 20_000, 37_001, 99_999, 300_000)  # us


def positive_definite(rng, n):
    factor = rng.standard_normal((n, n))
    return factor @ factor.T + 0.1 * np.eye(n)


def sparse_rows(rng, m, n):
    columns = np.argsort(rng.random((m, n)), axis=1)[:, :5].copy()
    return SparseRows(columns, rng.standard_normal((m, 5)) * (rng.random((m, 5)) < 0.7))


def both(rng, P):
    compiled, plain = (of(dim_x=len(P), dim_z=1) for of in (StructuredKalmanFilter, KalmanFilter))
    compiled.x = plain.x = rng.standard_normal(len(P))
    compiled.P, plain.P = P.copy(), P.copy()
    return compiled, plain


def corrected(seed, P, variance):
    """Correct both filters by measurements with ``variance``; return them and the normalised innovation squared."""
    rng, m = np.random.default_rng(seed), len(variance)
    compiled, plain = both(rng, P)
    rows, y = sparse_rows(rng, m, len(P)), rng.standard_normal(m)
    H = rows.dense(len(P))
    squared = compiled.correct(Innovation(rows, y - H @ compiled.x, H @ P @ H.T), variance)
    plain.update(y, R=np.diag(variance), H=H)
    assert squared == pytest.approx(plain.y @ plain.SI @ plain.y, rel=1e-10)
    return compiled, plain


@pytest.mark.parametrize("seed", range(20))
def test_correction_by_one_row_after_the_other_equals_filterpys_update(seed):
    rng = np.random.default_rng(seed)
    variance = 10.0 ** rng.uniform(-2.0, 1.0, rng.integers(1, 25))
    compiled, plain = corrected(seed, positive_definite(rng, N_STATES), variance)
    assert compiled.x == pytest.approx(plain.x, rel=1e-11, abs=1e-11)
    assert np.allclose(compiled.P, plain.P, rtol=1e-11, atol=1e-11)
    assert (compiled.P == compiled.P.T).all()


@pytest.mark.parametrize("seed", range(5))
def test_correction_that_cancels_a_variance_takes_josephs_form(seed):
    compiled, plain = corrected(seed, 1e4 * np.eye(N_STATES), np.full(3, 1e-9))
    assert np.allclose(compiled.P, (plain.P + plain.P.T) / 2, rtol=1e-9, atol=1e-12)
    assert np.linalg.eigvalsh(compiled.P)[0] > 0.0


def test_correction_without_positive_definite_covariance_is_filterpys():
    compiled, plain = corrected(1, -np.eye(N_STATES), np.full(3, 0.1))
    assert compiled.x == pytest.approx(plain.x)


def van_loan(process, densities, interval_us, force_scale):
    """Integrate the process noise by one matrix exponential (Van Loan 1978)."""
    p, layout, m, g = densities, process.layout, process.size, process.model.parameters.g
    sigma, A = np.zeros(m), np.zeros((m, m))
    sigma[layout.v_0], sigma[layout.omega] = p.payload_acceleration, p.payload_angular_acceleration
    sigma[layout.s_dot], sigma[layout.n_acc], sigma[layout.f] = p.link_acceleration, p.uav_jerk, p.thrust
    sigma[process.mass] = p.mass
    density, n = np.diag(sigma**2), layout.size
    density[process.uav_force, process.uav_force] = process.uav_forces(force_scale * p.uav_force, 0.0)
    wind = np.zeros((m, 3))  # of one newton on the payload
    wind[process.force] = np.eye(3)
    wind[process.uav_force, :2] = process.drag_share * np.tile(np.eye(2), (layout.number_of_uavs, 1))
    density += (force_scale * p.force) ** 2 * wind @ wind.T
    A[:n, :n], A[:n, process.forces] = process.model.A, process.model.B_d
    A[:n, process.mass] = process.model.B_d[:, 2] * g
    big = expm(np.block([[-A, density], [np.zeros((m, m)), A.T]]) * interval_us * 1e-6)
    return big[m:, m:].T @ big[:m, m:]


@pytest.mark.parametrize(
    ("vehicles", "interval_us"),
    [
        *itertools.product((3, 4), INTERVALS),
        (12, INTERVALS[-1]),
        *(pytest.param(12, interval, marks=pytest.mark.long) for interval in INTERVALS[:-1]),
    ],
)
def test_integrated_process_noise_equals_that_by_a_matrix_exponential(vehicles, interval_us):
    model = LinearModel(read_system(MISSIONS / "system.toml").with_vehicles(vehicles).parameters())
    densities = ProcessNoiseSettings()
    process = ProcessModel(model, densities)
    for force_scale in (1.0, 7.0):
        expected = van_loan(process, densities, interval_us, force_scale)
        found = process.noise(interval_us, force_scale)
        sigma = np.sqrt(np.diag(expected))
        assert (np.abs(found - expected) <= 1e-12 * np.outer(sigma, sigma)).all()


@pytest.mark.parametrize("vehicles", [3, 4, 6])
@pytest.mark.parametrize("is_changed", [True, False])
def test_propagation_by_blocks_equals_filterpys_prediction(vehicles, is_changed):
    model = LinearModel(read_system(MISSIONS / "system.toml").with_vehicles(vehicles).parameters())
    process, rng = ProcessModel(model, ProcessNoiseSettings()), np.random.default_rng(vehicles)
    compiled, plain = both(rng, positive_definite(rng, process.size))
    transition, Q = process.transition(37_000), process.noise(37_000, 5.0)
    direction = process.force_of_mass(np.array([0.5, -1.0, 2.0]))
    F = transition.F(direction)
    A_k, B_k, B_dk = model.discretised(37_000)
    n, B = len(A_k), transition.B
    assert (F[:n, :n] == A_k).all()
    assert (F[:n, process.forces] == B_dk).all()
    assert F[:n, process.mass] == pytest.approx(B_dk[:, :3] @ [-0.5, 1.0, model.parameters.g - 2.0])
    assert (F[n:, n:] == np.eye(process.size - n)).all()
    assert (B[:n] == B_k).all()
    u, change, probability = rng.standard_normal(3 * vehicles), rng.standard_normal(3 * vehicles), rng.random(vehicles)
    alone = transition.state(compiled.x, direction, u)
    compiled.propagate(transition, direction, u, Q, change if is_changed else np.zeros(0), probability)
    assert (alone == compiled.x).all()
    # The tilts of one vehicle are lost together, its thrust by itself.
    error = is_changed * B * (change * np.sqrt(np.concatenate([np.repeat(probability, 2), probability])))
    tilts, thrusts = error[:, : 2 * vehicles], error[:, 2 * vehicles :]
    lost = np.hstack([tilts[:, ::2] + tilts[:, 1::2], thrusts])
    plain.predict(u=u, F=F, B=B, Q=Q + lost @ lost.T)
    assert np.allclose(compiled.x, plain.x, rtol=1e-12, atol=1e-12)
    assert np.allclose(compiled.P, plain.P, rtol=1e-12, atol=1e-12)
    assert (compiled.P == compiled.P.T).all()


@pytest.mark.parametrize("interval_us", [250_000, 1_000_000, 5_000_000])
@pytest.mark.parametrize("time_constant", [0.02, 0.05, 0.15, 0.3, 0.5])
@pytest.mark.parametrize("is_slow", [False, True], ids=["loop_of_system_file", "loop_as_slow_as_the_motors"])
def test_propagation_by_blocks_equals_dense_product_for_slow_motors_and_long_intervals(
    is_slow, time_constant, interval_us
):
    parameters = replace(system(3), motor_time_constant=time_constant)
    if is_slow:
        parameters = replace(parameters, attitude_kp=0.1 / time_constant**2, attitude_kd=0.8 / time_constant)
    model = LinearModel(parameters)
    process, rng = ProcessModel(model, ProcessNoiseSettings()), np.random.default_rng(interval_us)
    compiled, plain = both(rng, positive_definite(rng, process.size))
    A_k, B_k, B_dk = model.discretised(interval_us)
    n, F, B = len(A_k), np.eye(process.size), np.zeros((process.size, 9))
    F[:n, :n], F[:n, process.forces], F[:n, process.mass], B[:n] = A_k, B_dk, B_dk[:, 2] * parameters.g, B_k
    u, Q, hovering = rng.standard_normal(9), positive_definite(rng, process.size), process.force_of_mass(np.zeros(3))
    compiled.propagate(process.transition(interval_us), hovering, u, Q, np.zeros(0), np.zeros(3))
    plain.predict(u=u, F=F, B=B, Q=Q)
    scale = np.sqrt(np.diag(plain.P))
    assert (np.abs(compiled.x - plain.x) <= 1e-10 * scale).all()
    assert (np.abs(compiled.P - plain.P) <= 1e-10 * np.outer(scale, scale)).all()


def plain_gate(residual, covariance, variance, starts, sizes, limits):
    covariance = covariance + np.diag(variance)
    normalised, mean_squares, accepted, rows = [], [], [], np.zeros(len(residual), dtype=bool)
    ratios = []

    def squared(part):
        return residual[part] @ np.linalg.solve(covariance[part, part], residual[part])

    for first, size in zip(starts, sizes, strict=True):
        part = slice(first, first + size)
        normalised.append(np.linalg.solve(np.linalg.cholesky(covariance[part, part]), residual[part]))
        mean_squares.append(squared(part) / size)
        accepted.append(squared(part) <= limits[size])
        rows[part] = accepted[-1]
        ratios.append([squared(part) / limits[size]] * 2)
        if size > 3:
            halves = slice(first, first + size // 2), slice(first + size // 2, first + size)
            ratios[-1] = [min(squared(half) / limits[size // 2], ratios[-1][0]) for half in halves]
            for half in halves if not accepted[-1] else ():
                rows[half] = squared(half) <= limits[size // 2]
    return np.concatenate(normalised), np.array(mean_squares), np.array(accepted), rows, np.array(ratios)


@pytest.mark.parametrize("seed", range(20))
def test_compiled_gate_equals_plain_one(seed):
    rng = np.random.default_rng(seed)
    sizes = rng.choice([2, 3, 4, 6], 8)
    starts, m = np.cumsum(sizes) - sizes, int(sizes.sum())
    residual = rng.standard_normal(m) * 10.0 ** rng.uniform(0.0, 1.5, m)
    arguments = (
        residual,
        positive_definite(rng, m),
        rng.uniform(0.1, 1.0, m),
        starts,
        sizes,
        lower_quantile(0.9, range(7)),
    )
    compiled, plain = gated(*arguments), plain_gate(*arguments)
    for ours, theirs in zip(compiled[:2], plain[:2], strict=True):
        assert ours == pytest.approx(theirs, rel=1e-10)
    assert all((ours == theirs).all() for ours, theirs in zip(compiled[2:4], plain[2:4], strict=True))
    assert compiled[4] == pytest.approx(plain[4], rel=1e-10)
    assert 0 < compiled[3].sum() < m
    channels = (compiled[4] > 1.0).tolist()
    parts = [(first, first + size // 2 if size > 3 else first) for first, size in zip(starts, sizes, strict=True)]
    assert channels == [[not compiled[3][row] for row in rows] for rows in parts]


def test_gate_rejects_measurement_without_covariance_and_accepts_others():
    covariance, limits = np.diag([np.nan] * 6 + [-2.0] * 6 + [1.0] * 6), lower_quantile(0.999, range(7))
    starts, sizes = np.array([0, 6, 12]), np.full(3, 6)
    normalised, mean_squares, accepted, rows, ratios = gated(
        np.zeros(18), covariance, np.full(18, 0.1), starts, sizes, limits
    )
    assert ratios.tolist() == [[np.inf, np.inf], [np.inf, np.inf], [0.0, 0.0]]
    assert accepted.tolist() == [False, False, True]
    assert rows.tolist() == [False] * 12 + [True] * 6
    assert mean_squares.tolist() == [np.inf, np.inf, 0.0]
    assert np.isinf(normalised[:12]).all()


@pytest.mark.parametrize("vehicles", [3, 4, 6])
def test_compiled_innovation_and_its_subset_equal_plain_ones(vehicles):
    parameters = read_system(MISSIONS / "system.toml").with_vehicles(vehicles).parameters()
    model = Estimator(LinearModel(parameters)).measurement_model
    flat = flat_reference(parameters, Wave(), np.array([1.0, 2.0]), Load(parameters.m_0, np.zeros(3)))
    rng, x, layout = np.random.default_rng(vehicles), flat.x[1], model.layout
    samples, expected = [], []
    for source in (2, PAYLOAD, 0):
        turn, values = rng.standard_normal(4), rng.standard_normal((3, 3))
        turn /= np.linalg.norm(turn)
        samples += [Attitude(2.0, source, turn, values[0]), Position(2.0, source, values[1], values[2])]
        position, velocity = flat.payload[:2, 1]
        if source == PAYLOAD:
            expected += [euler_from_quaternion(turn), values[0]]
        else:
            R, of = rotation_from_quaternion(turn), slice(2 * source, 2 * source + 2)
            expected += [
                -R[:2, 2] - x[layout.n][of],
                -(R @ np.cross(values[0], [0.0, 0.0, 1.0]))[:2] - x[layout.n_dot][of],
            ]
            position = position + parameters.p[source] - parameters.l[source] * flat.links.q[1]
            velocity = velocity - parameters.l[source] * flat.links.q_dot[1]
        expected += [values[1] - position, values[2] - velocity]
    samples[-1] = samples[-1].without(pose=True, motion=False)
    expected[-2] = np.full(3, np.nan)
    observation = model.observation(tuple((sample.source, type(sample)) for sample in samples))
    stacked = observation.samples(samples)
    stacked.values.flags.writeable = False
    error, P = rng.standard_normal(layout.size), positive_definite(rng, layout.size)
    innovation = model.innovation(observation, stacked, flat, 1, error, P)
    upright, tilted, n = observation.rows.dense(layout.size), innovation.rows.dense(layout.size), layout.s.start
    for source, height in zip(observation.uavs, observation.heights, strict=True):
        slope, at = parameters.l[source] * flat.links.q[1, :2] / flat.links.q[1, 2], n + 2 * source
        upright[height, at : at + 2] = upright[height + 3, at + 2 * vehicles : at + 2 * vehicles + 2] = slope
    assert tilted == pytest.approx(upright, rel=1e-14)
    sizes, m = observation.stack.sizes, len(tilted)
    number = np.repeat(np.arange(len(sizes)), sizes)
    covariance = (number == number[:, None]) * (tilted @ P @ tilted.T)
    residual = np.concatenate(expected) - tilted @ error
    which = rng.random(m) < 0.5
    for part, kept in ((innovation, np.full(m, True)), (innovation.subset(which), which)):
        assert part.residual == pytest.approx(residual[kept], rel=1e-12, abs=1e-11, nan_ok=True)
        assert part.covariance == pytest.approx(covariance[np.ix_(kept, kept)], rel=1e-12, abs=1e-10)


def test_chi_squared_quantiles_equal_scipys():
    freedom = np.arange(1, 300)
    assert lower_quantile(1.0 - 1e-6, freedom) == pytest.approx(chi2.ppf(1.0 - 1e-6, freedom), rel=1e-12)
    assert upper_quantile(1e-10, freedom) == pytest.approx(chi2.isf(1e-10, freedom), rel=1e-12)


def test_compiled_mean_products_equal_plain_ones():
    rng = np.random.default_rng(8)
    normalised, last, accepted, of_payload = *rng.standard_normal((2, 30)), rng.random(30) < 0.7, np.arange(30) < 12
    plain = [(normalised * last)[accepted & part].mean() for part in (of_payload, ~of_payload)]
    assert mean_products(normalised, last, accepted, of_payload) == pytest.approx(plain, rel=1e-12)
    assert np.isnan(mean_products(normalised, last, of_payload, of_payload)[1])


@pytest.mark.parametrize("vehicles", [3, 4])
def test_state_and_setpoints_of_reference_between_times_equal_plain_numpy(vehicles):
    model = LinearModel(read_system(MISSIONS / "system.toml").with_vehicles(vehicles).parameters())
    process, layout, g = ProcessModel(model, ProcessNoiseSettings()), model.layout, model.parameters.g
    load = Load(5.5, np.array([1.0, -2.0, 0.5]), np.array([0.3, -0.1, 0.0]))
    flat = flat_reference(model.parameters, Wave(), np.array([1.0, 1.04, 1.052]), load)
    links = flat.links
    u, direction, x = about_reference(flat.x, flat.u, flat.payload, links.on_payload, links.on_uavs, g, 0.25)
    assert (u == (flat.u[:-1] + flat.u[1:]) / 2).all()
    assert (direction == process.force_of_mass((flat.payload[2, :-1] + flat.payload[2, 1:]) / 2)).all()
    assert (x[:, : layout.size] == flat.x).all()
    assert (x[:, process.force] == links.on_payload).all()
    assert (x[:, process.uav_force] == links.on_uavs[..., :2].reshape(3, -1)).all()
    assert (x[:, process.mass] == 0.25).all()


def test_noise_between_vehicles_goes_to_both_axes_of_the_force_on_each_that_is_measured():
    model = LinearModel(read_system(MISSIONS / "system.toml").parameters())
    process = ProcessModel(model, ProcessNoiseSettings(per_vehicle_force=0.3))
    P = np.zeros((process.size, process.size))
    process.add_per_vehicle_noise(P, np.array([0, 2]))
    expected = np.zeros(process.size)
    forces = expected[process.uav_force].reshape(-1, 2)
    forces[[0, 2]] = 0.3**2
    np.testing.assert_array_equal(P, np.diag(expected))


def test_wind_that_is_found_on_the_payload_is_taken_on_the_uavs_by_their_areas():
    model = LinearModel(read_system(MISSIONS / "system.toml").parameters())
    process, settings = ProcessModel(model, ProcessNoiseSettings()), EstimatorSettings().reset
    P = process.covariance_reset(np.zeros((process.size, process.size)), settings)
    gain = P[process.uav_force, process.force] / settings.force**2  # of a force on the payload that is measured
    speed = np.array([3.0, 4.0, 0.0])
    payload = payload_drag(drag_coefficients(model.parameters.payload.areas), speed)
    uav = 0.5 * AIR_DENSITY * 0.03 * np.linalg.norm(speed) * speed
    assert (gain @ payload).reshape(-1, 2) == pytest.approx(np.tile(uav[:2], (4, 1)), rel=0.2)


@pytest.mark.parametrize("vehicles", [3, 4, 6])
def test_estimated_force_varies_by_half_of_its_error_variance_where_there_is_none(vehicles):
    """The covariance of the filter counts on a force that walks; that of its gains without a walk is less."""
    model = LinearModel(read_system(MISSIONS / "system.toml").with_vehicles(vehicles).parameters())
    settings = EstimatorSettings()
    walking = ProcessModel(model, settings.process)
    calm = ProcessModel(model, replace(settings.process, force=0.0))
    force, period = walking.force, 40_000
    observed = MeasurementModel(model, MeasurementNoise(), settings.measurement).observations.values()
    H = np.zeros((sum(len(rows) for rows, _ in observed), walking.size))
    H[:, : model.layout.size] = np.vstack([rows for rows, _ in observed])
    R = np.diag(np.concatenate([variance for _, variance in observed]))
    F = walking.transition(period).F(walking.force_of_mass(np.zeros(3)))
    P = walking.initial_covariance(settings.initial)
    C = P.copy()
    C[force, force] = 0.0
    for _ in range(100):
        P, C = F @ P @ F.T + walking.noise(period, 1.0), F @ C @ F.T + calm.noise(period, 1.0)
        for covariance in (P, C):
            walking.add_per_vehicle_noise(covariance, np.arange(vehicles))
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
        L = np.eye(walking.size) - K @ H
        P, C = (L @ covariance @ L.T + K @ R @ K.T for covariance in (P, C))
    share = np.linalg.eigvals(np.linalg.solve(P[force, force], C[force, force])).real
    assert 0.3 < share.max() < DEFAULTS.monitor.force_share
