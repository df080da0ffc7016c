"""Fault injection without a flight, for tests: samples and datagrams in, samples and datagrams out."""

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import read_system
from gcs.mavlink.codec import Codec
from gcs.mission.model import Fault
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.world.sensors import Measurement

SYSTEM = read_system()
TAKE_OFF = 3.0
STILL = Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.01, 0.02, 0.03), (1.0, 2.0, -5.0), (0.1, 0.2, 0.3))
# What every kind needs in order to be.
NEEDED = {
    "packet_loss": {"probability": 0.3}, "latency": {"delay": 0.1}, "jitter": {"spread": 0.1},
    "reordering": {"probability": 0.3}, "duplication": {"probability": 0.3}, "corruption": {"probability": 0.5},
    "bad_checksum": {"probability": 0.5}, "truncation": {"probability": 0.5}, "bandwidth_cap": {"rate": 1000.0},
    "burst_loss": {"burst": 0.3, "gap": 0.6}, "flapping": {"down": 0.2, "up": 0.3},
    "clock_skew": {"rate": 0.01}, "clock_step": {"step": 0.5},
    "stale_stamps": {"age": 0.3}, "swapped_vehicles": {"other": 2}, "position_glitch": {"size": 2.0},
    "position_drift": {"velocity": [0.1, 0.0, 0.0]}, "wind": {"velocity": [3.0, 0.0, 0.0]},
    "payload_mass": {"change": 0.5}, "bias": {"amount": 0.5}, "drift": {"rate": 0.1}, "scale": {"factor": 1.1},
    "spikes": {"probability": 0.2, "amount": 1.0}, "quantisation": {"step": 0.5}, "noise": {"factor": 5.0},
}  # fmt: skip


def injected(*faults, seed=1):
    made = FaultInjector(faults, seed, SYSTEM)
    made.took_off(TAKE_OFF)
    return made


def fault(kind, start=0.0, duration=None, **more):
    outer = {key: more.pop(key) for key in ("every", "times", "vehicles", "direction") if key in more}
    return Fault(kind, start, duration, settings={**NEEDED.get(kind, {}), **more}, **outer)


def at(time):
    return STILL._replace(time=TAKE_OFF + time)


def sent(disturbed, count, gap=0.02, vehicle=1, message=lambda i: i.to_bytes(4, "little") * 10, direction="telemetry"):
    """(serial, sent at, arrived at, bytes) of what arrives of ``count`` datagrams, s after take-off."""
    cross = disturbed.from_vehicle if direction == "telemetry" else disturbed.to_vehicle
    serials, arrived = {}, []
    due = [TAKE_OFF + i * gap for i in range(count)]
    i = 0
    while True:
        timer = disturbed.next_timer()
        now = min([*due[i : i + 1], *([] if timer is None else [timer])], default=None)
        if now is None:
            return arrived
        batch = []
        if i < count and now == due[i]:
            data = message(i)
            serials[i] = now
            batch = [(data, i)]  # the address identifies it
            i += 1
        arrived += [(n, serials[n] - TAKE_OFF, now - TAKE_OFF, data) for data, n in cross(vehicle, batch, now)]


def codec_frames(*messages):
    codec = Codec(1, 1)
    return b"".join(codec.encode(message) for message in messages)


def position(stamp):
    return mavlink.MAVLink_local_position_ned_message(stamp, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0)


def reported(disturbed, time, vehicle=1, **values):
    return disturbed.reported_sample(vehicle, at(time)._replace(**values))


def positions(disturbed, count=2000, vehicle=1):
    return np.array([reported(disturbed, i * 0.01, vehicle).position.position for i in range(count)]) - STILL.position
