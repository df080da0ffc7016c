"""PX4's modes of a free vehicle: how each is entered, or why it is not, and what it then flies."""

import math
from collections.abc import Callable

from gcs.mavlink import px4
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from vehicle_sim.autopilot.free import parameters as names
from vehicle_sim.autopilot.free.auto_flight import Brake, Descent, Phase
from vehicle_sim.autopilot.free.mission import Action, MissionStep
from vehicle_sim.autopilot.free.state import FreeFlightState

_FLOWN = (Action.TAKE_OFF, Action.FLY, Action.LAND)
"""What is flown for an item of the mission has a place."""
_EXACT = 0.3  # m, horizontal distance to a place above which a landing begins


def enter_mode(state: FreeFlightState, custom_mode: int) -> Answer:
    """Enter any mode but OFFBOARD. Disarmed, it begins when the vehicle is armed."""
    enter = ENTRY.get(custom_mode)
    if enter is None:
        return denied(f"{px4.mode_name(custom_mode)} denied: no such mode")
    if state.armed and state.reckoning.is_lost and custom_mode != px4.MODE_LAND:
        return without_position(px4.mode_name(custom_mode))
    answer = enter(state, custom_mode)
    if answer == ACCEPTED:
        state.mode, state.failsafe = custom_mode, False
        begin(state)
    return answer


def without_position(what: str) -> Answer:
    """Return the refusal of what needs a position, while none is measured."""
    return rejected_for_now(f"{what} denied: no position")


def begin(state: FreeFlightState) -> None:
    """Fly the mode that is commanded from now on, if the vehicle is armed."""
    state.speed = math.nan
    if not state.armed or state.mode == px4.MODE_OFFBOARD:
        state.flight = None
        return
    _BEGIN.get(state.mode, _hold)(state)


def fly_mission(state: FreeFlightState) -> None:
    """Fly the current item of the mission, and do at once what needs no flight."""
    mission = state.mission
    if not mission.steps:  # cleared meanwhile
        state.mode = px4.MODE_HOLD
        _hold(state)
    for _ in range(2 * len(mission.steps)):
        if mission.finished:
            state.mode = px4.MODE_HOLD
            state.notices.append("Mission finished, loitering")
            if state.flight is None or math.isnan(sum(state.flight.place)):
                _hold(state)
            else:
                state.fly([state.goal(state.flight.place, hold=math.inf)])
            return
        step = mission.step
        if step.action is Action.RETURN:
            mission.done()
            state.mode = px4.MODE_RETURN
            return_home(state)
            return
        if phases := _phases(state, step):
            state.fly(phases)
            return
        if step.action is Action.SPEED:
            state.speed = step.speed if step.speed > 0.0 else math.nan
        mission.done()


def return_home(state: FreeFlightState) -> None:
    """Climb, fly to the nearest of home and the rally points, and land, as PX4 by default.

    Near there it climbs no higher than that is far (a cone of 45 deg), but at least as high as the rally point.
    """
    if not state.land.in_air:
        state.stop()
        return
    measured, home = state.estimate, state.home
    assert measured is not None and home is not None
    get = state.parameters
    x, y, z = measured.position
    north, east, height = min((home, *state.rally_points), key=lambda place: math.hypot(place[0] - x, place[1] - y))
    distance, radius = math.hypot(north - x, east - y), get[names.ACCEPTANCE_RADIUS]
    altitude = get[names.RETURN_ALTITUDE]
    if distance <= radius:
        altitude = 2.0 * distance
    else:
        if distance <= get[names.RETURN_NEAR]:
            altitude = min(distance, altitude)
        altitude = max(altitude, 2.0 * radius)
    top = min(z, height, home[2] - altitude)
    low = min(home[2], state.ground) - get[names.DESCEND_ALTITUDE]
    state.fly(
        [
            Brake(),
            state.goal((math.nan, math.nan, top), radius=math.inf, looks_ahead=False),
            state.goal((north, east, top), radius=_EXACT),
            state.goal((north, east, max(top, low)), radius=_EXACT, looks_ahead=False),
            Descent(state.ground),
        ]
    )


def _phases(state: FreeFlightState, step: MissionStep) -> list[Phase]:
    """Return what is flown for a step of the mission; empty: it needs no flight."""
    if step.action not in _FLOWN:
        return []
    x, y, z = step.position
    phases: list[Phase] = []
    if not state.land.in_air and (state.flight is None or state.flight.finished):
        top = state.ground - state.parameters[px4.PARAM_TAKEOFF_ALTITUDE]
        if step.action is Action.TAKE_OFF:
            top = z
        elif not math.isnan(z):
            top = min(z, top)
        phases.append(_climb(state, top))
    if step.action is Action.LAND:
        if not math.isnan(x + y):
            phases.append(state.goal((x, y, math.nan), step.yaw, radius=_EXACT))
        return [*phases, Brake(), Descent(state.ground)]
    if step.action is Action.FLY or not math.isnan(x + y):
        phases.append(state.goal((x, y, z), step.yaw, step.hold, step.radius))
    elif not phases:
        phases.append(state.goal((math.nan, math.nan, z), radius=math.inf, looks_ahead=False))
    return phases


def _climb(state: FreeFlightState, top: float) -> Phase:
    """Return the vertical climb of a take-off to ``top`` (NED, m)."""
    return state.goal(
        (math.nan, math.nan, top),
        radius=math.inf,
        looks_ahead=False,
        climb_speed=state.parameters[names.TAKEOFF_SPEED],
    )


# What each mode flies, armed


def _hold(state: FreeFlightState) -> None:
    if state.land.in_air:
        state.hold_here()
    else:
        state.flight = None


def _take_off(state: FreeFlightState) -> None:
    measured = state.estimate
    assert measured is not None
    altitude = state.take_off_altitude
    if math.isnan(altitude):
        altitude = state.parameters[px4.PARAM_TAKEOFF_ALTITUDE]
    top = min(state.ground - altitude, measured.position[2])
    if state.land.in_air:
        state.fly([Brake(), _climb(state, top)])
    else:
        state.fly([_climb(state, top)])


def _land(state: FreeFlightState) -> None:
    if state.land.in_air:
        state.land_here()
    else:
        state.stop()


_BEGIN: dict[int, Callable[[FreeFlightState], None]] = {
    px4.MODE_TAKEOFF: _take_off,
    px4.MODE_LAND: _land,
    px4.MODE_RETURN: return_home,
    px4.MODE_MISSION: fly_mission,
}


# Whether each mode may be entered


def _freely(state: FreeFlightState, custom_mode: int) -> Answer:
    return ACCEPTED


def _when_armed(state: FreeFlightState, custom_mode: int) -> Answer:
    if not state.armed:
        return rejected_for_now(f"{px4.mode_name(custom_mode)} denied: not flying")
    return ACCEPTED


def _when_disarmed(state: FreeFlightState, custom_mode: int) -> Answer:
    if state.armed:
        return denied(f"{px4.mode_name(custom_mode)} denied: no manual control")
    return ACCEPTED


def _with_mission(state: FreeFlightState, custom_mode: int) -> Answer:
    if not state.mission.steps:
        return rejected_for_now("AUTO.MISSION denied: no mission")
    for number, step in enumerate(state.mission.steps):
        if step.action in _FLOWN and (breach := state.refused_by_fence(step.position)):
            return denied(f"AUTO.MISSION denied: item {number} is beyond the fence: {breach}")
    if state.mission.finished:
        state.mission.restart()
    return ACCEPTED


ENTRY: dict[int, Callable[[FreeFlightState, int], Answer]] = {
    px4.MODE_HOLD: _freely,
    px4.MODE_TAKEOFF: _freely,
    px4.MODE_LAND: _when_armed,
    px4.MODE_RETURN: _when_armed,
    px4.MODE_MISSION: _with_mission,
    px4.MODE_MANUAL: _when_disarmed,
    # Without sticks they hold.
    px4.MODE_ALTCTL: _freely,
    px4.MODE_POSCTL: _freely,
}
