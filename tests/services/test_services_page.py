"""The page of services is the one that the code makes."""

from pathlib import Path

from vehicle_sim.mavlink.services_page import services_page

PAGE = Path(__file__).parents[2] / "docs" / "services.md"


def test_services_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == services_page(), "run make docs"


def test_every_row_of_the_page_says_what_it_is() -> None:
    rows = [line for line in services_page().splitlines() if line.startswith("| ")]
    assert len(rows) > 80 and not [row for row in rows if row.endswith("|  |") and "MODE" not in row and "`" not in row]
