"""Routes that are begun in the air, or at one of their items."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from gcs.mission.model import Lissajous
from gcs.mission.read import read_mission
from gcs.mission.route import END, Circle, Climb, FlyTo, Go, HoldForever, Land, Leg, Place, Route, Speed
from gcs.serve.flight_speed import FlightSpeed, LegSpeeds
from gcs.serve.orders import Orders
from idc_controller.guidance.progress import Guidance

STEPS = (
    Climb("take-off", Place(None, 3.0)),
    Go("first", Place((5.0, 0.0), 3.0)),
    Go("second", Place((5.0, 5.0), 3.0)),
)


MISSION_SPEED = Route((*STEPS[:2], Speed("change speed", 2.5), STEPS[2]), 1.0, 0.25)


def route(holds_at_end: bool = False) -> Route:
    return Route(STEPS, 1.0, 0.25, holds_at_end)


@pytest.mark.parametrize(("source", "flown"), [("first", ["first", "second"]), ("second", ["second"]), (END, [])])
def test_route_goes_on_at_an_item_and_after_the_last(source: str, flown: list[str]) -> None:
    legs = list(route().beginning_at(source).legs((1.0, 2.0, -3.0)))
    assert [leg.source for leg in legs] == [*flown, END, END]
    assert isinstance(legs[-2], FlyTo) and legs[-2].position == (0.0, 0.0, -3.0)
    assert isinstance(legs[-1], Land)


def test_route_that_holds_at_its_end_stays_where_it_is() -> None:
    legs = list(route(holds_at_end=True).beginning_at(END).legs((1.0, 2.0, -3.0)))
    assert isinstance(legs[-1], HoldForever) and legs[-1].position == (1.0, 2.0, -3.0)


@pytest.mark.parametrize(("wanted", "cap", "limit"), [(1.0, 2.5, math.inf), (0.5, 0.5, math.inf), (3.0, 2.5, math.inf)])
def test_legs_are_as_fast_as_the_mission_names_unless_a_slower_speed_is_ordered(
    wanted: float, cap: float, limit: float
) -> None:
    speed = FlightSpeed()
    assert speed.plan(LegSpeeds.of(MISSION_SPEED, 1.5), wanted) == cap
    assert speed.limit(wanted) == limit and speed.limit(0.4) == 0.4


def test_mission_resumed_faster_flies_what_remains_with_the_speeds_it_names() -> None:
    remaining = [
        Circle((0.0, 0.0, -3.0), 6.0, 1.25, True, 1.0, "turns"),
        FlyTo((5.0, 0.0, -3.0), 2.5, "first", 4.0),
        FlyTo((5.0, 5.0, -3.0), 1.0, "second", 4.0),
        Land((0.0, 0.0, 0.0), "end"),
    ]
    flown: list[Leg] = []

    def fly(time: float, legs: Iterator[Leg], speed: float) -> None:
        assert speed == 3.0
        flown.extend(legs)

    mission = SimpleNamespace(
        is_held=True, remaining=lambda: iter(remaining), fly=fly, position=lambda time: (6.0, 0.0, -3.0)
    )
    flight = SimpleNamespace(flown=mission, time=0.0, next_source="turns", system=SimpleNamespace(guidance=Guidance()))
    world = replace(read_mission("hover"), reference=MISSION_SPEED)
    session: Any = SimpleNamespace(flight=flight, world=world, in_air=True, changes=0, enter=lambda mode: None)
    orders = Orders(session)
    orders.mission, orders._flies_mission = world, True
    orders._speed.plan(LegSpeeds(1.0, 2.5), 1.0)
    orders._speed.ordered = 3.0
    orders.fly_mission()
    speeds = [3.0, 2.5, 3.0]
    assert flown == [*(replace(leg, speed=v) for leg, v in zip(remaining, speeds, strict=False)), remaining[-1]]


@pytest.mark.parametrize("wanted", [math.inf, 0.4])
def test_legs_beside_a_curve_have_the_cruise_speed_and_the_curve_its_own_up_to_a_limit(wanted: float) -> None:
    speed = FlightSpeed()
    assert speed.plan(LegSpeeds.of(Lissajous((6.0, 3.0), 0.5, 5.0, 40.0), 1.5), wanted) == 1.5
    assert speed.limit(wanted) == wanted
