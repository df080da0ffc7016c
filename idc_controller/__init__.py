"""Integrated Decision Controller: perceive, estimate, guide and control, as pure mathematics.

Numbers in, numbers out: no socket, clock, log, file or MAVLink. SI units, north-east-down (NED) frames and
w-first quaternions throughout. Not public: other projects use :mod:`gcs`. The sub-packages follow the flow of the data:

``model``, ``geometry``           the payload, its links and its UAVs (Section II of the paper, corrected); shapes
``estimation``, ``perception``    noisy, late, missing measurements -> the state now, and the obstacles
``trajectory``, ``guidance``      mission -> a trajectory smooth enough to be flown -> progress along it, detours
``safety``                        reference -> a plan that keeps obstacles out of the hull
``control``, ``qp``               state and reference -> attitude and thrust set-points
``paper``                         the paper as printed, for comparison
"""
