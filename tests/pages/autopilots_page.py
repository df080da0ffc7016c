"""``docs/autopilots.md`` from the table of requirements: ``python tests/pages/autopilots_page.py`` prints it."""

from gcs.flight.autopilot_requirements import REQUIREMENTS, USED_IF_OFFERED


def listing() -> str:
    """Return the whole page."""
    needed = "\n".join(
        f"| `{row.what}` | {'`rates.control`' if row.at_control_rate else ''} | {row.purpose} |" for row in REQUIREMENTS
    )
    used = "\n".join(f"| {what} | {purpose} |" for what, purpose in USED_IF_OFFERED)
    return f"""# What an autopilot must offer

This page is made by `make docs` from the table in `gcs/flight/autopilot_requirements.py`, which `gcs fly --connect`
checks before anything is armed: all that is missing is named at once, with the vehicles that lack it
(`CONNECT_TIMEOUT`); then that TIMESYNC is answered, and telemetry comes often enough (`AUTOPILOT_UNFIT`).

A PX4 without changes lacks the parameters that begin with `CLFT_` and the payload unit's telemetry: a companion
computer on each vehicle has to add them, and to fly the stop plan. None has been flown.

| needed | at least as often as | for |
|---|---|---|
{needed}

Not checked, because flights go on without it or it shows in flight only:

| used | for |
|---|---|
{used}
"""


if __name__ == "__main__":
    print(listing(), end="")
