"""Upload of a plan, item by item, as the aircraft does it: one at a time, and in effect only when it is complete."""

import math
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.dispatcher import Request
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mavlink.services.mission_messages import ItemMessage, ack, item_of
from gcs.mavlink.services.mission_store import MissionAnswer, MissionStore
from gcs.mavlink.services.peer import TIME_TOLERANCE
from gcs.mavlink.settings import MissionTransferSettings

Ground = tuple[object, int]
"""Sender and component."""


def ground_of(request: Request) -> Ground:
    """Return who sent a message."""
    return request.sender, request.component


def send_answer(request: Request, plan_type: int, answer: MissionAnswer, opaque_id: int = 0) -> None:
    """Send MISSION_ACK, and the reason as a text."""
    if answer.text:
        request.peer.send_statustext(answer.text)
    request.peer.reply_packed(ack(request.system, request.component, answer.result, plan_type, opaque_id))


class _Outcome(NamedTuple):
    """How an upload ended: the ground may not have got the answer, and sends its last item again."""

    ground: Ground
    plan_type: PlanType
    last: int
    """Number of the item that was expected or came last."""
    result: int
    opaque_id: int


class Kept(NamedTuple):
    """Items of the plan in effect that an upload leaves, before and behind those that it brings."""

    before: tuple[MissionItem, ...] = ()
    behind: tuple[MissionItem, ...] = ()


NOTHING_KEPT = Kept()


class _Transfer:
    """An upload: its ground, the items that it leaves, and those that have come."""

    def __init__(self, request: Request, plan_type: PlanType, count: int, kept: Kept) -> None:
        self.request = request
        self.ground = ground_of(request)
        self.plan_type = plan_type
        self.kept = kept
        self.end = len(kept.before) + count
        """Number behind that of the last item that is uploaded."""
        self.items: list[MissionItem] = []
        self.current = 0
        self.heard_at = self.requested_at = request.now
        self.as_real_numbers = False

    @property
    def expected(self) -> int:
        """Number of the item that comes next."""
        return len(self.kept.before) + len(self.items)


class MissionUpload:
    """The upload that is under way, if any. Items are requested one by one, again and again until the timeout."""

    def __init__(self, store: MissionStore, settings: MissionTransferSettings) -> None:
        self._store = store
        self._settings = settings
        self._transfer: _Transfer | None = None
        self._outcome: _Outcome | None = None

    @property
    def next_due(self) -> float:
        """Time at which :meth:`run` has something to do (s), inf: none."""
        transfer = self._transfer
        if transfer is None:
            return math.inf
        settings = self._settings
        return min(transfer.requested_at + settings.retry_interval, transfer.heard_at + settings.timeout)

    def run(self, now: float) -> None:
        """Request again what has not come, and give up after the timeout; ``now`` in s."""
        transfer = self._transfer
        if transfer is None:
            return
        latest = now + TIME_TOLERANCE
        if latest >= transfer.heard_at + self._settings.timeout:
            text = f"Upload cancelled: item {transfer.expected} of {transfer.end} did not come"
            self._finish(MissionAnswer(mavlink.MAV_MISSION_OPERATION_CANCELLED, text))
        elif latest >= transfer.requested_at + self._settings.retry_interval:
            self._request_next(transfer, now)

    def is_busy_for(self, request: Request) -> bool:
        """Whether another ground uploads."""
        return self._transfer is not None and self._transfer.ground != ground_of(request)

    def begin(self, request: Request, plan_type: PlanType, count: int, kept: Kept = NOTHING_KEPT) -> None:
        """Begin to request ``count`` items; an upload of the same ground that is under way is given up."""
        self._transfer = _Transfer(request, plan_type, count, kept)
        if self._outcome is not None and self._outcome[:2] == (self._transfer.ground, plan_type):
            self._outcome = None
        self._request_next(self._transfer, request.now)

    def cancel(self, request: Request) -> None:
        """End the upload of a ground without an answer: it has ended it itself."""
        if self._transfer is not None and self._transfer.ground == ground_of(request):
            self._transfer = None

    def take(self, message: ItemMessage, request: Request) -> None:
        """Take an item: request the next one, or finish."""
        transfer = self._transfer
        if transfer is None or (transfer.ground, transfer.plan_type) != (ground_of(request), message.mission_type):
            self._take_late(message, request)
            return
        transfer.heard_at = request.now
        if message.seq >= transfer.end:
            text = f"Upload refused: item {message.seq}, of {transfer.end} that were announced"
            self._finish(MissionAnswer(mavlink.MAV_MISSION_INVALID_SEQUENCE, text))
        elif message.seq == transfer.expected:  # else it came twice, or was overtaken: the next request is on its way
            self._append(transfer, message, request.now)

    def refuse(self, message: ItemMessage, request: Request, answer: MissionAnswer) -> None:
        """Refuse an item, and with it the upload that it is part of."""
        self.cancel(request)
        send_answer(request, message.mission_type, answer)

    def on_ack(self, message: mavlink.MAVLink_mission_ack_message, request: Request) -> None:
        """End an upload that its ground cancels; where it knows one kind of items only, request the other."""
        transfer = self._transfer
        if transfer is None or transfer.ground != ground_of(request) or message.mission_type != transfer.plan_type:
            return
        if message.type == mavlink.MAV_MISSION_OPERATION_CANCELLED:
            self._transfer = None
        elif message.type == mavlink.MAV_MISSION_UNSUPPORTED:
            transfer.heard_at = request.now
            transfer.as_real_numbers = not transfer.as_real_numbers
            self._request_next(transfer, request.now)

    def _append(self, transfer: _Transfer, message: ItemMessage, now: float) -> None:
        item = item_of(message)
        answer = self._store.check(transfer.plan_type, item, message.seq)
        if not answer.is_accepted:
            self._finish(answer)
            return
        transfer.items.append(item)
        if message.current == 1:
            transfer.current = message.seq
        if transfer.expected < transfer.end:
            self._request_next(transfer, now)
            return
        items = *transfer.kept.before, *transfer.items, *transfer.kept.behind
        self._finish(self._store.accept(transfer.plan_type, items, transfer.current))

    def _take_late(self, message: ItemMessage, request: Request) -> None:
        """Answer an item behind the end of its upload once more, if it is the last; earlier ones came twice."""
        outcome = self._outcome
        if outcome is None or outcome[:2] != (ground_of(request), message.mission_type):
            send_answer(
                request, message.mission_type, MissionAnswer(mavlink.MAV_MISSION_ERROR, "No upload: item ignored")
            )
        elif message.seq >= outcome.last:
            send_answer(request, outcome.plan_type, MissionAnswer(outcome.result), outcome.opaque_id)

    def _request_next(self, transfer: _Transfer, now: float) -> None:
        transfer.requested_at = now
        kind = (
            mavlink.MAVLink_mission_request_message
            if transfer.as_real_numbers
            else mavlink.MAVLink_mission_request_int_message
        )
        request = transfer.request
        request.peer.reply(kind(request.system, request.component, transfer.expected, transfer.plan_type))

    def _finish(self, answer: MissionAnswer) -> None:
        transfer = self._transfer
        assert transfer is not None
        self._transfer = None
        identity = self._store.id_of(transfer.plan_type) if answer.is_accepted else 0
        last = min(transfer.expected, transfer.end - 1)
        self._outcome = _Outcome(transfer.ground, transfer.plan_type, last, answer.result, identity)
        send_answer(transfer.request, transfer.plan_type, answer, identity)
