"""Answers of the autopilot to commands."""

from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.newer_messages import RESULT_UNSUPPORTED_FRAME


class Answer(NamedTuple):
    """A command's outcome: a MAV_RESULT, and the reason of a refusal, as STATUSTEXT."""

    result: int
    text: str = ""
    parameter: int = 0
    """The parameter (1 .. 7) that a refusal is about; 0: none."""


ACCEPTED = Answer(mavlink.MAV_RESULT_ACCEPTED)
UNSUPPORTED = Answer(mavlink.MAV_RESULT_UNSUPPORTED)
UNSUPPORTED_FRAME = Answer(RESULT_UNSUPPORTED_FRAME, "Command denied: its MAV_FRAME is not a global one")


def denied(text: str, parameter: int = 0) -> Answer:
    """Return the answer to a command that the vehicle refuses, for a ``parameter`` (1 .. 7) if there is a wrong one."""
    return Answer(mavlink.MAV_RESULT_DENIED, text, parameter)


def rejected_for_now(text: str) -> Answer:
    """Return the answer to a command that may succeed later."""
    return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED, text)
