"""The set-points that act on the vehicles, from when on, and how many of them are lost on their way."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNCLEAR = 0.012
"""So near to the moment at which a set-point should act it is not known which one does (s)."""
LEAST_PERIOD = 0.012
"""Set-points that follow each other sooner are taken to come after this time (s)."""
SAME = np.array([2e-4, 2e-4, 2e-3])
"""Set-points that differ by less are the same: tilts, thrust (N)."""
LOSS_SHARE = 0.05
"""Of one set-point in the running mean of those that are lost."""
LOST_MAX = 20
"""Set-points in a row whose loss is noticed."""
PUNCTUAL = 0.005
"""What begins to act so near to its time acts at its time (s): vehicles look for set-points once a step of theirs."""
NEIGHBOURS = 3
"""Set-points before and after one that may act in its place, because they come late or early."""


@dataclass
class _Entry:
    """Set-points of all vehicles; None: they are held. What is believed of them, vehicle by vehicle."""

    effective: float
    leaves: Array
    """When they leave the ground, vehicle by vehicle (N,) (s)."""
    sent: Array | None
    flown: Array | None
    starts: Array
    """When each vehicle (N,) began to fly it (s)."""
    known: NDArray[np.bool_]
    """Which vehicles (N,) have told so, or that they never did."""
    exact: bool = True
    """Whether all began when they should."""


class InForce(NamedTuple):
    """Set-points ``u`` (3 N,) that act for a while; None: the vehicles are held.

    ``change``: against those before (3 N,), None where there is nothing to compare. ``doubt``: with what probability
    each vehicle (N,) still flies those before.
    """

    u: Array | None
    change: Array | None
    doubt: Array


class Confirmation(NamedTuple):
    """``as_sent``: whether a vehicle flew what it was sent; None: that cannot be told yet.

    ``corrected_from``: when the history has changed (s). ``delay``: from when the one flown left the ground until it
    began to act (s); None: that was known.
    """

    as_sent: bool | None = None
    corrected_from: float | None = None
    delay: float | None = None


class SetpointHistory:
    """Set-points of all N vehicles in order of the time at which they act (s)."""

    def __init__(self, number_of_uavs: int, least_loss: float) -> None:
        self._N, self._least_loss = number_of_uavs, least_loss
        self._entries: list[_Entry] = []
        self._spread = np.zeros(number_of_uavs)
        self.loss = np.full(number_of_uavs, least_loss)
        """Share of the set-points to each vehicle (N,) that is lost, ``least_loss`` at least."""

    def clear(self) -> None:
        """Forget the set-points, not what is known of the links."""
        self._entries = []

    def add(self, effective: float, u: Array | None, leaves: Array | None = None) -> None:
        """Set-points (3 N,) that act from ``effective`` on; None: the vehicles are held.

        ``leaves`` (N,): when they leave the ground (s); None: when they act.
        """
        starts, known = np.full(self._N, effective), np.zeros(self._N, dtype=bool)
        entry = _Entry(effective, starts.copy() if leaves is None else leaves, u, u, starts, known)
        bisect.insort(self._entries, entry, key=_effective)

    def switches(self, start: float, end: float) -> list[float]:
        """Times between ``start`` and ``end`` at which other set-points should begin to act."""
        return [entry.effective for entry in self._entries if start < entry.effective < end]

    def in_force(self, start: float, end: float) -> InForce:
        """What acts between two such times, on average."""
        at = self._at((start + end) / 2)
        now = self._entries[at].flown if at >= 0 else None
        before = self._entries[at - 1].flown if at >= 1 else None
        if now is None or before is None:
            return InForce(now, None, self.loss)
        entry = self._entries[at]
        # One that comes sooner or later than it should leaves as much variance as one that is lost that often.
        period = max(entry.effective - self._entries[at - 1].effective, LEAST_PERIOD)
        unknown = np.minimum(self.loss + (self._spread / period) ** 2, 1.0)
        doubt = np.where(entry.known, (PUNCTUAL / period) ** 2 / 3.0, unknown)
        return InForce(self._mean(at, start, end), now - before, doubt)

    def _mean(self, at: int, start: float, end: float) -> Array | None:
        near = self._entries[max(at - NEIGHBOURS, 0) : at + NEIGHBOURS + 1]
        if all(entry.exact for entry in near) or any(entry.flown is None for entry in near):
            return self._entries[at].flown
        flown = np.array([entry.flown for entry in near])
        # What is not known of begins after what is known to have begun before it, and before what is known after it.
        starts, known = np.array([entry.starts for entry in near]), np.array([entry.known for entry in near])
        after = np.minimum.accumulate(np.where(known, starts, np.inf)[::-1], axis=0)[::-1]
        starts = np.maximum.accumulate(np.where(known, starts, np.minimum(starts, after)), axis=0)
        starts[0] = -np.inf
        edges = np.clip(np.vstack([starts, np.full(self._N, np.inf)]), start, end)
        shares = np.diff(edges, axis=0) / (end - start)  # (entries, N)
        return np.asarray(np.einsum("ki,ki->i", np.hstack([np.repeat(shares, 2, axis=1), shares]), flown))

    def confirm(
        self, uav: int, since: float, until: float, told: Array, spread: float, longest: float = math.inf
    ) -> Confirmation | None:
        """A vehicle says that it flew ``told``, tilt (north, east) and thrust (3,), from ``since`` to ``until`` (s).

        ``spread`` (s): by how much the time varies that set-points take on their way. From now on the history has it
        when the vehicle began to fly this one, and, where others should have come since, that they were lost. Words
        that tell of none that was sent are not believed: None. Nor is a beginning that is earlier than the set-point
        left, or later by more than ``longest`` (s): then a clock is wrong.
        """
        self._spread[uav] = spread
        entries, unclear = self._entries, UNCLEAR + spread
        which = [2 * uav, 2 * uav + 1, 2 * self._N + uav]

        def is_told(u: Array | None) -> bool:
            return u is not None and bool((np.abs(u[which] - told) < SAME).all())

        newest = self._at(until + unclear)
        # Those that should act already; then those that would come earlier than they should.
        candidates = (*range(newest, max(newest - LOST_MAX, -1), -1), *range(newest + 1, len(entries)))
        flown = next((k for k in candidates if is_told(entries[k].sent)), None)
        if flown is None:
            return None
        changed = math.inf
        overdue = [k for k in range(flown + 1, newest + 1) if entries[k].effective + unclear < until]
        for k in overdue:
            changed = min(changed, self._overwrite(entries[k], uav, which, told))
        first = flown
        while first > 0 and is_told(entries[first - 1].sent):
            first -= 1
        delay = None
        took = since - float(entries[first].leaves[uav])
        if first and flown - first < LOST_MAX and -PUNCTUAL <= took <= longest:
            if first == flown and not entries[first].known[uav]:
                delay = max(took, 0.0)
                changed = min(changed, self._expect(entries[first + 1 :], uav, delay))
            changed = min(changed, self._begins(entries[first], uav, which, since))
        as_sent = None
        if overdue or entries[flown].effective + unclear < until:
            as_sent = not overdue
            self._learn(uav, float(not as_sent))
        elif changed == math.inf and delay is None:
            return None
        return Confirmation(as_sent, changed if changed < math.inf else None, delay)

    def _overwrite(self, entry: _Entry, uav: int, which: list[int], told: Array) -> float:
        """One that never came: returns from when on that changes anything."""
        entry.known[uav] = True
        if entry.flown is None or bool((entry.flown[which] == told).all()):
            return math.inf
        entry.flown = entry.flown.copy()
        entry.flown[which] = told
        return entry.effective

    def _begins(self, entry: _Entry, uav: int, which: list[int], since: float) -> float:
        """One that came, and when: returns from when on that changes anything."""
        entry.known[uav] = True
        assert entry.flown is not None and entry.sent is not None
        changed = math.inf
        if bool((entry.flown[which] != entry.sent[which]).any()):
            entry.flown = entry.flown.copy()
            entry.flown[which] = entry.sent[which]
            changed = entry.effective
        if abs(since - entry.starts[uav]) > PUNCTUAL:
            changed = min(changed, since, float(entry.starts[uav]))
            entry.starts[uav], entry.exact = since, False
        return changed

    def _expect(self, later: list[_Entry], uav: int, delay: float) -> float:
        """What is on its way will take as long, where that is clearly longer than was thought."""
        changed = math.inf
        for entry in later:
            start = float(entry.leaves[uav]) + delay
            if not entry.known[uav] and start > entry.starts[uav] + UNCLEAR:
                changed = min(changed, float(entry.starts[uav]))
                entry.starts[uav], entry.exact = start, False
        return changed

    def forget(self, before: float) -> None:
        """What does not act any more at ``before`` (s)."""
        del self._entries[: max(self._at(before) - NEIGHBOURS, 0)]

    def _at(self, time: float) -> int:
        """Index of the last entry that should act at ``time``; -1: none."""
        return bisect.bisect_right(self._entries, time, key=_effective) - 1

    def _learn(self, uav: int, lost: float) -> None:
        share = self.loss[uav] + LOSS_SHARE * (lost - self.loss[uav])
        self.loss[uav] = max(share, self._least_loss)


def _effective(entry: _Entry) -> float:
    return entry.effective
