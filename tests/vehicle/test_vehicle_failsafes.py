from pathlib import Path

import pytest

from vehicle_sim.autopilot.failsafe import FAILSAFES

ARCHITECTURE = Path(__file__).parents[2] / "docs" / "architecture.md"


@pytest.mark.parametrize("failsafe", FAILSAFES, ids=lambda failsafe: failsafe.name)
def test_document_names_failsafe_of_vehicle_with_its_parameter(failsafe):
    rows = [line for line in ARCHITECTURE.read_text(encoding="utf-8").splitlines() if f"| `{failsafe.name}` |" in line]
    assert len(rows) == 1 and f"| `{failsafe.parameter}` |" in rows[0]


def test_notices_of_failsafes_fit_one_statustext():
    assert all(len(failsafe.notice) <= 50 for failsafe in FAILSAFES)
