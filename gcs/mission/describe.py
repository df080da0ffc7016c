"""Description of a mission for the operator: the output of ``gcs check``."""

import math
from collections.abc import Iterable

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from gcs.config import MotionConfig, SystemConfig
from gcs.mission.model import Fault, Limits, Lissajous, Mission
from gcs.mission.route import Circle, FlyTo, HoldForever, Land, Leg, Position, Route, TakeOff

SHOWN_LEGS = 40
COUNTED_LEGS = 20_000


def describe(mission: Mission) -> RenderableType:
    """Return the mission leg by leg, with lengths, an estimate of the time, and what is left out."""
    home, team = mission.home, mission.system.team
    parts: list[RenderableType] = [
        Text(f"{mission.name}  ({mission.path})", style="bold"),
        Text(
            f"{team.vehicles} vehicles, payload {mission.system.payload.mass:g} kg, seed {mission.seed}; home "
            f"{home.latitude:.7f}, {home.longitude:.7f}, {home.altitude:g} m above mean sea level"
        ),
    ]
    if isinstance(mission.reference, Lissajous):
        parts.append(_lissajous(mission.reference))
    else:
        parts += _route(mission.reference, mission.system)
    parts += [Text(line) for line in (*_surroundings(mission), *_limits(mission.limits))]
    parts += [Text(f"note: {note}", style="yellow") for note in mission.notes]
    return Group(*parts)


def _lissajous(curve: Lissajous) -> Text:
    (a, b), w = curve.amplitude, curve.angular_frequency
    time = np.linspace(0.0, curve.duration, 20_001)
    speed = np.hypot(a * w * np.cos(w * time), 2.0 * b * w * np.cos(2.0 * w * time))
    return Text(
        f"figure eight of {2 * a:g} x {2 * b:g} m at {curve.altitude:g} m for {curve.duration:g} s: "
        f"{np.mean(speed) * curve.duration:.1f} m at up to {speed.max():.2f} m/s"
    )


def _route(route: Route, system: SystemConfig) -> list[RenderableType]:
    table = Table("", "leg", "north", "east", "altitude", "m/s", "length (m)", "time (s)", "from")
    length = time = 0.0
    count, last = 0, None
    start: Position = (0.0, 0.0, -system.resting_altitude)
    for leg in route.first_lap(COUNTED_LEGS):
        count, last = count + 1, leg
        leg_length, leg_time, end = _measure(leg, start, system.motion)
        length, time = length + leg_length, time + leg_time
        if count <= SHOWN_LEGS:
            speed = f"{leg.speed:g}" if isinstance(leg, FlyTo | Circle) else ""
            place = (f"{end[0]:.2f}", f"{end[1]:.2f}", f"{-end[2]:.2f}")
            cost = (speed, f"{leg_length:.1f}", f"{leg_time:.0f}")
            table.add_row(str(count), _action(leg), *place, *cost, escape(leg.source))
        start = end
    for column in table.columns[2:8]:
        column.justify = "right"
    summary = f"{count} legs, {length:.0f} m, about {time:.0f} s"
    if isinstance(last, HoldForever):
        summary += ", then holds until stopped"
    elif not isinstance(last, Land):
        summary = f"and so on until stopped: endless; so far {count} legs, {length:.0f} m, about {time:.0f} s"
    more = [Text(f"... and {count - SHOWN_LEGS} more legs")] if count > SHOWN_LEGS else []
    return [table, *more, Text(summary)]


def _action(leg: Leg) -> str:
    match leg:
        case TakeOff(delay=delay):
            return f"wait {delay:g} s, take off" if delay else "take off"
        case FlyTo(hold=hold):
            return ("spline to" if leg.spline else "fly to") + (f", hold {hold:g} s" if hold else "")
        case Circle(turns=turns, radius=radius):
            sense = "clockwise" if leg.clockwise else "counter-clockwise"
            return f"circle {turns:g} x {radius:g} m {sense}"
        case HoldForever():
            return "hold until stopped"
    return "land"


def _measure(leg: Leg, start: Position, motion: MotionConfig) -> tuple[float, float, Position]:
    """Return length (m), time (s) and end of a leg, as an upper estimate: from rest to rest."""
    if isinstance(leg, Circle):
        length = math.tau * leg.radius * leg.turns
        speed = min(leg.speed, math.sqrt(motion.acceleration * leg.radius))
        return length, _time(length, speed, motion), leg.end(start)
    length = math.dist(start, leg.position)
    if isinstance(leg, FlyTo):
        vertical = abs(start[2] - leg.position[2])
        return length, max(_time(length, leg.speed, motion), vertical / motion.climb_speed) + leg.hold, leg.position
    if isinstance(leg, TakeOff):
        return length, leg.delay + _time(length, motion.climb_speed, motion), leg.position
    return length, length / motion.landing_speed if isinstance(leg, Land) else 0.0, leg.position


def _time(length: float, speed: float, motion: MotionConfig) -> float:
    """Return the time from rest to rest at a bounded acceleration (s)."""
    if length < speed**2 / motion.acceleration:
        return 2.0 * math.sqrt(length / motion.acceleration)
    return length / speed + speed / motion.acceleration


def _surroundings(mission: Mission) -> Iterable[str]:
    for obstacle in mission.obstacles:
        shape = obstacle.shape
        place = ", ".join(f"{x:.1f}" for x in obstacle.position[: 2 if shape.is_grounded else 3])
        moving = f", moving ({obstacle.motion.kind})" if obstacle.motion else ""
        hidden = "" if obstacle.known else ", not on the map"
        yield f"{shape.kind} '{obstacle.name}' at [{place}], {shape.dimensions}{hidden}{moving}"
    if mission.boundary:
        rings = f" in {len(mission.boundary)} rings" if len(mission.boundary) > 1 else ""
        yield f"boundary of {sum(map(len, mission.boundary))} corners{rings}"
    for fault in mission.faults:
        yield _fault(fault)


def _fault(fault: Fault) -> str:
    from gcs.faults import KINDS  # takes long to import, spent only where there are faults

    kind = KINDS[fault.kind]
    text = f"fault {fault.kind} from {fault.start:g} s "
    text += f"for {fault.duration:g} s" if fault.duration else "to the end"
    if fault.every is not None:
        text += f", every {fault.every:g} s" + (f" {fault.times} times" if fault.times else "")
    if kind.of_vehicles:
        text += ", all vehicles" if fault.vehicles is None else f", vehicles {', '.join(map(str, fault.vehicles))}"
    if kind.direction is not None:
        direction = fault.direction or kind.direction
        text += ", both directions" if direction == "both" else f", {direction}"
    settings = ", ".join(f"{key} = {value}" for key, value in fault.settings.items())
    return text + (f": {settings}" if settings else "")


def _limits(limits: Limits | None) -> Iterable[str]:
    if limits is None:
        return
    for name, limit, unit in (
        ("position RMSE", limits.position_rmse, f"m after {limits.settle:g} s"),
        ("payload tilt", limits.payload_tilt_deg, "deg"),
        ("clearance", limits.clearance, "m"),
        ("separation of the UAVs", limits.uav_separation, "m"),
        ("touchdown speed", limits.touchdown_speed, "m/s"),
        ("arrival at waypoints and landing", limits.arrival, "m"),
    ):
        if limit is not None:
            yield f"limit: {name} {limit:g} {unit}"
