"""Links over a payload on the ground: wrong attitudes are found, and links without a position are predicted."""

from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config import read_system
from idc_controller.control.ground_controller import GroundController
from idc_controller.estimation.grounded_links import N_ACC, N_DOT, OFF, S_DOT, GroundedLinks, N, S
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import quaternion_from_euler

MODEL = LinearModel(read_system().parameters())
P = MODEL.parameters
PERIOD, STEP, TELEMETRY = 0.05, 0.002, 0.04  # s
SHARE = 0.6  # of the hover thrust
FRICTION = 1.0  # m/s2; with which a payload that slides comes to rest
REFERENCE = SimpleNamespace(x=np.zeros((1, MODEL.layout.size)), u=np.zeros((1, MODEL.layout.inputs)))
REST = np.zeros(12)


class Pendulums:
    """Four UAVs on their links over a payload at rest, north only, with the estimator and the controller."""

    def __init__(self, lean=0.0, wrong=0.0, drag=0.0, latency=0.0, sliding=0.0, seed=1):
        self.wrong, self.drag, self.latency = np.array([wrong, 0.0, 0.0, 0.0]), drag, latency
        self.rng, self.time = np.random.default_rng(seed), 0.0
        self.sliding, self.slid = sliding, 0.0  # the payload's velocity (m/s) and way (m)
        self.thrust = SHARE * P.hover_thrust
        self.x = np.zeros((5, 4))  # s, s', n, n', n''
        self.x[0] = lean
        self.links, self.controller = GroundedLinks(P), GroundController(MODEL, PERIOD)
        start = np.zeros((6, 4, 2))
        start[S, :, 0] = lean
        payload = REST.copy()
        payload[3] = sliding
        self.links.start(0.0, payload, start, self.thrust, np.array([drag, 0.0]))
        self.commands, self.waiting, self.leans, self.states = [(0.0, np.zeros((4, 2)))], [], [], None

    def measure(self, lost):
        along, velocity_along = np.array([self.slid, 0.0, 0.0]), np.array([self.sliding, 0.0, 0.0])
        for i in range(4):
            above = np.array([-P.l[i] * self.x[0, i], 0.0, -P.l[i]])
            place = along + P.p[i] + above + self.rng.normal(0.0, 0.02, 3)
            velocity = velocity_along - [P.l[i] * self.x[1, i], 0.0, 0.0] + self.rng.normal(0.0, 0.02, 3)
            pitch = -self.x[2, i] + self.rng.normal(0.0, 0.0035)
            samples = [Attitude(self.time, i, quaternion_from_euler(0.0, pitch, 0.0), np.zeros(3))]
            if i not in lost:
                samples.append(Position(self.time, i, place, velocity))
            self.waiting += [(self.time + self.latency, sample) for sample in samples]
        place, velocity = along + self.rng.normal(0.0, 0.02, 3), velocity_along + self.rng.normal(0.0, 0.008, 3)
        unit = Position(self.time, PAYLOAD, place, velocity)
        self.waiting.append((self.time + self.latency, unit))

    def control(self):
        for _, sample in [each for each in self.waiting if each[0] <= self.time]:
            self.links.add(sample)
        self.waiting = [each for each in self.waiting if each[0] > self.time]
        effective = self.time + self.latency
        self.states = self.links.at(effective)
        tilts = self.controller.setpoints(self.states, REFERENCE)[MODEL.layout.n_setpoint].reshape(4, 2)
        self.links.command(effective, tilts, self.thrust)
        self.commands.append((effective, tilts))

    def fly(self, duration, lost=()):
        for k in range(round(duration / STEP)):
            if k % round(TELEMETRY / STEP) == 0:
                self.measure(lost)
            if k % round(PERIOD / STEP) == 0:
                self.control()
            tilts = [tilts[:, 0] for at, tilts in self.commands if at <= self.time + 1e-9][-1]
            s, s_dot, n, n_dot, n_acc = self.x
            pull = (self.thrust - P.m * P.g) * s + self.thrust * (n + self.wrong) + self.drag
            turn = (P.attitude_kp * (tilts - n) - P.attitude_kd * n_dot - n_acc) / P.motor_time_constant
            slower = np.clip(-self.sliding, -FRICTION * STEP, FRICTION * STEP)
            s_dot_change = slower / P.l - STEP * pull / (P.m * P.l)
            self.x = self.x + np.array([STEP * s_dot, s_dot_change, STEP * n_dot, STEP * n_acc, STEP * turn])
            self.slid, self.sliding = self.slid + STEP * self.sliding, self.sliding + slower
            self.time += STEP
            self.leans.append(np.abs(self.x[0]).max())
        return self


@pytest.mark.parametrize("latency", [0.0, 0.05, 0.1])
def test_wrong_attitude_is_found_and_its_link_comes_upright_whatever_the_latency(latency):
    team = Pendulums(wrong=0.1, drag=0.5, latency=latency).fly(4.0)
    assert team.states.x[OFF, :, 0] == pytest.approx([0.1, 0.0, 0.0, 0.0], abs=0.04)
    assert max(team.leans) < 0.125 and max(team.leans[-100:]) < 0.03


def test_leaning_links_come_upright_without_passing_far_beyond():
    team = Pendulums(lean=0.2).fly(4.0)
    assert max(team.leans[-100:]) < 0.02 and team.x[0].min() > -0.05


def test_link_without_a_position_stays_upright_by_the_error_that_was_found_before():
    team = Pendulums(wrong=0.1, drag=0.5).fly(1.5)
    team.leans.clear()
    team.fly(3.0, lost=(0,))
    assert max(team.leans) < 0.1


def test_errors_that_were_found_last_without_the_noise_hold_where_all_positions_are_lost():
    team = Pendulums(wrong=0.1).fly(2.0)
    team.fly(0.5, lost=(0, 1, 2, 3))
    assert team.states.x[OFF, 0] == pytest.approx([0.1, 0.0], abs=0.03)
    assert np.ptp(team.states.x[OFF, 1:], axis=0).max() < 1e-3


def test_link_without_a_position_stays_upright_in_wind_that_the_others_find():
    team = Pendulums().fly(0.3, lost=(1,))
    team.drag = 0.5
    team.fly(4.0, lost=(1,))
    assert team.states.x[OFF, 1, 0] == pytest.approx(0.5 / team.thrust[1], abs=0.03)
    assert max(team.leans) < 0.2 and np.abs(team.x[1]).max() < 0.15


def test_links_without_positions_lean_as_the_payload_slides_and_come_upright():
    team = Pendulums(sliding=0.5).fly(0.7, lost=(0, 1, 2, 3))
    assert team.states.x[S, :, 0] == pytest.approx(team.x[0], abs=0.01) and team.x[0].max() < -0.03
    team.fly(3.3, lost=(0, 1, 2, 3))
    assert max(team.leans[-100:]) < 0.03


def test_states_follow_the_uavs_and_outliers_do_not_move_them():
    team = Pendulums(lean=0.1).fly(1.0)
    assert team.states.x[[S, S_DOT, N], :, 0] == pytest.approx(team.x[:3], abs=0.05)
    before = team.links.at(team.time).x[S, 0, 0]
    team.links.add(Position(team.time, 0, np.array([50.0, 0.0, -3.7]), np.array([np.nan] * 3)))
    assert team.links.at(team.time).x[S, 0, 0] == pytest.approx(before, abs=0.05)


def test_below_its_own_weight_nothing_is_learnt_of_a_uav_that_a_cradle_may_hold():
    links = GroundedLinks(P)
    links.start(0.0, REST, np.zeros((6, 4, 2)), np.zeros(4), np.zeros(2))
    for k in range(1, 20):
        time = k * TELEMETRY
        links.add(Attitude(time, 0, quaternion_from_euler(0.0, 0.1, 0.0), np.zeros(3)))
        links.add(Position(time, 0, P.p[0] - [0.0, 0.0, P.l[0]], np.zeros(3)))
    x = links.at(1.0).x
    assert x[[S, S_DOT, OFF]] == pytest.approx(np.zeros((3, 4, 2)))
    assert np.isfinite(x[[N, N_DOT, N_ACC]]).all()


def started(payload=REST, unlocated=()):
    links, x = GroundedLinks(P), np.zeros((6, 4, 2))
    x[S, :, 0], x[S, 3, 0] = 0.1, 0.4
    links.start(0.0, payload, x, 0.6 * P.hover_thrust, np.zeros(2), unlocated)
    return links


def test_link_swings_about_a_foot_that_the_ground_stops():
    moving = np.concatenate([np.zeros(3), [0.3, 0.0, 0.0], np.zeros(6)])
    links = started(moving, {3})
    links.add(Position(0.0, PAYLOAD, np.zeros(3), np.zeros(3)))
    assert links.at(0.0).x[S_DOT, :, 0] == pytest.approx(-0.3 / P.l)


def test_impossible_motion_of_the_payload_hardly_moves_the_links():
    level = quaternion_from_euler(0.0, 0.0, 0.0)
    for spike in (
        Attitude(0.0, PAYLOAD, level, np.array([80.0, -80.0, 0.0])),
        Position(0.0, PAYLOAD, np.zeros(3), np.array([80.0, -80.0, 0.0])),
    ):
        links = started()
        links.add(spike)
        assert np.abs(links.at(0.0).x[S_DOT]).max() < 0.5 / P.l.min() + 1e-9


@pytest.mark.parametrize("wrong", ["position", "velocity", ""])
def test_link_whose_uavs_position_and_velocity_contradict_each_other_goes_on_without_both(wrong):
    links, rng = GroundedLinks(P), np.random.default_rng(2)
    links.start(0.0, REST, np.zeros((6, 4, 2)), 0.6 * P.hover_thrust, np.zeros(2))
    drift = np.array([0.3, 0.0, 0.0])
    for k in range(1, 50):
        time, above = k * TELEMETRY, np.array([0.0, 0.0, P.l[0]])
        links.command(time, np.zeros((4, 2)), 0.6 * P.hover_thrust)
        for i in range(4):
            off = i == 2 and bool(wrong)
            place = P.p[i] - above + rng.normal(0.0, 0.02, 3) + drift * time * (off and wrong == "position")
            velocity = rng.normal(0.0, 0.02, 3) + drift * (off and wrong == "velocity")
            links.add(Attitude(time, i, quaternion_from_euler(0.0, 0.0, 0.0), np.zeros(3)))
            links.add(Position(time, i, place, velocity))
    states = links.at(50 * TELEMETRY)
    assert states.located.tolist() == [True, True, not wrong, True]
    assert np.abs(states.x[S]).max() < 0.12


def test_uav_whose_positions_have_stopped_in_the_air_has_none():
    links = GroundedLinks(P)
    for uav in range(4):
        for time in (0.0, 1.0)[: 1 if uav == 2 else 2]:
            links.locate(Position(time, uav, np.zeros(3), np.zeros(3)))
    assert links.unlocated == {2}
