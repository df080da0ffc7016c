"""Faults of the links."""

from __future__ import annotations

from gcs.faults import link as kinds
from vehicle_sim.faults.frames import frames
from vehicle_sim.faults.impairment import OnOff, OrderedStage, Stage
from vehicle_sim.faults.interface import Datagram
from vehicle_sim.faults.schedule import TOLERANCE, Moment


class PacketLoss(Stage):
    """Each one may be lost."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Lost or let through."""
        if self.random() < self.fault.settings.probability:
            return True
        out.append(datagram)
        return False


class BurstLoss(Stage):
    """Gilbert-Elliott, the states in continuous time: how often is sent does not change how long they last."""

    _state: OnOff | None = None

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Lost or let through."""
        settings: kinds.BurstLoss = self.fault.settings
        if self._state is None:
            self._state = OnOff(self.generator.spawn(1)[0], settings.gap, settings.burst)
        loss = settings.loss_in_burst if self._state.is_on(moment) else settings.loss_in_gap
        if self.random() < loss:
            return True
        out.append(datagram)
        return False


class Latency(OrderedStage):
    """All of them later."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Held back."""
        self.hold_in_order(datagram, now + self.fault.settings.delay)
        return True


class Jitter(OrderedStage):
    """All of them later by random times."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Held back."""
        self.hold_in_order(datagram, now + self.fault.settings.spread * self.random())
        return True


class Reordering(Stage):
    """Some of them behind those that come after."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Held back or let through."""
        if self.random() < self.fault.settings.probability:
            self.hold(datagram, now + self.fault.settings.delay)
            return True
        out.append(datagram)
        return False


class Duplication(Stage):
    """Some of them twice."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Let through, and perhaps once more."""
        out.append(datagram)
        if self.random() >= self.fault.settings.probability:
            return False
        self.hold(datagram, now + self.fault.settings.delay)
        return True


class Corruption(Stage):
    """Bytes replaced."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Changed or let through."""
        settings: kinds.Corruption = self.fault.settings
        if self.random() >= settings.probability or not datagram[0]:
            out.append(datagram)
            return False
        data = bytearray(datagram[0])
        count = min(settings.bytes, len(data))
        for at in self.generator.choice(len(data), count, replace=False):
            data[at] ^= int(self.generator.integers(1, 256))  # never what it was
        out.append((bytes(data), datagram[1]))
        return True


class BadChecksum(Stage):
    """Checksums wrong."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Changed or let through."""
        if self.random() >= self.fault.settings.probability:
            out.append(datagram)
            return False
        data = bytearray(datagram[0])
        for frame in frames(datagram[0]):
            data[frame.checksum] ^= int(self.generator.integers(1, 256))
        out.append((bytes(data), datagram[1]))
        return True


class Truncation(Stage):
    """Cut off."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Cut off or let through."""
        if self.random() >= self.fault.settings.probability or len(datagram[0]) < 2:
            out.append(datagram)
            return False
        out.append((datagram[0][: int(self.generator.integers(1, len(datagram[0])))], datagram[1]))
        return True


class BandwidthCap(OrderedStage):
    """A queue in front of a slow line."""

    _free_at = 0.0

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Held back, or lost."""
        settings: kinds.BandwidthCap = self.fault.settings
        begin = max(now, self._free_at)
        if (begin - now) * settings.rate + len(datagram[0]) > settings.queue:
            return True
        self._free_at = begin + len(datagram[0]) / settings.rate
        self.hold_in_order(datagram, self._free_at)
        return begin > now


class Partition(Stage):
    """Nothing passes."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Lost."""
        return True


class Stall(OrderedStage):
    """Nothing passes, until all does."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Held back."""
        self.hold_in_order(datagram, self.fault.schedule.end_after(now))
        return True


class Flapping(Stage):
    """Down and up."""

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Lost or let through."""
        settings: kinds.Flapping = self.fault.settings
        if (moment.elapsed + TOLERANCE) % (settings.down + settings.up) < settings.down:
            return True
        out.append(datagram)
        return False


STAGES: dict[type, type[Stage]] = {
    kinds.PacketLoss: PacketLoss,
    kinds.BurstLoss: BurstLoss,
    kinds.Latency: Latency,
    kinds.Jitter: Jitter,
    kinds.Reordering: Reordering,
    kinds.Duplication: Duplication,
    kinds.Corruption: Corruption,
    kinds.BadChecksum: BadChecksum,
    kinds.Truncation: Truncation,
    kinds.BandwidthCap: BandwidthCap,
    kinds.Partition: Partition,
    kinds.Stall: Stall,
    kinds.Flapping: Flapping,
}
