"""The link to one vehicle with a clock and latencies of one's own, as the ground's detector of timing gets it."""

import math
from types import SimpleNamespace

import numpy as np

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.alarms import AlarmLog
from gcs.flight.detectors import LinkTiming, MonitorAlarm
from gcs.flight.monitor_step import MonitorStep
from gcs.mavlink.vehicle_link import VehicleLink

TELEMETRY, TIMESYNC, CONTROL = 0.04, 0.1, 0.05
"""Periods (s)."""
TELEMETRY_SIZE, ANSWER_SIZE = 215, 24
"""Sizes of datagrams (bytes)."""


def none(_):
    return 0.0


class TimedLink:
    """Telemetry at 25 Hz and TIMESYNC at 10 Hz of one vehicle, from ground time 0 on.

    Args:
        clock: what the vehicle's clock reads (s) at a ground time (s).
        out, back: latency (s) to and from the vehicle of what is sent at a time (s); order is kept.
        lost: whether the TIMESYNC answer to a request of a time (s) is lost.
        stamp: the stamp (s) of telemetry by what the clock reads (s).
        timesync_from: time (s) of the first TIMESYNC request.
        rate: what the link from the vehicle passes (bytes/s) in the air, from 5 s on.
    """

    def __init__(
        self,
        clock=lambda t: t,
        out=none,
        back=none,
        lost=lambda t: False,
        stamp=lambda reading: reading,
        timesync_from=0.0,
        rate=math.inf,
    ):
        self.link = VehicleLink(1, None)
        self.log = AlarmLog()
        self.detector = LinkTiming(DEFAULTS.monitor, CONTROL, 1)
        self.clock, self.out, self.back, self.lost, self.stamp = clock, out, back, lost, stamp
        self.timesync_from, self.rate = timesync_from, rate

    def run(self, until, in_air_from=0.0):
        """Run to ``until`` (s); return the alarms, each as code and time (s)."""
        events, arrived_last, asked_last = [], -math.inf, -math.inf
        sent = []
        for k in range(round(until / TELEMETRY)):
            at = TELEMETRY * k
            sent.append((at, None))
        for k in range(round((until - self.timesync_from) / TIMESYNC)):
            at = self.timesync_from + TIMESYNC * k
            asked_last = max(asked_last, at + self.out(at))
            if not self.lost(at):
                sent.append((asked_last, at))
        for at, request in sorted(sent, key=lambda item: item[0]):
            size = TELEMETRY_SIZE if request is None else ANSWER_SIZE
            arrived_last = max(arrived_last, at + self.back(at)) + (size / self.rate if at >= 5.0 else 0.0)
            events.append((arrived_last, at, request))
        steps = [(CONTROL * k, None, None) for k in range(1, round(until / CONTROL))]
        requests = [(self.timesync_from + TIMESYNC * k, None, True) for k in range(round(until / TIMESYNC))]
        asked = {}
        for now, at, request in sorted([*requests, *events, *steps], key=lambda event: event[0]):
            if request is True:
                asked[round(now, 6)] = self.link.clock.request(now)
            elif request is not None:
                reading = self.clock(at)
                self.link.clock.add_answer(asked[round(request, 6)], now, round(reading * 1e9))
                self.link.clock.queue.add(ANSWER_SIZE, self.link.clock.bounds.sent, now)
            elif at is not None:
                stamp = round(self.stamp(self.clock(at)) * 1e3) % 2**32
                self.link.clock.add_stamp(stamp * 1e-3, now, in_order=True)
                self.link.clock.queue.add(TELEMETRY_SIZE, self.link.clock.bounds.sent, now)
            else:
                self._step(now, now >= in_air_from)
        return [(alarm.code, alarm.time) for alarm in self.log.alarms]

    def _step(self, now, in_air):
        flight = SimpleNamespace(system=SimpleNamespace(team=SimpleNamespace(links=(self.link,))))
        names = ("vehicle 1", "payload")
        self.detector(MonitorStep(now, now, flight, None, self.log, None, in_air, names, clear=in_air, steady=True))

    @property
    def texts(self):
        """Texts of the alarms of the clock."""
        return [alarm.text for alarm in self.log.alarms if alarm.code is MonitorAlarm.CLOCK_ERROR]


def constant(latency):
    """The same latency (s) at all times."""
    return lambda t: latency


def stepped(at, before, after):
    """A latency (s) that changes at a time (s)."""
    return lambda t: after if t >= at else before


def random_latency(seed, spread, least=0.0):
    """A latency that varies by ``spread`` (s) from datagram to datagram."""
    generator = np.random.default_rng(seed)
    return lambda t: least + spread * generator.random()
