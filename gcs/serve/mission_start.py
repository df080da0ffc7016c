"""Where an uploaded mission can be begun, or gone on with."""

from gcs.mission.flow import TRIED_LEGS
from gcs.mission.route import GroundLeg, Position, Route
from gcs.mission.steps import RouteError


def beginning(route: Route, first: str) -> Route:
    """Return the route from the step of source ``first`` on; empty: all of it."""
    return route.beginning_at(first) if first else route


def why_not(route: Route, first: str, start: Position | None) -> str | None:
    """Return why a route cannot be flown from ``first`` on, in the air at ``start`` (NED, m); None: it can be.

    ``start`` None: from the ground.
    """
    try:
        beginning(route, first).first_lap(TRIED_LEGS, start)
    except RouteError as error:
        return f"{error.source}: {error.reason}"
    return None


def begins_on_ground(route: Route, first: str) -> bool:
    """Return whether there is something to do on the ground before the take-off."""
    return isinstance(next(beginning(route, first).legs(), None), GroundLeg)
