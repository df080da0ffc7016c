"""Statistics of a link by sequence numbers: messages lost, reordered, duplicated."""

from collections import deque

from gcs.mavlink import px4
from gcs.mavlink.scan_sequence import ScanSequence
from gcs.mavlink.settings import LinkSettings

NUMBERS = 256
REMEMBERED = 96
"""Numbers known as received; less than half of all, so that behind and ahead are not confused."""
AHEAD = NUMBERS - REMEMBERED
"""Numbers that are farther ahead than this are behind."""
_CYCLE = bytes(range(NUMBERS)) * 2


class LinkStatistics:
    """Counts of one link, each since the beginning.

    A gap in the numbers counts once, however many are missing: simultaneous losses are one.
    """

    def __init__(self, reordering_time: float = LinkSettings.reordering_time) -> None:
        """``reordering_time`` (s): a gap that is older is a loss; from then on all are, until a message comes late."""
        self._reordering_time = reordering_time
        self.lost = 0
        self.received = 0
        """Messages, without duplicates."""
        self.missing = 0
        """Messages of the gaps that are losses."""
        self.reordered = 0
        self.duplicated = 0
        self.damaged = 0
        """Datagrams with frames that could not be read: checksum, length, contents."""
        self.not_finite = 0
        """The vehicle's measurements that hold no number."""
        self.payload_not_finite = 0
        """Measurements of the payload that it relays and that hold no number."""
        self.breaks = 0
        """Messages that do not follow the newest one: there was a gap, or they came late or again; or the first."""
        self.scans = ScanSequence()
        """Which scans are complete."""
        self._seen: deque[int] = deque(maxlen=REMEMBERED)
        """The newest last."""
        self._gaps: deque[tuple[float, set[int]]] = deque()
        self._losing = False
        """Whether what was missing last was lost."""

    def add_not_finite(self, component: int) -> None:
        """Count a measurement of ``component`` that is not finite."""
        self.not_finite += component == px4.AUTOPILOT_COMPONENT
        self.payload_not_finite += component == px4.PAYLOAD_UNIT_COMPONENT

    def message(self, number: int, now: float) -> bool:
        """Count a message by its sequence number (0 .. 255); return True if it was sent after all that came before."""
        if self._gaps:
            self.settle(now)
        newest = self._seen[-1] if self._seen else None
        ahead = 1 if newest is None else (number - newest) % NUMBERS
        self.breaks += newest is None or ahead != 1
        if 0 < ahead <= AHEAD:
            if newest is not None and ahead > 1:
                missing = {(newest + k) % NUMBERS for k in range(1, ahead)}
                self._gaps.append((now, missing))
            self._seen.append(number)
            self.received += 1
            return True
        if number in self._seen:
            self.duplicated += 1
        else:
            self.received += 1
            self.reordered += 1
            self._losing = False
            for _, missing in self._gaps:
                missing.discard(number)
        return False

    def run(self, number: int, length: int, now: float) -> None:
        """Count messages of consecutive numbers, ``number`` the first, as :meth:`message` does one by one."""
        first = 0
        # Where the first follows what came before, all do.
        if not self._seen or (number - self._seen[-1]) % NUMBERS != 1:
            while first < length and not self.message((number + first) % NUMBERS, now):
                first += 1
            first += 1
        if first < length:
            if self._gaps:
                self.settle(now)
            begin = (number + first) % NUMBERS
            self._seen.extend(_CYCLE[begin : begin + length - first])
            self.received += length - first

    def settle(self, now: float) -> None:
        """Count the gaps that are not filled by ``now`` (s) as losses; those after a loss at once."""
        while self._gaps and (self._losing or now - self._gaps[0][0] > self._reordering_time):
            missing = len(self._gaps.popleft()[1])
            self._losing = missing > 0
            self.lost += self._losing
            self.missing += missing
