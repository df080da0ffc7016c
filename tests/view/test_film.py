"""``gcs film``: what it refuses, and a short film, read back by the encoder's package."""

import imageio_ffmpeg
import numpy as np
import pytest
from browser import browser_path
from recorded_run import BALL, write_reference, write_truth

from gcs.app.cli import main
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.view import film


@pytest.fixture
def folder(tmp_path):
    """Ten seconds past a sphere."""
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder, standing=[BALL])
    write_reference(folder)
    write_json(folder / "manifest.json", {"mission": {"name": "hover"}, "seed": 3, "command": ["gcs", "fly", "hover"]})
    return folder


@pytest.mark.parametrize(
    "options, reason",
    [
        ("--size 641x360", "--size 641x360: must be even numbers"),
        ("--size 64x64", "--size 64x64: must be even numbers"),
        ("--size wide", "'wide' is not WIDTHxHEIGHT"),
        ("--from 11", "--from 11: the flight is from 0 to 10 s"),
        ("--to nan", "--to nan: the flight is from 0 to 10 s"),
        ("--from 5 --to 5", "--from 5: must be before --to 5"),
        ("--speed 0", "--speed 0: must be above 0"),
        ("--speed inf", "--speed inf: must be above 0"),
        ("--fps 61", "--fps 61: must be 1 to 60"),
        ("--camera left", "--camera"),
        ("--out film.avi", "must end in .mp4, .webp, .gif"),
        ("--out nowhere/film.mp4", "there is no folder nowhere"),
    ],
)
def test_what_cannot_be_filmed_is_refused(options, reason, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder.parent)
    before = {path: path.stat().st_mtime_ns for path in folder.parent.rglob("*")}
    try:
        status = main(["film", str(folder), *options.split()])
    except SystemExit as end:  # argparse
        status = end.code
    assert status == 2
    assert reason in capsys.readouterr().err
    assert before == {path: path.stat().st_mtime_ns for path in folder.parent.rglob("*")}


def test_run_without_rows_is_refused(tmp_path, capsys):
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder, rows=0)
    assert main(["film", str(folder)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_run_that_does_not_exist_is_refused(tmp_path, capsys):
    assert main(["film", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_without_a_browser_it_says_what_to_install(folder, monkeypatch, capsys):
    monkeypatch.setattr(film, "find_browser", lambda: None)
    assert main(["film", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "apt-get install chromium" in error


@pytest.mark.slow
def test_film_has_a_frame_for_each_moment(folder, tmp_path, capsys):
    browser_path()
    out = tmp_path / "short.mp4"
    options = f"--out {out} --from 4 --to 7 --speed 2 --size 320x180 --fps 10".split()
    assert main(["film", str(folder), *options]) == 0
    assert capsys.readouterr().out.strip() == str(out)
    frames = imageio_ffmpeg.read_frames(str(out))
    about = next(frames)
    assert about["size"] == (320, 180) and about["fps"] == 10 and about["duration"] == pytest.approx(1.5)
    pictures = [np.frombuffer(frame, np.uint8).reshape(180, 320, 3).astype(int) for frame in frames]
    assert len(pictures) == 15
    # The formation moves past the sphere: no two moments a second of the flight apart look the same.
    assert all(np.abs(a - b).max() > 40 for a, b in zip(pictures, pictures[5:], strict=False))
    assert {path.name for path in tmp_path.iterdir()} == {"run", "short.mp4"}


@pytest.mark.slow
def test_interrupt_leaves_no_file(folder, tmp_path, monkeypatch):
    browser_path()
    taken = []

    def interrupted(browser, **parameters):
        taken.append(browser)
        if len(taken) == 3:
            raise KeyboardInterrupt
        return picture(browser, **parameters)

    picture = film.Browser.picture
    monkeypatch.setattr(film.Browser, "picture", interrupted)
    before = {path.name for path in folder.iterdir()}
    with pytest.raises(KeyboardInterrupt):
        film.write_film(read_run(folder), film.FilmSettings(size=(320, 180)))
    assert {path.name for path in folder.iterdir()} == before
    assert taken[0]._process.poll() is not None
