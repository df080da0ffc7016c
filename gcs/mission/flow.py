"""Control flow of a route: loops without a waypoint, steps never reached, legs that cannot be flown."""

import math
from collections.abc import Iterator, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from itertools import islice
from operator import itemgetter

from gcs.mission.fence import Fence
from gcs.mission.route import (
    END,
    Circle,
    Climb,
    Descend,
    Go,
    Jump,
    Land,
    Leg,
    Position,
    Return,
    Route,
    RouteError,
    Stay,
    Step,
    TakeOff,
    Turn,
)

TRIED_LEGS = 20_000
"""So many legs are tried before the flight. Legs repeat after a lap; a file has at most 10 000 items."""

WAYPOINTS = (Climb, Go, Turn, Stay, Descend, Return)


def check_flow(route: Route, fence: Fence) -> tuple[list[str], list[str]]:
    """Return problems and notes, one line each without the file's name."""
    steps = route.steps
    if not any(isinstance(step, Climb | Go | Turn | Stay) for step in steps):
        return ["mission: there is no waypoint"], []
    if (jump := _loop_without_waypoint(steps)) is not None:
        return [f"{jump.source}: target: a loop without a waypoint in it would never end"], []
    flown = _reached(steps, through_landing=False)
    after = sorted(_reached(steps, through_landing=True) - flown)
    if (again := next((steps[i] for i in after if isinstance(steps[i], Climb)), None)) is not None:
        return [f"{again.source}: command: lands and takes off again: not flown yet"], []
    if not any(isinstance(step, Climb | Go | Turn | Stay) for i, step in enumerate(steps) if i in flown):
        return ["mission: no waypoint is ever reached"], []
    try:
        legs = list(islice(route.legs(), TRIED_LEGS))
    except RouteError as error:
        return [f"{error.source}: altitude: {error.reason}"], []
    return list(_outside_fence(legs, fence)), list(_notes(route, flown, legs))


def _next(steps: tuple[Step, ...], index: int, through_landing: bool) -> list[int]:
    """Return the indices that may follow a step; ``len(steps)`` is the end."""
    match steps[index]:
        case Jump(target=target, repeats=repeats):
            return [target] if repeats is None else [target, index + 1]
        case Stay():
            return []
        case Descend() | Return():
            return [index + 1] if through_landing else []
    return [index + 1]


def _reached(steps: tuple[Step, ...], through_landing: bool) -> set[int]:
    reached, waiting = set[int](), [0]
    while waiting:
        index = waiting.pop()
        if index in reached or index >= len(steps):
            continue
        reached.add(index)
        waiting += _next(steps, index, through_landing)
    return reached


def _loop_without_waypoint(steps: tuple[Step, ...]) -> Jump | None:
    """Return the jump that closes a loop in which nothing is flown; None if there is none."""
    idle = [i for i, step in enumerate(steps) if not isinstance(step, WAYPOINTS)]
    if (loop := loop_in({i: _next(steps, i, through_landing=True) for i in idle})) is None:
        return None
    jumps = [(i, step) for i in loop if isinstance(step := steps[i], Jump) and step.target <= i]
    return max(jumps, key=itemgetter(0))[1]


def loop_in(following: Mapping[int, Sequence[int]]) -> list[int] | None:
    """Return the items of a loop in which nothing is flown, by the items that may follow each that is not flown."""
    try:
        TopologicalSorter(following).prepare()
    except CycleError as error:
        loop: list[int] = error.args[1]
        return loop
    return None


def _notes(route: Route, flown: set[int], legs: list[Leg]) -> Iterator[str]:
    steps = route.steps
    reached = {steps[i].source for i in flown}
    yield from (
        f"{source}: never reached" for source in dict.fromkeys(s.source for s in steps) if source not in reached
    )
    for i in sorted(flown):
        if isinstance(jump := steps[i], Jump) and jump.repeats is None and jump.target < i:
            yield f"{jump.source}: repeats the items from {steps[jump.target].source} on until stopped"
    if isinstance(legs[0], TakeOff):
        first = next(step for step in steps if step.source == legs[0].source)
        if not isinstance(first, Climb):
            yield f"{first.source}: no take-off before it: takes off to {-legs[0].position[2]:g} m first"
    if isinstance(legs[-1], Land) and legs[-1].source == END:
        yield "end of mission: no landing in the file: returns to the pad and lands"


def _outside_fence(legs: list[Leg], fence: Fence) -> Iterator[str]:
    """Yield what is wrong with legs that end outside the boundary or inside an excluded area; each item once."""
    if Fence(fence.boundary).violation((0.0, 0.0, 0.0)):
        yield "geoFence: inclusion: home is outside of it"
    sources = set[str]()
    for leg in legs:
        if leg.source in sources:
            continue
        if reasons := [reason for place in _places(leg) if (reason := fence.violation(place))]:
            sources.add(leg.source)
            yield f"{leg.source}: latitude, longitude: {reasons[-1]}"


def _places(leg: Leg) -> list[Position]:
    """Return the end of a leg; of a circle, places all around it."""
    if not isinstance(leg, Circle):
        return [leg.position]
    north, east, down = leg.centre
    angles = [math.tau * i / 64 for i in range(64)]
    return [(north + leg.radius * math.cos(a), east + leg.radius * math.sin(a), down) for a in angles]
