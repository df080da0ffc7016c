"""Rows of ``truth.csv`` from states as tests write them down."""

import numpy as np


def write_state(log, state, contacts, obstacles=()):
    """Append a :class:`WorldState`, in which numbers may be integers, and the obstacles at that time."""
    payload = (
        *state.payload_position_in_world, *state.payload_quaternion, *state.payload_velocity_in_world,
        *state.payload_rates_in_payload,
    )  # fmt: skip
    uavs = [(*u.position_in_world, *u.quaternion, *u.velocity_in_world, *u.rates_in_body) for u in state.uavs]
    thrusts = [float(uav.thrust) for uav in state.uavs]
    log.write(float(state.time), np.array([payload, *uavs], dtype=float), thrusts, contacts, obstacles)
