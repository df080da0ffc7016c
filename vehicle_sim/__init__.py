"""The world: payload, links and UAVs in PyBullet, each UAV with an autopilot that speaks MAVLink."""
