"""The report page of a run: one self-contained ``report.html`` in the run folder."""

import html
import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from gcs.errors import UnusableInput
from gcs.record.run_data import RunData
from gcs.view.page_data import PageData
from gcs.view.poster import write_poster

REPORT = "report.html"
_HERE = Path(__file__).parent


def report(run: RunData) -> list[Path]:
    """Write report page and poster of a run into its folder, and return their paths; see :func:`write_report`."""
    return [write_report(run), write_poster(run)]


def write_report(run: RunData, other: RunData | None = None) -> Path:
    """Write the report page of a run, or of two that are compared, into the first one's folder, and return its path.

    Raises :class:`UnusableInput` where nothing was flown, or where the page cannot be written.
    """
    text = report_text([run] if other is None else [run, other])
    name = REPORT if other is None else f"report-{other.folder.resolve().name}.html"
    return write_page(run.folder / name, text)


def report_text(runs: Sequence[RunData]) -> str:
    """Return the report page of a run, or of two that are compared; see :func:`write_report`."""
    for each in runs:
        if len(each.time) == 0:
            raise UnusableInput(f"{each.folder}: nothing was flown: there is no row in truth.csv or estimate.csv")
    documents = [PageData(each).document() for each in runs]
    first, *others = (header["meta"] for header, _ in documents)
    title = f"{first['mission']}, seed {first['seed']}: {first['outcome']}"
    for second in others:
        title += f", compared with {second['mission']}, seed {second['seed']}: {second['outcome']}"
    data = "\n".join(
        f'{script("run-header", header)}\n<script type="application/octet-stream" class="run-blob">{blob}</script>'
        for header, blob in documents
    )
    return page(title, data)


def page(title: str, data: str) -> str:
    """Return the page with its script and style, around ``data`` (HTML)."""
    parts = {
        "title": html.escape(title),
        "style": (_HERE / "page.bundle.css").read_text(encoding="utf-8"),
        "data": data,
        "script": (_HERE / "page.bundle.js").read_text(encoding="utf-8").replace("</script", "<\\/script"),
    }
    template = (_HERE / "page" / "page.html").read_text(encoding="utf-8")
    pieces = template.split("@")  # the names between two of them are the places
    return "".join(parts[piece] if k % 2 else piece for k, piece in enumerate(pieces))


def script(name: str, value: object) -> str:
    """Return an element of the page that holds a value (strict JSON), under a class by which its script finds it."""
    # Within a script, only "<" could end it.
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    return f'<script type="application/json" class="{name}">{text}</script>'


def write_page(path: Path, text: str) -> Path:
    """Write a page to ``path`` and return it. Raises :class:`UnusableInput` if it cannot be written."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path
