"""Download of plans: a ground gets the plan that MISSION_COUNT promised, even if another is uploaded meanwhile."""

from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.dispatcher import Request
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mavlink.services.mission_messages import count, item_message
from gcs.mavlink.services.mission_store import MissionAnswer, MissionStore
from gcs.mavlink.services.mission_upload import Ground, ground_of, send_answer
from gcs.mavlink.settings import MissionTransferSettings


class _Promised(NamedTuple):
    """The items that a ground downloads, and when it was heard last (s)."""

    items: tuple[MissionItem, ...]
    heard_at: float


class MissionDownload:
    """All downloads. Items are sent on request, in any order, and again; what was not promised is that in effect."""

    def __init__(self, store: MissionStore, settings: MissionTransferSettings) -> None:
        self._store = store
        self._settings = settings
        self._promised: dict[tuple[Ground, PlanType], _Promised] = {}

    def on_request_list(self, plan_type: PlanType, request: Request) -> None:
        """Send MISSION_COUNT, and keep the plan for this ground."""
        items = self._store.items_of(plan_type)
        identity = self._store.id_of(plan_type)
        self._promised.pop((ground_of(request), plan_type), None)
        if items:
            self._keep((ground_of(request), plan_type), items, request.now)
        request.peer.reply_packed(count(request.system, request.component, len(items), plan_type, identity))

    def on_request(self, plan_type: PlanType, number: int, request: Request) -> None:
        """Send item ``number``, whichever of the two requests it was; outside of the plan a refusal."""
        key = ground_of(request), plan_type
        promised = self._promised.get(key)
        items = self._store.items_of(plan_type)
        if promised is not None and request.now - promised.heard_at <= self._settings.timeout:
            items = promised.items
            self._promised[key] = promised._replace(heard_at=request.now)
        if number < len(items):
            self._send(plan_type, items, number, request)
        else:
            send_answer(request, plan_type, MissionAnswer(mavlink.MAV_MISSION_INVALID_SEQUENCE))

    def on_request_partial(self, plan_type: PlanType, first: int, last: int, request: Request) -> None:
        """Send items ``first`` to ``last`` (-1: to the end) at once, a bounded number; else a refusal."""
        items = self._store.items_of(plan_type)
        if last == -1:
            last = len(items) - 1
        if not 0 <= first <= last < len(items):
            send_answer(request, plan_type, MissionAnswer(mavlink.MAV_MISSION_INVALID_SEQUENCE))
        elif last - first >= self._settings.partial_list_max:
            text = f"At most {self._settings.partial_list_max} mission items at once"
            send_answer(request, plan_type, MissionAnswer(mavlink.MAV_MISSION_NO_SPACE, text))
        else:
            for number in range(first, last + 1):
                self._send(plan_type, items, number, request)

    def on_ack(self, plan_type: int, request: Request) -> None:
        """End a download."""
        for key in [key for key in self._promised if key == (ground_of(request), plan_type)]:
            del self._promised[key]

    def _send(self, plan_type: PlanType, items: tuple[MissionItem, ...], number: int, request: Request) -> None:
        is_current = plan_type == PlanType.MISSION and number == self._store.progress().current
        request.peer.reply(
            item_message(request.system, request.component, number, items[number], is_current, plan_type)
        )  # fmt: skip

    def _keep(self, key: tuple[Ground, PlanType], items: tuple[MissionItem, ...], now: float) -> None:
        """Keep a plan for a ground, in place of that of the one that was heard least lately, if there are many."""
        if len(self._promised) >= self._settings.downloads_max:
            del self._promised[min(self._promised, key=lambda key: self._promised[key].heard_at)]
        self._promised[key] = _Promised(items, now)
