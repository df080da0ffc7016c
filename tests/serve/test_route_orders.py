"""Routes that are begun in the air, or at one of their items."""

from __future__ import annotations

import pytest

from gcs.mission.route import END, Climb, FlyTo, Go, HoldForever, Land, Place, Route

STEPS = (
    Climb("take-off", Place(None, 3.0)),
    Go("first", Place((5.0, 0.0), 3.0)),
    Go("second", Place((5.0, 5.0), 3.0)),
)


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
