"""The system of the paper's Table I, for tests."""

import numpy as np

from idc_controller.parameters import PayloadHull, SystemParameters, polygon_attachments

UNSYMMETRIC = np.array([[0.5, 0.4, -0.25], [0.3, -0.5, -0.2], [-0.5, -0.3, -0.25], [-0.4, 0.5, -0.1]])
"""Attachment points on the payload (4, 3) (m, payload frame)."""


def system(n=4):
    """Table I for ``n`` UAVs."""
    return SystemParameters(
        m_0=3.1, J_0=np.diag([0.29, 0.29, 0.55]), payload=PayloadHull.box([1.0, 1.0, 0.5]), m=np.full(n, 0.7),
        J=np.tile(0.01 * np.eye(3), (n, 1, 1)), p=polygon_attachments(n, 1.0, -0.25), l=np.full(n, 3.2),
        disc_radius=0.3, thrust_max=30.0, motor_time_constant=0.05, attitude_kp=100.0, attitude_kd=16.0,
    )  # fmt: skip
