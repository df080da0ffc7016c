"""Fly vehicle 1 of ``vehicle-sim --free --lockstep`` by a script: the same to the byte every time.

``python free_lockstep.py [VEHICLE_PORT CLOCK_PORT]``. The clock's messages: a tick (magic, serial number, time in us),
and its answer (magic, serial number, latest time of the next tick in us, 1: leaving).
"""

import socket
import struct
import sys

from pymavlink.dialects.v20 import common as mavlink

TICK, DONE = struct.Struct("<4sIQ"), struct.Struct("<4sIQB")
STEP = 50_000  # us between set-points
PLACE = (4.0, 3.0, -5.0)  # m north, east, down
MASK = 0b110111111000  # position alone

vehicle, clock = (("127.0.0.1", int(port)) for port in sys.argv[1:] or (14580, 14579))
wire = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
wire.bind(("127.0.0.1", 0))
wire.settimeout(10.0)
mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)


def send(message: mavlink.MAVLink_message) -> None:
    """Send a message to vehicle 1."""
    wire.sendto(message.pack(mav), vehicle)


def command(number: int, *parameters: float) -> None:
    """Send a command to vehicle 1."""
    send(mavlink.MAVLink_command_long_message(1, 1, number, 0, *parameters, *[0.0] * (7 - len(parameters))))


wire.sendto(DONE.pack(b"CLDN", 0, 2**64 - 1, 0), clock)  # join
time = 0.0
begun = arrived = landed = None
asked = 0
position, armed = (0.0, 0.0, 0.0), False
while landed is None or time < landed + 3.0:
    datagram, sender = wire.recvfrom(65535)
    if sender != clock:
        for message in mav.parse_buffer(datagram) or ():
            if message.get_srcSystem() != 1:
                continue
            if message.get_type() == "LOCAL_POSITION_NED":
                position = message.x, message.y, message.z
            elif message.get_type() == "HEARTBEAT":
                armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        continue
    _, serial, now = TICK.unpack(datagram)
    time = now * 1e-6
    begun = time if begun is None else begun
    if arrived is None and now >= asked:
        send(mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, MASK, *PLACE, 0, 0, 0, 0, 0, 0, 0, 0))
        if time > begun + 0.5 and not armed:
            command(mavlink.MAV_CMD_DO_SET_MODE, 1, 6)  # OFFBOARD
            command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        if max(abs(a - b) for a, b in zip(position, PLACE, strict=True)) < 0.2:
            arrived = time
            command(mavlink.MAV_CMD_NAV_LAND)
        asked = now + STEP
    if arrived is not None and landed is None and time > arrived + 1.0 and not armed:
        landed = time
        print(f"landed at {time:.2f} s, {position[0]:.1f} m north, {position[1]:.1f} m east")
    wire.sendto(DONE.pack(b"CLDN", serial, max(asked, now + 1) if arrived is None else now + STEP, 0), clock)
wire.sendto(DONE.pack(b"CLDN", 0, 2**64 - 1, 1), clock)  # leave
