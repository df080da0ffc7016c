"""Control flow of a route: loops without a waypoint, steps never reached, legs that cannot be flown."""

import math
from collections.abc import Iterator, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from itertools import islice
from operator import itemgetter

from gcs.mission.fence import Fence
from gcs.mission.route import END, TRIED_LEGS, Circle, GroundLeg, Land, Leg, Position, Route, TakeOff, ends_on_ground
from gcs.mission.steps import (
    Climb,
    Descend,
    Go,
    Grip,
    Jump,
    PlacePayload,
    Return,
    Stay,
    Step,
    Turn,
)

WAYPOINTS = (Climb, Go, Turn, Stay, PlacePayload, Descend, Return)
_FLOWN = Climb | Go | Turn | Stay | PlacePayload


def check_flow(route: Route, fence: Fence) -> tuple[list[str], list[str]]:
    """Return problems and notes, one line each without the file's name."""
    steps = route.steps
    if not any(isinstance(step, _FLOWN) for step in steps):
        return ["mission: there is no waypoint"], []
    if (jump := _loop_without_waypoint(steps)) is not None:
        return [f"{jump.source}: target: a loop without a waypoint in it would never end"], []
    flown = _reached(steps)
    if not any(isinstance(step, _FLOWN) for i, step in enumerate(steps) if i in flown):
        return ["mission: no waypoint is ever reached"], []
    if (problem := route.problem()) is not None:
        return [problem], []
    legs = list(islice(route.legs(), TRIED_LEGS))
    return list(_outside_fence(legs, fence)), list(_notes(route, flown, legs))


def _next(steps: tuple[Step, ...], index: int) -> list[int]:
    """Return the indices that may follow a step; ``len(steps)`` is the end."""
    match steps[index]:
        case Jump(target=target, repeats=repeats):
            return [target] if repeats is None else [target, index + 1]
        case Stay():
            return []
    return [index + 1]


def _reached(steps: tuple[Step, ...]) -> set[int]:
    """Return the indices of the steps that are carried out.

    After a landing that nothing follows, only what the grippers do is.
    """
    following: dict[tuple[int, Step | None], list[tuple[int, Step | None]]] = {}
    waiting: list[tuple[int, Step | None]] = [(0, None)]
    while waiting:
        index, landed_by = state = waiting.pop()
        if state in following or index >= len(steps) or ends_on_ground(step := steps[index], landed_by):
            continue
        if isinstance(step, Descend | Return):
            landed_by = step
        elif isinstance(step, _FLOWN):
            landed_by = None
        following[state] = [(i, landed_by) for i in _next(steps, index)]
        waiting += following[state]
    used = {s for s in following if s[1] is None or isinstance(steps[s[0]], _FLOWN | Grip)}
    while more := {s for s, after in following.items() if s not in used and not used.isdisjoint(after)}:
        used |= more
    return {index for index, _ in used}


def _loop_without_waypoint(steps: tuple[Step, ...]) -> Jump | None:
    """Return the jump that closes a loop in which nothing is flown; None if there is none."""
    idle = [i for i, step in enumerate(steps) if not isinstance(step, WAYPOINTS)]
    if (loop := loop_in({i: _next(steps, i) for i in idle})) is None:
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
    climbs = {step.source for step in steps if isinstance(step, Climb | PlacePayload)}
    for source, leg in {leg.source: leg for leg in reversed(legs) if isinstance(leg, TakeOff)}.items():
        if source not in climbs:
            yield f"{source}: no take-off before it: takes off to {-leg.position[2]:g} m first"
    if isinstance(legs[-1], Land) and legs[-1].source == END:
        yield "end of mission: no landing in the file: returns to the pad and lands"


def _outside_fence(legs: list[Leg], fence: Fence) -> Iterator[str]:
    """Yield what is wrong with legs that end outside the boundary or inside an excluded area; each item once."""
    if Fence(fence.boundary).violation((0.0, 0.0, 0.0)):
        yield "geoFence: inclusion: home is outside of it"
    sources = set[str]()
    for leg in legs:
        if leg.source in sources or isinstance(leg, GroundLeg):
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
