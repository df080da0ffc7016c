"""Another vehicle's telemetry while one vehicle's port is flooded, and the bytes that one HEARTBEAT draws.

    python tests/benchmarks/flood.py [--rate 20000] [--seconds 5] [--json] [FLOOD ...]

Starts `vehicle-sim` in real time, calls in at vehicle 2 and sends each flood to vehicle 1 in turn. Printed are the
datagrams sent a second, the largest gap between two arrivals of vehicle 2's ATTITUDE_QUATERNION, without a flood too,
next to the period due, and the CPU time of the simulator a second. Then a new address sends vehicle 1 one HEARTBEAT and
nothing else. Exit status 1 where it draws more bytes than it sent, or a gap is longer than half a second.
"""

import argparse
import json
import math
import multiprocessing
import random
import re
import select
import socket
import subprocess
import sys
import time
from pathlib import Path

import pymavlink.dialects.v20.ardupilotmega as mavlink
from measure import ROOT

from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import Sample

HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
SETTLED = 2.0  # s from the call to the first measurement
BURST = 0.001  # s between the bursts of a flood
LIMIT = 500.0  # ms


def with_heartbeat(*messages):
    """Return a datagram of a client: a HEARTBEAT and messages."""
    codec = Codec(250, 190)
    return b"".join(codec.encode(message) for message in (HEARTBEAT, *messages))


def floods():
    """Return the datagrams of each flood, by name; they are sent in turns."""
    generator = random.Random(1)
    read = mavlink.MAVLink_param_request_read_message(1, 1, b"MIS_TAKEOFF_ALT", -1)
    return {
        "random": [generator.randbytes(60) for _ in range(64)],
        "markers": [b"\xfd" * 1200],
        "parameters": [with_heartbeat(read)],
        "lists": [with_heartbeat(mavlink.MAVLink_param_request_list_message(1, 1))],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("floods", nargs="*", metavar="FLOOD", help=f"{', '.join(floods())} (default: all)")
    parser.add_argument("--rate", type=positive, default=20_000, help="datagrams a second (default: %(default)g)")
    parser.add_argument("--seconds", type=positive, default=5.0, help="length of each flood (default: %(default)g)")
    parser.add_argument("--json", action="store_true", help="print JSON only")
    options = parser.parse_args()
    if unknown := set(options.floods) - set(floods()):
        parser.error(f"{min(unknown)}: not one of {', '.join(floods())}")
    with Simulator() as simulator:
        result = {"drawn": simulator.drawn(options.seconds), "heartbeat": len(with_heartbeat())}
        client = Client(simulator.vehicles[1])
        client.watch(SETTLED)
        result["calm"] = measured(simulator, client, options.seconds)
        for name in options.floods or floods():
            with Flood(simulator.vehicles[0], name, options.rate) as flood:
                result[name] = measured(simulator, client, options.seconds)
            result[name]["rate"] = flood.sent.value / flood.duration
            client.watch(SETTLED)
    print(json.dumps(result) if options.json else text_of(result))
    streams = [row for row in result.values() if isinstance(row, dict)]
    return int(result["drawn"] > result["heartbeat"] or max(row["gap_ms"] for row in streams) > LIMIT)


def positive(text):
    """Return a number above 0."""
    number = float(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not above 0")
    return number


def measured(simulator, client, seconds):
    """Return period and largest gap (ms) of vehicle 2's telemetry, and the CPU time of the simulator (s/s)."""
    before = simulator.cpu_time()
    period, gap = client.watch(seconds)
    return {"period_ms": period, "gap_ms": gap, "cpu_s": (simulator.cpu_time() - before) / seconds}


def text_of(result):
    """Return the lines for people."""
    lines = [f"{'flood':12}{'datagrams/s':>12}{'period':>9}{'largest gap':>13}{'CPU':>9}"]
    for name, row in result.items():
        if isinstance(row, dict):
            lines += [
                f"{name:12}{row.get('rate', 0.0):12.0f}{row['period_ms']:6.0f} ms{row['gap_ms']:10.0f} ms"
                f"{row['cpu_s']:5.2f} s/s"
            ]
    return "\n".join([*lines, f"a HEARTBEAT of {result['heartbeat']} bytes draws {result['drawn']} bytes"])


class Simulator:
    """A `vehicle-sim` in real time."""

    def __enter__(self):
        command = [sys.executable, "-m", "vehicle_sim", "--sdk-port", "0", "--ground-port", "0", "--base-port", "0"]
        self._process = subprocess.Popen([*command, "--quiet"], cwd=ROOT, stdout=subprocess.PIPE, text=True)
        self.vehicles = []
        for line in self._process.stdout:
            if line == "ready\n":
                return self
            host, port = re.search(r"udp://(.+):(\d+)", line).groups()
            self.vehicles.append((host, int(port)))
        sys.exit("vehicle-sim did not start")

    def __exit__(self, *_):
        self._process.terminate()
        self._process.wait()

    def cpu_time(self):
        """Return the CPU time (s) since its start."""
        user, system = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / 100

    def drawn(self, seconds):
        """Return the bytes that come in ``seconds`` after one HEARTBEAT from a new address."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as newcomer:
            newcomer.sendto(with_heartbeat(), self.vehicles[0])
            size, end = 0, time.perf_counter() + seconds
            while select.select([newcomer], [], [], max(0.0, end - time.perf_counter()))[0]:
                size += len(newcomer.recv(65535))
        return size


class Client:
    """A client that has called in at a vehicle, and answers."""

    def __init__(self, vehicle):
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._vehicle, self._codec = vehicle, Codec(255, 190)
        self._call = with_heartbeat(mavlink.MAVLink_param_request_read_message(2, 1, b"MIS_TAKEOFF_ALT", -1))

    def watch(self, seconds):
        """Return the median interval and the largest gap (ms) of its attitude; infinity: there is none."""
        arrivals, now = [], time.perf_counter()
        end, called = now + seconds, -math.inf
        while now < end:
            if now > called + 1.0:
                self._socket.sendto(self._call, self._vehicle)
                called = now
            ready = select.select([self._socket], [], [], 0.1)[0]
            now = time.perf_counter()
            if ready:
                messages = self._codec.read(self._socket.recv(65535))
                arrivals += [now for m in messages if m.system == 2 and m.layout.sample is Sample.ATTITUDE]
        gaps = sorted(1e3 * (b - a) for a, b in zip(arrivals, [*arrivals[1:], now], strict=True))
        return (gaps[len(gaps) // 2], gaps[-1]) if gaps else (math.inf, math.inf)


class Flood:
    """A process that sends datagrams to a vehicle at a rate while the context lasts."""

    def __init__(self, vehicle, name, rate):
        context = multiprocessing.get_context("spawn")
        self.sent, self._stop = context.Value("q", 0), context.Event()
        self._process = context.Process(target=send, args=(vehicle, name, rate, self.sent, self._stop))

    def __enter__(self):
        self._process.start()
        while not self.sent.value:
            time.sleep(BURST)
        self._begun = time.perf_counter()
        return self

    def __exit__(self, *_):
        self.duration = time.perf_counter() - self._begun
        self._stop.set()
        self._process.join()


def send(vehicle, name, rate, sent, stop):
    """Send the flood, in bursts, until ``stop`` is set."""
    datagrams, begun, count = floods()[name], time.perf_counter(), 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        while not stop.is_set():
            due = int((time.perf_counter() - begun) * rate)
            for k in range(count, due):
                sender.sendto(datagrams[k % len(datagrams)], vehicle)
            count = sent.value = max(count, due)
            time.sleep(BURST)


if __name__ == "__main__":
    sys.exit(main())
