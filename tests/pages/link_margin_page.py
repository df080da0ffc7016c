"""The margins of ``docs/link-margin.md``, computed on the linear model, and its flights over latency and loss.

``python tests/pages/link_margin_page.py docs/link-margin.md``: both tables, and the picture beside the page. With
``--margins`` only the first table.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from page_tables import commit_of, made_by, markdown_table, renewed

import gcs
from gcs.config import SystemConfig
from gcs.flight.link_limit import latency_limit
from gcs.flight.stack import linear_model
from idc_controller.control.delay_margin import HoverLoop, expected_extra_age
from idc_controller.control.mpc import ModelPredictiveController

HERE = Path(__file__).parent
LATENCIES = (0.0, 0.05, 0.1, 0.125, 0.15)
LOSSES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
MARGIN_LATENCIES = (0.0, 0.025, 0.05, 0.075, 0.11, 0.15)
SEED = 4101
TOP_SPEED_AT = 9.5  # s after take-off: the lap's first leg is flown at 3 m/s


class Start(NamedTuple):
    """When latency and loss begin."""

    name: str
    mission: Path
    start: float


STARTS = (
    Start("from lift-off", HERE.parents[1] / "missions" / "hop.toml", 0.0),
    Start("at 3 m/s", HERE / "lap.toml", TOP_SPEED_AT),
)


class Flown(NamedTuple):
    """How a flight ended."""

    outcome: str
    tilt: float
    separation: float
    contacts: int

    @property
    def is_lost(self) -> bool:
        """True if control was lost: a contact, an overturned payload, or UAVs nearer than 0.6 m."""
        return bool(self.contacts) or self.tilt > 20.0 or self.separation < 0.6


def hover_loop(late: bool = False) -> HoverLoop:
    """Return the loop of the default system; ``late``: with the lower bandwidth."""
    system = SystemConfig()
    model = linear_model(system)
    mpc = replace(system.control.mpc, period=1.0 / system.rates.control, tuning=system.controller)
    return HoverLoop(model, ModelPredictiveController(model, mpc.late if late else mpc))


def margins() -> list[dict[str, str]]:
    """Return a row of the first table for each latency, cells by title."""
    system, rows = SystemConfig(), []
    loops = hover_loop(), hover_loop(late=True)
    period, settings = 1.0 / system.rates.control, system.flight.failsafe
    for latency in MARGIN_LATENCIES:
        age = 2.0 * latency + 1.0 / system.rates.telemetry
        steps = math.ceil(age / period - 1e-9)
        late = age > system.control.mpc.late_age
        loss = loops[late].loss_margin(steps)
        growth = [loop.mean_square_growth(steps, 0.0, late=1) for loop in loops]
        allowed = max((k for k in range(100) if latency_limit(settings, k / 100.0, period) >= latency), default=None)
        flown = "not flown" if allowed is None else f"{allowed / 100.0:.2f}"
        rows.append({
            "latency one way": f"{latency * 1e3:.0f} ms",
            "age of the newest known state": f"{steps} periods",
            "bandwidth": "lower" if late else "usual",
            "growth where set-points act a period late": f"{growth[late]:.2f} (usual bandwidth {growth[0]:.2f})"
            if late
            else f"{growth[0]:.2f}",
            "loss of set-points at which the mean square grows": f"{loss:.2f}",
            "age that it adds in the mean": f"{expected_extra_age(loss, period) * 1e3:.0f} ms",
            "loss up to which it is flown": "any" if latency <= settings.latency_any_loss else flown,
        })  # fmt: skip
    return rows


def fly(start: Start, latency: float, loss: float, seed: int = SEED) -> Flown:
    """Fly one case."""
    begin = {"start": start.start}
    faults = [{"kind": "latency", "delay": latency, **begin}] if latency else []
    faults += [{"kind": "packet_loss", "probability": loss, **begin}] if loss else []
    figures = gcs.fly(start.mission, seed=seed, faults=faults).figures
    tilt = max(figures["payload_tilt_max_deg"].values())
    return Flown(figures["outcome"], tilt, figures["uav_separation_min_m"], figures["contacts"])


def main(arguments: Sequence[str]) -> int:
    """Write the tables, and the picture."""
    parser = argparse.ArgumentParser(description="Write the tables and the picture of the link margins.")
    parser.add_argument("page", type=Path, metavar="PAGE")
    parser.add_argument("--margins", action="store_true", help="only the table of the margins, without a flight")
    options = parser.parse_args(arguments)
    commit, command = commit_of(HERE.parent), f"python tests/pages/link_margin_page.py {options.page}"
    page = options.page.read_text(encoding="utf-8")
    page = renewed(page, "margins", f"\n{markdown_table(margins())}\n")
    if not options.margins:
        flown = {
            (start, latency, loss): fly(start, latency, loss)
            for start in STARTS for latency in LATENCIES for loss in LOSSES
        }  # fmt: skip
        page = renewed(page, "flights", made_by(command, commit, markdown_table(rows(flown))))
        draw(flown).savefig(options.page.parent / "link_margin.png", dpi=110)
    options.page.write_text(page, encoding="utf-8")
    return 0


def rows(flown: dict[tuple[Start, float, float], Flown]) -> list[dict[str, str]]:
    """Return a row for each start, cells by title."""
    found = []
    for start in STARTS:
        own = [flight for (of, _, _), flight in flown.items() if of is start]
        found.append({
            "begins": start.name,
            "flights": f"{len(own)}",
            "completed": f"{sum(flight.outcome == 'completed' for flight in own)}",
            "ended and landed": f"{sum(flight.outcome == 'aborted' and not flight.is_lost for flight in own)}",
            "control lost": f"{sum(flight.is_lost for flight in own)}",
            "largest payload angle": f"{max(flight.tilt for flight in own):.1f} deg",
            "least UAV separation": f"{min(flight.separation for flight in own):.2f} m",
        })  # fmt: skip
    return found


def draw(flown: dict[tuple[Start, float, float], Flown]) -> Figure:
    """Return the picture: one square a flight, by its end, with the largest payload angle in it (deg)."""
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    colours = {"completed": "#7fbf7f", "aborted": "#f2c46d"}
    for axes, start in zip(figure.subplots(1, len(STARTS), sharey=True), STARTS, strict=True):
        for (of, latency, loss), flight in flown.items():
            if of is not start:
                continue
            x, y = LOSSES.index(loss), LATENCIES.index(latency)
            colour = "#d95f5f" if flight.is_lost else colours.get(flight.outcome, "#d95f5f")
            axes.add_patch(_square(x, y, colour))
            axes.text(x, y, f"{flight.tilt:.1f}", ha="center", va="center", fontsize=9)
        axes.set(
            title=f"latency and loss {start.name}", xlabel="loss of datagrams, both ways",
            xlim=(-0.5, len(LOSSES) - 0.5), ylim=(-0.5, len(LATENCIES) - 0.5),
            xticks=range(len(LOSSES)), xticklabels=[f"{loss:.0%}" for loss in LOSSES],
            yticks=range(len(LATENCIES)), yticklabels=[f"{latency * 1e3:.0f} ms" for latency in LATENCIES],
        )  # fmt: skip
    figure.axes[0].set_ylabel("latency, one way")
    handles = [_square(0, 0, colour) for colour in (*colours.values(), "#d95f5f")]
    labels = ["completed", "ended and landed", "control lost"]
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    return figure


def _square(x: float, y: float, colour: str) -> Rectangle:
    return Rectangle((x - 0.47, y - 0.47), 0.94, 0.94, facecolor=colour, edgecolor="none")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
