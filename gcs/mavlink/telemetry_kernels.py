"""Navigation messages, compiled: the fields of all that came in one exchange to poses and motions."""

import math

import numpy as np

from idc_controller.arrays import Array2, Floats2, Mask1, Mask2
from idc_controller.compiled import kernel


@kernel
def poses_and_motions(fields: Floats2, is_attitude: Mask1) -> tuple[Array2, Mask2]:
    """Return poses and motions in ATTITUDE_QUATERNION and LOCAL_POSITION_NED.

    Args:
        fields: First 32 bytes of each message, the stamp in front (K, 8).
        is_attitude: Whether each is an attitude; else it is a position (K,).

    Returns:
        Pose, the quaternion (w first) with norm 1 or the position (m, NED), in the first columns, and motion, body
        rates (rad/s) or velocity (m/s, NED), in the last three (K, 7). What cannot be one is nan: values that are not
        finite, a quaternion that is no rotation. Then, whether each has a pose, and whether it has a motion (K, 2).
    """
    count = fields.shape[0]
    values, measured = np.full((count, 7), np.nan), np.zeros((count, 2), np.bool_)
    for i in range(count):
        row, width, scale = fields[i, 1:].astype(np.float64), 3, 1.0
        if is_attitude[i]:
            width, scale = 4, math.sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] + row[3] * row[3])
            measured[i, 0] = 0.9 < scale < 1.1
        else:
            measured[i, 0] = math.isfinite(row[0] + row[1] + row[2])
        if measured[i, 0]:
            for k in range(width):
                values[i, k] = row[k] / scale
        measured[i, 1] = math.isfinite(row[width] + row[width + 1] + row[width + 2])
        if measured[i, 1]:
            for k in range(3):
                values[i, 4 + k] = row[width + k]
    return values, measured
