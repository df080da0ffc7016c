"""The world: payload, links and UAVs in PyBullet, each UAV with an autopilot that speaks MAVLink.

Not public: other projects use the command ``vehicle-sim``, or :mod:`gcs`.
"""
