"""The MAVLink mission protocol: mission, fence and rally points of an aircraft, as PX4 serves them.

https://mavlink.io/en/services/mission.html
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import Packed, packed
from gcs.mavlink.messages import Message
from gcs.mavlink.services.aircraft import Built, Control, MessageKey
from gcs.mavlink.services.answer import Answer, denied
from gcs.mavlink.services.dispatcher import Command, Dispatcher, Request
from gcs.mavlink.services.mission_download import MissionDownload
from gcs.mavlink.services.mission_item import PlanType
from gcs.mavlink.services.mission_messages import ItemMessage, current
from gcs.mavlink.services.mission_store import TAKEN, MissionAnswer, MissionStore
from gcs.mavlink.services.mission_upload import Kept, MissionUpload, send_answer
from gcs.mavlink.services.peers import Peers
from gcs.mavlink.services.streams import whole
from gcs.mavlink.settings import MissionTransferSettings

M = TypeVar("M", bound=Message)

_BUSY = MissionAnswer(mavlink.MAV_MISSION_ERROR, "Mission upload refused: another ground uploads")
_STRANGER = MissionAnswer(mavlink.MAV_MISSION_DENIED, "Mission upload denied: another ground station is in control")
_UNKNOWN_TYPE = MissionAnswer(mavlink.MAV_MISSION_UNSUPPORTED)


class MissionServer:
    """Uploads, downloads, clearing, the current item, and what is said of the mission's progress.

    Only messages to the aircraft's own system are heeded, as by PX4: a broadcast uploads nothing to several.
    """

    def __init__(
        self, system_id: int, store: MissionStore, control: Control, peers: Peers, settings: MissionTransferSettings
    ) -> None:
        self._system_id = system_id
        self._store = store
        self._control = control
        self._peers = peers
        self._upload = MissionUpload(store, settings)
        self._download = MissionDownload(store, settings)
        self._limits = {
            PlanType.MISSION: settings.mission_items_max,
            PlanType.FENCE: settings.fence_items_max,
            PlanType.RALLY: settings.rally_points_max,
        }
        self._sent_changes = store.changes()

    # Messages

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service, and its command."""
        m = mavlink
        self._take(dispatcher, m.MAVLink_mission_request_list_message, self._on_request_list)
        self._take(dispatcher, m.MAVLink_mission_request_int_message, self._on_request)
        self._take(dispatcher, m.MAVLink_mission_request_message, self._on_request)
        self._take(dispatcher, m.MAVLink_mission_request_partial_list_message, self._on_request_partial_list)
        self._take(dispatcher, m.MAVLink_mission_count_message, self._on_count)
        self._take(dispatcher, m.MAVLink_mission_write_partial_list_message, self._on_write_partial_list)
        self._take(dispatcher, m.MAVLink_mission_item_int_message, self._on_item)
        self._take(dispatcher, m.MAVLink_mission_item_message, self._on_item)
        self._take(dispatcher, m.MAVLink_mission_ack_message, self._on_ack)
        self._take(dispatcher, m.MAVLink_mission_clear_all_message, self._on_clear_all)
        self._take(dispatcher, m.MAVLink_mission_set_current_message, self._on_set_current)
        dispatcher.register_commands({mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: self._do_set_current})

    def _take(self, dispatcher: Dispatcher, kind: type[M], handler: Callable[[M, Request], None]) -> None:
        def take_own(message: Any, request: Request) -> None:
            if message.target_system == self._system_id:
                handler(message, request)

        dispatcher.register(kind, take_own)

    def _on_request_list(self, message: mavlink.MAVLink_mission_request_list_message, request: Request) -> None:
        if (plan_type := _plan_type(message, request)) is not None:
            self._download.on_request_list(plan_type, request)

    def _on_request(
        self, message: mavlink.MAVLink_mission_request_int_message | mavlink.MAVLink_mission_request_message,
        request: Request,
    ) -> None:  # fmt: skip
        if (plan_type := _plan_type(message, request)) is not None:
            self._download.on_request(plan_type, message.seq, request)

    def _on_request_partial_list(
        self, message: mavlink.MAVLink_mission_request_partial_list_message, request: Request
    ) -> None:
        if request.peer.is_full:
            return  # the items would be dropped
        if (plan_type := _plan_type(message, request)) is not None:
            self._download.on_request_partial(plan_type, message.start_index, message.end_index, request)

    def _on_count(self, message: mavlink.MAVLink_mission_count_message, request: Request) -> None:
        if (plan_type := _plan_type(message, request)) is None:
            return
        if message.count == 0:
            self._clear((plan_type,), plan_type, request)
        elif not (answer := self._may_upload(plan_type, request)).is_accepted:
            send_answer(request, plan_type, answer)
        elif message.count > self._limits[plan_type]:
            text = f"Mission upload refused: {message.count} items, limit {self._limits[plan_type]}"
            self._upload.cancel(request)
            send_answer(request, plan_type, MissionAnswer(mavlink.MAV_MISSION_NO_SPACE, text))
        else:
            self._upload.begin(request, plan_type, message.count)

    def _on_write_partial_list(
        self, message: mavlink.MAVLink_mission_write_partial_list_message, request: Request
    ) -> None:
        if (plan_type := _plan_type(message, request)) is None:
            return
        items = self._store.items_of(plan_type)
        first, last = message.start_index, message.end_index if message.end_index != -1 else len(items) - 1
        if not (answer := self._may_upload(plan_type, request)).is_accepted:
            send_answer(request, plan_type, answer)
        elif not 0 <= first <= last < len(items):
            text = f"Mission upload refused: items {first} to {last} of {len(items)}"
            send_answer(request, plan_type, MissionAnswer(mavlink.MAV_MISSION_INVALID_SEQUENCE, text))
        else:
            self._upload.begin(request, plan_type, last + 1 - first, Kept(items[:first], items[last + 1 :]))

    def _on_item(self, message: ItemMessage, request: Request) -> None:
        if self._control.is_stranger(request.sender, request.now):  # another took control since the upload began
            self._upload.refuse(message, request, _STRANGER)
        else:
            self._upload.take(message, request)

    def _on_ack(self, message: mavlink.MAVLink_mission_ack_message, request: Request) -> None:
        self._download.on_ack(message.mission_type, request)
        self._upload.on_ack(message, request)

    def _on_clear_all(self, message: mavlink.MAVLink_mission_clear_all_message, request: Request) -> None:
        if message.mission_type == mavlink.MAV_MISSION_TYPE_ALL:
            self._clear(tuple(PlanType), message.mission_type, request)
        elif (plan_type := _plan_type(message, request)) is not None:
            self._clear((plan_type,), plan_type, request)

    def _on_set_current(self, message: mavlink.MAVLink_mission_set_current_message, request: Request) -> None:
        if self._control.is_stranger(request.sender, request.now):
            answer = denied("Mission item denied: another ground station is in control")
        else:
            answer = self._store.set_current(message.seq, request.now)
        if answer.text:
            request.peer.send_statustext(answer.text)
        request.peer.reply_packed(*self._current(request.now))  # the answer, be it the old one

    def _do_set_current(self, message: Command, request: Request) -> Answer:
        """Go on with an item of the mission (param1; -1: the current one); param2 1 resets the mission."""
        number = self._store.progress().current if message.param1 == -1.0 else whole(message.param1, 1 << 16)
        if number is None:
            return denied(f"Mission item denied: {message.param1:g} is no item")
        return self._store.set_current(number, request.now, reset=message.param2 == 1.0)

    # Changes

    def _may_upload(self, plan_type: PlanType, request: Request) -> MissionAnswer:
        if self._control.is_stranger(request.sender, request.now):
            return _STRANGER
        if self._upload.is_busy_for(request):
            return _BUSY
        return self._store.begin(plan_type)

    def _clear(self, plan_types: tuple[PlanType, ...], answered_type: int, request: Request) -> None:
        """Clear plans; where all are empty there is nothing that could be refused."""
        for plan_type in plan_types:
            if self._store.items_of(plan_type) and not (answer := self._may_upload(plan_type, request)).is_accepted:
                send_answer(request, answered_type, answer)
                return
        self._upload.cancel(request)
        for plan_type in plan_types:
            if self._store.items_of(plan_type):
                self._store.accept(plan_type, (), 0)
        send_answer(request, answered_type, TAKEN)

    # Streams and timers

    @property
    def builders(self) -> dict[MessageKey, Callable[[float], Built]]:
        """What builds MISSION_CURRENT and MISSION_ITEM_REACHED."""
        component = px4.AUTOPILOT_COMPONENT
        return {
            (component, mavlink.MAVLINK_MSG_ID_MISSION_CURRENT): self._current,
            (component, mavlink.MAVLINK_MSG_ID_MISSION_ITEM_REACHED): self._reached_again,
        }

    @property
    def next_due(self) -> float:
        """Time at which :meth:`run` has something to do (s); -inf: at once, inf: never."""
        return self._upload.next_due if self._store.changes() == self._sent_changes else -math.inf

    def run(self, now: float) -> None:
        """Send what has changed, and repeat requests of an upload; ``now`` in s."""
        self._upload.run(now)
        if (changes := self._store.changes()) != self._sent_changes:
            self._sent_changes = changes
            self._peers.repeat(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
            for number in self._store.take_reached():
                for peer in self._peers:
                    peer.reply(mavlink.MAVLink_mission_item_reached_message(number))

    def _current(self, now: float) -> tuple[Packed, ...]:
        """Item and state of the mission, and the ids of the plans."""
        mission, fence, rally = (self._store.id_of(plan_type) for plan_type in PlanType)
        return (current(self._store.progress(), (mission, fence, rally)),)

    def _reached_again(self, now: float) -> Built:
        """The item of the mission that was reached last, some times."""
        number = self._store.reached_again()
        return () if number is None else packed(mavlink.MAVLink_mission_item_reached_message(number))


def _plan_type(message: Any, request: Request) -> PlanType | None:
    """Return the plan that a message is about; None, and a refusal, if there is no such one."""
    try:
        return PlanType(message.mission_type)
    except ValueError:
        send_answer(request, message.mission_type, _UNKNOWN_TYPE)
        return None
