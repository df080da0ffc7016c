"""Evidence that a body does not stand: rays through the places where its points were."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_scene import HERE, Scene, map_of, moving_tracks, pole, run, sphere

from idc_controller.perception.motion_evidence import Frame, MotionEvidence, PartOfScan
from idc_controller.perception.motion_evidence_kernels import Places, count_rays
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.surfaces.points import SurfacePoints

MAP = StandingMapSettings()
EVIDENT = -math.log(1e-3)


def counted(origin, returns, free, sigmas, places, variances, normals, beside, deviations):
    """Plain reference of the kernel: all rays against all places."""
    known = normals.any(axis=1)
    counts = [0, 0]
    for end, returned in [*((end, True) for end in returns), *((end, False) for end in free)]:
        way = end - origin
        length = np.linalg.norm(way)
        along = (places - origin) @ way / length
        square = np.sum((places - origin) ** 2, axis=1) - along**2
        met = (along > 0.0) & (square <= beside**2)
        variance = sigmas[1] ** 2 + (sigmas[2] * length) ** 2 + (sigmas[0] ** 2 if returned else 0.0)
        noise = deviations * np.sqrt(variance + variances)
        ends = met & (abs(length - along) <= noise)
        across = np.abs(normals @ way) / length
        with np.errstate(divide="ignore"):
            nearer = np.where(known, beside * np.sqrt(1.0 - across**2) / across, beside)
        passes = met & (length - along > noise + np.maximum(nearer, beside))
        if ends.any():
            counts[0] += returned
        elif passes.any():
            counts[1] += 1
    return counts


@settings(deadline=None, derandomize=True, max_examples=60)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 30), spread=st.floats(0.05, 2.0), upright=st.floats(1.0, 9.0))
def test_counted_rays_agree_with_plain_reference(seed, count, spread, upright):
    rng = np.random.default_rng(seed)
    origin = rng.normal(size=3)
    spreads = spread * np.array([1.0, 1.0, upright])
    places = origin + np.array([rng.uniform(0.3, 8.0), 0.0, 0.0]) + rng.normal(0.0, spreads, (count, 3))
    ends = places[rng.integers(count, size=60)] + rng.normal(0.0, 0.2, (60, 3))
    ends = origin + (ends - origin) * rng.uniform(0.6, 1.8, (60, 1))
    sigmas, variances = np.array([0.05, 0.02, 0.004]), rng.uniform(0.001, 0.01, count)
    normals = rng.normal(size=(count, 3))
    normals *= rng.integers(2, size=(count, 1)) / np.linalg.norm(normals, axis=1)[:, None]
    places_of_body, limits = Places(places, variances, normals), (0.15, 3.0)
    scan = PlacedScan(0.0, origin, ends[:40], *sigmas.tolist(), ends[40:])
    sensors = rng.integers(2, size=(count, 1)) * np.ones(3) + origin
    found = count_rays(Frame.of([scan]).rays, places_of_body, places_of_body, sensors, *limits)
    assert found[0, :2].tolist() == counted(*scan.rays, *places_of_body, *limits)
    others = Places(*(of[sensors[:, 0] != origin[0]] for of in places_of_body))
    assert found[0, 2:].tolist() == counted(*scan.rays, *others, *limits)


def scan_of(returns, free=(), uav=0, time=0.0):
    """A scan from the origin."""
    ends = [np.reshape(np.asarray(points, dtype=float), (-1, 3)) for points in (returns, free)]
    return PlacedScan(time, np.zeros(3), ends[0], 0.05, 0.02, 0.0035, ends[1], uav)


def points_at(places, time=0.0, origin=(0.0, 0.0, 0.0)):
    places = np.reshape(np.asarray(places, dtype=float), (-1, 3))
    n = len(places)
    return SurfacePoints(time, places, np.tile(origin, (n, 1)), np.zeros(n, dtype=bool), 0.05, np.full(n, 1e-3))


ASIDE = (0.0, 1.0, 0.0)
FACE = [(5.0, 0.1 * y, 0.1 * z) for y in (-1, 0, 1) for z in (-1, 0, 1)]
BEYOND = [(9.0, 0.18 * y, 0.18 * z) for y in (-1, 0, 1) for z in (-1, 0, 1)]


def test_points_in_space_of_which_nothing_is_known_are_no_evidence_and_others_are():
    evidence, points = MotionEvidence(), points_at(FACE)
    for k in range(8):
        evidence.add(points_at(FACE, 0.05 * k, ASIDE), [PartOfScan(0, 0, 0)], Frame.of([scan_of(FACE)]), MAP)
    assert evidence.nats == 0.0
    evidence.add(points, [PartOfScan(0, 9, 0), PartOfScan(1, 9, 0)], Frame.of([scan_of([]), scan_of([], uav=1)]), MAP)
    assert evidence.nats == pytest.approx(2.0 * math.log(0.5 / MAP.false_share))
    before = evidence.nats
    evidence.add(points, [PartOfScan(0, 4, 5)], Frame.of([scan_of([])]), MAP)
    assert evidence.nats == pytest.approx(before + math.log(0.5 / (1.0 - MAP.false_share)))


def test_points_where_space_was_seen_free_beside_what_is_thin_are_little_evidence():
    """Of two rays that it takes for free space, both pass with the square of the share that passes."""
    evidence = MotionEvidence()
    for k in range(8):
        scans = [scan_of(FACE), scan_of([], BEYOND, 1)]
        evidence.add(points_at(FACE, 0.05 * k, ASIDE), [], Frame.of(scans), MAP)
    evidence.add(points_at(FACE, 0.4), [PartOfScan(0, 9, 0)], Frame.of([scan_of([])]), MAP)
    assert evidence.nats == pytest.approx(math.log(0.5 / 0.5**MAP.free_passes))


def test_rays_through_earlier_places_of_a_body_seen_elsewhere_are_evidence():
    evidence = MotionEvidence()
    for k in range(10):
        evidence.add(points_at(FACE, 0.1 * k, ASIDE), [], Frame.of([scan_of(FACE)]), MAP)
    assert evidence.nats == 0.0
    aside = np.add(FACE, [0.0, 2.0, 0.0])
    for k in range(6, 12):
        evidence.add(points_at(aside, 0.1 * k + 1.0), [], Frame.of([scan_of(aside, BEYOND)]), MAP)
    assert evidence.nats > EVIDENT


def test_rays_beside_what_is_thin_are_no_evidence_where_they_ever_passed_it():
    rng, evidence = np.random.default_rng(3), MotionEvidence()
    for k in range(100):
        scans = [scan_of(FACE) if rng.uniform() < 0.5 else scan_of([], BEYOND, uav) for uav in range(4)]
        evidence.add(points_at(FACE, 0.1 * k, ASIDE), [], Frame.of(scans), MAP)
        assert evidence.nats < EVIDENT


@pytest.mark.parametrize("body", [pole((4.0, 2.0), 0.05), pole((5.0, 1.0), 0.3), sphere((5.0, 1.5, -6.0))])
@pytest.mark.parametrize("seed", range(2))
def test_evidence_of_what_stands_stays_below_what_is_evident_as_the_team_passes(body, seed):
    m, most = map_of(), [0.0]

    def each(t):
        most.append(max((track.detections.evidence.nats for track in m.tracks), default=0.0))

    run(m, lambda t: [body], 6.0, scene=Scene(seed), centre=passing, each=each)
    assert max(most) < EVIDENT


@pytest.mark.parametrize("seed", range(2))
def test_wire_that_most_rays_pass_never_moves(seed):
    m, moved = map_of(), set()
    run(
        m, lambda t: [pole((4.0, 2.0), 0.05)], 6.0, scene=Scene(seed), centre=passing,
        each=lambda t: moved.update(moving_tracks(m)),
    )  # fmt: skip
    assert moved == set()


def passing(t):
    return np.add(HERE, [1.5 * t - 4.0, 0.0, 0.0])
