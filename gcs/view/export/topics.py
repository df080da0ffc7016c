"""PX4's topics from the records of a run: names, fields, units and frames are PX4's (its folder ``msg``).

Topics that PX4 does not have begin with ``cooplift_``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.record.reader import Table
from gcs.record.tables import ALARMS, ESTIMATE, FORCES, INNOVATIONS, PLAN, REFERENCE, TRUTH
from gcs.view.export.telemetry import Messages, Telemetry
from gcs.view.export.ulog_file import LoggedMessage, Topic, topic
from idc_controller.arrays import Array

Tables = Mapping[str, Table]

_NAV_STATES = {
    "MANUAL": 0, "ALTCTL": 1, "POSCTL": 2, "AUTO.MISSION": 3, "AUTO.LOITER": 4, "AUTO.RTL": 5, "ACRO": 10,
    "OFFBOARD": 14, "STABILIZED": 15, "AUTO.TAKEOFF": 17, "AUTO.LAND": 18, "AUTO.FOLLOW_TARGET": 19,
    "AUTO.PRECLAND": 20,
}  # fmt: skip
"""NAVIGATION_STATE_* of PX4's VehicleStatus by the name of a mode."""
_OTHER_STATE = 31
_DISARMED, _ARMED = 1, 2
_ROTARY_WING = 1
_SEVERITIES = {
    name.removeprefix("MAV_SEVERITY_").lower(): value
    for value, name in ((number, entry.name) for number, entry in mavlink.enums["MAV_SEVERITY"].items())
}
_POSITION, _VELOCITY, _QUATERNION = ("x_m", "y_m", "z_m"), ("vx_mps", "vy_mps", "vz_mps"), ("qw", "qx", "qy", "qz")
_RATES = ("wx_radps", "wy_radps", "wz_radps")
_VALID = dict.fromkeys(("xy_valid", "z_valid", "v_xy_valid", "v_z_valid"), True)


def vehicle_topics(tables: Tables, telemetry: Telemetry, system: int) -> dict[str, Topic]:
    """Return the topics of a vehicle by name: its own telemetry, in its clock, and the truth, in the world's."""
    position = telemetry.of(system, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED)
    attitude = telemetry.of(system, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION)
    received = telemetry.of(system, mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET)
    flown = telemetry.of(system, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET)
    state = telemetry.of(system, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE)
    quaternion = _columns(attitude.fields, ("q1", "q2", "q3", "q4"))
    rates = _columns(attitude.fields, ("rollspeed", "pitchspeed", "yawspeed"))
    places = {name: position.fields[name] for name in ("x", "y", "z", "vx", "vy", "vz")}
    return {
        "vehicle_local_position": topic(position.time, **places, **_VALID),
        "vehicle_attitude": topic(attitude.time, q=quaternion),
        "vehicle_angular_velocity": topic(attitude.time, xyz=rates),
        "vehicle_attitude_setpoint": topic(
            received.time, q_d=received.fields["q"], thrust_body=_upward(received.fields["thrust"])
        ),
        "vehicle_thrust_setpoint": topic(flown.time, xyz=_upward(flown.fields["thrust"])),
        "vehicle_status": _status(telemetry.of(system, mavlink.MAVLINK_MSG_ID_HEARTBEAT), system),
        "vehicle_land_detected": topic(
            state.time, landed=state.fields["landed_state"] == mavlink.MAV_LANDED_STATE_ON_GROUND
        ),
        "battery_status": _battery(telemetry.of(system, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS)),
        **_innovations(tables[INNOVATIONS], f"vehicle {system}"),
        **_vehicle_truth(tables, system),
    }


def payload_topics(tables: Tables) -> dict[str, Topic]:
    """Return the topics of the payload by name: the ground's estimate of it, its reference and plan, and the truth."""
    estimate, reference, plan, truth = (tables[name] for name in (ESTIMATE, REFERENCE, PLAN, TRUTH))
    unknown = np.nan
    return {
        **_state(estimate, ""),
        **_state(truth, "_groundtruth"),
        "trajectory_setpoint": topic(
            reference["time_s"], position=_columns(reference, _POSITION), velocity=_columns(reference, _VELOCITY),
            acceleration=np.full((len(reference), 3), unknown), jerk=np.full((len(reference), 3), unknown),
            yaw=unknown, yawspeed=unknown,
        ),
        "vehicle_local_position_setpoint": topic(
            plan["time_s"], x=plan["x_m"], y=plan["y_m"], z=plan["z_m"], yaw=unknown, yawspeed=unknown, vx=unknown,
            vy=unknown, vz=unknown, acceleration=_columns(plan, ("ax_mps2", "ay_mps2", "az_mps2")),
            thrust=np.full((len(plan), 3), unknown),
        ),
        "cooplift_disturbance": topic(
            estimate["time_s"], force=_columns(estimate, _forces("")), force_sd=_columns(estimate, _forces("_sd"))
        ),
        **_innovations(tables[INNOVATIONS], "payload"),
    }  # fmt: skip


def alarms_of(tables: Tables, source: str | None) -> list[LoggedMessage]:
    """Return the alarms of a ``source``; None: all those that are of no vehicle."""
    return [
        LoggedMessage(time, _SEVERITIES.get(severity, mavlink.MAV_SEVERITY_INFO), f"{name}: {code}: {text}")
        for time, name, code, severity, text in tables[ALARMS][
            ["time_s", "source", "code", "severity", "text"]
        ].tolist()
        if (not name.startswith("vehicle ") if source is None else name == source)
    ]


def texts_of(telemetry: Telemetry, system: int) -> list[LoggedMessage]:
    """Return the STATUSTEXT messages of a system."""
    messages = telemetry.of(system, mavlink.MAVLINK_MSG_ID_STATUSTEXT)
    return [
        LoggedMessage(time, severity, b"".join(text).rstrip(b"\0").decode(errors="replace"))
        for time, severity, text in zip(
            messages.time.tolist(), messages.fields["severity"].tolist(), messages.fields["text"].tolist(), strict=True
        )
    ]


def _state(table: Table, suffix: str) -> dict[str, Topic]:
    """Return position, attitude and rates of the payload in a table, as topics of that ``suffix``."""
    time = table["time_s"]
    position, velocity, quaternion, rates = (
        _columns(table, [f"payload_{name}" for name in names]) for names in (_POSITION, _VELOCITY, _QUATERNION, _RATES)
    )
    places = dict(zip(("x", "y", "z", "vx", "vy", "vz"), np.column_stack([position, velocity]).T, strict=True))
    deviations: dict[str, Array] = {}
    if "payload_x_m_sd" in (table.dtype.names or ()):
        x, y, z, v_x, v_y, v_z = (table[f"payload_{name}_sd"] for name in (*_POSITION, *_VELOCITY))
        deviations = {"eph": np.hypot(x, y), "epv": z, "evh": np.hypot(v_x, v_y), "evv": v_z}
    return {
        f"vehicle_local_position{suffix}": topic(time, **places, **deviations, **_VALID),
        f"vehicle_attitude{suffix}": topic(time, q=quaternion),
        f"vehicle_angular_velocity{suffix}": topic(time, xyz=rates),
    }


def _vehicle_truth(tables: Tables, system: int) -> dict[str, Topic]:
    """Return the truth of a vehicle; none where none is recorded."""
    truth, forces = tables[TRUTH], tables[FORCES]
    names = truth.dtype.names or ()
    if f"uav{system}_thrust_n" not in names:
        return {}
    position, quaternion = (
        _columns(truth, [f"uav{system}_{name}" for name in part]) for part in (_POSITION, _QUATERNION)
    )
    topics = {
        "vehicle_local_position_groundtruth": topic(
            truth["time_s"], **dict(zip("xyz", position.T, strict=True)), xy_valid=True, z_valid=True
        ),
        "vehicle_attitude_groundtruth": topic(truth["time_s"], q=quaternion),
        "cooplift_thrust": topic(truth["time_s"], thrust=truth[f"uav{system}_thrust_n"]),
    }
    if f"link{system}_n" in (forces.dtype.names or ()):
        topics["cooplift_link"] = topic(forces["time_s"], tension=forces[f"link{system}_n"])
    return topics


def _innovations(table: Table, source: str) -> dict[str, Topic]:
    """Return test ratios, and which channels are not used, of a ``source`` of measurements.

    Each of the ratios is that of a whole vector, which PX4 puts into its first component.
    """
    rows = table[table["source"] == source]
    by_channel = {name: rows[rows["channel"] == name] for name in ("position", "velocity", "attitude", "rates")}
    time = by_channel["position"]["time_s"]
    if not len(time) or any(len(each) != len(time) for each in by_channel.values()):
        return {}
    ratio = {name: each["test_ratio"] for name, each in by_channel.items()}
    unused = {name: each["state"] != "ok" for name, each in by_channel.items()}
    none = np.full(len(time), np.nan)
    return {
        "estimator_innovation_test_ratios": topic(
            time, gps_hvel=np.column_stack([ratio["velocity"], none]), gps_vvel=ratio["velocity"],
            gps_hpos=np.column_stack([ratio["position"], none]), gps_vpos=ratio["position"],
            attitude=ratio["attitude"], rates=ratio["rates"],
        ),
        "estimator_status_flags": topic(
            time, reject_hor_vel=unused["velocity"].astype(bool), reject_ver_vel=unused["velocity"].astype(bool),
            reject_hor_pos=unused["position"].astype(bool), reject_ver_pos=unused["position"].astype(bool),
        ),
    }  # fmt: skip


def _status(heartbeats: Messages, system: int) -> Topic:
    modes = [px4.mode_name(mode) for mode in heartbeats.fields["custom_mode"].tolist()]
    states = np.array([_NAV_STATES.get(mode, _OTHER_STATE) for mode in modes], np.uint8)
    armed = heartbeats.fields["base_mode"] & mavlink.MAV_MODE_FLAG_SAFETY_ARMED != 0
    return topic(
        heartbeats.time, nav_state=states, arming_state=np.where(armed, _ARMED, _DISARMED).astype(np.uint8),
        failsafe=heartbeats.fields["system_status"] == mavlink.MAV_STATE_CRITICAL,
        vehicle_type=np.uint8(_ROTARY_WING), system_id=np.uint8(system), component_id=np.uint8(px4.AUTOPILOT_COMPONENT),
    )  # fmt: skip


def _battery(messages: Messages) -> Topic:
    cells = messages.fields["voltages"].astype(float)
    current = messages.fields["current_battery"].astype(float)
    return topic(
        messages.time, voltage_v=1e-3 * np.where(cells == np.iinfo(np.uint16).max, 0.0, cells).sum(axis=1),
        current_a=np.where(current < 0.0, -1.0, 0.01 * current),
        remaining=0.01 * messages.fields["battery_remaining"].astype(float), connected=True,
    )  # fmt: skip


def _upward(thrust: Array) -> Array:
    """Return the normalised thrust in the body frame (n, 3) of a thrust from 0 to 1 (n,)."""
    return np.column_stack([np.zeros_like(thrust), np.zeros_like(thrust), -thrust])


def _columns(table: Table, names: Sequence[str]) -> Array:
    return np.column_stack([table[name] for name in names])


def _forces(suffix: str) -> list[str]:
    return [f"disturbance_{axis}_n{suffix}" for axis in "xyz"]
