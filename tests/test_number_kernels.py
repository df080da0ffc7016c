"""The text of tables of numbers: equal to Python's own, to the byte."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gcs.record.number_kernels import lines

FLOATS_ONLY = np.zeros(1, dtype=bool)


def text_of(rows, whole):
    """What the kernel returns, in plain Python."""
    row_texts = (",".join(str(int(v)) if w else repr(v) for v, w in zip(row, whole, strict=True)) for row in rows)
    return "".join(f"{text}\n" for text in row_texts)


def written(rows, whole):
    return lines(np.array(rows, dtype=float), np.array(whole)).tobytes().decode()


@given(number=st.floats())
@example(number=5e-324)
@example(number=2.2250738585072014e-308)
@example(number=1.7976931348623157e308)
@example(number=-0.0)
@example(number=1e16)
@example(number=9999999999999998.0)
@example(number=1e-4)
@example(number=9.999999999999999e-05)
@example(number=9007199254740993.0)
@settings(deadline=None, derandomize=True, max_examples=500)
def test_number_is_written_as_python_writes_it(number):
    assert written([[number]], FLOATS_ONLY) == f"{number!r}\n"


@pytest.mark.parametrize("power", range(-1074, 1024, 7))
def test_numbers_beside_powers_of_two_are_written_as_python_writes_them(power):
    number = 2.0**power
    row = [number, float(np.nextafter(number, 0.0)), float(np.nextafter(number, np.inf))]
    assert written([row], [False] * 3) == text_of([row], [False] * 3)


def test_many_numbers_are_written_as_python_writes_them():
    rng = np.random.default_rng(1)
    any_bits = rng.integers(0, 2**64, (500, 40), dtype=np.uint64).view(float)
    usual = rng.normal(size=(500, 40)) * 10.0 ** rng.integers(-12, 20, (500, 40))
    rounded = np.round(rng.normal(size=(500, 40)), 6)
    for rows in (any_bits, usual, rounded):
        assert written(rows, [False] * 40) == text_of(rows.tolist(), [False] * 40)


@given(
    rows=st.lists(st.tuples(st.floats(), st.integers(-(2**53) + 1, 2**53 - 1), st.floats()), max_size=4),
)
@example(rows=[(1.0, 0, -0.0), (0.0, -1, 1.5)])
@settings(deadline=None, derandomize=True)
def test_columns_of_whole_numbers_have_no_decimal_point(rows):
    whole = [False, True, False]
    assert written(np.array(rows, dtype=float).reshape(-1, 3), whole) == text_of(rows, whole)
