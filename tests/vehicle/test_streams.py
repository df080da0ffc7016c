"""Streams of a vehicle to its peers: when each message is due, what is repeated or never sent twice, and to whom."""

import math
from types import SimpleNamespace

import pymavlink.dialects.v20.common as mavlink
import pytest

from gcs.config.vehicle_settings import StreamIntervals, VehicleLinkSettings
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.layout import packed
from gcs.mavlink.services.peer import Peer, Stream
from gcs.mavlink.services.peers import Peers
from vehicle_sim.mavlink.streams import OFFSETS, default_intervals

OWN, UNIT = px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT
HEARTBEAT, ATTITUDE = mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION
STATE = mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE
SETTINGS = VehicleLinkSettings()
IDENTITIES = (3, OWN), (px4.PAYLOAD_UNIT_SYSTEM, UNIT)
BEAT = packed(mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 3, 3))


def sample(stamp=0):
    """The messages of one sample: attitude with its ``stamp`` (ms), landed state, else a heartbeat."""
    attitude = packed(mavlink.MAVLink_attitude_quaternion_message(stamp, 1, 0, 0, 0, 0, 0, 0))
    of_kind = {ATTITUDE: attitude, STATE: packed(mavlink.MAVLink_extended_sys_state_message(0, 1))}
    return SimpleNamespace(messages=lambda key: of_kind.get(key[1], BEAT))


@pytest.mark.parametrize(
    ("now", "due"), [(0.0, 0.25), (0.1, 0.25), (0.2499, 0.25), (0.2499995, 0.5), (0.25, 0.5), (0.7, 0.75)]
)
def test_stream_is_due_at_the_next_multiple_of_its_interval(now, due):
    stream = Stream(OWN, HEARTBEAT, 0.25)
    assert stream.due == -math.inf and stream.key == (OWN, HEARTBEAT)
    assert stream.take(sample(), now, 0.04) == BEAT
    assert stream.due == pytest.approx(due)


def test_stream_with_an_offset_begins_with_it_and_is_repeated_at_once():
    stream = Stream(OWN, HEARTBEAT, 1.0, 0.08)
    assert stream.take(sample(), 5.02, 0.04) == () and stream.due == pytest.approx(5.08)
    assert stream.take(sample(), 5.08, 0.04) == BEAT and stream.due == pytest.approx(6.08)
    stream = Stream(OWN, HEARTBEAT, 1.0, 0.08)
    stream.repeats = 1
    assert stream.take(sample(), 5.02, 0.04) == BEAT and stream.due == pytest.approx(5.06)
    assert stream.take(sample(), 5.06, 0.04) == BEAT and stream.due == pytest.approx(5.08)


def test_default_streams_stay_within_a_datagram_between_scans():
    """Those with offsets come with the vehicle's and the payload's navigation, and with nothing else."""
    intervals = default_intervals(StreamIntervals(), 0.04)
    for offset in set(OFFSETS.values()):
        assert offset / 0.04 == pytest.approx(round(offset / 0.04)) and 0.0 < offset < 0.1
    assert all(intervals[key] >= 1.0 for key in OFFSETS)


def test_repetitions_are_due_sooner_and_end():
    stream = Stream(OWN, HEARTBEAT, 1.0)
    stream.repeats = 2
    times = [10.0]
    for _ in range(4):
        stream.take(sample(), times[-1], 0.04)
        times.append(stream.due)
    assert times == pytest.approx([10.0, 10.04, 10.08, 11.0, 12.0])
    stream.repeats = 1
    stream.take(sample(), 12.99, 0.04)
    assert stream.due == pytest.approx(13.0)  # the stream itself is due sooner still


def test_messages_of_one_sample_are_sent_once_and_others_again_and_again():
    for number, expected in ((ATTITUDE, [1, 0, 1, 0, 1]), (HEARTBEAT, [1, 1, 1, 1, 1])):
        stream = Stream(OWN, number, 0.02)
        taken = [len(stream.take(sample(stamp), 0.02 * k, 0.04)) for k, stamp in enumerate((40, 40, 60, 60, 40))]
        assert taken == expected


def peer(settings=SETTINGS, **options):
    found = Peer(("10.0.0.1", 5), IDENTITIES, default_intervals(StreamIntervals(), 0.02), settings, **options)
    found.answered = True
    return found


def sent(to, now, stamp=0):
    """Kinds and components of what goes out, the payload unit's by a system id of its own."""
    received = [r for datagram in to.datagrams(sample(stamp), now) for r in Codec(254, 1).decode(datagram)]
    assert all(r.system == (px4.PAYLOAD_UNIT_SYSTEM if r.component == UNIT else 3) for r in received)
    return [(r.component, r.layout.message_id) for r in received]


def test_answers_go_out_before_what_is_due():
    asking = peer()
    sent(asking, 0.0)
    asking.reply(mavlink.MAVLink_extended_sys_state_message(0, 1))
    assert sent(asking, 0.001) == [(OWN, STATE)] and sent(asking, 0.001) == []
    asking.reply(mavlink.MAVLink_extended_sys_state_message(0, 1), component=UNIT)
    assert sent(asking, 0.02, stamp=1)[:1] == [(UNIT, STATE)]


def test_peer_gets_the_payload_units_streams_by_default_or_on_request():
    without = peer(silent=UNIT)
    assert {component for component, _ in sent(without, 0.0)} == {OWN}
    without.set_interval(ATTITUDE, 0.0, UNIT)
    assert [key for key in sent(without, 0.02, stamp=1) if key[0] == UNIT] == [(UNIT, ATTITUDE)]
    without.set_interval(ATTITUDE, math.inf, UNIT)
    assert {component for component, _ in sent(without, 0.04, stamp=2)} == {OWN}


def test_streaming_peer_gets_everything_at_once_and_changed_messages_repeatedly():
    streaming = peer()
    assert streaming.next_due == -math.inf
    assert len(sent(streaming, 10.0)) == len(default_intervals(StreamIntervals(), 0.02))
    assert streaming.next_due == pytest.approx(10.02)
    streaming.repeat(STATE)
    times = [10.001 + SETTINGS.repeat_interval * k for k in range(5)]
    found = [sum(key == (OWN, STATE) for key in sent(streaming, t, stamp=k)) for k, t in enumerate(times)]
    assert found == [1] * (SETTINGS.repeats + 1) + [0]


def test_interval_of_a_message_can_be_set_stopped_and_restored():
    streaming, key = peer(), (OWN, STATE)
    sent(streaming, 0.0)

    def count(begin):
        return sum(sent(streaming, begin + 0.01 * k, stamp=k).count(key) for k in range(1, 101))

    usual = round(1.0 / StreamIntervals().extended_sys_state)
    assert count(0.0) == usual
    for interval, expected in ((0.1, 10), (math.inf, 0), (0.5, 2), (0.0, usual)):
        streaming.set_interval(STATE, interval)
        assert streaming.next_due == -math.inf
        sent(streaming, 0.0)
        assert count(0.0) == expected
    # The default of what is not streamed is silence.
    streaming.set_interval(mavlink.MAVLINK_MSG_ID_ODOMETRY, 0.1)
    streaming.set_interval(mavlink.MAVLINK_MSG_ID_ODOMETRY, 0.0)
    sent(streaming, 0.0)
    assert not any(number == mavlink.MAVLINK_MSG_ID_ODOMETRY for _, number in sent(streaming, 0.5, stamp=7))


def test_answers_beyond_the_limit_are_dropped():
    busy = peer(VehicleLinkSettings(replies_max=3))
    sent(busy, 0.0)
    for _ in range(5):
        busy.reply(mavlink.MAVLink_extended_sys_state_message(0, 1))
    assert len(sent(busy, 0.001)) == 3


def test_long_text_is_sent_in_pieces():
    talking = peer()
    sent(talking, 0.0)
    text = "".join(chr(97 + k % 26) for k in range(120)) + "é"
    talking.send_statustext(text)
    pieces = [r.message for datagram in talking.datagrams(sample(), 0.001) for r in Codec(254, 1).decode(datagram)]
    assert [piece.text for piece in pieces] == [text[:50], text[50:100], text[100:120] + "?"]
    assert {piece.severity for piece in pieces} == {mavlink.MAV_SEVERITY_WARNING}


def test_components_have_sequence_numbers_of_their_own():
    streaming = peer()
    numbers = {OWN: [], UNIT: []}
    for k in range(3):
        for datagram in streaming.datagrams(sample(k), 0.02 * k):
            for received in Codec(254, 1).decode(datagram):
                numbers[received.component].append(received.sequence)
    for found in numbers.values():
        assert len(found) > 3 and found == list(range(len(found)))


LIMITED = VehicleLinkSettings(peers_max=2, peer_timeout=10.0)
GROUND, FIRST, SECOND, THIRD, SDK = (("10.0.0.1", port) for port in range(5))


class Builders:
    """What the peers send of: of all kinds a heartbeat."""

    def __init__(self):
        self.builders = dict.fromkeys(default_intervals(StreamIntervals(), 0.02), lambda now: BEAT)


def peers(*clients):
    intervals = default_intervals(StreamIntervals(), 0.02)
    return Peers(
        lambda address, with_payload: Peer(address, IDENTITIES, intervals, LIMITED, None if with_payload else UNIT),
        dict.fromkeys(clients, True), LIMITED,
    )  # fmt: skip


def called_in(served, address, now, *, answered=True):
    """Let an address send something; return whether it is served."""
    found = served.receive_from(address, now)
    if found is not None and not found.answered:
        found.hear(21, addressed=answered)
    return found is not None


def addressees(served, now):
    return {address for _, address in served.datagrams_to_send(Builders(), now)}


def test_newcomer_gets_no_acknowledgement_of_a_message_that_is_too_long_for_it():
    new = Peer(GROUND, IDENTITIES, {}, SETTINGS)
    new.hear(60, addressed=False)
    new.reply(mavlink.MAVLink_statustext_message(4, b"x" * 50))
    new.reply(mavlink.MAVLink_extended_sys_state_message(0, 1))
    assert sent(new, 0.0) == [(OWN, HEARTBEAT)]


def test_vehicle_without_peers_is_never_due_and_one_with_clients_at_once():
    assert peers().next_due == math.inf and addressees(peers(), 0.0) == set()
    sending = peers(GROUND)
    assert sending.next_due == -math.inf and addressees(sending, 0.0) == {GROUND}
    assert sending.next_due == pytest.approx(0.02) and addressees(sending, 0.01) == set()


@pytest.mark.parametrize("clients", [(), (GROUND,), (GROUND, SDK)])
def test_number_of_peers_is_bounded_beside_the_clients(clients):
    served = peers(*clients)
    found = [called_in(served, address, 0.0) for address in (FIRST, SECOND, THIRD)]
    assert found == [True, True, False]
    assert served.receive_from(FIRST, 0.0) is served.receive_from(FIRST, 1.0)
    assert all(served.receive_from(client, 0.0) is not None for client in clients)
    assert len(list(served)) == 2 + len(clients)


@pytest.mark.parametrize(("age", "room"), [(2.4, False), (2.6, True)])
def test_silent_peer_makes_room_for_a_newcomer_that_has_answered_or_not(age, room):
    served = peers()
    called_in(served, FIRST, 0.0)
    called_in(served, SECOND, age)
    assert called_in(served, THIRD, age, answered=False) is room
    assert (FIRST in {peer.address for peer in served}) is not room


def test_streams_of_a_silent_peer_stop_and_those_of_a_client_do_not():
    served = peers(GROUND, SDK)
    for address in (GROUND, FIRST, SECOND):
        called_in(served, address, 0.0)
    called_in(served, SECOND, 5.0)
    assert addressees(served, 9.9) == {GROUND, SDK, FIRST, SECOND}
    assert addressees(served, 10.1) == {GROUND, SDK, SECOND}
    assert addressees(served, 3600.0) == {GROUND, SDK}


def test_listener_is_a_client_that_has_never_sent_anything():
    served = peers(GROUND, SDK)
    assert served.listeners == {GROUND, SDK}
    called_in(served, FIRST, 0.0)
    called_in(served, SDK, 0.0)
    assert served.listeners == {GROUND}


def test_texts_and_changed_messages_go_to_all():
    served = peers(GROUND)
    called_in(served, FIRST, 0.0)
    addressees(served, 0.0)
    served.send_statustext("landed")
    assert addressees(served, 0.001) == {FIRST, GROUND}
    served.repeat(HEARTBEAT)
    assert served.next_due == -math.inf and addressees(served, 0.002) == {GROUND, FIRST}


def test_message_is_built_once_for_all_peers():
    served, built = peers(), []
    for address in (FIRST, SECOND):
        called_in(served, address, 0.0)
    telemetry = Builders()
    telemetry.builders = {key: lambda now, key=key: built.append((key, now)) or BEAT for key in telemetry.builders}
    served.datagrams_to_send(telemetry, 7.0)
    assert sorted(built) == sorted((key, 7.0) for key in telemetry.builders)


def test_one_that_has_not_answered_makes_room_at_once_and_one_that_has_does_not():
    served = peers()
    called_in(served, FIRST, 0.0)
    called_in(served, SECOND, 0.0, answered=False)
    assert called_in(served, THIRD, 0.1)
    assert {peer.address for peer in served} == {FIRST, THIRD}
    assert not called_in(served, SECOND, 0.2)


def test_one_heartbeat_draws_no_more_than_it_sent_before_it_has_answered():
    served, telemetry = peers(), Builders()
    called_in(served, FIRST, 0.0, answered=False)
    drawn = [len(d) for k in range(400) for d, _ in served.datagrams_to_send(telemetry, 0.02 * k)]
    assert sum(drawn) == 21  # a HEARTBEAT in return
    called_in(served, FIRST, 8.0, answered=False)  # it speaks again after that
    assert sum(len(d) for d, _ in served.datagrams_to_send(telemetry, 8.0)) > 100


def test_answers_to_one_that_has_not_answered_are_no_more_than_it_sent():
    served = peers()
    called_in(served, FIRST, 0.0, answered=False)
    for _ in range(5):
        served.receive_from(FIRST, 0.0).reply(mavlink.MAVLink_system_time_message(1 << 60, 1 << 30))
    assert sum(len(d) for d, _ in served.datagrams_to_send(Builders(), 0.0)) <= 21
