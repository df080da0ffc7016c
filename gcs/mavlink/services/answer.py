"""Answers of the autopilot to commands."""

from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink


class Answer(NamedTuple):
    """A command's outcome: a MAV_RESULT, and the reason of a refusal, as STATUSTEXT."""

    result: int
    text: str = ""


ACCEPTED = Answer(mavlink.MAV_RESULT_ACCEPTED)
UNSUPPORTED = Answer(mavlink.MAV_RESULT_UNSUPPORTED)


def denied(text: str) -> Answer:
    """Return the answer to a command that the vehicle refuses."""
    return Answer(mavlink.MAV_RESULT_DENIED, text)


def rejected_for_now(text: str) -> Answer:
    """Return the answer to a command that may succeed later."""
    return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED, text)
