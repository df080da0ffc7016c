"""One line for one reason of many rows."""

import pytest

from gcs.mission.reasons import merged

CAMERA = [f"line {i + 2}: row {i} (IMAGE_START_CAPTURE): left out" for i in range(4, 90, 2)]


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (CAMERA, ["rows 4, 6, 8 and 40 more (IMAGE_START_CAPTURE): left out"]),
        (CAMERA[:3], ["rows 4, 6 and 8 (IMAGE_START_CAPTURE): left out"]),
        (CAMERA[:1] * 2, CAMERA[:1]),
        (
            ["item 1.2 (NAV_LAND): 4 m low", "item 3 (DO_JUMP): -1", "item 7 (NAV_WAYPOINT): 12.5 m low"],
            ["items 1.2 and 7 (NAV_LAND, NAV_WAYPOINT): 4 to 12.5 m low", "item 3 (DO_JUMP): -1"],
        ),
        (["line 4: 3 columns, expected 12", "line 6: 13 columns, expected 12"],
         ["lines 4 and 6: 3 to 13 columns, expected 12"]),
        (["item 1: params[2]: not finite", "item 2: params[3]: not finite"],
         ["item 1: params[2]: not finite", "item 2: params[3]: not finite"]),
        (["item 2: crosses fence circle 1", "item 2: crosses fence circle 2"],
         ["item 2: crosses fence circle 1", "item 2: crosses fence circle 2"]),
        (["home: 3 m", "home: 4 m", "not valid JSON"], ["home: 3 m", "home: 4 m", "not valid JSON"]),
        ([], []),
    ],
)  # fmt: skip
def test_reasons_that_differ_in_row_and_numbers_are_one_line(lines: list[str], expected: list[str]) -> None:
    assert list(merged(lines)) == expected
