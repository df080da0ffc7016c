"""The table of profiles in ``docs/links.md``: ``python tests/pages/links_page.py docs/links.md`` renews it."""

import sys
from pathlib import Path

from vehicle_sim.faults.link_profiles import PROFILES, LinkDirection, LinkProfile

BEGIN, END = "<!-- profiles -->", "<!-- end of profiles -->"


def profiles_table() -> str:
    """Return the table, a row for each direction, or for both where they are the same."""
    lines = [
        "| profile | direction | rate | queue | loss | latency | jitter |",
        "|---|---|---|---|---|---|---|",
        *(row for name, profile in PROFILES.items() for row in _rows(name, profile)),
    ]
    return "\n".join(lines)


def _rows(name: str, profile: LinkProfile) -> list[str]:
    if profile.telemetry == profile.command:
        return [f"| `{name}` | both | {_cells(profile.telemetry)} |"]
    return [f"| `{name}` | {way} | {_cells(getattr(profile, way))} |" for way in ("telemetry", "command")]


def _cells(way: LinkDirection) -> str:
    assert way.rate is not None and not way.reordering
    rate = f"{way.rate:,.0f} bytes/s"
    if turns := way.time_division:
        rate += f", for {_ms(turns.window)} of every {_ms(turns.round)}"
    loss = f"{100.0 * way.loss:g} %" + (f", in bursts of {_ms(way.burst)}" if way.burst else "")
    return " | ".join((rate, f"{way.queue:,} bytes", loss, _ms(way.latency), _ms(way.jitter)))


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.4g} ms" if seconds else "0"


def renewed(page: str) -> str:
    """Return ``docs/links.md`` with the table of the present profiles."""
    before, _, rest = page.partition(BEGIN)
    return f"{before}{BEGIN}\n\n{profiles_table()}\n\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    documentation = Path(sys.argv[1])
    documentation.write_text(renewed(documentation.read_text(encoding="utf-8")), encoding="utf-8")
