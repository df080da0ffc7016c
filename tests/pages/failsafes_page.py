"""``docs/failsafes.md`` from the tables of failsafes and alarms: ``python tests/pages/failsafes_page.py`` prints it."""

from dataclasses import asdict

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.condition import Reaction
from gcs.flight.delivery import DeliveryAlarm
from gcs.flight.detectors import MonitorAlarm
from gcs.flight.failsafe import Failsafe
from gcs.flight.guarantee import GuaranteeAlarm


def listing() -> str:
    """Return the whole page, with the default thresholds."""
    reactions = "\n".join(f"| `{reaction.name}` | {reaction.meaning} |" for reaction in Reaction if reaction)
    failsafes = "\n".join(
        f"| `{row.code}` | {row.meaning.format(**asdict(DEFAULTS.failsafe))} | {row.check.value} "
        f"| `{row.reaction.name}` | {row.severity.name.lower()} | {row.action} |"
        for row in Failsafe
    )
    alarms = "\n".join(
        f"| `{row.code}` | {row.meaning.format(**asdict(DEFAULTS.monitor))} | {row.scope.value} "
        f"| {row.severity.name.lower()} | {row.action} |"
        for row in (*MonitorAlarm, *GuaranteeAlarm, *DeliveryAlarm)
    )
    return f"""# Failsafes and alarms

This page is made from the code by `make docs`. Thresholds are those of the default settings
(`gcs/config/flight_settings.py`).

## Failsafes

Every condition that ends or changes a flight is a member of `Failsafe` in `gcs/flight/failsafe.py`. Of several
conditions the one with the most severe reaction counts; a reaction that is under way gives way only to a more severe
one. Before arming every reaction but `END_CONTROL` is `REFUSE`; until the climb, and while the vehicles are disarmed,
it is `DISARM`; between two flights, disarmed, `REFUSE` again: the next take-off is not begun.

| reaction, in ascending severity | what is done |
|---|---|
{reactions}

| code | condition | evaluated | reaction | severity | what to do |
|---|---|---|---|---|---|
{failsafes}

## Alarms

What the detectors in `gcs/flight/detectors.py`, `guarantee.py` and `delivery.py` find changes nothing by itself. With
the failsafes they are the codes of `alarms.csv` in the run folder; severities are those of MAV_SEVERITY. "Clear of the
ground" is 0.3 m above it.

| code | meaning | evaluated | severity | what to do |
|---|---|---|---|---|
{alarms}
"""


if __name__ == "__main__":
    print(listing(), end="")
