"""Impairments of a link, one class a kind of fault."""

from gcs.faults import link as kinds
from vehicle_sim.faults.active import TOLERANCE, Moment
from vehicle_sim.faults.impairment import (
    Datagram,
    DatagramChange,
    GilbertElliottProcess,
    LinkImpairment,
    OrderedImpairment,
    frames,
)


class PacketLoss(DatagramChange, of=kinds.PacketLoss):
    """Loss of each datagram with a probability."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        return None if self.random() < self.fault.settings.probability else data


class BurstLoss(DatagramChange, of=kinds.BurstLoss):
    """Gilbert-Elliott loss, its states in continuous time: the traffic does not change their lengths."""

    _state: GilbertElliottProcess | None = None

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        settings: kinds.BurstLoss = self.fault.settings
        if self._state is None:
            self._state = GilbertElliottProcess(self.generator.spawn(1)[0], settings.gap, settings.burst)
        loss = settings.loss_in_burst if self._state.is_bad(moment) else settings.loss_in_gap
        return None if self.random() < loss else data


class Latency(OrderedImpairment, of=kinds.Latency):
    """Delay of all datagrams."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        self.delay_in_order(datagram, now + self.fault.settings.delay)
        return True


class Jitter(OrderedImpairment, of=kinds.Jitter):
    """Random delays, the order kept."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        self.delay_in_order(datagram, now + self.fault.settings.spread * self.random())
        return True


class Reordering(LinkImpairment, of=kinds.Reordering):
    """Delay of some datagrams, which later ones overtake."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        if self.random() < self.fault.settings.probability:
            self.delay(datagram, now + self.fault.settings.delay)
            return True
        out.append(datagram)
        return False


class Duplication(LinkImpairment, of=kinds.Duplication):
    """Some datagrams twice."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        out.append(datagram)
        if self.random() >= self.fault.settings.probability:
            return False
        self.delay(datagram, now + self.fault.settings.delay)
        return True


class Corruption(DatagramChange, of=kinds.Corruption):
    """Replacement of bytes."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        settings: kinds.Corruption = self.fault.settings
        if self.random() >= settings.probability or not data:
            return data
        changed = bytearray(data)
        for at in self.generator.choice(len(data), min(settings.bytes, len(data)), replace=False):
            changed[at] ^= int(self.generator.integers(1, 256))  # never what it was
        return bytes(changed)


class BadChecksum(DatagramChange, of=kinds.BadChecksum):
    """Wrong checksums."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        if self.random() >= self.fault.settings.probability:
            return data
        changed = bytearray(data)
        for frame in frames(data):
            changed[frame.checksum] ^= int(self.generator.integers(1, 256))
        return bytes(changed)


class Truncation(DatagramChange, of=kinds.Truncation):
    """Datagrams cut off."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        if self.random() >= self.fault.settings.probability or len(data) < 2:
            return data
        return data[: int(self.generator.integers(1, len(data)))]


class BandwidthCap(OrderedImpairment, of=kinds.BandwidthCap):
    """Queue in front of a slow line."""

    _free_at = 0.0

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        settings: kinds.BandwidthCap = self.fault.settings
        begin = max(now, self._free_at)
        if (begin - now) * settings.rate + len(datagram[0]) > settings.queue:
            return True
        self._free_at = begin + len(datagram[0]) / settings.rate
        self.delay_in_order(datagram, self._free_at)
        return begin > now


class Partition(DatagramChange, of=kinds.Partition):
    """Loss of every datagram."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        return None


class Stall(OrderedImpairment, of=kinds.Stall):
    """Delay of all datagrams until the fault ends."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        self.delay_in_order(datagram, self.fault.schedule.end_after(now))
        return True


class Flapping(DatagramChange, of=kinds.Flapping):
    """Loss of every datagram while the link is down."""

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        settings: kinds.Flapping = self.fault.settings
        is_down = (moment.elapsed + TOLERANCE) % (settings.down + settings.up) < settings.down
        return None if is_down else data
