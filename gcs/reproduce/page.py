"""``index.html``: what was reproduced, figure by figure, and the text with this run's numbers."""

import html
import math
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

_PLACE = re.compile(r"\{\{([\w.|]+)(?::([^}]*))?\}\}")
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
ABSENT = "n/a"
ANGLES = ("roll", "pitch", "yaw")

CAPTIONS = {
    "trackxyz.png": "trackxyz: position of the payload without obstacles.",
    "attrpy.png": "attrpy: attitude of the payload without obstacles; dashed: the 5 degrees of the paper.",
    "anim3d.png": "anim3d: snapshots, east-north-up.",
    "anim3d.gif": "The simulation without obstacles.",
    "trackObsxyz.png": "trackObsxyz: with two spheres; avoidance is shaded.",
    "attObsrpy.png": "attObsrpy: attitude with two spheres; avoidance is shaded.",
    "animObs3d.png": "animObs3d: snapshots with the spheres, at the moment of least clearance among others.",
    "animObs3d.gif": "The simulation with two spheres.",
    "sigmavsdev.png": "sigmavsdev: largest roll and pitch against noise.",
    "mass.png": "Mass uncertainty: control effort and tilt.",
    "margin.png": "Relative safety margin.",
    "gazObs.png": "gazObs, payTrajGaz: the obstacle scenario and the payload's path, in PyBullet through MAVLink.",
    "payloadObsGaz.png": "payloadObsGaz: the payload in the obstacle scenario.",
}


def paper_text(numbers: Mapping[str, Any], *, links: bool = True) -> str:
    """Return the text of ``docs/paper.md`` with its numbers from ``numbers``; those that a quick run lacks are n/a.

    Without ``links``: for another folder, where there are none of the pages that it links to.
    """
    template = resources.files("gcs.reproduce").joinpath("paper.md.in").read_text(encoding="utf-8")

    def put(match: re.Match[str]) -> str:
        value: Any = numbers
        for key in match[1].split("."):
            # A point within a key is written as a bar: 2|7.
            value = value.get(key.replace("|", ".")) if isinstance(value, Mapping) else None
        if value is None:
            return ABSENT
        return format(value, match[2]) if match[2] else str(value)

    return _PLACE.sub(put, template if links else _LINK.sub(r"\1", template))


def write_page(out: Path, numbers: Mapping[str, Any], pictures: Sequence[str], seconds: float) -> Path:
    """Write ``index.html`` into ``out``."""
    note = (
        "<p><b>Quick run.</b> Shorter simulations; without the flights in PyBullet through MAVLink (gazObs, "
        "payTrajGaz, payloadObsGaz), the project's controller in the studies, the repeats of the noise, and the other "
        "readings of the paper's filter. "
        "<code>gcs reproduce</code> without <code>--quick</code> has them all.</p>"
        if numbers["quick"]
        else ""
    )
    shown = "\n".join(
        f'<figure><img src="{name}" alt="{html.escape(CAPTIONS[name])}">'
        f"<figcaption>{html.escape(CAPTIONS[name])}</figcaption></figure>"
        for name in pictures
    )
    body = f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>The paper, reproduced</title><style>
body {{ font-family: sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color: #222; }}
img {{ max-width: 100%; }} figure {{ margin: 2em 0; }} figcaption {{ color: #555; }}
table {{ border-collapse: collapse; }}
td, th {{ border-bottom: 1px solid #ccc; padding: .2em .8em; text-align: right; }}
td:first-child, th:first-child {{ text-align: left; }}
</style></head><body>
<h1>The paper, reproduced</h1>
<p>Each figure of Section IV as printed (the paper's equations with the least that makes them run), with thrust and
torque about the exact reference, and with this project's controller, all on the corrected nonlinear plant.
Took {seconds:.0f} s.
Files: <a href="paper.md">paper.md</a> (equation by equation), <a href="numbers.json">numbers.json</a>,
<a href="matrices/">matrices</a>.</p>
{note}
{_relative_degrees(numbers["model"]["relative_degrees"])}
{_cases("Without obstacles", numbers.get("tracking", {}))}
{_cases("With two spheres", numbers.get("avoidance", {}))}
{_flights(numbers.get("flights", {}))}
{shown}
</body></html>
"""
    page = out / "index.html"
    page.write_text(body, encoding="utf-8")
    return page


def rounded(value: Any) -> Any:
    """Return numbers with their floats rounded to six significant digits, and None for those that are not finite."""
    if isinstance(value, Mapping):
        return {name: rounded(part) for name, part in value.items()}
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value


def _relative_degrees(table: Mapping[str, Mapping[str, Any]]) -> str:
    rows = [[name, *(str(by[axis]) for axis in "xyz")] for name, by in table.items()]
    return "<h2>Relative degree of the payload's position</h2>" + _table(["input", "x", "y", "z"], rows)


def _cases(title: str, section: Mapping[str, Any]) -> str:
    head = ["", "RMSE (m)", "roll (deg)", "pitch (deg)", "yaw (deg)", "clearance (m)", "infeasible (steps)", "lost"]
    rows = []
    for name, n in section.items():
        lost = "" if n["lost_at_s"] is None else f"at {n['lost_at_s']:.2f} s"
        infeasible = f"{n['tracking_infeasible_steps']} + {n['avoidance_infeasible_steps']} of {n['steps']}"
        cells = (n["rmse_m"]["total"], *(n[f"{axis}_max_deg"] for axis in ANGLES), n.get("clearance_min_m"))
        rows.append([name, *(_cell(value, ".3f") for value in cells), infeasible, lost])
    return f"<h2>{title}</h2>" + _table(head, rows)


def _flights(section: Mapping[str, Any]) -> str:
    if not section:
        return ""
    head = ["", "outcome", "clearance (m)", "contacts", "angle (deg)", "UAVs apart (m)"]
    keys = ("clearance_min_m", "contacts", "tilt_max_deg", "uav_separation_min_m")
    rows = [[name, n["outcome"], *(_cell(n[key], ".3g") for key in keys)] for name, n in section.items()]
    return "<h2>Flights in PyBullet</h2>" + _table(head, rows)


def _cell(value: float | None, form: str) -> str:
    return ABSENT if value is None else format(value, form)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{cells}</tr>{body}</table>"
