"""Set-points and stop plans: what a vehicle flies of them, and what it refuses."""

from __future__ import annotations

import math
from typing import Any

import pytest
from onboard import step_alone
from packed_messages import message_of
from vehicle_bench import (
    ACCEPTED,
    GROUND,
    HOLD,
    HOVER,
    STRANGER,
    Bench,
    attitude_target,
)

from gcs.mavlink import px4
from gcs.mavlink.setpoints import stop_plan_message


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
    assert thrust_after(10, 0.35) == pytest.approx(0.35)


# Stop plans


def stop_plan(flying: Bench, start: float, x: float = 0.0, duration: float = 4.0, **changes: Any) -> Any:
    here = flying.body.position
    points = [(here[0] + x * k / 4, here[1], here[2]) for k in (0, 1, 4, 4, 4)]
    message = message_of(stop_plan_message(start, duration, points))
    for name, value in changes.items():
        setattr(message, name, value)
    return message


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
        (0.0, {"valid_points": 4}),
        (0.0, {"pos_x": [math.nan] * 5}),
        (0.0, {"delta": [0.0] * 5}),
        (0.0, {"delta": [math.inf] * 5}),
        (0.0, {"pos_yaw": [math.nan] * 5}),
        (0.0, {"pos_y": [50.0] * 5}),
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


@pytest.mark.parametrize("duration", [0.05, 0.9, 4.0])
def test_stop_plan_of_any_duration_is_taken(flying: Bench, duration: float) -> None:
    flying.send(message_of(stop_plan_message(flying.now, duration, [(0.0, 0.0, -1.0)] * 5)))
    taken = flying.vehicle.autopilot.state.stop_plan
    assert taken is not None and taken.duration == pytest.approx(duration)


def test_stop_plan_of_foreign_system_is_not_followed(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0), STRANGER)
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.body.position[0] - x == pytest.approx(0.0, abs=0.3)


def test_repeated_hold_command_continues_stop_plan(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0))
    flying.streaming.clear()
    assert flying.result(HOLD) == ACCEPTED
    for _ in range(5):
        flying.run(1.0)
        assert flying.result(HOLD) == ACCEPTED
    assert flying.body.position[0] - x == pytest.approx(3.0, abs=0.3)
