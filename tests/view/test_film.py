"""``gcs film``: what it refuses, and a short film, read back by the encoder's package."""

import os
import sys

import numpy as np
import pytest
from browser import REQUIRED, need_browser
from recorded_run import BALL, write_reference, write_truth

from gcs.app.cli import main
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.view import browser, film


@pytest.fixture
def folder(tmp_path):
    """Ten seconds past a sphere."""
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder, standing=[BALL])
    write_reference(folder)
    write_json(folder / "manifest.json", {"mission": {"name": "hover"}, "seed": 3, "command": ["gcs", "fly", "hover"]})
    return folder


@pytest.fixture
def reader():
    """The encoder's package; skips where it or a browser is missing."""
    need_browser()
    if os.environ.get(REQUIRED) != "1":
        pytest.importorskip("imageio_ffmpeg")
    import imageio_ffmpeg

    return imageio_ffmpeg


def files(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    "options, reason",
    [
        ("--size 641x360", "'641x360' is not WIDTHxHEIGHT, even numbers from 160 to 4096"),
        ("--size 64x64", "'64x64' is not WIDTHxHEIGHT"),
        ("--size wide", "'wide' is not WIDTHxHEIGHT"),
        ("--from 11", "--from 11: the flight is from 0 to 10 s"),
        ("--to nan", "--to nan: the flight is from 0 to 10 s"),
        ("--from 5 --to 5", "--from 5: must be before --to 5"),
        ("--speed 0", "'0' is not a number from 0.01 to 100"),
        ("--speed inf", "'inf' is not a number"),
        ("--fps 61", "'61' is not a whole number from 1 to 60"),
        ("--camera left", "--camera"),
        ("--out film.avi", "must end in .mp4, .webp, .gif"),
        ("--out nowhere/film.mp4", "nowhere/film.mp4: cannot be written: No such file or directory"),
    ],
)
def test_what_cannot_be_filmed_is_refused(options, reason, folder, monkeypatch, capsys):
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.chdir(folder.parent)
    before = files(folder.parent)
    try:
        status = main(["film", str(folder), *options.split()])
    except SystemExit as end:  # argparse
        status = end.code
    assert status == 2
    *usage, last = capsys.readouterr().err.strip().splitlines()
    assert reason in last and (not usage or usage[0].startswith("usage:"))
    assert files(folder.parent) == before


def test_run_without_rows_is_refused(tmp_path, capsys):
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder, rows=0)
    assert main(["film", str(folder)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_run_that_does_not_exist_is_refused(tmp_path, capsys):
    assert main(["film", str(tmp_path / "none")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_without_a_browser_it_says_what_to_install(folder, monkeypatch, capsys):
    pytest.importorskip("imageio_ffmpeg")
    monkeypatch.setattr(browser.shutil, "which", lambda name: None)
    before = files(folder)
    assert main(["film", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "apt-get install chromium" in error
    assert files(folder) == before


def test_without_the_extra_it_says_what_to_install(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert main(["film", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "pip install 'cooplift[film]'" in error


@pytest.mark.slow
def test_film_has_a_frame_for_each_moment(folder, tmp_path, reader, capsys):
    out = tmp_path / "short.mp4"
    options = f"--out {out} --from 4 --to 7 --speed 2 --size 320x180 --fps 10".split()
    assert main(["film", str(folder), *options]) == 0
    assert capsys.readouterr().out.strip() == str(out)
    frames = reader.read_frames(str(out))
    about = next(frames)
    assert about["size"] == (320, 180) and about["fps"] == 10 and about["duration"] == pytest.approx(1.5)
    pictures = [np.frombuffer(frame, np.uint8).reshape(180, 320, 3).astype(int) for frame in frames]
    assert len(pictures) == 15
    # The formation moves past the sphere: no two moments a second of the flight apart look the same.
    assert all(np.abs(a - b).max() > 40 for a, b in zip(pictures, pictures[5:], strict=False))
    assert {path.name for path in tmp_path.iterdir()} == {"run", "short.mp4"}


@pytest.mark.slow
def test_film_as_an_animated_picture(folder, tmp_path, reader):
    options = ["--from", "4", "--to", "5", "--speed", "4", "--size", "320x180", "--fps", "12", "--camera", "top"]
    for suffix in ("gif", "webp"):
        assert main(["film", str(folder), "--out", str(tmp_path / f"short.{suffix}"), *options]) == 0
    assert reader.count_frames_and_secs(str(tmp_path / "short.gif"))[0] == 3
    content = (tmp_path / "short.webp").read_bytes()
    assert content.startswith(b"RIFF") and content.count(b"ANMF") == 3


@pytest.mark.slow
def test_interrupt_leaves_no_file(folder, reader, monkeypatch):
    taken = []

    def interrupted(browser, **parameters):
        taken.append(browser)
        if len(taken) == 3:
            raise KeyboardInterrupt
        return picture(browser, **parameters)

    picture = film.Browser.picture
    monkeypatch.setattr(film.Browser, "picture", interrupted)
    before = files(folder)
    with pytest.raises(KeyboardInterrupt):
        film.write_film(read_run(folder), film.FilmSettings(size=(320, 180)))
    assert files(folder) == before
    assert taken[0]._process.poll() is not None
