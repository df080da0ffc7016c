"""Comparison of a vehicle's attitude with its body rates, and the attitude that both lead to; one row a vehicle."""

import math

from idc_controller import rotations_float
from idc_controller.arrays import Array, Array1
from idc_controller.compiled import inlined, kernel
from idc_controller.rotations_float import Quaternion, Vector

# Columns of ``rate_checks``: the attitude that the rates lead to (4), since when, and the last sample's time (s); until
# when rates are refused (s); how far the attitude may be from theirs (rad); window and duration of a refusal (s);
# whether the attitude has stepped in the window; the inertial attitude (4), and whether it is aligned with the measured
# one, with which time constant (s).
CHECKED_SINCE, CHECKED_AT, REFUSED_UNTIL, RATES_ERROR_MAX, RATES_WINDOW, RATES_REFUSED, STEPPED = 4, 5, 6, 7, 8, 9, 10
INERTIAL, ALIGNED, ALIGNMENT_TIME = 11, 15, 16
RATE_CHECK_COLUMNS = 17

_half_rotation = inlined(rotations_float.half_rotation)


@inlined
def _turned(attitude: Quaternion, p: float, q: float, r: float) -> Quaternion:
    """Return the ``attitude`` turned by half a small rotation vector (rad), in the body frame."""
    w, x, y, z = attitude
    a, b, c, d = (
        w - x * p - y * q - z * r,
        x + w * p + y * r - z * q,
        y + w * q + z * p - x * r,
        z + w * r + x * q - y * p,
    )
    length = math.sqrt(a * a + b * b + c * c + d * d)
    return a / length, b / length, c / length, d / length


@inlined
def _angle(first: Quaternion, second: Quaternion) -> float:
    """Return the small angle (rad) between two attitudes."""
    x, y, z = _half_rotation(first, second)
    return 2.0 * math.sqrt(x * x + y * y + z * z)


@inlined
def _restart(check: Array, time: float, attitude: Quaternion) -> None:
    """Begin a window at ``time`` (s)."""
    check[CHECKED_SINCE], check[STEPPED] = time, 0.0
    check[0], check[1], check[2], check[3] = attitude


@inlined
def _align(check: Array, attitude: Quaternion, share: float) -> None:
    """Turn the inertial attitude towards the measured one by a ``share`` of their difference."""
    inertial = (check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3])
    x, y, z = _half_rotation(inertial, attitude)
    if check[ALIGNED] == 0.0:
        if 2.0 * math.sqrt(x * x + y * y + z * z) > check[RATES_ERROR_MAX]:
            return
        check[ALIGNED] = 1.0
    w, x, y, z = _turned(inertial, share * x, share * y, share * z)
    check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3] = w, x, y, z


@kernel
def compare(check: Array1, time: float, last: Quaternion, attitude: Quaternion, rates: Vector) -> None:
    """Take a sample at ``time`` (s), of an ``attitude`` after the ``last`` one.

    Refuse rates for a while where the attitude has not turned by them over the window, one step of it aside: such a
    step, from one sample to the next, is an error of the attitude; wrong rates differ in every sample. The inertial
    attitude follows the rates. It is aligned with the measured one, but for errors by such a step.
    """
    step = time - check[CHECKED_AT]
    check[CHECKED_AT] = time
    if not 0.0 < step < check[RATES_WINDOW]:
        _restart(check, time, attitude)
        check[ALIGNED] = 1.0
        check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3] = attitude
        return
    p, q, r = 0.5 * step * rates[0], 0.5 * step * rates[1], 0.5 * step * rates[2]
    w, x, y, z = _turned((check[0], check[1], check[2], check[3]), p, q, r)
    check[0], check[1], check[2], check[3] = w, x, y, z
    w, x, y, z = _turned((check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3]), p, q, r)
    check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3] = w, x, y, z
    if check[STEPPED] == 0.0 and _angle(_turned(last, p, q, r), attitude) > check[RATES_ERROR_MAX]:
        check[STEPPED], check[ALIGNED] = 1.0, 0.0
        check[0], check[1], check[2], check[3] = attitude
    _align(check, attitude, min(step / check[ALIGNMENT_TIME], 1.0))
    if time - check[CHECKED_SINCE] < check[RATES_WINDOW]:
        return
    if _angle((check[0], check[1], check[2], check[3]), attitude) > check[RATES_ERROR_MAX]:
        check[REFUSED_UNTIL] = time + check[RATES_REFUSED]
        check[ALIGNED] = 1.0
        check[INERTIAL], check[INERTIAL + 1], check[INERTIAL + 2], check[INERTIAL + 3] = attitude
    _restart(check, time, attitude)
