from pathlib import Path

import pytest

from vehicle_sim.autopilot.failsafe import FAILSAFES
from vehicle_sim.autopilot.free import failsafe as free

ARCHITECTURE = Path(__file__).parents[2] / "docs" / "architecture.md"


@pytest.mark.parametrize(
    "heading, failsafe",
    [
        *[("Failsafes of a vehicle", failsafe) for failsafe in FAILSAFES],
        *[("Failsafes of a free vehicle", failsafe) for failsafe in free.FAILSAFES],
    ],
)
def test_document_names_failsafe_of_vehicle_with_its_parameter(heading, failsafe):
    section = ARCHITECTURE.read_text(encoding="utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = [line for line in section.splitlines() if f"| `{failsafe.name}` |" in line]
    assert len(rows) == 1 and f"| `{failsafe.parameter}` |" in rows[0]


def test_notices_of_failsafes_fit_one_statustext():
    assert all(len(failsafe.notice) <= 50 for failsafe in (*FAILSAFES, *free.FAILSAFES))
