"""Text of tables of numbers, compiled: the shortest that reads back to the same double, as Python's ``repr`` writes it.

Algorithm: R. Giulietti, "The Schubfach way to render doubles", 2020, with powers of ten in 128 bits.
"""

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel

Bytes = NDArray[np.uint8]

_LONGEST = 25
"""Characters of the longest number, and what separates it from the next."""
_LEAST_POWER, _LARGEST_POWER = -292, 324
_LOW = np.uint64(0xFFFFFFFF)
_0, _1, _2, _4, _10, _32, _40, _52 = (np.uint64(number) for number in (0, 1, 2, 4, 10, 32, 40, 52))
_FRACTION = np.uint64((1 << 52) - 1)
_HIDDEN = np.uint64(1 << 52)
_ZERO, _POINT, _MINUS, _PLUS, _COMMA, _LINE, _E = (np.uint8(ord(letter)) for letter in "0.-+,\ne")
_NAN, _INF = (np.frombuffer(word.encode(), np.uint8) for word in ("nan", "inf"))


def _powers() -> NDArray[np.uint64]:
    """Return the powers of ten from the least to the largest, rounded up to 128 bits, high and low half (P, 2)."""
    rows = []
    for power in range(_LEAST_POWER, _LARGEST_POWER + 1):
        shift = 127 - ((power * 1741647) >> 19)  # 2^127 <= 10^power 2^shift < 2^128
        numerator, denominator = 10 ** max(power, 0) << max(shift, 0), 10 ** max(-power, 0) << max(-shift, 0)
        scaled = -(-numerator // denominator)
        rows.append((scaled >> 64, scaled & ((1 << 64) - 1)))
    return np.array(rows, dtype=np.uint64)


_POWERS = _powers()


@inlined
def _product(a: np.uint64, b: np.uint64) -> tuple[np.uint64, np.uint64]:
    """Return the high and the low half of a product."""
    low = (a & _LOW) * (b & _LOW)
    cross, other = (a >> _32) * (b & _LOW), (a & _LOW) * (b >> _32)
    middle = (low >> _32) + (cross & _LOW) + (other & _LOW)
    high = (a >> _32) * (b >> _32) + (cross >> _32) + (other >> _32) + (middle >> _32)
    return high, (middle << _32) | (low & _LOW)


@inlined
def _rounded_to_odd(high: np.uint64, low: np.uint64, factor: np.uint64) -> np.uint64:
    """Return ``factor`` times a power of ten over 2^128, the last bit 1 where that is not exact."""
    carried, _ = _product(low, factor)
    whole, rest = _product(high, factor)
    total = rest + carried
    if total < rest:
        whole += _1
    return whole | (_1 if total > _1 else _0)


@inlined
def _shortest(bits: np.uint64) -> tuple[np.uint64, int]:
    """Return the digits and the power of ten of the last of them, of a double above zero by its ``bits``."""
    fraction, exponent = bits & _FRACTION, np.int64(bits >> _52)
    c = _HIDDEN | fraction if exponent else fraction
    q = int((exponent if exponent else 1) - 1075)
    closer = fraction == _0 and exponent > 1  # the double below is half as far as that above
    odd = c & _1
    k = (q * 1262611 - (524031 if closer else 0)) >> 22
    h = np.uint64(q + ((-k * 1741647) >> 19) + 1)
    high, low = _POWERS[-k - _LEAST_POWER, 0], _POWERS[-k - _LEAST_POWER, 1]
    middle = _rounded_to_odd(high, low, (_4 * c) << h)
    lower = _rounded_to_odd(high, low, (_4 * c - (_1 if closer else _2)) << h) + odd
    upper = _rounded_to_odd(high, low, (_4 * c + _2) << h) - odd
    s = middle // _4
    if s >= _10:
        short = s // _10
        below, above = lower <= _40 * short, _40 * short + _40 <= upper
        if below != above:
            return short + (_1 if above else _0), k + 1
    below, above = lower <= _4 * s, _4 * s + _4 <= upper
    if below != above:
        return s + (_1 if above else _0), k
    half = _4 * s + _2
    return s + (_1 if middle > half or (middle == half and (s & _1) != _0) else _0), k


@inlined
def _write_digits(text: Bytes, at: int, number: np.uint64) -> int:
    """Write a whole number; return the position behind it."""
    end, rest = at + 1, number // _10
    while rest != _0:
        end, rest = end + 1, rest // _10
    rest = number
    for i in range(end - 1, at - 1, -1):
        text[i] = _ZERO + np.uint8(rest % _10)
        rest = rest // _10
    return end


@inlined
def _write_float(text: Bytes, at: int, bits: np.uint64) -> int:
    """Write a finite double above zero as ``repr`` does; return the position behind it."""
    digits, power = _shortest(bits)
    while digits % _10 == _0:
        digits, power = digits // _10, power + 1
    end = _write_digits(text, at, digits)
    point = end - at + power  # digits before the decimal point
    if 0 < point <= 16:
        if power >= 0:
            text[end : end + power] = _ZERO
            end += power
            text[end], text[end + 1] = _POINT, _ZERO
            return end + 2
        for i in range(end, at + point, -1):
            text[i] = text[i - 1]
        text[at + point] = _POINT
        return end + 1
    if -4 < point <= 0:
        shift = 2 - point
        for i in range(end - 1, at - 1, -1):
            text[i + shift] = text[i]
        text[at : at + shift] = _ZERO
        text[at + 1] = _POINT
        return end + shift
    if end - at > 1:
        for i in range(end, at + 1, -1):
            text[i] = text[i - 1]
        text[at + 1] = _POINT
        end += 1
    text[end], text[end + 1] = _E, _MINUS if point <= 0 else _PLUS
    exponent = abs(point - 1)
    end += 2
    if exponent < 10:
        text[end] = _ZERO
        end += 1
    return _write_digits(text, end, np.uint64(exponent))


@kernel("uint8[::1](float64[:, ::1], boolean[::1])")
def lines(numbers: Array, whole: NDArray[np.bool_]) -> Bytes:
    """Return the text of rows of numbers: commas between them, a line feed behind each row.

    Args:
        numbers: (R, C).
        whole: columns of whole numbers, without a decimal point; they are finite and below 2^53 (C,).
    """
    rows, columns = numbers.shape
    all_bits = numbers.view(np.uint64)
    text = np.empty(rows * columns * _LONGEST, np.uint8)
    at = 0
    for row in range(rows):
        for column in range(columns):
            number = numbers[row, column]
            bits = all_bits[row, column]
            if bits >> np.uint64(63) and number == number and not (whole[column] and number == 0.0):
                text[at] = _MINUS
                at += 1
            bits &= np.uint64((1 << 63) - 1)
            if whole[column]:
                at = _write_digits(text, at, np.uint64(abs(number)))
            elif number != number or bits == np.uint64(2047 << 52):
                text[at : at + 3] = _NAN if number != number else _INF
                at += 3
            elif bits == _0:
                text[at], text[at + 1], text[at + 2] = _ZERO, _POINT, _ZERO
                at += 3
            else:
                at = _write_float(text, at, bits)
            text[at] = _COMMA
            at += 1
        text[at - 1] = _LINE
    return text[:at].copy()
