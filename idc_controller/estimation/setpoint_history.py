"""Set-points in force on the vehicles over time, and the share of them that their links lose."""

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.settings import SetpointHistorySettings


@dataclass(slots=True)
class _Entry:
    """Set-points of all vehicles, as sent and as estimated to be flown; None: the vehicles are held."""

    effective: float
    sent_at: list[float]
    """Times at which they are sent to each vehicle (N,) (s)."""
    sent: Array | None
    """(3 N,)"""
    flown: Array | None
    """(3 N,); the same object as ``sent`` where that is what all vehicles fly."""
    starts: list[float]
    """Times at which they take effect on each vehicle (N,) (s)."""
    confirmed: list[bool]
    """Vehicles (N,) that have reported that, or that they never flew them."""
    reported: list[bool]
    """Vehicles (N,) that have reported to fly them; what seems to be lost may only be late."""
    exact: bool = True
    """True if all take effect at ``effective``."""
    numbers: list[float] = field(init=False)
    """Those of ``sent``; of held vehicles none."""

    def __post_init__(self) -> None:
        self.numbers = [] if self.sent is None else self.sent.tolist()

    def is_reported(self, which: list[int], reported: Sequence[float], settings: SetpointHistorySettings) -> bool:
        """Return whether a vehicle ``reported`` the elements ``which`` (tilts and thrust) of what was sent."""
        u = self.numbers
        if not u:
            return False
        (north, east, thrust), (tilt_north, tilt_east, lift) = which, reported
        return (
            abs(u[thrust] - lift) < settings.thrust_tolerance
            and abs(u[north] - tilt_north) < settings.tilt_tolerance
            and abs(u[east] - tilt_east) < settings.tilt_tolerance
        )


class InForce(NamedTuple):
    """Set-points ``u`` (3 N,) that act for a while; None: the vehicles are held.

    ``change``: from those before (3 N,), None where there are none. ``previous``: probability with which each vehicle
    (N,) still flies those before.
    """

    u: Array | None
    change: Array | None
    previous: Array


class Confirmation(NamedTuple):
    """Result of a vehicle's report of the set-point that it flew.

    ``as_sent``: whether the vehicle flew what it was sent; None: not decided yet. ``corrected_from``: from when on the
    history has changed (s). ``delay``: from sending the set-point to its effect (s); None: known before. ``late``: it
    had been taken for lost.
    """

    as_sent: bool | None = None
    corrected_from: float | None = None
    delay: float | None = None
    late: bool = False


class SetpointHistory:
    """Set-points of all N vehicles in order of the time at which they take effect (s)."""

    def __init__(self, number_of_uavs: int, settings: SetpointHistorySettings = SetpointHistorySettings()) -> None:
        self._N = number_of_uavs
        self._settings = settings
        self._entries: list[_Entry] = []
        self._effective: list[float] = []
        """Times at which the entries should take effect (s)."""
        self._jitter = [0.0] * number_of_uavs
        self.loss = [settings.loss_min] * number_of_uavs
        """Share of the set-points to each vehicle (N,) that is lost, ``loss_min`` or more."""
        self._confirmed_until = [-math.inf] * number_of_uavs
        """Time at which the newest set-point that each vehicle (N,) has reported should take effect (s)."""

    def clear(self) -> None:
        """Discard the set-points, not the statistics of the links."""
        self._entries, self._effective = [], []

    def add(self, effective: float, u: Array | None, sent_at: Array | None = None) -> None:
        """Add set-points.

        Args:
            effective: when they should take effect (s).
            u: tilts and thrusts (3 N,); None: the vehicles are held.
            sent_at: when they are sent to each vehicle (N,) (s); None: when they take effect.
        """
        starts = [effective] * self._N
        sent = starts.copy() if sent_at is None else sent_at.tolist()
        at = self._at(effective) + 1
        self._entries.insert(at, _Entry(effective, sent, u, u, starts, [False] * self._N, [False] * self._N))
        self._effective.insert(at, effective)

    def switches(self, start: float, end: float) -> list[float]:
        """Return the times between ``start`` and ``end`` (s) at which other set-points should take effect."""
        return [effective for effective in self._effective if start < effective < end]

    def in_force(self, start: float, end: float) -> InForce:
        """Return the mean set-points in force between two such times (s)."""
        at = self._at((start + end) / 2)
        now = self._entries[at].flown if at >= 0 else None
        before = self._entries[at - 1].flown if at >= 1 else None
        if now is None or before is None:
            return InForce(now, None, np.array(self.loss))
        entry, s = self._entries[at], self._settings
        # Jitter of the time of effect leaves as much variance as a loss with that probability.
        period = max(entry.effective - self._entries[at - 1].effective, s.period_min)
        punctual = (s.punctuality / period) ** 2 / 3.0
        previous = [
            punctual if confirmed else min(loss + (jitter / period) ** 2, 1.0)
            for confirmed, loss, jitter in zip(entry.confirmed, self.loss, self._jitter, strict=True)
        ]
        return InForce(self._mean(at, start, end), now - before, np.array(previous))

    def _mean(self, at: int, start: float, end: float) -> Array | None:
        n = self._settings.neighbours
        near = self._entries[max(at - n, 0) : at + n + 1]
        if False not in [entry.exact for entry in near] or any(entry.flown is None for entry in near):
            return self._entries[at].flown
        flown = np.array([entry.flown for entry in near])
        # An unconfirmed one takes effect after the confirmed ones before it, and before the confirmed ones after it.
        starts, confirmed = np.array([entry.starts for entry in near]), np.array([entry.confirmed for entry in near])
        after = np.minimum.accumulate(np.where(confirmed, starts, np.inf)[::-1], axis=0)[::-1]
        starts = np.maximum.accumulate(np.where(confirmed, starts, np.minimum(starts, after)), axis=0)
        starts[0] = -np.inf
        edges = np.clip(np.vstack([starts, np.full(self._N, np.inf)]), start, end)
        shares = np.diff(edges, axis=0) / (end - start)  # (entries, N)
        return np.asarray(np.einsum("ki,ki->i", np.hstack([np.repeat(shares, 2, axis=1), shares]), flown))

    def confirm(
        self, uav: int, since: float, until: float, reported: Sequence[float], jitter: float,
        latency_max: float = math.inf,
    ) -> Confirmation | None:  # fmt: skip
        """Correct the history by a vehicle's report of the set-point that it flew.

        Set-points that should have followed since were lost. A time of effect before the set-point was sent, or later
        by more than ``latency_max``, comes from a wrong clock and is not used.

        Args:
            uav: the vehicle (0 .. N-1).
            since, until: in which it flew the set-point (s).
            reported: its tilt (north, east) and thrust (N) (3,).
            jitter: by how much the latency of set-points to it varies (s).
            latency_max: largest latency of set-points to it (s).

        Returns:
            What follows; None for a set-point that was never sent.
        """
        self._jitter[uav] = jitter
        s, entries, tolerance = self._settings, self._entries, self._settings.time_tolerance + jitter
        which = [2 * uav, 2 * uav + 1, 2 * self._N + uav]
        newest = self._at(until + tolerance)
        # Those that should be in force already; then those that would come earlier than they should.
        for flown in chain(range(newest, max(newest - s.losses_max, -1), -1), range(newest + 1, len(entries))):
            if entries[flown].is_reported(which, reported, s):
                break
        else:
            return None
        self._confirmed_until[uav] = max(self._confirmed_until[uav], entries[flown].effective)
        changed = math.inf
        overdue = [entry for entry in entries[flown + 1 : newest + 1] if entry.effective + tolerance < until]
        for entry in overdue:
            changed = min(changed, self._set_lost(entry, uav, which, reported))
        first = flown
        while first > 0 and entries[first - 1].is_reported(which, reported, s):
            first -= 1
        delay, late = None, entries[flown].confirmed[uav] and not entries[flown].reported[uav]
        latency = since - entries[first].sent_at[uav]
        if first and flown - first < s.losses_max and -s.punctuality <= latency <= latency_max:
            if first == flown and not entries[first].reported[uav]:
                delay = max(latency, 0.0)
                changed = min(changed, self._expect(entries[first + 1 :], uav, delay))
            changed = min(changed, self._set_start(entries[first], uav, which, since))
        as_sent = None
        if overdue or entries[flown].effective + tolerance < until:
            as_sent = not overdue
            self._learn(uav, float(not as_sent))
        elif changed == math.inf and delay is None:
            return None
        return Confirmation(as_sent, changed if changed < math.inf else None, delay, late)

    def _set_lost(self, entry: _Entry, uav: int, which: list[int], flown: Sequence[float]) -> float:
        """Set what a vehicle flew instead of a lost set-point; return from when on the history changes (s)."""
        entry.confirmed[uav] = True
        if entry.flown is None or bool((entry.flown[which] == flown).all()):
            return math.inf
        entry.flown = entry.flown.copy()
        entry.flown[which] = flown
        return entry.effective

    def _set_start(self, entry: _Entry, uav: int, which: list[int], since: float) -> float:
        """Set the time at which a set-point took effect; return from when on the history changes (s)."""
        entry.confirmed[uav] = entry.reported[uav] = True
        assert entry.flown is not None and entry.sent is not None
        changed = math.inf
        if entry.flown is not entry.sent and any(entry.flown[k] != entry.sent[k] for k in which):
            entry.flown = entry.flown.copy()
            entry.flown[which] = entry.sent[which]
            changed = entry.effective
        if abs(since - entry.starts[uav]) > self._settings.punctuality:
            changed = min(changed, since, entry.starts[uav])
            entry.starts[uav], entry.exact = since, False
        return changed

    def _expect(self, later: list[_Entry], uav: int, delay: float) -> float:
        """Expect the same delay of those that were sent later, where it is clearly longer than expected."""
        changed = math.inf
        for entry in later:
            start = entry.sent_at[uav] + delay
            if not entry.confirmed[uav] and start > entry.starts[uav] + self._settings.time_tolerance:
                changed = min(changed, entry.starts[uav])
                entry.starts[uav], entry.exact = start, False
        return changed

    def received_by_all(self, effective: float, age_max: float) -> float:
        """Return when the last set-points which all vehicles are known to have received take effect (s).

        Between ``effective`` - ``age_max`` and ``effective`` (s); a vehicle that has reported none is left out.
        """
        known = [time for time in self._confirmed_until if time > -math.inf]
        return min(max(min(known, default=effective), effective - age_max), effective)

    def forget(self, before: float) -> None:
        """Discard what is no longer in force at ``before`` (s)."""
        old = max(self._at(before) - self._settings.neighbours, 0)
        del self._entries[:old], self._effective[:old]

    def _at(self, time: float) -> int:
        """Return the index of the last entry that should be in force at ``time``; -1: none."""
        return bisect.bisect_right(self._effective, time) - 1

    def _learn(self, uav: int, lost: float) -> None:
        share = self.loss[uav] + self._settings.loss_share * (lost - self.loss[uav])
        self.loss[uav] = max(share, self._settings.loss_min)
