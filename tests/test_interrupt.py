"""Ctrl-C on the ground: the first one is a request, the second one ends control."""

import os
import signal

import pytest

from gcs.drivers.interrupt import Interrupt


@pytest.mark.parametrize("numbers", [(signal.SIGINT, signal.SIGINT), (signal.SIGTERM, signal.SIGINT)])
def test_first_signal_is_a_request_and_the_second_ends_control(numbers):
    with Interrupt() as interrupt:
        assert not interrupt.requested
        os.kill(os.getpid(), numbers[0])
        assert interrupt.requested
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), numbers[1])


def test_handlers_of_before_are_restored():
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    with Interrupt():
        assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] != before
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before
