"""How long set-points are on their way to one vehicle, as it says itself."""

from __future__ import annotations

from collections import deque
from statistics import median

REMEMBERED = 5  # set-points: a quarter of a second
ON_THEIR_WAY = 40  # set-points that may yet be told of
ENOUGH = 3


class SetpointWay:
    """From when a set-point is sent until the vehicle flies it. Times in s, of the team's clock.

    Round trips tell less: on a way that loses or reorders, those that arrive are not late.
    """

    def __init__(self) -> None:
        self._sent: deque[tuple[float, float]] = deque(maxlen=ON_THEIR_WAY)
        self._delays: deque[float] = deque(maxlen=REMEMBERED)

    def sent(self, effective: float, time: float) -> None:
        """The set-point that is to act from ``effective`` on goes out at ``time``."""
        self._sent.append((effective, time))

    def began(self, effective: float, since: float) -> None:
        """The set-point that was to act from ``effective`` on did so from ``since`` on."""
        time = next((sent for meant, sent in reversed(self._sent) if meant == effective), None)
        if time is not None:
            self._delays.append(max(since - time, 0.0))

    @property
    def delay(self) -> float | None:
        """The usual time (s); None: too few were told of."""
        return median(self._delays) if len(self._delays) >= ENOUGH else None
