"""Files that are not kept, and texts in chunks."""

from __future__ import annotations

import struct

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from service_bench import SYSTEM, ServiceBench

from gcs.mavlink.status_text import TextChunks

HEADER = "<HBBBBBBI"
ACK, NAK = 128, 129


def ask(opcode: int, data: bytes = b"", session: int = 0) -> tuple[tuple[int, ...], bytes] | None:
    """Header and data of the answer to a request of FTP."""
    payload = (struct.pack(HEADER, 41, session, opcode, len(data), 0, 0, 0, 8) + data).ljust(251, b"\0")
    answers = ServiceBench().request(mavlink.MAVLink_file_transfer_protocol_message(0, SYSTEM, 1, list(payload)))
    if not answers:
        return None
    [answer] = answers
    assert (answer.target_system, answer.target_component) == (255, 190)
    raw = bytes(answer.payload)
    header = struct.unpack(HEADER, raw[:12])
    return header, raw[12 : 12 + header[3]]


@pytest.mark.parametrize(
    ("opcode", "error"), [(3, 10), (4, 10), (14, 10), (5, 4), (15, 4), (7, 4), (6, 7), (8, 7), (9, 7), (13, 7), (99, 7)]
)
def test_request_of_a_file_is_refused_with_the_error(opcode: int, error: int) -> None:
    """10: no such file; 4: no such session; 7: no such command."""
    answer = ask(opcode, b"/etc/extras/component_general.json", session=3)
    assert answer == ((42, 3, NAK, 1, opcode, 0, 0, 8), bytes([error]))


@pytest.mark.parametrize("opcode", [0, 1, 2])
def test_end_of_sessions_is_acknowledged(opcode: int) -> None:
    assert ask(opcode) == ((42, 0, ACK, 0, opcode, 0, 0, 8), b"")


@pytest.mark.parametrize("opcode", [ACK, NAK])
def test_answer_of_another_is_not_answered(opcode: int) -> None:
    assert ask(opcode) is None


def test_there_are_no_logs() -> None:
    [entry] = ServiceBench().request(mavlink.MAVLink_log_request_list_message(SYSTEM, 1, 0, 0xFFFF))
    assert (entry.get_type(), entry.num_logs, entry.last_log_num, entry.size) == ("LOG_ENTRY", 0, 0, 0)


@pytest.mark.parametrize("length", [1, 49, 50, 51, 99, 100, 101, 150, 180])
def test_text_arrives_as_it_was_sent(length: int) -> None:
    bench, reader = ServiceBench(), TextChunks()
    texts = ["".join(chr(33 + (k + shift) % 90) for k in range(length)) for shift in (0, 1)]
    whole = []
    for text in texts:
        bench.peer.send_statustext(text)
        chunks = bench.drain()
        assert len(chunks) == (1 if length <= 50 else length // 50 + 1)
        assert len({chunk.id for chunk in chunks}) == 1 and (chunks[0].id > 0) is (length > 50)
        assert [chunk.chunk_seq for chunk in chunks] == list(range(len(chunks)))
        for chunk in [chunks[0], *chunks, chunks[-1]] if length > 50 else chunks:  # the first and the last come twice
            read = reader.add(chunk.text, chunk.id, chunk.chunk_seq)
            whole += [] if read is None else [read]
    assert whole == texts


def test_lost_chunk_leaves_a_gap() -> None:
    reader = TextChunks()
    assert reader.add("a" * 50, 4, 0) is None
    assert reader.add("c", 4, 2) == "a" * 50 + "..." + "c"
    assert reader.add("d" * 50, 5, 0) is None  # its last is lost
    assert reader.add("e" * 50, 6, 0) is None and reader.add("", 6, 1) == "e" * 50
