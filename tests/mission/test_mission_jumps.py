"""Jumps in a mission."""

from pathlib import Path

from mission_files import RETURN, TAKE_OFF, A, B, legs, north, plan, read, row, wpl

from gcs.mission.route import HoldForever, Land


def test_jump_repeats(tmp_path: Path) -> None:
    assert north(read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, 2), RETURN))) == [10, 20, 10, 20, 10, 20, 0]


def test_jump_zero_times_is_not_taken(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, 0), RETURN))
    assert north(mission) == [10, 20, 0]
    assert any("not taken" in note for note in mission.notes)


def test_endless_jump_is_lazy(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 2, -1), RETURN))
    assert len(legs(mission, 10_001)) == 10_001
    assert north(mission, 6) == [10, 20, 10, 20, 10]
    assert any("row 5" in note and "never reached" in note for note in mission.notes)


def test_jump_uses_file_index_past_unsupported_items(tmp_path: Path) -> None:
    camera = row(2000, frame=2, alt=0)
    assert north(read(tmp_path, wpl(camera, TAKE_OFF, camera, A, B, row(177, 5, 1), RETURN))) == [10, 20, 20, 0]
    # To an unsupported item: continue with the next.
    assert north(read(tmp_path, wpl(TAKE_OFF, A, camera, B, row(177, 3, 1), RETURN))) == [10, 20, 20, 0]


def test_plan_jumps_by_do_jump_id(tmp_path: Path) -> None:
    document = plan(TAKE_OFF, A, B, row(177, 70, 1), RETURN)
    document["mission"]["items"][2]["doJumpId"] = 70
    assert north(read(tmp_path, document)) == [10, 20, 20, 0]


def test_jump_tags(tmp_path: Path) -> None:
    assert north(read(tmp_path, wpl(TAKE_OFF, A, row(600, 7, alt=0), B, A, row(601, 7, 2), RETURN))) == [
        10, 20, 10, 20, 10, 20, 10, 0,
    ]  # fmt: skip


def test_nested_jumps_keep_their_count(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, row(177, 3, 1), row(177, 2, 1), RETURN))
    assert north(mission) == [10, 20, 20, 10, 20, 0]


def test_jump_forward(tmp_path: Path) -> None:
    mission = read(tmp_path, wpl(TAKE_OFF, row(177, 4, -1), A, B, RETURN))
    assert north(mission) == [20, 0]
    assert any("row 3" in note and "never reached" in note for note in mission.notes)


def test_lap_without_motion_is_a_hold(tmp_path: Path) -> None:
    found = legs(read(tmp_path, wpl(TAKE_OFF, A, row(177, 2, -1))), 1000)
    assert isinstance(found[-1], HoldForever) and len(found) < 6
    assert isinstance(legs(read(tmp_path, wpl(TAKE_OFF, A, row(177, 2, 1_000_000_000))), 1000)[-1], Land)
