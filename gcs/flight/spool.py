"""How much of the hover thrust there is while the payload stands: growing before the climb, fading after it."""

from __future__ import annotations

SPOOL_UP = 2.5  # s from idle to hover thrust
SPOOL_DOWN = 2.0  # s from hover thrust to idle
STANDING_SHARE = 0.8  # of the hover thrust, with which the payload stands and the links are taut
LEAN = 0.05  # sine of a link's tilt with which it stays upright as the thrust fades
UPRIGHT_TIMEOUT = 5.0  # s that are waited for this


def spooling_up(elapsed: float) -> float:
    """Share of the hover thrust ``elapsed`` (s) after the rotors have started."""
    return min(elapsed / SPOOL_UP, 1.0)


class SpoolDown:
    """The thrust fades, but not before links that lean against the wind have come upright."""

    def __init__(self, time: float) -> None:
        """``time`` (s) of the touch-down."""
        self._since = time
        self._leaning = True

    def share(self, time: float, lean: float) -> float:
        """Share of the hover thrust at ``time`` (s); ``lean``: the largest sine of a link's tilt along an axis."""
        if self._leaning:
            share = max(1.0 - (time - self._since) / SPOOL_DOWN, STANDING_SHARE)
            if share > STANDING_SHARE or (lean > LEAN and time - self._since < UPRIGHT_TIMEOUT):
                return share
            self._leaning, self._since = False, time - (1.0 - STANDING_SHARE) * SPOOL_DOWN
        return max(1.0 - (time - self._since) / SPOOL_DOWN, 0.0)
