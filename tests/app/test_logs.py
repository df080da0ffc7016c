"""The log of the programs: what is shown at which level, and the log file."""

import argparse
import logging
import subprocess
import sys

import pytest

from gcs.app.cli import main
from gcs.app.logs import add_log_arguments, logging_to

LEVELS = (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR)


def log_one_line_per_level(*words):
    parser = argparse.ArgumentParser()
    add_log_arguments(parser)
    with logging_to(parser.parse_args(words)):
        for name in ("gcs", "vehicle_sim"):
            for level in LEVELS:
                logging.getLogger(name).log(level, "%s %d", name, level)


@pytest.mark.parametrize(("words", "least"), [([], 30), (["-v"], 20), (["-vv"], 10), (["-q"], 40), (["-qv"], 30)])
def test_log_shows_levels_chosen_by_options(words, least, capsys):
    log_one_line_per_level(*words)
    shown = [f"{name} {level}" for name in ("gcs", "vehicle_sim") for level in LEVELS if level >= least]
    assert capsys.readouterr().err.splitlines() == shown


def test_log_file_holds_every_level(tmp_path, capsys):
    path = tmp_path / "flight.log"
    for _ in range(2):
        log_one_line_per_level("-q", "--log-file", str(path))
    lines = path.read_text().splitlines()
    assert len(lines) == 2 * 2 * len(LEVELS) and lines[0].endswith("DEBUG   gcs: gcs 10")
    assert len(capsys.readouterr().err.splitlines()) == 2 * 2


def test_no_log_file_is_left_by_a_command_line_that_is_refused(tmp_path):
    (tmp_path / "old.log").touch()
    for name in ("new.log", "old.log"):
        assert main(["check", "--log-file", str(tmp_path / name), "--none"]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["old.log"]


def test_help_imports_no_command():
    code = "import sys; from gcs.app.cli import main\ntry: main(['--help'])\nexcept SystemExit: print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "gcs.app.cli" in modules and not {"numpy", "scipy", "pydantic", "matplotlib"} & set(modules)
