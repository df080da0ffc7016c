"""Set-points and stop plans: what a vehicle flies of them, and what it refuses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pytest
from onboard import step_alone
from packed_messages import message_of
from vehicle_bench import (
    ACCEPTED,
    GROUND,
    HOLD,
    HOVER,
    LAND,
    OFFBOARD,
    STRANGER,
    Bench,
    attitude_target,
)

from gcs.mavlink import px4
from gcs.mavlink.stop_plan import StopPlanContent, stop_plan_message


@pytest.mark.parametrize(
    "message",
    [
        attitude_target(q=(math.nan, 0, 0, 0)),
        attitude_target(q=(0, 0, 0, 0)),
        attitude_target(q=(math.inf, 0, 0, 0)),
        attitude_target(q=(2, 0, 0, 0)),
        attitude_target(q=(3e38, 3e38, 0, 0)),
        attitude_target(thrust=math.nan),
        attitude_target(thrust=-0.1),
        attitude_target(thrust=1.1),
        attitude_target(thrust=math.inf),
        attitude_target(mask=0, rates=(math.nan, 0, 0)),
        attitude_target(mask=0, rates=(0, 50.0, 0)),
        attitude_target(mask=128 | 7),
        attitude_target(mask=8 | 7),
        attitude_target(mask=32 | 7),
    ],
)
def test_invalid_setpoints_are_ignored(flying: Bench, message: Any) -> None:
    flying.streaming[GROUND, 255] = message
    flying.run(0.3)
    assert flying.vehicle.refused_setpoints >= 5
    assert flying.vehicle.autopilot.mode == px4.MODE_OFFBOARD
    flying.run(0.3)  # and they do not keep the failsafe away
    assert flying.vehicle.autopilot.failsafe


@pytest.mark.parametrize(
    ("message", "target"),
    [
        (attitude_target(q=(-1, 0, 0, 0), thrust=0.3), ((-1, 0, 0, 0), (0, 0, 0), 0.3)),
        (attitude_target(mask=3, rates=(9, 9, 0.5), thrust=0.3), ((1, 0, 0, 0), (0, 0, 0.5), 0.3)),
        (attitude_target(mask=128, q=(0, 0, 0, 0), rates=(0.1, 0.2, 0.3), thrust=0.3), (None, (0.1, 0.2, 0.3), 0.3)),
        (attitude_target(mask=7 | 64, thrust=math.nan), ((1, 0, 0, 0), (0, 0, 0), HOVER)),
        (attitude_target(mask=7, rates=(math.nan, math.inf, 1e9), thrust=0.3), ((1, 0, 0, 0), (0, 0, 0), 0.3)),
    ],
)
def test_type_masks_of_setpoints_are_followed(flying: Bench, message: Any, target: Any) -> None:
    flying.send(message)
    flying.body.command = step_alone(flying.vehicle.autopilot, flying.body.measure(), flying.now)
    attitude, rates, thrust = flying.vehicle.autopilot.state.actuation.target
    assert attitude == (None if target[0] is None else pytest.approx(target[0], abs=1e-6))
    assert rates == pytest.approx(target[1], abs=1e-6) and thrust == pytest.approx(target[2], abs=1e-6)


def test_reordered_setpoints_are_dropped_but_not_after_clock_step(flying: Bench) -> None:
    def thrust_after(stamp: int, thrust: float) -> float:
        flying.send(attitude_target(stamp=stamp, thrust=thrust))
        step_alone(flying.vehicle.autopilot, flying.body.measure(), flying.now)
        return flying.vehicle.autopilot.state.actuation.target[2]

    assert thrust_after(5000, 0.2) == pytest.approx(0.2)
    assert thrust_after(4950, 0.3) == pytest.approx(0.2)
    assert thrust_after(5000, 0.25) == pytest.approx(0.25)
    assert thrust_after(10, 0.35) == pytest.approx(0.25)
    assert thrust_after(30, 0.35) == pytest.approx(0.35)


# Stop plans


def stop_plan(
    flying: Bench, start: float, x: float = 0.0, number: int = 1, system: int = 1, hold: float = 60.0, **changes: Any
) -> Any:
    here = flying.body.position
    points = [(here[0] + x * k / 4, here[1], here[2]) for k in (0, 1, 4, 4, 4)]
    plan = StopPlanContent(7, number, start, start + hold, 4.0, 0.0, points)._replace(**changes)
    return message_of(stop_plan_message(system, plan))


@pytest.mark.parametrize("wrapped", [0.0, 2**32 * 1e-3])
def test_vehicle_follows_last_stop_plan_without_setpoints(flying: Bench, wrapped: float) -> None:
    """The ground estimates the vehicle clock from stamps of 32 bits of milliseconds."""
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now + wrapped, x=3.0))
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.vehicle.autopilot.failsafe
    assert flying.body.position[0] - x == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize(
    ("late", "changes"),
    [
        (0.0, {"control_points": [(math.nan, 0.0, 0.0)] * 5}),
        (0.0, {"duration": 0.0}),
        (0.0, {"duration": math.inf}),
        (0.0, {"yaw": math.nan}),
        (0.0, {"control_points": [(0.0, 50.0, 0.0)] * 5}),
        (0.0, {"hold": 4100.0}),
        (0.0, {"hold": -4100.0}),
        (0.0, {"system": 2}),
        (0.0, {"system": 0}),
        (3.0, {}),
        (-9.0, {}),
    ],
)
def test_inconsistent_or_missing_stop_plan_is_not_followed(flying: Bench, late: float, changes: Any) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now - late, x=3.0, **changes))
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.vehicle.autopilot.failsafe
    assert flying.body.position[0] - x == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize(
    "far",
    [
        (0.0, 0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 1.0, 1.1), (0.0, 0.0, 0.0, 1e30, 0.0),
        (0.0, 50.0, 99.0, 99.0, 99.0), (0.0, 21.0, 0.0, 0.0, 0.0), (0.0, 1e30, 0.0, 0.0, 0.0),
    ],
)  # fmt: skip
def test_stop_plan_that_does_not_end_at_rest_or_leads_far_away_is_refused(flying: Bench, far: Sequence[float]) -> None:
    x, y, z = flying.body.position
    refused = flying.vehicle.refused_setpoints
    flying.send(stop_plan(flying, flying.now, control_points=[(x + k, y, z) for k in far]))
    assert flying.vehicle.autopilot.state.stop_plan is None and flying.vehicle.refused_setpoints == refused + 1


@pytest.mark.parametrize("duration", [0.05, 0.9, 4.0])
def test_stop_plan_of_any_duration_is_taken(flying: Bench, duration: float) -> None:
    flying.send(stop_plan(flying, flying.now, duration=duration))
    taken = flying.vehicle.autopilot.state.stop_plan
    assert taken is not None and taken.duration == pytest.approx(duration)


def test_stop_plan_of_foreign_system_is_not_followed(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0), STRANGER)
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.body.position[0] - x == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize(("share", "held"), [(1.1, 1.1), (0.1, None), (math.nan, 1.0), (math.inf, 1.0)])
def test_vehicle_holds_with_the_hover_thrust_of_the_stop_plan(flying: Bench, share: float, held: float | None) -> None:
    state = flying.vehicle.autopilot.state
    learnt, weight = state.land.hover_thrust, state.airframe.mass * state.airframe.g
    assert learnt is not None
    flying.send(stop_plan(flying, flying.now, hover_force=(0.0, 0.0, -share * learnt)))
    flying.streaming.clear()
    flying.run(1.0)
    assert state.hold is not None
    assert state.hold.hover_thrust == pytest.approx(weight if held is None else held * learnt, rel=0.02)


def test_repeated_hold_command_continues_stop_plan(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0))
    flying.streaming.clear()
    assert flying.result(HOLD) == ACCEPTED
    for _ in range(5):
        flying.run(1.0)
        assert flying.result(HOLD) == ACCEPTED
    assert flying.body.position[0] - x == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize(("aside", "taken"), [(0.45, True), (0.55, False)])
@pytest.mark.parametrize("late", [-0.1, 0.0, 0.3])
def test_plan_that_does_not_begin_on_the_vehicles_way_is_refused(
    flying: Bench, aside: float, taken: bool, late: float
) -> None:
    refused = flying.vehicle.refused_setpoints
    x, y, z = flying.body.position
    z -= min(late, 0.0) * flying.body.velocity[2]
    flying.send(stop_plan(flying, flying.now - late, control_points=[(x, y + aside, z)] * 5))
    assert (flying.vehicle.autopilot.state.stop_plan is not None) is taken
    assert flying.vehicle.refused_setpoints - refused == (not taken)


def test_plan_with_a_higher_number_of_the_same_session_alone_is_taken(flying: Bench) -> None:
    def taken(number: int, session: int = 7) -> bool:
        before = flying.vehicle.autopilot.state.stop_plan
        flying.send(stop_plan(flying, flying.now, number=number, session=session))
        return flying.vehicle.autopilot.state.stop_plan is not before

    assert taken(5)
    assert not taken(5) and not taken(4)
    assert taken(6)
    assert not taken(9, session=8)  # a ground started anew has to ask for control first
    assert flying.result(OFFBOARD) == ACCEPTED
    assert not taken(6) and not taken(2)
    assert taken(1, session=8)
    assert not taken(7) and taken(2, session=8)


@pytest.mark.parametrize("order", [(), (HOLD,), (HOLD, LAND), (LAND,), (LAND, HOLD)])
def test_common_descent_is_neither_put_off_nor_brought_forward(flying: Bench, order: Any) -> None:
    start = flying.now
    flying.send(stop_plan(flying, start, hold=3.0))
    flying.streaming.clear()
    flying.run(1.0)
    for message in order:
        assert flying.result(message) == ACCEPTED
        flying.run(0.3)
    hold = flying.vehicle.autopilot.state.hold
    assert hold is not None and hold.plan.descent_start == pytest.approx(start + 3.0, abs=1e-5)
    flying.run(2.5)
    assert flying.vehicle.autopilot.mode == px4.MODE_LAND and flying.result(HOLD) == ACCEPTED
    assert flying.vehicle.autopilot.mode == px4.MODE_LAND and hold.plan.descent_start < flying.now


def test_descent_of_its_own_is_put_off_by_hold(flying: Bench) -> None:
    flying.streaming.clear()
    flying.run(1.0)
    hold = flying.vehicle.autopilot.state.hold
    assert hold is not None and hold.plan.descent_start == pytest.approx(flying.now + 4.5, abs=0.1)
    assert flying.result(HOLD) == ACCEPTED
    assert hold.plan.descent_start == math.inf
