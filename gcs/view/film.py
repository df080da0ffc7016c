"""A film of a run: its report page, frame by frame, in a browser without a screen, encoded by ffmpeg."""

import json
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gcs.errors import GcsError, UnusableInput
from gcs.extras import extra
from gcs.record.run_data import RunData
from gcs.view.browser import Browser
from gcs.view.page import report_text, write_page

FILM = "film.mp4"
ENCODERS = {
    ".mp4": ["-c:v", "libx264", "-preset", "veryfast", "-crf", "23", "-pix_fmt", "yuv420p", "-movflags", "+faststart"],
    ".webp": ["-c:v", "libwebp_anim", "-quality", "60", "-compression_level", "4", "-loop", "0"],
    # A palette for each frame: one for all would keep all frames in memory.
    ".gif": ["-filter_complex", "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=none"],
}
"""Options of ffmpeg by the suffix of the file."""


@dataclass(frozen=True)
class FilmSettings:
    """What is shown, and how. Times are those of the run (s); ``None`` is its begin or end."""

    start: float | None = None
    end: float | None = None
    speed: float = 1.0
    """Seconds of the flight in one of the film."""
    size: tuple[int, int] = (960, 540)
    """Width and height (pixels), both even, as colours are subsampled (4:2:0)."""
    fps: int = 20
    view: str = "around"
    """A `View` of `page/film.js`."""

    def times(self, run: RunData) -> np.ndarray:
        """Return the times of the frames (s), shape (frames,). Raises :class:`UnusableInput` where there are none."""
        if len(run.time) == 0:
            raise UnusableInput(f"{run.folder}: nothing was flown: there is no row in truth.csv or estimate.csv")
        first, last = float(run.time[0]), float(run.time[-1])
        start = first if self.start is None else self.start
        end = last if self.end is None else self.end
        for option, value in (("--from", start), ("--to", end)):
            if not first <= value <= last:
                raise UnusableInput(f"{option} {value:g}: the flight is from {first:g} to {last:g} s")
        if start >= end:
            raise UnusableInput(f"--from {start:g}: must be before --to {end:g}")
        return start + np.arange(max(1, round((end - start) / self.speed * self.fps))) * self.speed / self.fps


def write_film(run: RunData, settings: FilmSettings, out: Path | None = None) -> Path:
    """Write a film of a run to ``out`` (default: into its folder), and return its path.

    Raises :class:`UnusableInput` where browser or encoder are missing, or times or path cannot be used, and
    :class:`GcsError` where one of them fails. A file appears only when it is whole.
    """
    out = run.folder / FILM if out is None else out
    if out.suffix not in ENCODERS:
        raise UnusableInput(f"--out {out}: must end in {', '.join(ENCODERS)}")
    times = settings.times(run)
    with extra("film", "gcs film"):
        from imageio_ffmpeg import get_ffmpeg_exe
    try:
        ffmpeg = get_ffmpeg_exe()
    except RuntimeError as error:
        raise UnusableInput(f"gcs film: {error}") from None
    part = out.with_name(f".{out.stem}.part{out.suffix}")
    try:
        with _writing(out):
            part.touch()
        with tempfile.TemporaryDirectory(prefix="gcs-film-", ignore_cleanup_errors=True) as folder:
            page = write_page(Path(folder) / "report.html", report_text([run]))
            with Browser(Path(folder) / "profile") as browser:
                browser.open(page, *settings.size)
                if not browser.value("Boolean(window.report?.scene)"):
                    raise GcsError(f"gcs film: the browser does not show the page: {'; '.join(browser.errors)}")
                browser.value(f"window.draw = report.film({json.dumps(settings.view)})")
                _encode(browser, times, settings.fps, ffmpeg, part)
        with _writing(out):
            part.replace(out)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
    return out


@contextmanager
def _writing(out: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise UnusableInput(f"{out}: cannot be written: {error.strerror}") from None


def _encode(browser: Browser, times: np.ndarray, fps: int, ffmpeg: str, path: Path) -> None:
    command = [
        ffmpeg, "-y", "-loglevel", "error", "-threads", "1", "-f", "image2pipe", "-framerate", str(fps), "-c:v",
        "mjpeg", "-i", "-", *ENCODERS[path.suffix], str(path),
    ]  # fmt: skip
    with tempfile.TemporaryFile() as said:
        try:
            encoder = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said, start_new_session=True)
        except OSError as error:
            raise GcsError(f"gcs film: {ffmpeg}: {error.strerror}") from None
        assert encoder.stdin is not None
        try:
            with suppress(BrokenPipeError), encoder.stdin as frames:
                for time in times:
                    browser.value(f"draw({time:.6f})")
                    frames.write(browser.picture(format="jpeg", quality=90, optimizeForSpeed=True))
            status = encoder.wait()
        finally:
            encoder.kill()
            encoder.wait()
        if status != 0:
            said.seek(0)
            raise GcsError(f"gcs film: ffmpeg: {said.read().decode(errors='replace').strip() or f'status {status}'}")
