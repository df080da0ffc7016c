"""Integrated Decision Controller: estimate, plan and control, as pure mathematics.

Numbers in, numbers out: no socket, clock, log, file or MAVLink. SI units, north-east-down (NED) frames and
w-first quaternions throughout. The modules follow the way of the data:

``model``     what the payload, its links and its UAVs do (source: Section II of the paper, corrected)
``estimate``  noisy, late, missing measurements -> the state now (Kalman filter)
``plan``      what the mission asks -> a trajectory smooth enough to be flown -> the exact state along it
``control``   state and reference -> attitude and thrust set-points (MPC, safety filter)
"""
