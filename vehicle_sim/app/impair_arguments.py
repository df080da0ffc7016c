"""The command line of ``vehicle-sim impair``."""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from gcs.app.arguments import SEED, Parser, Version, number, whole_number
from gcs.errors import UnusableInput
from gcs.mavlink.address import Address, ConnectionUrl, parse_url
from vehicle_sim.faults.impaired_link import ENDS, End
from vehicle_sim.faults.link_profiles import PROFILES, LinkDirection, LinkProfile

_DESCRIPTION = """\
Puts a radio link between any two MAVLink programs: what comes at LISTEN goes on to FORWARD, late or never, and what
FORWARD answers goes back to all that sent to LISTEN in the last 10 s. Datagrams are lost, delayed and reordered whole,
with all messages in them, and not read. The same seed, datagrams and times give the same losses.

LISTEN and FORWARD are udpin://HOST:PORT (listens there, and answers who sends) or udpout://HOST:PORT (sends there; of
FORWARD only); HOST:PORT alone is udpin of LISTEN and udpout of FORWARD."""

_EPILOG = """\
On standard output, line by line: every link, and "ready"; at the end the datagrams of each direction: received,
forwarded, lost, lost because the queue was full, late (they waited for others or for their turn to transmit) and
reordered.

Examples:
  vehicle-sim impair --profile lte udpin://127.0.0.1:14550 udpout://127.0.0.1:14560
                                    PX4 SITL, which sends to port 14550, as over LTE to a ground station on 14560
  vehicle-sim --base-port 14680     a swarm on other ports than usual, in another terminal, and in front of it
  vehicle-sim impair --profile wifi --vehicle forward --links 4 127.0.0.1:14580 127.0.0.1:14680
                                    four links, for gcs fly MISSION --realtime --connect in a third one
  vehicle-sim impair --loss 0.1 --latency 0.05,0.02 127.0.0.1:14550 127.0.0.1:14560
                                    loss of 10 %; telemetry is 50 ms late, commands 20 ms

Exit status: 0 ended by SIGTERM, 2 unusable input, with the reason on standard error and nothing started, 130
interrupted, or its terminal closed. docs/links.md has the profiles with their sources.
"""
_HOST_AND_PORT = {"listen": "udpin", "forward": "udpout"}
_URL_SCHEMES = ("udp", "udpin", "udpout")
_PORT_MAX = 65535


class ImpairOptions(NamedTuple):
    """What is between which addresses."""

    profile: LinkProfile
    name: str
    """Of the profile, and of what was changed."""
    seed: int
    vehicle: End
    addresses: list[tuple[Address, ConnectionUrl]]
    """Of each link where it listens, and where it forwards to."""


class _Value(NamedTuple):
    """An option for a field of both directions: a value, or one of telemetry and one of commands."""

    field: str
    type: Callable[[str], float]
    meaning: str


_VALUES = (
    _Value("loss", partial(number, least=0.0, most=1.0), "probability that a datagram is lost"),
    _Value("burst", partial(number, least=0.0, most=1e3), "mean length of bursts of losses (s); 0: independent losses"),
    _Value("latency", partial(number, least=0.0, most=60.0), "delay of every datagram (s)"),
    _Value("jitter", partial(number, least=0.0, most=60.0), "longest random delay beside it (s), the order kept"),
    _Value("reordering", partial(number, least=0.0, most=1.0), "probability that later datagrams overtake one"),
    _Value("rate", partial(number, least=1.0, most=1e9), "limit of the rate (bytes/s), of sik in its windows"),
    _Value("queue", partial(whole_number, least=1, most=10**9), "bytes that may wait for it; others are lost"),
)  # fmt: skip


def parse_impair(argv: list[str]) -> ImpairOptions:
    """Return the options. Raises :class:`~gcs.errors.UnusableInput`; ``--help`` and ``--version`` exit."""
    parser = Parser(prog="vehicle-sim impair", description=_DESCRIPTION, epilog=_EPILOG)
    add = parser.add_argument
    add("listen", metavar="LISTEN", help="where one of the programs sends to")
    add("forward", metavar="FORWARD", help="where the other one is")
    add("--profile", choices=PROFILES, help="the kind of link: %(choices)s")
    add("--seed", type=SEED, default=1, metavar="S", help="seed of all random numbers (default: %(default)s)")
    add("--vehicle", choices=ENDS, default="listen", metavar="END",
        help="end at which the vehicle is, listen or forward: from there the profile's values of telemetry hold, from "
        "the other one those of commands (default: listen)")  # fmt: skip
    add("--links", type=partial(whole_number, least=1, most=99), default=1, metavar="N",
        help="number of links, each on the ports that follow the last one's (default: %(default)s)")  # fmt: skip
    values = parser.add_argument_group("values", "in place of the profile's; two between a comma: telemetry, commands")
    for value in _VALUES:
        values.add_argument(f"--{value.field}", type=partial(_pair, value.type), metavar="X", help=value.meaning)
    add("--version", action=Version)
    options, unknown = parser.parse_known_args(argv)
    parser.refuse_unknown(unknown)
    changed = {value.field: pair for value in _VALUES if (pair := getattr(options, value.field)) is not None}
    if options.profile is None and not changed:
        parser.error(f"needs --profile ({', '.join(PROFILES)}), or a value such as --loss 0.1")
    profile = _changed(PROFILES.get(options.profile, LinkProfile(LinkDirection(), LinkDirection())), changed)
    for needed, field in (("loss", "burst"), ("rate", "queue")):
        if field in changed and not all(getattr(way, needed) for way in (profile.telemetry, profile.command)):
            parser.error(f"--{field}: without effect where there is no {needed}; add --{needed}")
    name = ", ".join([options.profile or "no profile", *(f"{f} {_shown(pair)}" for f, pair in changed.items())])
    return ImpairOptions(profile, name, options.seed, options.vehicle, _addresses(options))


def _pair(read: Callable[[str], float], text: str) -> tuple[float, float]:
    first, comma, second = text.partition(",")
    value = read(first)
    return value, read(second) if comma else value


def _shown(pair: tuple[float, float]) -> str:
    return f"{pair[0]:g}" if pair[0] == pair[1] else f"{pair[0]:g},{pair[1]:g}"


def _changed(profile: LinkProfile, values: dict[str, tuple[float, float]]) -> LinkProfile:
    telemetry, command = ({field: pair[way] for field, pair in values.items()} for way in (0, 1))
    # What mypy cannot know: every value is of its field's type.
    return LinkProfile(
        dataclasses.replace(profile.telemetry, **telemetry),  # type: ignore[arg-type]
        dataclasses.replace(profile.command, **command),  # type: ignore[arg-type]
    )


def _addresses(options: argparse.Namespace) -> list[tuple[Address, ConnectionUrl]]:
    """Return where each link listens and forwards to. Raises :class:`UnusableInput`."""
    listen, forward = (_url(getattr(options, end), end) for end in ENDS)
    if not listen.listens:
        raise UnusableInput(f"LISTEN {options.listen}: listens; expected udpin://HOST:PORT or HOST:PORT")
    for url, text, end in ((listen, options.listen, "LISTEN"), (forward, options.forward, "FORWARD")):
        if url.port + options.links - 1 > _PORT_MAX:
            raise UnusableInput(f"{end} {text}: port {url.port + options.links - 1} of link {options.links} is none")
    is_here = forward.listens or forward.host.startswith("127.") or forward.host == listen.host
    if is_here and abs(forward.port - listen.port) < options.links:
        raise UnusableInput(
            f"FORWARD {options.forward}: port {max(forward.port, listen.port)} is one of LISTEN's; choose another"
        )
    return [
        ((listen.host, listen.port + i), dataclasses.replace(forward, port=forward.port + i))
        for i in range(options.links)
    ]


def _url(text: str, end: End) -> ConnectionUrl:
    scheme = text.partition(":")[0]
    return parse_url(text if scheme in _URL_SCHEMES else f"{_HOST_AND_PORT[end]}://{text}", end.upper())
