"""All pairs of failsafes in all phases, without flying: what the ground does is the more severe, and ends disarmed.

That vehicles without a ground end so, too, is in ``tests/vehicle/test_vehicle_failsafes.py``.
"""

from itertools import product
from types import SimpleNamespace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from flights import MISSIONS

from gcs.flight import stack
from gcs.flight.alarms import AlarmLog
from gcs.flight.command_sequences import Arming
from gcs.flight.condition import Trigger
from gcs.flight.control_loop import Hold, Setpoints
from gcs.flight.failsafe import Failsafe
from gcs.flight.failsafe_state import FailsafeState
from gcs.flight.flight import Flight
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.team_failsafe import Reaction, TeamState
from gcs.mission.read import read_mission
from idc_controller.control.load_adaptation import LoadAdaptation
from idc_controller.control.settings import ControllerSettings
from idc_controller.estimation.grounded_links import LinkStates
from idc_controller.guidance.progress import Guidance
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.trajectory import RestTrajectory

MISSION = read_mission(MISSIONS / "short_leg.toml")
PARAMETERS = MISSION.system.parameters()
MODEL = LinearModel(PARAMETERS)
UPRIGHT = LinkStates(np.zeros((6, 4, 2)), PARAMETERS.hover_thrust, np.zeros(2))
LAYOUT, STANDING = MODEL.layout, -PARAMETERS.payload.below
STEP = 0.1
DESCENT = 10.0
"""Time (s) from AUTO.LAND until the stub's vehicles have landed, and disarmed."""
BY_REACTION = {
    Reaction.DISARM: Failsafe.ARMING_FAILED,
    Reaction.RETURN: Failsafe.LANDING_ABORTED,
    Reaction.BRAKE_AND_LAND: Failsafe.INTERRUPTED,
    Reaction.AUTONOMOUS_LANDING: Failsafe.TELEMETRY_LOST,
    Reaction.END_CONTROL: Failsafe.INTERRUPTED_TWICE,
}
WALKED = [phase for phase in Phase if phase.state is not TeamState.DISARMED and phase is not Phase.HOLD]


class ObedientTeam:
    """Vehicles that do at once what they are commanded, and land after AUTO.LAND."""

    parameters = PARAMETERS

    answered, refusal, links, land_delay, hold = True, None, (), 5.0, Hold()
    waits = unanswered = False

    def __init__(self):
        self.armed, self.time, self.lands_at, self.commands = False, 0.0, np.inf, []

    @property
    def disarmed(self):
        return not self.armed

    def command_all(self, number, *parameters):
        self.commands.append((number, *parameters))
        if number == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            self.armed = bool(parameters[0])
        elif parameters[1:] == (px4.MainMode.AUTO, px4.AutoMode.LAND):
            self.lands_at = self.time + DESCENT

    def reachable_are_disarmed(self, now, timeout):
        self.armed = self.armed and self.time < self.lands_at
        return not self.armed


class TrackedFlight(Flight):
    """A flight whose payload is where the trajectory leads; of failsafes only those that are raised."""

    def __init__(self):
        self.team, none = ObedientTeam(), lambda *arguments, **options: None
        health = SimpleNamespace(uav_positions_isolated=False)
        model = SimpleNamespace(vehicles=lambda time, x: SimpleNamespace(values=np.zeros((4, 3))))
        setpoints = SimpleNamespace(add=none)
        estimator = SimpleNamespace(
            hold_payload=none, setpoints=setpoints, health=health, measurement_model=model, start=none
        )
        load = LoadAdaptation(MODEL, ControllerSettings())
        controller = SimpleNamespace(
            tracker=SimpleNamespace(horizon=20),
            parameters=PARAMETERS,
            guidance=Guidance(),
            layout=LAYOUT,
            load=load,
            settings=ControllerSettings(),
        )
        links = SimpleNamespace(at=lambda time: UPRIGHT, command=none, unlocated=())
        control = SimpleNamespace(
            estimator=estimator, controller=controller, estimate=self.on_trajectory, decide=self.decided, send=none,
            links=links, start_links=none, resting_place=None, stand=none,
        )  # fmt: skip
        super().__init__(MISSION, self.team, control, AlarmLog(), stack.obstacle_map(MISSION))
        self.failsafes.evaluate = none
        self.payload_control.pad = RestTrajectory(np.array([0.0, 0.0, STANDING]), 0.0)
        self._sequence, self.phase = Arming(self.team, 0.0), Phase.ARM

    def on_trajectory(self, effective, trajectory):
        x = np.zeros(LAYOUT.size)
        x[LAYOUT.r_0] = trajectory.position(self.system.guidance.progress(effective))
        x[LAYOUT.r_0.start + 2] = min(x[LAYOUT.r_0][2], STANDING)
        return SimpleNamespace(time=effective, x=x)

    @staticmethod
    def decided(estimate, trajectory, **options):
        flat = SimpleNamespace(x=np.zeros((1, LAYOUT.size)), payload=np.zeros((3, 1, 3)))
        decision = SimpleNamespace(flat=flat, **Setpoints.idle(4)._asdict(), u=np.zeros(LAYOUT.inputs))
        return SimpleNamespace(estimate=estimate, decision=decision)

    def advance(self):
        self.team.time += STEP
        setpoints, _ = self.step(self.team.time, self.team.time, np.zeros(4), self.team.time)
        assert setpoints is None or isinstance(setpoints, Setpoints)

    def advance_to(self, phase):
        if phase is Phase.AUTONOMOUS_LANDING:
            self.advance_to(Phase.FLY)
            self.fails(Failsafe.TELEMETRY_LOST)
        while self.phase is not phase:
            assert self.team.time < 120.0, self.phase
            self.advance()
        return self

    def fails(self, failsafe):
        self.raise_failsafe(self.team.time, failsafe, Trigger("a reason"))


@pytest.mark.parametrize("phase", Phase)
def test_of_any_two_failsafes_in_any_phase_the_more_severe_counts_in_either_order(phase):
    system = SimpleNamespace(team=SimpleNamespace(links=()))
    for first, second in product(Failsafe, repeat=2):
        reactions = set()
        for pair in ((first, second), (second, first)):
            state = FailsafeState(system, AlarmLog())
            done = [state.raise_failsafe(1.0, phase.state, failsafe, Trigger("a reason")) for failsafe in pair]
            assert done[0] is not Reaction.NONE, (phase, first)
            assert done[1] is Reaction.NONE or done[1] > done[0], (phase, pair)
            assert state.raised == set(pair)
            reactions.add(state.reaction)
        assert reactions == {max(phase.state.reaction(each.reaction) for each in (first, second))}, (phase, pair)


@pytest.mark.parametrize("state", TeamState)
def test_every_state_has_a_reaction_and_none_to_what_is_more_severe_is_milder(state):
    done = [state.reaction(reaction) for reaction in Reaction]
    assert done == sorted(done) and Reaction.NONE not in done and done[-1] is Reaction.END_CONTROL


def test_every_state_of_the_team_leads_to_disarmed():
    for state in TeamState:
        for _ in TeamState:
            state = state.next
        assert state is TeamState.DISARMED


@pytest.mark.parametrize("phase", WALKED)
@pytest.mark.parametrize("first", BY_REACTION)
def test_every_reaction_in_every_phase_ends_disarmed_also_with_a_more_severe_one_after_it(phase, first):
    more_severe = [reaction for reaction in BY_REACTION if reaction > first]  # others have no effect
    for second, delay in [(None, 0), *product(more_severe, (0, 1, 15))]:
        flight = TrackedFlight().advance_to(phase)
        flight.fails(BY_REACTION[first])
        for _ in range(delay):
            flight.advance()
        if second is not None:
            flight.fails(BY_REACTION[second])
        while not flight.ended:
            assert flight.team.time < 240.0, (flight.phase, second, delay)
            flight.advance()
        if Reaction.END_CONTROL in (first, second):
            continue  # the rest is the vehicles' own
        assert flight.landed and not flight.team.armed and not flight.completed, (second, delay)


def test_undisturbed_flight_passes_all_phases_and_ends_disarmed():
    flight, phases = TrackedFlight(), []
    while not flight.ended:
        assert flight.team.time < 240.0, flight.phase
        flight.advance()
        phases += [flight.phase] if flight.phase not in phases[-1:] else []
    assert flight.completed and not flight.team.armed
    assert [phase for phase in WALKED if phase not in phases] == [Phase.AUTONOMOUS_LANDING]
