"""Settings of a vehicle's MAVLink side: stream rates, peers, repetitions."""

from __future__ import annotations

from dataclasses import dataclass

from idc_controller.settings import setting


@dataclass(frozen=True)
class StreamIntervals:
    """How often a peer is sent what it has not asked for at another rate; PX4's rates in its normal mode or near."""

    heartbeat: float = setting(1.0, "s", "HEARTBEAT of the autopilot and of the payload unit", gt=0.0)
    sys_status: float = setting(1.0, "s", "SYS_STATUS", gt=0.0)
    extended_sys_state: float = setting(0.2, "s", "EXTENDED_SYS_STATE", gt=0.0)
    attitude: float = setting(0.1, "s", "ATTITUDE", gt=0.0)
    global_position_int: float = setting(0.2, "s", "GLOBAL_POSITION_INT", gt=0.0)
    gps_raw_int: float = setting(1.0, "s", "GPS_RAW_INT", gt=0.0)
    home_position: float = setting(2.0, "s", "HOME_POSITION", gt=0.0)
    battery_status: float = setting(2.0, "s", "BATTERY_STATUS", gt=0.0)
    vfr_hud: float = setting(0.5, "s", "VFR_HUD", gt=0.0)


@dataclass(frozen=True)
class VehicleLinkSettings:
    """How a vehicle serves those that it is in contact with."""

    peer_timeout: float = setting(10.0, "s", "without a message from a peer until its streams stop", gt=0.0)
    peers_max: int = setting(8, "", "peers served at once, beside the ground that the vehicle offers itself to", ge=1)
    replies_max: int = setting(200, "", "answers queued for one peer; more requests at once are dropped", ge=1)
    interval_min: float = setting(
        0.004, "s", "shortest interval that SET_MESSAGE_INTERVAL may set: the onboard loop's period", gt=0.0
    )
    repeat_interval: float = setting(0.04, "s", "between the repetitions of a message whose content changed", gt=0.0)
    repeats: int = setting(3, "", "repetitions of a message whose content changed: a datagram may be lost", ge=0)
    setpoint_streams_max: int = setting(16, "", "senders of set-points told apart at once", ge=1)
    reordering_max: float = setting(
        1.0,
        "s",
        "a set-point older than the last by less was overtaken on the link; by more: its clock was set",
        gt=0.0,
    )
