"""Events of a run for the report page: phases, modes, faults, alarms, isolated channels and waypoints."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np

from gcs.mission.targets import Target
from gcs.record.arrival import closest_in_order
from gcs.record.faults import FAULTS_FILE
from gcs.record.modes import OFFBOARD
from gcs.record.reader import read_json
from gcs.record.run_data import RunData
from gcs.record.tables import ALARMS, INNOVATIONS, MODES, PHASES

Event = dict[str, Any]


def event(kind: str, start: float, end: float | None, source: str, text: str, severity: str = "info") -> Event:
    """Return an event as the page reads it; ``end`` None: it has no duration, or lasts to the end (an isolation)."""
    return {"kind": kind, "start": start, "end": end, "source": source, "text": text, "severity": severity}


def events(run: RunData, *, is_over: bool = True) -> list[Event]:
    """Return all events of a run, in the order of time; of one that is not over without waypoints, still ahead."""
    found = [*phases(run), *modes(run), *faults(run), *alarms(run), *isolations(run), *contacts(run)]
    if is_over:
        found += waypoints(run)
    return sorted(found, key=lambda each: each["start"])


def phases(run: RunData) -> Iterable[Event]:
    """Yield the phases of the flight."""
    table = run.tables[PHASES]
    ends = [*table["time_s"][1:].tolist(), _end(run)] if len(table) else []
    for row, end in zip(table, ends, strict=True):
        start = float(row["time_s"])
        yield event("phase", start, max(start, end), "team", row["phase"])  # the last one begins after the truth ends


def modes(run: RunData) -> Iterable[Event]:
    """Yield when vehicles flew by themselves: in another mode than OFFBOARD, or by a failsafe, while armed."""
    table = run.tables[MODES]
    for vehicle in np.unique(table["vehicle"]).astype(int).tolist():
        rows = table[table["vehicle"] == vehicle]
        ends = [*rows["time_s"][1:].tolist(), _end(run)]
        for row, end in zip(rows, ends, strict=True):
            if row["armed"] and (row["mode"] != OFFBOARD or row["failsafe"]):
                text = f"{row['mode']}{' by a failsafe' if row['failsafe'] else ''}"
                severity = "error" if row["failsafe"] else "info"
                yield event("mode", float(row["time_s"]), end, f"vehicle {vehicle}", text, severity)


def faults(run: RunData) -> Iterable[Event]:
    """Yield the occurrences of each fault, in the time of the tables."""
    record = read_json(run.folder / FAULTS_FILE)
    take_off, given = record.get("take_off_s") or 0.0, (run.manifest.get("mission") or {}).get("faults") or []
    for fault in record.get("faults", ()):
        settings = (given[fault["number"] - 1] if fault["number"] <= len(given) else {}).get("settings") or {}
        detail = ", ".join(f"{name} {_word(value)}" for name, value in settings.items())
        vehicles = fault.get("vehicles")
        source = "all vehicles" if vehicles is None else ", ".join(f"vehicle {i}" for i in vehicles)
        if str(settings.get("channel", "")).startswith("payload"):
            source = "payload"
        kind = fault["kind"].replace("_", " ")
        text = f"{kind}{f' of {direction}' if (direction := fault.get('direction')) else ''}"
        for start, end in fault.get("activations", ()):
            until = None if end is None else end + take_off
            yield event("fault", start + take_off, until, source, f"{text} ({detail})" if detail else text, "warning")


def alarms(run: RunData) -> Iterable[Event]:
    """Yield the onsets of alarms."""
    for row in run.tables[ALARMS]:
        text = f"{row['code'].replace('_', ' ')}{': ' if row['text'] else ''}{row['text']}"
        yield event("alarm", float(row["time_s"]), None, row["source"], text, row["severity"]) | {"code": row["code"]}


def isolations(run: RunData) -> Iterable[Event]:
    """Yield when a channel of a source was isolated: by the innovation tests or, where not on record, by the alarms."""
    table = run.tables[INNOVATIONS]
    if not len(table):
        for row in run.tables[ALARMS]:
            if row["code"] == "channel_isolated":
                yield event("isolation", float(row["time_s"]), None, row["source"], row["text"], row["severity"])
        return
    isolated = table[table["state"] == "isolated"]
    for source, channel in dict.fromkeys(zip(isolated["source"], isolated["channel"], strict=True)):
        rows = table[(table["source"] == source) & (table["channel"] == channel)]
        states = np.array(rows["state"], dtype=str)
        edges = [0, *(np.flatnonzero(states[1:] != states[:-1]) + 1).tolist(), len(rows)]
        for begin, end in pairwise(edges):
            if states[begin] == "isolated":
                until = float(rows["time_s"][end]) if end < len(rows) else None
                yield event("isolation", float(rows["time_s"][begin]), until, source, channel, "error")


def contacts(run: RunData) -> Iterable[Event]:
    """Yield when something began to touch where nothing had before: payload, UAVs and obstacles."""
    touches = np.zeros(0, dtype=bool) if run.contacts is None else run.contacts > 0
    for row in np.flatnonzero(touches & ~np.concatenate([[False], touches])[:-1]).tolist():
        yield event("contact", float(run.time[row]), None, "team", "something touches", "error")


def waypoints(run: RunData) -> Iterable[Event]:
    """Yield when the payload was nearest to each waypoint of a route, in the order of the route without its jumps."""
    mission = run.manifest.get("mission") or {}
    steps = (mission.get("reference") or {}).get("steps") or ()
    targets = []
    for step in steps:
        place = step.get("place") or {}
        if "spline" in step and None not in (place.get("horizontal"), place.get("altitude")):
            targets.append(Target(step["source"], (*place["horizontal"], -place["altitude"])))
    if not targets or not len(run.time):
        return
    rows, distances = closest_in_order(run.payload_position, targets, (mission.get("limits") or {}).get("arrival", 0.3))
    for number, (target, row, distance) in enumerate(zip(targets, rows.tolist(), distances.tolist(), strict=True), 1):
        text = f"waypoint {number}, {target.name}: nearest, {distance:.2f} m from it"
        yield event("waypoint", float(run.time[row]), None, "payload", text)


def _end(run: RunData) -> float:
    return float(run.time[-1]) if len(run.time) else 0.0


def _word(value: Any) -> str:
    return (
        ", ".join(map(_word, value))
        if isinstance(value, list)
        else f"{value:g}"
        if isinstance(value, float)
        else str(value)
    )
