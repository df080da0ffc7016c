"""Take the screenshots of README.md: pages of a flight past obstacles, a fault, a comparison and a campaign.

    python tests/packaging/screenshots.py RUN FOLDER OUT

RUN is the folder of the flight past obstacles, FOLDER one for what is flown here, OUT where the pictures go.
"""

import sys
from pathlib import Path

import gcs
from gcs.app.cli import main as run_gcs
from gcs.record.run_data import read_run
from gcs.view.browser import Browser
from gcs.view.page import write_report

MISSION = "missions/figure_eight_spheres.toml"
SEED = 5001
# A position of one vehicle that drifts away, until it is isolated and flown without.
FAULT = gcs.Fault("drift", 12.0, 10.0, vehicles=(2,), settings={"channel": "position", "axes": ["x"], "rate": 0.3})
CAMPAIGN = """
[campaign]
name = "links and positions"
missions = ["{hover}"]
seeds = [1, 2]

[[fault]]
name = "random loss"
kind = "packet_loss"
start = 5.0
severity = {{ probability = [0.1, 0.3, 0.5] }}

[[fault]]
name = "position biased"
kind = "bias"
channel = "position"
vehicles = [3]
start = 5.0
severity = {{ amount = [0.2, 0.5, 1.0] }}
"""
SIZE = (1280, 800)


def main(run, folder, out):
    """Fly, write the pages and save what they show."""
    folder.mkdir(parents=True, exist_ok=True)
    gcs.fly(MISSION, seed=SEED, faults=[FAULT], run_dir=folder / "fault")
    campaign = folder / "campaign.toml"
    campaign.write_text(CAMPAIGN.format(hover=Path("missions/hover.toml").resolve()))
    run_gcs(["faults", str(campaign), "--out", str(folder / "campaign"), "--keep", "all"])
    run_gcs(["report", str(folder / "campaign")])
    clean, fault = read_run(run), read_run(folder / "fault")
    estimation = "[...document.querySelectorAll('#plots summary')].find((head) => head.textContent === 'Estimation')"
    pages = {
        "report": (write_report(clean), ""),
        "report_fault": (write_report(fault), f"{estimation}.scrollIntoView()"),
        "report_comparison": (write_report(fault, clean), "report.scene.setCamera('free')"),
        "report_campaign": (folder / "campaign" / "report.html", ""),
    }
    with Browser(folder / "profile") as browser:
        for name, (page, script) in pages.items():
            browser.open(page, *SIZE)
            browser.value(script)
            browser.frame()
            (out / f"{name}.webp").write_bytes(browser.picture(format="webp", quality=80))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
