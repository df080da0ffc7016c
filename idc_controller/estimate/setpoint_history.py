"""The set-points that act on the vehicles, from when on, and how many of them are lost on their way."""

from __future__ import annotations

import bisect
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNCLEAR = 0.012
"""So near to the moment at which a set-point should act it is not known which one does (s)."""
SAME = np.array([2e-4, 2e-4, 2e-3])
"""Set-points that differ by less are the same: tilts, thrust (N)."""
LOSS_SHARE = 0.05
"""Of one set-point in the running mean of those that are lost."""
LOST_MAX = 20
"""Set-points in a row whose loss is noticed."""


class _Entry(NamedTuple):
    effective: float
    u: Array | None


class InForce(NamedTuple):
    """Set-points (3 N,) that act at a moment, and what they changed (3 N,) against those before; None: none did."""

    u: Array | None
    change: Array | None


class Confirmation(NamedTuple):
    """``as_sent``: whether a vehicle flew what it was sent. ``corrected_from``: when the history has changed (s)."""

    as_sent: bool
    corrected_from: float | None = None


class SetpointHistory:
    """Set-points of all N vehicles in order of the time at which they act (s)."""

    def __init__(self, number_of_uavs: int, least_loss: float) -> None:
        self._N, self._least_loss = number_of_uavs, least_loss
        self._entries: list[_Entry] = []
        self.loss = np.full(number_of_uavs, least_loss)
        """Share of the set-points to each vehicle (N,) that is lost, ``least_loss`` at least."""

    def clear(self) -> None:
        """Forget the set-points, not what is known of the links."""
        self._entries = []

    def add(self, effective: float, u: Array | None) -> None:
        """Set-points (3 N,) that act from ``effective`` on; None: the vehicles are held."""
        bisect.insort(self._entries, _Entry(effective, u), key=_effective)

    def switches(self, start: float, end: float) -> list[float]:
        """Times between ``start`` and ``end`` at which other set-points begin to act."""
        return [entry.effective for entry in self._entries if start < entry.effective < end]

    def in_force(self, time: float) -> InForce:
        """What acts at ``time``."""
        at = self._at(time)
        now = self._entries[at].u if at >= 0 else None
        before = self._entries[at - 1].u if at >= 1 else None
        return InForce(now, None if now is None or before is None else now - before)

    def confirm(self, uav: int, time: float, told: Array, spread: float) -> Confirmation | None:
        """What a vehicle says it flew at ``time``: tilt (north, east) and thrust (3,).

        ``spread`` (s): by how much the time varies that set-points take on their way. Where that is an older set-point
        than it should be, those since were lost, and the history has it so. Other words are not believed.
        None where nothing can be told.
        """
        entries, at = self._entries, self._at(time)
        following = entries[at + 1].effective if at + 1 < len(entries) else np.inf
        unclear = UNCLEAR + spread
        if at < 1 or not entries[at].effective + unclear < time < following - unclear:
            return None
        which = [2 * uav, 2 * uav + 1, 2 * self._N + uav]

        def flew(k: int) -> bool:
            u = entries[k].u
            return u is not None and bool((np.abs(u[which] - told) < SAME).all())

        if flew(at):
            self._learn(uav, 0.0)
            return Confirmation(as_sent=True)
        last = next((k for k in range(at - 1, max(at - LOST_MAX, 0) - 1, -1) if flew(k)), None)
        if last is None:
            return None
        for k in range(last + 1, at + 1):
            effective, u = entries[k]
            if u is not None:
                u = u.copy()
                u[which] = told
                entries[k] = _Entry(effective, u)
        self._learn(uav, 1.0)
        return Confirmation(as_sent=False, corrected_from=entries[last + 1].effective)

    def forget(self, before: float) -> None:
        """What does not act any more at ``before`` (s)."""
        del self._entries[: max(self._at(before), 0)]

    def _at(self, time: float) -> int:
        """Index of the last entry that acts at ``time``; -1: none."""
        return bisect.bisect_right(self._entries, time, key=_effective) - 1

    def _learn(self, uav: int, lost: float) -> None:
        share = self.loss[uav] + LOSS_SHARE * (lost - self.loss[uav])
        self.loss[uav] = max(share, self._least_loss)


def _effective(entry: _Entry) -> float:
    return entry.effective
