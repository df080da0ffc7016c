"""Faults of the links: what happens to datagrams on a link."""

from collections.abc import Callable, Iterable
from typing import Annotated, dataclass_transform

from gcs.faults.kind import LOST, FaultSettings, S, kind, names, parameter

_LINKS = "link datalink data_link comm comms communication connection radio telemetry mavlink network gcs rc signal"
_PACKETS = "packet packets message messages datagram datagrams frame frames data"
_CHANCE_ALIASES = "p prob chance rate ratio share loss loss_rate percentage percent"
_Chance = Annotated[float, parameter("of a datagram", aliases=_CHANCE_ALIASES, ge=0.0, le=1.0)]
_DELAY_ALIASES = "latency lag time delay_s delay_ms seconds value"
_Delay = 60.0  # s, the longest


@dataclass_transform(frozen_default=True, kw_only_default=True)
def _link_kind(name: str, aliases: Iterable[str], *, bounded: bool = False) -> Callable[[type[S]], type[S]]:
    """Class decorator of a kind that acts on both directions of a link, where a mission names none."""
    return kind(name, "link", aliases, direction="both", bounded=bounded)


@_link_kind(
    "packet_loss",
    (*names(_PACKETS, "loss losses lost drop drops dropped dropping"), "loss", "drop", "drops", "random_loss"),
)
class PacketLoss(FaultSettings):
    """Datagrams are lost, each independently of the others."""

    probability: _Chance


@_link_kind("burst_loss", ("burst", "bursts", "bursty_loss", "loss_burst", "gilbert_elliott", "fading"))
class BurstLoss(FaultSettings):
    """Datagrams are lost in bursts (Gilbert-Elliott): a good and a bad state alternate, with exponential durations."""

    burst: Annotated[float, parameter("mean length of the bad state", "s", gt=0.0, le=1e3)] = 0.5
    gap: Annotated[float, parameter("mean length of the good state", "s", gt=0.0, le=1e4)] = 5.0
    loss_in_burst: Annotated[float, parameter("of a datagram in the bad state", ge=0.0, le=1.0)] = 1.0
    loss_in_gap: Annotated[float, parameter("of a datagram in the good state", ge=0.0, le=1.0)] = 0.0


@_link_kind(
    "latency", ("delay", "lag", "ping", "slow_link", *names(f"{_LINKS} {_PACKETS} time transport", "delay latency lag"))
)
class Latency(FaultSettings):
    """Datagrams arrive later, in their order."""

    delay: Annotated[float, parameter("delay", "s", aliases=_DELAY_ALIASES, ge=0.0, le=_Delay)]


@_link_kind(
    "jitter", ("variable_delay", "random_delay", *names("delay latency", "variation jitter"), *names(_LINKS, "jitter"))
)
class Jitter(FaultSettings):
    """Datagrams arrive later by a random time, in their order."""

    spread: Annotated[
        float,
        parameter(
            "the longest delay; each is uniform from 0",
            "s",
            aliases=f"{_DELAY_ALIASES} delay jitter",
            ge=0.0,
            le=_Delay,
        ),
    ]


@_link_kind("reordering", ("reorder", "out_of_order", *names(_PACKETS, "reordering order")))
class Reordering(FaultSettings):
    """Some datagrams are delayed, so that later ones overtake them."""

    probability: _Chance
    delay: Annotated[float, parameter("of such a datagram", "s", aliases=_DELAY_ALIASES, gt=0.0, le=_Delay)] = 0.05


@_link_kind("duplication", ("duplicate", "duplicates", "repeat", *names(_PACKETS, "duplication duplicated repeated")))
class Duplication(FaultSettings):
    """Some datagrams arrive twice."""

    probability: _Chance
    delay: Annotated[float, parameter("delay of the second one", "s", aliases=_DELAY_ALIASES, ge=0.0, le=_Delay)] = 0.0


@_link_kind(
    "corruption",
    ("corrupt", "garbage", *names("bit byte", "error errors flip flips"), *names(_PACKETS, "corruption corrupted")),
)
class Corruption(FaultSettings):
    """Some bytes of some datagrams are replaced by other ones, anywhere."""

    probability: _Chance
    bytes: Annotated[int, parameter("number of bytes replaced", ge=1, le=1000)] = 1


@_link_kind("bad_checksum", ("crc", "bad_crc", *names("crc checksum", "error errors fault")))
class BadChecksum(FaultSettings):
    """The checksum of every message in some datagrams is wrong; the contents are not."""

    probability: _Chance


@_link_kind("truncation", ("truncate", *names(_PACKETS, "truncation truncated cut")))
class Truncation(FaultSettings):
    """Some datagrams are truncated at a random byte."""

    probability: _Chance


@_link_kind(
    "bandwidth_cap",
    ("throttle", "congestion", "baudrate", "baud_rate", *names("bandwidth rate low", "limit bandwidth cap")),
)
class BandwidthCap(FaultSettings):
    """Datagrams wait for those before them to pass, and are lost when too many wait."""

    rate: Annotated[float, parameter("of each direction of a vehicle's link", "bytes/s", gt=0.0, le=1e9)]
    queue: Annotated[int, parameter("bytes that may wait", "bytes", ge=1, le=10**9)] = 8192


@_link_kind("partition", ("no_link", "disconnect", "blackout", *names(_LINKS, f"{LOST} blackout partition")))
class Partition(FaultSettings):
    """No datagram passes, in both directions or in one."""


@_link_kind(
    "stall", ("freeze", "buffering", *names("link datalink connection network telemetry", "stall freeze")), bounded=True
)
class Stall(FaultSettings):
    """No datagram passes for the duration; then all delayed ones arrive at once."""


@_link_kind("flapping", ("flap", *names(_LINKS, "flapping"), *names("unstable", _LINKS)))
class Flapping(FaultSettings):
    """The link is down and up alternately, down first; what is sent while it is down is lost."""

    down: Annotated[float, parameter("length of each outage", "s", gt=0.0, le=1e4)]
    up: Annotated[float, parameter("time between outages", "s", gt=0.0, le=1e4)]
