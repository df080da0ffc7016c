"""Profiles of real links: what each direction does to datagrams, every number with its source (docs/links.md)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TimeDivision:
    """Half-duplex radios that transmit in turns: what comes outside of an end's windows waits for the next one."""

    window: float
    """Length of a transmit window of each end (s)."""
    silence: float
    """Time after each window in which neither end transmits (s)."""

    @property
    def round(self) -> float:
        """Return the time from one window of an end to its next one (s)."""
        return 2.0 * (self.window + self.silence)


@dataclass(frozen=True, kw_only=True)
class LinkDirection:
    """One direction of a link. What is zero, or None, has no effect."""

    rate: float | None = None
    """What the radio passes (bytes/s), in its windows if it has any."""
    queue: int = 8192
    """Bytes that may wait in front of it; what comes beyond is lost."""
    time_division: TimeDivision | None = None
    loss: float = 0.0
    """Probability of a datagram, beside those that find the queue full."""
    burst: float = 0.0
    """Mean length of the bursts (s) in which all datagrams are lost (Gilbert-Elliott); 0: losses are independent."""
    latency: float = 0.0
    """Least delay of a datagram (s), beside those in the queue and between windows."""
    jitter: float = 0.0
    """Longest delay beyond it (s); each is uniform from 0, the order is kept."""
    reordering: float = 0.0
    """Probability that a datagram is delayed so that later ones overtake it."""
    reordering_delay: float = 0.05
    """Delay of such a datagram (s)."""


@dataclass(frozen=True)
class LinkProfile:
    """Both directions of a link."""

    telemetry: LinkDirection
    """From the vehicle."""
    command: LinkDirection
    """To the vehicle."""


# Firmware of SiK radios, tdm.c (tdm_init), as it computes for AIR_SPEED=64 with ECC=1, in ticks of 16 us: 18 a byte,
# 202 for an empty packet, at most 118 bytes of data in each, windows of three full packets, then two empty ones' time.
_TICK = 16e-6
_BYTE, _EMPTY, _DATA = 18 * _TICK, 202 * _TICK, 118
_PACKET = _EMPTY + _DATA * _BYTE
_SIK = LinkDirection(
    rate=_DATA / _PACKET,
    queue=1850,  # RX_BUFF_MAX in serial.c, of what the serial line brings
    time_division=TimeDivision(3.0 * _PACKET, 2.0 * _EMPTY),
    loss=0.01,  # the middle of 0 to 2 of 100 packets, what the flight report of an RFD900x counts as no loss
    latency=_EMPTY,
)

# Handover interruption (ITU-R M.2134, within a frequency), as often as 3GPP TR 36.777 allows: 1 of 1000 packets is
# lost. Losses come together: 70 % of them at changes of the access or losses of service (Baltrunas and others).
_LTE_LOSS, _LTE_BURST = 1e-3, 0.0275
# One way in operating networks (ITU-T workshop of 24 July 2014): 16.2 ms up, to which the scheduler adds 10 to 30 ms,
# and 13.6 ms down. The jitter down makes up the mean round trip of 53.1 ms that Ofcom measured (end of 2014).
_LTE_UP, _LTE_SCHEDULER, _LTE_DOWN, _LTE_ROUND_TRIP = 0.0162, (0.010, 0.030), 0.0136, 0.0531
_LTE_QUEUE_TIME = 0.5  # s: with background traffic delays grow by an order of magnitude (Garcia and others)
_LTE_UP_MEAN = _LTE_UP + sum(_LTE_SCHEDULER) / 2.0


def _lte(megabits: float, latency: float, jitter: float) -> LinkDirection:
    rate = megabits * 1e6 / 8.0
    return LinkDirection(
        rate=rate, queue=round(_LTE_QUEUE_TIME * rate), loss=_LTE_LOSS, burst=_LTE_BURST, latency=latency, jitter=jitter
    )


# Throughput of 802.11a from the air to the ground at 300 m (Yanmaz and others). The median round trip of the hop is
# 20 ms (Pei and others), here without a least delay. The queue is Linux's, 1000 frames of 1500 bytes. Losses come in
# bursts (Miu and others); that they are 1 % in bursts of 20 ms, after the repetitions of the link layer, is chosen.
_WIFI = LinkDirection(rate=12e6 / 8.0, queue=1_500_000, loss=0.01, burst=0.02, jitter=0.02)

# A geostationary satellite: round trip of 600 ms (FAU). Delays of successive datagrams differ by 35 ms in the mean, and
# 0.3 % of the requests fail (Poland's UKE, 2011): a third of a uniform jitter is its mean difference. The rate is that
# of a streaming context of an I-4 satellite (8 to 256 kbit/s); that it is 128 kbit/s, with a queue of 1 s, is chosen.
_SATCOM_ROUND_TRIP, _SATCOM_DIFFERENCE = 0.6, 0.035
_SATCOM_JITTER = 3.0 * _SATCOM_DIFFERENCE
_SATCOM = LinkDirection(
    rate=16_000.0, queue=16_000, loss=0.003, latency=(_SATCOM_ROUND_TRIP - _SATCOM_JITTER) / 2.0, jitter=_SATCOM_JITTER
)

PROFILES = {
    "sik": LinkProfile(_SIK, _SIK),
    "lte": LinkProfile(
        telemetry=_lte(13.6, _LTE_UP + _LTE_SCHEDULER[0], _LTE_SCHEDULER[1] - _LTE_SCHEDULER[0]),
        command=_lte(14.7, _LTE_DOWN, 2.0 * (_LTE_ROUND_TRIP - _LTE_UP_MEAN - _LTE_DOWN)),
    ),
    "wifi": LinkProfile(_WIFI, _WIFI),
    "satcom": LinkProfile(_SATCOM, _SATCOM),
}
