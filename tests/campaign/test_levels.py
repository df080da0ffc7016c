"""Levels of evidence: courses are planned, the nearest misses flown in full within a budget, and nothing twice."""

import math
from dataclasses import replace

import pytest
from levels_page import COURSES, rows
from page_tables import markdown_table
from scenario_results import result_of
from small_campaign import InThisThread

from gcs.app.cli import main
from gcs.campaign import engine
from gcs.campaign.result import Result
from gcs.campaign.scenarios.levels import contact_bound

CLEARANCES = {1: 0.9, 2: 0.4, 3: None, 4: 0.7, 5: 0.5, 6: 0.8}
"""Planned, by the number of the course (m)."""


@pytest.fixture
def flown(monkeypatch):
    """Nothing is flown: planning takes 10 s of CPU, a full flight 40 s; course 5 has a contact in full."""
    flights = []

    def fly(plan, folder):
        planning = plan.fly is not None
        flights.append((planning, plan.number))
        hit = (
            {"failures": "contact", "contacts": 1, "clearance_min_m": 0.0} if plan.number == 5 and not planning else {}
        )
        figures = {"clearance_min_m": CLEARANCES[plan.number], "cpu_s": 10.0 if planning else 40.0, **hit}
        (folder / f".{plan.name}").mkdir(exist_ok=True)
        return result_of(run_dir=str(folder / f".{plan.name}"), **figures)

    monkeypatch.setattr(engine, "fly_plan", fly)
    monkeypatch.setattr("gcs.app.campaigns.WorkerProcesses", InThisThread)
    return flights


def command(folder, *words, count=6):
    kinds = ["--kinds", "poles", "--count", str(count), "--jobs", "1"]
    return main(["courses", *kinds, "--out", str(folder / "out"), *words])


def test_nearest_misses_are_flown_in_full_until_the_budget_is_used(tmp_path, flown, capsys, pictures):
    # All six planned: 60 s; two flights at 30 s each, by which more are expected not to fit.
    assert command(tmp_path, "--level", "both", "--budget", "125s") == 1
    assert flown == [*((True, number) for number in range(1, 7)), (False, 2), (False, 5)]
    said = capsys.readouterr().out
    assert "4 not decided, with 0.70 m or more of planned clearance. Contacts in full flights of less: 1 of 2." in said
    assert "at most 97.5% of those not decided have one (95%, Clopper-Pearson):\n  0004-poles: passed, 0.70 m\n" in said
    assert "0005-poles: passed by planning, 0.50 m; in full failed (contact), 0.00 m" in said
    # Nothing is flown twice; a larger budget goes on where the other one ended.
    assert command(tmp_path, "--level", "both", "--budget", "125s") == 1 and len(flown) == 8
    assert command(tmp_path, "--level", "both") == 1
    assert flown[8:] == [(False, 4), (False, 6), (False, 1), (False, 3)]
    assert "not decided" not in capsys.readouterr().out.split("0004-poles")[-1]
    assert command(tmp_path, "--level", "full") == 1 and command(tmp_path, "--level", "planning") == 0
    assert len(flown) == 12


def test_budget_that_holds_no_flight_leaves_all_undecided(tmp_path, flown, capsys):
    assert command(tmp_path, "--level", "both", "--budget", "0m", count=2) == 0
    assert flown == [(True, 1), (True, 2)]
    assert "Contacts in full flights of less: 0 of 0." in (said := capsys.readouterr().out) and "at most 100.0%" in said


def test_bound_counts_only_flights_of_less_planned_clearance(tmp_path, flown, capsys):
    assert command(tmp_path, count=1) == 0  # in full, with the most clearance but one of which none is known
    assert command(tmp_path, "--level", "both", "--budget", "185s") == 1
    assert [number for planning, number in flown if not planning] == [1, 2, 5]
    assert "3 not decided" in (said := capsys.readouterr().out) and "Contacts in full flights of less: 1 of 2." in said


def test_levels_share_a_folder_in_any_order(tmp_path, flown):
    for level in ("planning", "full", "both", "planning"):
        assert command(tmp_path, "--level", level, count=1) == 0
    assert flown == [(True, 1), (False, 1)]


@pytest.mark.parametrize("flights", [1, 10, 59])
def test_bound_without_a_contact_is_exact(flights):
    assert contact_bound(0, flights) == pytest.approx(1.0 - 0.05 ** (1.0 / flights))


def test_bound_with_contacts_is_the_rate_at_which_as_few_come_in_one_case_of_twenty():
    p = contact_bound(2, 40)
    assert sum(math.comb(40, k) * p**k * (1.0 - p) ** (40 - k) for k in range(3)) == pytest.approx(0.05)
    assert contact_bound(3, 3) == 1.0


def test_table_of_levels_has_a_row_of_each_kind_and_of_all():
    planned = [Result(name=kind, kind=kind, passed=True, clearance_min_m=0.6, cpu_s=2.0) for kind in COURSES.kinds]
    full = [replace(result, clearance_min_m=0.5, cpu_s=6.0, passed=result.kind != "rooms") for result in planned]
    lines = markdown_table(rows(planned, full)).splitlines()
    assert len(lines) == 2 + len(planned) + 1
    assert lines[-1].split(" | ")[1:] == ["10", "9", "10", "9", "0.60 m", "0.50 m", "0.10 m", "20 s", "60 s |"]
