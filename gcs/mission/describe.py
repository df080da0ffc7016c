"""Description of a mission for the operator: the output of ``gcs check``."""

from collections.abc import Iterable

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from gcs.config import SystemConfig
from gcs.mission.flown_legs import End, flown_legs
from gcs.mission.model import Fault, Limits, Lissajous, Mission
from gcs.mission.route import Route

SHOWN_LEGS = 40


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
    flight = flown_legs(route, system)
    table = Table("", "leg", "north", "east", "alt.", "m/s", "m", "s", "from", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for leg in flight.legs[:SHOWN_LEGS]:
        speed = "" if leg.speed is None else f"{leg.speed:g}"
        place = (f"{leg.north:.2f}", f"{leg.east:.2f}", f"{leg.altitude:.2f}")
        cost = (speed, f"{leg.length:.1f}", f"{leg.time:.0f}")
        table.add_row(str(leg.number), leg.action, *place, *cost, escape(leg.source))
    for column in table.columns:
        column.overflow = "fold"
    for column in table.columns[2:8]:
        column.justify = "right"
    count = len(flight.legs)
    summary = f"{count} legs, {flight.length:.0f} m, about {flight.time:.0f} s"
    if flight.end is End.HOLD:
        summary += ", then holds until stopped"
    elif flight.end is End.NONE:
        summary = f"and so on until stopped: endless; so far {summary}"
    more = [Text(f"... and {count - SHOWN_LEGS} more legs: --json has all")] if count > SHOWN_LEGS else []
    return [table, *more, Text(summary)]


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


def _start(fault: Fault) -> str:
    if fault.start_phase is None:
        return f"{fault.start:g} s"
    after = f"{fault.start_offset:g} s after " if fault.start_offset else ""
    flight = f" of flight {fault.start_flight}" if fault.start_flight else ""
    return f"{after}the start of {fault.start_phase.replace('_', ' ')}{flight}"


def _fault(fault: Fault) -> str:
    from gcs.faults import KINDS  # takes long to import, spent only where there are faults

    kind = KINDS[fault.kind]
    text = f"fault {fault.kind} from {_start(fault)} "
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
